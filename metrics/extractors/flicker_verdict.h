/* SPDX-License-Identifier: MIT
 *
 * What flicker over a mask is called, from its numbers: constants in one place, with their reasons.
 */
#ifndef NEPH_METRICS_EXTRACTORS_FLICKER_VERDICT_H
#define NEPH_METRICS_EXTRACTORS_FLICKER_VERDICT_H

#include "metrics/extractors/flicker_spectrum.h"

/* A step of an 8-bit display, in luma: what is smaller cannot be shown. */
#define NEPH_FLICKER_STEP (1.0 / 255.0)

/* Level at which a pixel's cycle stands out of noise, for both periods together (Sidak). */
#define NEPH_FLICKER_ALPHA 1e-5

/* A mask is called cyclic, or restless, when more than this share of it is. Normal noise marks a
 * share of NEPH_FLICKER_ALPHA of the pixels as cyclic on average; by Markov's inequality the share
 * is above this in at most ALPHA / SHARE = 1 % of all sequences, however the noise of one pixel
 * depends on that of others. Fireflies, which are rare and clamped to one value, can fall into a
 * rhythm: up to 6e-4 of the pixels were marked in simulations (16 to 256 frames, 1 to 25 % of them
 * hit), 3e-5 when their strength varies. In a mask of some hundred pixels that is one now and then.
 */
#define NEPH_FLICKER_SHARE 1e-3

/* Whether a pixel has a cycle: more than a step of the display at the period of four or of two
 * frames, after the noise floor is subtracted, and significant there. */
bool neph_flicker_is_cyclic(const struct neph_flicker_spectrum *luma);

/* How far a pixel moves from frame to frame beyond what a fade can: max(0, mad - 2 p2p / (N - 1)),
 * with mad the mean |d_t - d_(t-1)| and p2p the range of d. A signal that rises or falls all the
 * time travels p2p in N - 1 steps, one that does so there and back twice that: both are 0 here. Of
 * white noise nearly all of mad is left. In the unit of the signal. */
double neph_flicker_unrest(double mad, double peak_to_peak, int frame_count);

enum neph_flicker_kind {
    NEPH_FLICKER_CALM,     /* still, or it fades */
    NEPH_FLICKER_RESTLESS, /* it flickers, but not in the cycle */
    NEPH_FLICKER_CYCLIC,   /* the cycle of four frames shows */
    NEPH_FLICKER_KIND_COUNT,
};

/* The kind of a mask of which `cyclic_share` is cyclic and `restless_share` has an unrest above a
 * step of the display (the metrics of these names). */
enum neph_flicker_kind neph_flicker_verdict(double cyclic_share, double restless_share);

/* "cyclic", "restless" or "calm". */
const char *neph_flicker_kind_name(enum neph_flicker_kind kind);

/* How much stronger the flicker is at edges than elsewhere: ratio of the two 95th percentiles of
 * four-frame flicker, the second one floored at a quarter of a step of the display, 1/1020, so that
 * a clean surrounding does not make a ratio of nothing. 1 for two equal numbers above that. */
double neph_flicker_edge_ratio(double edge_a4_p95, double other_a4_p95);

/* Whether a number of flicker says more about the reference than about the test: the same number
 * of the reference alone is above a third of it. */
bool neph_flicker_reference_limited(double test, double reference);

#endif
