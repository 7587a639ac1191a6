/* SPDX-License-Identifier: MIT
 *
 * Classifies the flicker of a mask from its numbers. All thresholds are here, with their reasons.
 */
#ifndef NEPH_METRICS_EXTRACTORS_FLICKER_VERDICT_H
#define NEPH_METRICS_EXTRACTORS_FLICKER_VERDICT_H

#include "metrics/extractors/flicker_spectrum.h"

/* A step of an 8-bit display, in luma; smaller changes cannot be displayed. */
#define NEPH_FLICKER_STEP (1.0 / 255.0)

/* Significance level of a pixel's cycle, for both periods together (Sidak). */
#define NEPH_FLICKER_ALPHA 1e-5

/* A mask is cyclic, or restless, if more than this share of its pixels is. Normal noise marks on
 * average a share NEPH_FLICKER_ALPHA of the pixels as cyclic. By Markov's inequality the share
 * exceeds this limit in at most ALPHA / SHARE = 1 % of all sequences, for any dependence between
 * pixels. Fireflies, which are rare and clamped to one value, can look periodic: in simulations (16
 * to 256 frames, 1 to 25 % of them hit) up to 6e-4 of the pixels were marked, and 3e-5 with varying
 * strength. In a mask of some hundred pixels that is occasionally one pixel.
 */
#define NEPH_FLICKER_SHARE 1e-3

/* Whether a pixel is cyclic: its flicker at the period of four or of two frames, after subtraction
 * of the noise floor, is above a step of the display and significant. */
bool neph_flicker_is_cyclic(const struct neph_flicker_spectrum *luma);

/* The frame-to-frame change of a pixel beyond a fade: max(0, mad - 2 p2p / (N - 1)), with mad the
 * mean |d_t - d_(t-1)| and p2p the range of d. A monotonic signal moves p2p in N - 1 steps, a
 * signal that goes up and down again moves twice that: both give 0. White noise keeps nearly all of
 * mad. In the unit of the signal. */
double neph_flicker_unrest(double mad, double peak_to_peak, int frame_count);

enum neph_flicker_kind {
    NEPH_FLICKER_CALM,     /* static, or it fades */
    NEPH_FLICKER_RESTLESS, /* flickers, but not with the cycle */
    NEPH_FLICKER_CYCLIC,   /* has the cycle of four frames */
    NEPH_FLICKER_KIND_COUNT,
};

/* Classify a mask: `cyclic_share` and `restless_share` are the shares of pixels that are cyclic and
 * with an unrest above a step of the display (the metrics of these names). */
enum neph_flicker_kind neph_flicker_verdict(double cyclic_share, double restless_share);

/* "cyclic", "restless" or "calm". */
const char *neph_flicker_kind_name(enum neph_flicker_kind kind);

/* How much stronger flicker is at edges than elsewhere: ratio of the two 95th percentiles of
 * four-frame flicker. The second one is at least a quarter of a display step, 1/1020, so that clean
 * surroundings do not make a large ratio of tiny numbers. 1 for two equal numbers above that. */
double neph_flicker_edge_ratio(double edge_a4_p95, double other_a4_p95);

/* Whether a flicker number is limited by the reference: the same number of the reference by itself
 * is above a third of it. */
bool neph_flicker_reference_limited(double test, double reference);

#endif
