/* SPDX-License-Identifier: MIT
 *
 * From series of displayed luminance to contrasts over threshold, side by side.
 */
#ifndef NEPH_METRICS_EXTRACTORS_SEEN_CONTRAST_H
#define NEPH_METRICS_EXTRACTORS_SEEN_CONTRAST_H

#include "metrics/extractors/seen_gain.h"
#include "metrics/extractors/seen_spectrum.h"

/* What is found of the series, by lane. */
struct neph_seen_lanes {
    float contrast[NEPH_SEEN_LANES]; /* over threshold; 1 is at it */
    float hertz[NEPH_SEEN_LANES];    /* where most of it lies; NaN when there is none */
};

/* `energies` as neph_seen_spectrum() gives them, which become contrasts squared; luminances by
 * lane, as levels of `gains` and in cd/m2. */
void neph_seen_weigh(const struct neph_seen_gains *gains, const float *levels,
                     const float *luminances_cd_per_m2, double bin_hz, float *energies,
                     struct neph_seen_lanes *found);

/* Where the energy around the largest bin has its centre [Hz]; NaN when there is none. Bins are
 * `stride` apart. */
float neph_seen_peak_hz(const float *energies, size_t stride, int bin_count, double bin_hz);

/* Largest response over time of the edge filter (eye.h), sampled at twice the rate of the frames,
 * which stand still before the first and after the last: between two frames the difference of two
 * exponential averages, of those before and of those after, both fading by `fade` a frame. (In the
 * middle of a frame it is never larger than at both of its ends.) `room` as for
 * neph_seen_spectrum(). */
void neph_seen_pops(const float *series, size_t stride, int frame_count, double fade, float *room,
                    float pops[NEPH_SEEN_LANES]);

#endif
