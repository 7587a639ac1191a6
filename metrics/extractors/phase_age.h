/* SPDX-License-Identifier: MIT
 *
 * The slot schedule of renderers that trace one pixel in four per frame: the traced pixels of each
 * frame, and thus each pixel's age. A pixel's phase is its slot in a block of 2x2 slots; a slot is
 * one pixel, or a square of pixels when tracing runs at a lower resolution.
 */
#ifndef NEPH_METRICS_EXTRACTORS_PHASE_AGE_H
#define NEPH_METRICS_EXTRACTORS_PHASE_AGE_H

#include <stdbool.h>

enum { NEPH_PHASE_COUNT = 4, NEPH_AGE_COUNT = 4 };

/* The order in which the phases p = (x & 1) + 2 (y & 1) are traced. */
enum neph_slot_order {
    NEPH_SLOT_CLOCKWISE, /* (0,0) (1,0) (1,1) (0,1): Red Dead Redemption 2 (Bauer, SIGGRAPH 2019) */
    NEPH_SLOT_Z,         /* (0,0) (1,0) (0,1) (1,1) */
    NEPH_SLOT_DIAGONAL,  /* (0,0) (1,1) (1,0) (0,1): Bayer's */
    NEPH_SLOT_ORDER_COUNT,
};

struct neph_phase_age {
    enum neph_slot_order order;
    int first_slot;    /* position in the order that is traced in frame 0 */
    int slot_px;       /* side of a slot */
    bool checkerboard; /* blocks of 2x2 slots are one position ahead in the order if their column
                        * and row are both even or both odd: Red Dead Redemption 2 */
};

/* The phase of a pixel, 0..3. */
int neph_slot_phase(const struct neph_phase_age *scheme, int x_px, int y_px);

/* The frame, modulo 4, in which a pixel is `age` frames old (0: just traced). */
int neph_slot_frame_at_age(const struct neph_phase_age *scheme, int x_px, int y_px, int age);

/* Slope of the least-squares line through values at ages 0, 1, 2, 3 [per frame]. */
double neph_age_slope(const double values[NEPH_AGE_COUNT]);

#endif
