/* SPDX-License-Identifier: MIT
 *
 * Two renderers of one scene held against each other, with their noise taken out by two
 * independent frames each.
 *
 * With X_A, X_B two seeds of one renderer and Y_A, Y_B of the other (a deterministic renderer gives
 * the same frame twice), the product (X_A - Y_A)(X_B - Y_B) has the square of the true difference
 * as its mean: the noise of the two factors is independent and drops out.
 */
#ifndef NEPH_METRICS_PAIR_H
#define NEPH_METRICS_PAIR_H

#include "base/image.h"
#include "metrics/mask.h"

/* Below these, two renderers are said to agree: what a report means to resolve. */
#define NEPH_PAIR_MEAN_MEANT 1e-3 /* of the mean radiance */
#define NEPH_PAIR_RMS_MEANT 1e-2  /* of the mean radiance, pixel by pixel */

enum neph_pair_verdict {
    NEPH_PAIR_AGREE,       /* the difference is certainly smaller than what is meant */
    NEPH_PAIR_DIFFER,      /* certainly there, and larger than what is meant */
    NEPH_PAIR_CANNOT_TELL, /* the noise is too large for either */
    NEPH_PAIR_VERDICT_COUNT,
};

/* All relative to the mean of both renderers over the mask; intervals at the level asked for, by
 * bootstrap over tiles (interval.h), taken as normal. */
struct neph_pair {
    double mean_difference, mean_low, mean_high; /* X - Y */
    double rms_difference;          /* noise taken out; 0 when the product is negative */
    double square_low, square_high; /* interval of the squared rms difference */
    double noise_floor;             /* rms of the noise of the difference of the means */
    enum neph_pair_verdict verdict;
};

/* `frames` are X_A, X_B, Y_A, Y_B of one size; `x_b` may be `x_a` itself. `critical_z`: half the
 * interval in standard errors (1.96 for 95 %; neph_normal_critical of Sidak's level for many
 * pairs). NEPH_ERR_GATE: a pixel is not finite. NEPH_ERR_UNSUPPORTED: too few tiles in the mask
 * for an interval, or the radiance is 0 everywhere. */
enum neph_status neph_pair_compare(const struct neph_image *const frames[4],
                                   const struct neph_mask *mask, double critical_z,
                                   struct neph_pair *pair, struct neph_diag *diag);

const char *neph_pair_verdict_name(enum neph_pair_verdict verdict);

#endif
