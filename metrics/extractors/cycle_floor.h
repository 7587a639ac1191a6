/* SPDX-License-Identifier: MIT
 *
 * The noise floor of a spectrum of any colour: a smooth curve through the powers, fitted robustly
 * against lines, and the scatter of the powers around the curve. The scatter is measured, because
 * an image of a million pixels may contain a million independent noise series, or only one.
 */
#ifndef NEPH_METRICS_EXTRACTORS_CYCLE_FLOOR_H
#define NEPH_METRICS_EXTRACTORS_CYCLE_FLOOR_H

#include <stdbool.h>

/* A frequency for the estimate of the noise. */
struct neph_cycle_probe {
    double per_frame; /* > 0 [cycles per frame] */
    double power;     /* power per degree of freedom; zero and less count as a tiny power */
    double bins;      /* its part of the spectrum in bins of 1 / N, at most 1 */
    int dof;          /* 2, or 1 at half a cycle per frame */
    bool is_noise;    /* usable for the curve: contains no found wave */
    double score;     /* standard deviations above the curve; set by neph_cycle_floor_fit() */
};

/* The scatter of the mean noise power over many series: a weighted sum of exponential variables,
 * one for each independent series. */
struct neph_cycle_scatter {
    double variance; /* of the power relative to its mean, for two degrees of freedom: 1 / number of
                      * series */
    double shape;    /* shape of the gamma distribution with the same mean, variance and skewness */
};

enum { NEPH_CYCLE_FLOOR_TERMS = 11 };

struct neph_cycle_floor {
    double coefficients[NEPH_CYCLE_FLOOR_TERMS]; /* Chebyshev series of ln(median power) in the
                                                    logarithm of the frequency */
    int term_count;
    double low, high; /* logarithms of the lowest and highest fitted frequency */
    struct neph_cycle_scatter scatter;
    double median;  /* median power relative to its mean */
    double widened; /* standard deviation of the probes' scores, at least 1 */
    const struct neph_cycle_probe *probes; /* borrowed, sorted by score */
    int probe_count;
    double bin; /* 1 / N [cycles per frame] */
};

/* Fit the floor. The curve is the least-absolute-deviations regression of ln(power) on the
 * polynomial, by iteratively reweighted least squares (E. J. Schlossmacher, JASA 68, 1973). Scores
 * come from a shifted gamma distribution with three moments (K. Pearson's type III), in the normal
 * approximation of E. B. Wilson and M. M. Hilferty (PNAS 17, 1931). They are divided by their own
 * deviation, the larger one of two: the deviation of the lower half, which contains no lines, and
 * the deviation from the upper quartile, which includes the curve's misfit. `probes` are reordered
 * and must stay valid with the floor. */
struct neph_cycle_floor neph_cycle_floor_fit(struct neph_cycle_probe *probes, int count, double bin,
                                             struct neph_cycle_scatter scatter);

/* The mean noise power at a frequency. */
double neph_cycle_floor_at(const struct neph_cycle_floor *floor, double per_frame);

/* Standard deviations of `probe` above the noise, and above the median of nearby probes if that
 * median is above the curve: a line is a single outlier, but a misfit of the curve raises all
 * probes nearby. */
double neph_cycle_floor_z(const struct neph_cycle_floor *floor,
                          const struct neph_cycle_probe *probe);

/* Whether the power exceeds eight times the powers of half of the nearby probes, independent of the
 * curve: near the ends of the spectrum a strong line bends the curve. */
bool neph_cycle_floor_is_outlier(const struct neph_cycle_floor *floor,
                                 const struct neph_cycle_probe *probe);

/* The power relative to its mean that is `z` above the noise, for two degrees of freedom. */
double neph_cycle_floor_ratio(const struct neph_cycle_floor *floor, double z);

#endif
