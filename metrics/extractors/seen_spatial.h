/* SPDX-License-Identifier: MIT
 *
 * The eye's fall over spatial frequency as a filter of a plane: all frequencies up to that of the
 * pixels, each by neph_eye_spatial(). Denes and Mantiuk, HVEI 2020, weigh the squares of the octave
 * bands of a Laplacian pyramid. Its bands overlap: a grating of contrast c comes out as 0.6 c to
 * 0.94 c, and a threshold is no threshold.
 *
 * Other models fall faster: of the sensitivity at 1 cycle per degree and 7.5 Hz, castleCSF (Ashraf
 * et al., Journal of Vision 24(4), 2024) leaves 0.26 at 16, this one 0.70. A dither from pixel to
 * pixel is judged severely here.
 */
#ifndef NEPH_METRICS_EXTRACTORS_SEEN_SPATIAL_H
#define NEPH_METRICS_EXTRACTORS_SEEN_SPATIAL_H

#include "base/status.h"

enum { NEPH_SEEN_RADIUS_MAX_PX = 16 };

struct neph_seen_filter {
    int radius_px;
    /* By distance in y and x; where a distance is 0, half of it. They sum to 1: what is uniform
     * stays. */
    float weights[NEPH_SEEN_RADIUS_MAX_PX + 1][NEPH_SEEN_RADIUS_MAX_PX + 1];
};

/* The Fourier series of the fall, cut at a fifteenth of a degree: right to 3 % of itself, 6 % at
 * the frequency of the pixels (60 pixels per degree). */
struct neph_seen_filter neph_seen_filter_of(double pixels_per_degree);

/* One row of the filtered plane. `wide`: room for width + 2 radius_px values. */
void neph_seen_filter_row(const struct neph_seen_filter *filter, const float *plane, int width_px,
                          int height_px, int row, float *wide, float *filtered);

#endif
