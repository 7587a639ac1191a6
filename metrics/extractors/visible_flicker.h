/* SPDX-License-Identifier: MIT
 *
 * A model, not a truth: how far the flicker of a cycle of four frames lies above the threshold of
 * the eye, at the rate and the distance at which the display is looked at.
 */
#ifndef NEPH_METRICS_EXTRACTORS_VISIBLE_FLICKER_H
#define NEPH_METRICS_EXTRACTORS_VISIBLE_FLICKER_H

#include "base/status.h"

/* Contrast dL / L of the peak of the sensitivity to flicker, 5 Hz at 4 cycles per degree, 100
 * cd/m2: castleCSF (Ashraf, Mantiuk, Chapiro, Wuerger, Journal of Vision 24(4), 2024). */
#define NEPH_VISIBLE_FLICKER_THRESHOLD 0.011

/* The display shows no less than this of its white (a contrast of 1000:1, as desk monitors have),
 * so that flicker in what is darker is not divided by almost nothing. */
#define NEPH_VISIBLE_FLICKER_BLACK 1e-3

/* Weight of a frequency in the transient channel, 1 at its peak of 5 Hz:
 * exp(-(f^0.1898 - 5^0.1898)^2 / 0.1231) (FovVideoVDP, Mantiuk et al., ACM TOG 40(4), 2021, eq. 5
 * with the values of ColorVideoVDP 0.5). */
double neph_visible_flicker_weight(double frequency_hz);

/* One row of the parts of the cycle of the displayed luminance, as in flicker_spectrum.h, and of
 * its mean in time; display white is 1. Called from several threads. */
typedef void neph_visible_flicker_row(const void *context, int row, double *quarter_cos,
                                      double *quarter_sin, double *half, double *mean);

struct neph_visible_flicker_params {
    int width_px, height_px;
    double frame_rate_hz, pixels_per_degree;
    neph_visible_flicker_row *row;
    const void *context;
};

/* V = sqrt((w(rate / 4) a4)^2 + (w(rate / 2) a2)^2) / 0.011 of every pixel, with a the amplitudes
 * divided by the mean, all after FLIP's filter of the achromatic channel (Andersson et al., HPG
 * 2020, section 4.1.1; the border continues the outermost pixel). Above 1: likely to be seen.
 * `values`: width * height. Errors: NEPH_ERR_MEMORY, NEPH_ERR_INTERRUPTED. */
enum neph_status neph_visible_flicker(const struct neph_visible_flicker_params *params,
                                      double *values, struct neph_diag *diag);

#endif
