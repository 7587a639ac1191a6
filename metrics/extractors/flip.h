/* SPDX-License-Identifier: MIT
 *
 * LDR-FLIP: how different two pictures look when they are shown in turn at the same place of a
 * display [Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom, Fairchild: FLIP: A Difference
 * Evaluator for Alternating Images, HPG 2020; the constants of NVlabs/flip 1.6]. In double
 * precision, 0 for equal pixels in equal surroundings and 1 at most, symmetric to the last bit.
 */
#ifndef NEPH_METRICS_EXTRACTORS_FLIP_H
#define NEPH_METRICS_EXTRACTORS_FLIP_H

#include "base/arena.h"

/* The curves of NVlabs/flip. ACES and Hable are quotients of quadratics by channel, Reinhard
 * divides a colour by 1 + its luminance. Index of the choices in neph_flip_tones. */
enum neph_flip_tone {
    NEPH_FLIP_NONE,
    NEPH_FLIP_ACES,
    NEPH_FLIP_REINHARD,
    NEPH_FLIP_HABLE,
    NEPH_FLIP_TONE_COUNT,
};

/* Names in the order of enum neph_flip_tone, ends with NULL: choices of an option. */
extern const char *const neph_flip_tones[];

/* From linear Rec.709 to what the display shows: clamp(tone(2^exposure_ev * max(rgb, 0)), 0, 1). */
struct neph_flip_display {
    double exposure_ev; /* -300 .. 300, so that nothing overflows */
    enum neph_flip_tone tone;
};

/* The filters for a viewing distance and the memory to work in, for one caller at a time. */
struct neph_flip;

/* It lives in the arena. Errors: NEPH_ERR_INPUT for pixels per degree outside 1..1000. */
enum neph_status neph_flip_create(double pixels_per_degree, struct neph_arena *memory,
                                  struct neph_flip **flip, struct neph_diag *diag);

/* Planes of width * height finite samples; the borders are repeated outwards. Writes width * height
 * values to `map`: of each pixel the largest over the displays, of which there is at least one. The
 * same bits on any number of threads. Errors: NEPH_ERR_INTERRUPTED. */
enum neph_status neph_flip_map(struct neph_flip *flip, int width_px, int height_px,
                               const float *const reference[3], const float *const test[3],
                               const struct neph_flip_display *displays, int display_count,
                               double *map, struct neph_diag *diag);

/* The luminance x > 0 of grey that a curve maps to `value`, 0 < value < 1. */
double neph_flip_tone_inverse(enum neph_flip_tone tone, double value);

#endif
