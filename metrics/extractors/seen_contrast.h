/* SPDX-License-Identifier: MIT
 *
 * Converts series of displayed luminance to contrasts relative to the eye's threshold, several
 * series at a time.
 */
#ifndef NEPH_METRICS_EXTRACTORS_SEEN_CONTRAST_H
#define NEPH_METRICS_EXTRACTORS_SEEN_CONTRAST_H

#include "metrics/extractors/seen_gain.h"
#include "metrics/extractors/seen_spectrum.h"

/* Results for the series of each lane. */
struct neph_seen_lanes {
    float contrast[NEPH_SEEN_LANES]; /* relative to the threshold: 1 is just visible */
    float hertz[NEPH_SEEN_LANES];    /* frequency of most of it; NaN: none */
};

/* Weight `energies` of neph_seen_spectrum(): they become squared contrasts. Luminances per lane, as
 * levels of `gains` and in cd/m2. */
void neph_seen_weigh(const struct neph_seen_gains *gains, const float *levels,
                     const float *luminances_cd_per_m2, double bin_hz, float *energies,
                     struct neph_seen_lanes *found);

/* Centroid of the energy around the largest bin [Hz]; NaN: no energy. Bins are `stride` apart. */
float neph_seen_peak_hz(const float *energies, size_t stride, int bin_count, double bin_hz);

/* The largest response over time of the edge filter (eye.h), sampled at twice the frame rate;
 * frames before the first and after the last are constant. Between two frames the response is the
 * difference of two exponential averages, one of the earlier and one of the later frames, both with
 * the factor `fade` per frame. (In the middle of a frame it is never larger than at both of its
 * ends.) `room` as for neph_seen_spectrum(). */
void neph_seen_pops(const float *series, size_t stride, int frame_count, double fade, float *room,
                    float pops[NEPH_SEEN_LANES]);

#endif
