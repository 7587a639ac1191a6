/* SPDX-License-Identifier: MIT
 *
 * LDR-FLIP: the perceived difference of two images that alternate at the same place of a display
 * [Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom, Fairchild: FLIP: A Difference Evaluator
 * for Alternating Images, HPG 2020; the constants of NVlabs/flip 1.6]. Computed in double
 * precision; 0 for equal pixels in equal surroundings, at most 1, symmetric to the last bit.
 */
#ifndef NEPH_METRICS_EXTRACTORS_FLIP_H
#define NEPH_METRICS_EXTRACTORS_FLIP_H

#include "base/arena.h"

/* The tone curves of NVlabs/flip. ACES and Hable are quotients of quadratics per channel; Reinhard
 * divides a colour by 1 + its luminance. Index of neph_flip_tones. */
enum neph_flip_tone {
    NEPH_FLIP_NONE,
    NEPH_FLIP_ACES,
    NEPH_FLIP_REINHARD,
    NEPH_FLIP_HABLE,
    NEPH_FLIP_TONE_COUNT,
};

/* Names in the order of enum neph_flip_tone, for an option; ends with NULL. */
extern const char *const neph_flip_tones[];

/* The map from linear Rec.709 to the display: clamp(tone(2^exposure_ev * max(rgb, 0)), 0, 1). */
struct neph_flip_display {
    double exposure_ev; /* -300 .. 300, to avoid overflow */
    enum neph_flip_tone tone;
};

/* The filters for a viewing distance, with working memory for one caller at a time. */
struct neph_flip;

/* Create it in the arena. NEPH_ERR_INPUT: pixels per degree outside 1..1000. */
enum neph_status neph_flip_create(double pixels_per_degree, struct neph_arena *memory,
                                  struct neph_flip **flip, struct neph_diag *diag);

/* Compute the map. Planes have width * height finite samples; borders are repeated outwards. `map`
 * receives width * height values: for each pixel the largest over the displays (at least one). The
 * bits do not depend on the number of threads. NEPH_ERR_INTERRUPTED. */
enum neph_status neph_flip_map(struct neph_flip *flip, int width_px, int height_px,
                               const float *const reference[3], const float *const test[3],
                               const struct neph_flip_display *displays, int display_count,
                               double *map, struct neph_diag *diag);

/* The grey luminance x > 0 that a tone curve maps to `value`, 0 < value < 1. */
double neph_flip_tone_inverse(enum neph_flip_tone tone, double value);

#endif
