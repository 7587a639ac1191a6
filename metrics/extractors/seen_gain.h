/* SPDX-License-Identifier: MIT
 *
 * The weight of a spectral bin's energy (seen_spectrum.h) for the eye: squared contrast relative to
 * the threshold = gain * energy / luminance^2.
 *
 * A display shows each frame until the next (sample and hold). A sine at f in a sequence with the
 * rate r appears at f with the factor sinc(f / r), and as an image at r - f with the factor sinc(1
 * - f / r): gain = (S(f) sinc(f / r))^2 + (S(r - f) sinc(1 - f / r))^2. At f = r / 2 both are the
 * same component, the fundamental of a square wave with amplitude 4 / pi. Images beyond r add less
 * than a hundredth from 24 frames a second on.
 */
#ifndef NEPH_METRICS_EXTRACTORS_SEEN_GAIN_H
#define NEPH_METRICS_EXTRACTORS_SEEN_GAIN_H

#include "base/arena.h"

/* The gain for a disk of `radius_deg`; 0 below NEPH_EYE_FLICKER_HZ. */
double neph_seen_gain(double frequency_hz, double frame_rate_hz, double luminance_cd_per_m2,
                      double radius_deg);

enum { NEPH_SEEN_LEVELS = 96 }; /* levels of luminance, equally spaced in its logarithm */

/* The gains of all bins for a disk of 1 degree, over the luminances of a display. */
struct neph_seen_gains {
    int bin_count;
    double black_cd_per_m2, levels_per_octave;
    float *values; /* index: bin, level */
};

/* Compute the gains; bins 0 .. bin_count - 1 are `bin_hz` apart. The values are allocated in the
 * arena. NEPH_ERR_MEMORY, NEPH_ERR_INTERRUPTED. */
enum neph_status neph_seen_gains_create(int bin_count, double bin_hz, double frame_rate_hz,
                                        double black_cd_per_m2, double white_cd_per_m2,
                                        struct neph_arena *memory, struct neph_seen_gains *gains,
                                        struct neph_diag *diag);

/* The position of a luminance among the levels, 0 .. NEPH_SEEN_LEVELS - 1. */
float neph_seen_level(const struct neph_seen_gains *gains, double luminance_cd_per_m2);

#endif
