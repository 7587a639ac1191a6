/* SPDX-License-Identifier: MIT
 *
 * The eye's sensitivity over spatial frequency as a filter of a plane: all frequencies up to the
 * Nyquist frequency of the pixels, each weighted by neph_eye_spatial(). Denes and Mantiuk, HVEI
 * 2020, instead weight the squared octave bands of a Laplacian pyramid. Those bands overlap: a
 * grating of contrast c yields 0.6 c to 0.94 c, which distorts the threshold.
 *
 * Other models fall faster: relative to the sensitivity at 1 cycle per degree and 7.5 Hz, castleCSF
 * (Ashraf et al., Journal of Vision 24(4), 2024) has 0.26 at 16 cycles per degree, this model 0.70.
 * So this model is strict about dither between neighbouring pixels.
 */
#ifndef NEPH_METRICS_EXTRACTORS_SEEN_SPATIAL_H
#define NEPH_METRICS_EXTRACTORS_SEEN_SPATIAL_H

#include "base/status.h"

enum { NEPH_SEEN_RADIUS_MAX_PX = 16 };

struct neph_seen_filter {
    int radius_px;
    /* Index: distance in y and in x; halved where a distance is 0. They sum to 1: uniform values
     * are kept. */
    float weights[NEPH_SEEN_RADIUS_MAX_PX + 1][NEPH_SEEN_RADIUS_MAX_PX + 1];
};

/* The Fourier series of the sensitivity, cut at a fifteenth of a degree: the relative error is 3 %,
 * and 6 % at the frequency of the pixels (60 pixels per degree). */
struct neph_seen_filter neph_seen_filter_make(double pixels_per_degree);

/* Compute one row of the filtered plane. `wide`: memory for width + 2 radius_px values. */
void neph_seen_filter_row(const struct neph_seen_filter *filter, const float *plane, int width_px,
                          int height_px, int row, float *wide, float *filtered);

#endif
