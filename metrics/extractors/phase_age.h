/* SPDX-License-Identifier: MIT
 *
 * Renderers that trace one pixel in four per frame: which pixel is fresh in which frame, and so how
 * old each one is. A pixel's phase is its place in the 2x2 of slots; a slot is one pixel, or a
 * square of them when tracing runs at a lower resolution.
 */
#ifndef NEPH_METRICS_EXTRACTORS_PHASE_AGE_H
#define NEPH_METRICS_EXTRACTORS_PHASE_AGE_H

#include <stdbool.h>

enum { NEPH_PHASE_COUNT = 4, NEPH_AGE_COUNT = 4 };

/* In which order the phases p = (x & 1) + 2 (y & 1) are traced. */
enum neph_slot_order {
    NEPH_SLOT_CLOCKWISE, /* (0,0) (1,0) (1,1) (0,1): Red Dead Redemption 2 (Bauer, SIGGRAPH 2019) */
    NEPH_SLOT_Z,         /* (0,0) (1,0) (0,1) (1,1) */
    NEPH_SLOT_DIAGONAL,  /* (0,0) (1,1) (1,0) (0,1): Bayer's */
    NEPH_SLOT_ORDER_COUNT,
};

struct neph_phase_age {
    enum neph_slot_order order;
    int first_slot;    /* the place in the order that is traced in frame 0 */
    int slot_px;       /* side of a slot */
    bool checkerboard; /* the 2x2 of slots are one place ahead in the order where their column and
                          row are both even or both odd: Red Dead Redemption 2 */
};

/* 0..3. */
int neph_phase_of(const struct neph_phase_age *scheme, int x_px, int y_px);

/* The frame, modulo 4, in which a pixel is `age` frames old (0: fresh). */
int neph_frame_of_age(const struct neph_phase_age *scheme, int x_px, int y_px, int age);

/* Slope of the least-squares line through values at ages 0, 1, 2, 3 [per frame]. */
double neph_age_slope(const double values[NEPH_AGE_COUNT]);

#endif
