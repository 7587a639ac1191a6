/* SPDX-License-Identifier: MIT
 *
 * What the energy of a bin (seen_spectrum.h) counts for the eye: contrast over threshold squared =
 * gain * energy / luminance^2.
 *
 * A display holds each frame until the next. Of a sine at f in a sequence at the rate r it shows
 * sinc(f / r) of it at f, and an image of it at r - f that is sinc(1 - f / r): gain =
 * (S(f) sinc(f / r))^2 + (S(r - f) sinc(1 - f / r))^2. At f = r / 2 both are one, the fundamental
 * 4 / pi of a square wave. Images beyond r add less than a hundredth from 24 frames a second on.
 */
#ifndef NEPH_METRICS_EXTRACTORS_SEEN_GAIN_H
#define NEPH_METRICS_EXTRACTORS_SEEN_GAIN_H

#include "base/arena.h"

/* For a disk of `radius_deg`; 0 below NEPH_EYE_FLICKER_HZ. */
double neph_seen_gain(double frequency_hz, double frame_rate_hz, double luminance_cd_per_m2,
                      double radius_deg);

enum { NEPH_SEEN_LEVELS = 96 }; /* of luminance, equal steps of its logarithm */

/* The gains of all bins for a disk of 1 degree, over the luminances of a display. */
struct neph_seen_gains {
    int bin_count;
    double black_cd_per_m2, levels_per_octave;
    float *values; /* by bin and level */
};

/* Bins 0 .. bin_count - 1 lie `bin_hz` apart. The arena has the values.
 * NEPH_ERR_MEMORY, NEPH_ERR_INTERRUPTED. */
enum neph_status neph_seen_gains_create(int bin_count, double bin_hz, double frame_rate_hz,
                                        double black_cd_per_m2, double white_cd_per_m2,
                                        struct neph_arena *memory, struct neph_seen_gains *gains,
                                        struct neph_diag *diag);

/* Where a luminance lies among the levels, 0 .. NEPH_SEEN_LEVELS - 1. */
float neph_seen_level(const struct neph_seen_gains *gains, double luminance_cd_per_m2);

#endif
