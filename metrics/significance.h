/* SPDX-License-Identifier: MIT
 *
 * Statistical significance: z-scores of means, and thresholds for a whole family of tests, so that
 * a report of a hundred numbers has few false alarms.
 */
#ifndef NEPH_METRICS_SIGNIFICANCE_H
#define NEPH_METRICS_SIGNIFICANCE_H

#include <stddef.h>

/* Two-sided probability that a standard normal variable is at least |z| away from 0. */
double neph_normal_p(double z);

/* The |z| above which a two-sided normal test at level `alpha` rejects. alpha in (0, 1). */
double neph_normal_critical(double alpha);

/* The level of each of `count` independent tests at which the whole family has a false positive
 * with probability `family_alpha`: 1 - (1 - alpha)^(1/count). (Z. Sidak, JASA 62, 1967.) count >=
 * 1. */
double neph_sidak_alpha(double family_alpha, int count);

/* Two-sided probability that Student's t with `dof` > 0 degrees of freedom is at least |t| away
 * from 0: I_x(dof/2, 1/2) at x = dof / (dof + t^2), the regularised incomplete beta function by its
 * continued fraction (Abramowitz and Stegun 26.7.1, 26.5.8). Relative error below 1e-11 for dof up
 * to 1e4. */
double neph_student_p(double t, double dof);

/* The |t| above which a two-sided Student test at level `alpha` in (0, 1) rejects. Relative error
 * below 1e-11 for results below 1e8. */
double neph_student_critical(double alpha, double dof);

/* Probability that chi-squared with `dof` > 0 degrees of freedom is at least `value` >= 0:
 * Q(dof/2, value/2), the incomplete gamma function by its series or its continued fraction
 * (Abramowitz and Stegun 26.4.2, 6.5.29, 6.5.31). Relative error below 1e-9 for dof up to 1e6 and
 * results above 1e-100. */
double neph_chi_squared_p(double value, double dof);

/* Two-sided exact sign test: the probability that a fair coin falls at least as unevenly as
 * `positive` against `negative`; 1 if both are 0. (Dixon and Mood, JASA 41, 1946.) */
double neph_sign_p(int positive, int negative);

/* Adjust a family of `count` p-values: rejecting where adjusted <= alpha has any false positive
 * with probability at most alpha, for any dependence between the tests. (S. Holm, Scandinavian
 * Journal of Statistics 6, 1979.) The work grows with the square of `count`. */
void neph_holm(const double *p, int count, double *adjusted);

/* Mean and variance of z-scores over many pixels: 0 and 1 if the reported standard errors are
 * right. */
struct neph_z_moments {
    size_t count;
    double mean, variance;
};

/* z = (test - truth) / sqrt(variance) per sample. Left out are samples with variance 0 and
 * difference 0 (no randomness), and samples with a standard error below `floor`, where rounding
 * dominates the noise. A difference above the floor with variance 0 counts as infinite. */
struct neph_z_moments neph_z_scores(const float *test, const float *truth, const float *variance,
                                    size_t count, double floor);

/* The moments of the union of both sets. */
struct neph_z_moments neph_z_merge(struct neph_z_moments a, struct neph_z_moments b);

#endif
