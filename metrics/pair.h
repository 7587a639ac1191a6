/* SPDX-License-Identifier: MIT
 *
 * Comparison of two renderers of one scene, without their noise, from two independent frames each.
 *
 * X_A, X_B are two seeds of one renderer and Y_A, Y_B of the other (a deterministic renderer gives
 * the same frame twice). The mean of the product (X_A - Y_A)(X_B - Y_B) is the squared true
 * difference: the noise of the two factors is independent and cancels.
 */
#ifndef NEPH_METRICS_PAIR_H
#define NEPH_METRICS_PAIR_H

#include "base/image.h"
#include "metrics/mask.h"

/* Two renderers agree if their differences are below these limits: the resolution that a report
 * aims for. */
#define NEPH_PAIR_MEAN_MEANT 1e-3 /* of the mean radiance */
#define NEPH_PAIR_RMS_MEANT 1e-2  /* rms over pixels, relative to the mean radiance */

enum neph_pair_verdict {
    NEPH_PAIR_AGREE,       /* the difference is significantly smaller than the limits */
    NEPH_PAIR_DIFFER,      /* the difference is significant and larger than the limits */
    NEPH_PAIR_CANNOT_TELL, /* the noise is too large for either verdict */
    NEPH_PAIR_VERDICT_COUNT,
};

/* All values are relative to the mean of both renderers over the mask. Intervals have the requested
 * level, by a bootstrap over tiles (interval.h), assumed normal. */
struct neph_pair {
    double mean_difference, mean_low, mean_high; /* X - Y */
    double rms_difference;                       /* without noise; 0 if the product is negative */
    double square_low, square_high;              /* interval of the squared rms difference */
    double noise_floor; /* rms of the noise of the difference of the means */
    enum neph_pair_verdict verdict;
};

/* Compare X_A, X_B, Y_A, Y_B of one size; X_B may be X_A itself, and Y_B may be Y_A. `critical_z`:
 * half of the interval in standard errors (1.96 for 95 %; neph_normal_critical of Sidak's level for
 * many pairs). NEPH_ERR_GATE: a pixel is not finite. NEPH_ERR_UNSUPPORTED: too few tiles in the
 * mask for an interval, or the radiance is 0 everywhere. */
enum neph_status neph_pair_compare(const struct neph_image *const frames[4],
                                   const struct neph_mask *mask, double critical_z,
                                   struct neph_pair *pair, struct neph_diag *diag);

const char *neph_pair_verdict_name(enum neph_pair_verdict verdict);

#endif
