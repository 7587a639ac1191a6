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

/* Two-sided probability that Student's t with `dof` > 0 degrees of freedom is at least |t| away
 * from 0: I_x(dof/2, 1/2) at x = dof / (dof + t^2), the regularised incomplete beta function by its
 * continued fraction (Abramowitz and Stegun 26.7.1, 26.5.8). Relative error below 1e-11 for dof up
 * to 1e4. */
double neph_student_p(double t, double dof);

/* The |t| above which a two-sided Student test at level `alpha` in (0, 1) rejects. Relative error
 * below 1e-11 where it is below 1e8. */
double neph_student_critical(double alpha, double dof);

/* Two-sided exact sign test: how likely a fair coin falls at least as unevenly as `positive`
 * against `negative`, 1 when both are 0. (Dixon and Mood, JASA 41, 1946.) */
double neph_sign_p(int positive, int negative);

/* Adjust a family of `count` p-values, so that rejecting where adjusted <= alpha errs anywhere with
 * at most the probability alpha, however the tests hang together. (S. Holm, Scandinavian Journal of
 * Statistics 6, 1979.) Work grows with the square of `count`. */
void neph_holm(const double *p, int count, double *adjusted);

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
