/* SPDX-License-Identifier: MIT
 *
 * Is a difference more than chance? Z-scores of means, and one threshold for a whole family of
 * tests, so that a report of a hundred numbers does not cry wolf once a run.
 */
#ifndef NEPH_METRICS_SIGNIFICANCE_H
#define NEPH_METRICS_SIGNIFICANCE_H

#include <stddef.h>

/* Two-sided probability that a standard normal variable is at least |z| away from 0. */
double neph_normal_p(double z);

/* The |z| above which a two-sided normal test at level `alpha` rejects. alpha in (0, 1). */
double neph_normal_critical(double alpha);

/* The level of one test of `count` independent ones so that the family errs with probability
 * `family_alpha`: 1 - (1 - alpha)^(1/count). (Z. Sidak, JASA 62, 1967.) count >= 1. */
double neph_sidak_alpha(double family_alpha, int count);

/* The mean and variance of z-scores over many pixels: 0 and 1 when the reported standard errors
 * are right. */
struct neph_z_moments {
    size_t count;
    double mean, variance;
};

/* z = (test - truth) / sqrt(variance) per sample; samples whose variance is 0 and whose difference
 * is 0 are left out (nothing random happened there), and so are those whose standard error is below
 * `floor`: there the rounding of the numbers is seen and not their noise. A difference above the
 * floor without any variance counts as infinite and shows. */
struct neph_z_moments neph_z_scores(const float *test, const float *truth, const float *variance,
                                    size_t count, double floor);

/* The moments of both sets together. */
struct neph_z_moments neph_z_merge(struct neph_z_moments a, struct neph_z_moments b);

#endif
