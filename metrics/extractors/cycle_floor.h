/* SPDX-License-Identifier: MIT
 *
 * The noise under a spectrum whatever its colour: a smooth curve through the powers that robustly
 * passes by the lines in it, and the scatter of the powers about the curve. The scatter is
 * measured, because a picture of a million pixels can have the noise of a million series, or that
 * of one.
 */
#ifndef NEPH_METRICS_EXTRACTORS_CYCLE_FLOOR_H
#define NEPH_METRICS_EXTRACTORS_CYCLE_FLOOR_H

#include <stdbool.h>

/* A frequency at which the noise may be looked at. */
struct neph_cycle_probe {
    double per_frame; /* > 0 [cycles per frame] */
    double power;     /* for each of its `dof`; what is not above 0 counts as hardly anything */
    double bins;      /* the part of the spectrum that it stands for, in bins of 1 / N: at most 1 */
    int dof;          /* 2, or 1 at half a cycle a frame */
    bool is_noise;    /* may be used for the curve */
    double score;     /* standard deviations above the curve; set by neph_cycle_floor_of() */
};

/* How the mean power of noise over many series scatters: as a weighted sum of exponential
 * variables, one for each series that is its own. */
struct neph_cycle_scatter {
    double variance; /* of the power over its mean, two degrees of freedom: 1 / number of series */
    double shape;    /* of the gamma distribution with the same mean, variance and skewness */
};

enum { NEPH_CYCLE_FLOOR_TERMS = 11 };

struct neph_cycle_floor {
    double coefficients[NEPH_CYCLE_FLOOR_TERMS]; /* Chebyshev series of ln(median power) in the
                                                    logarithm of the frequency */
    int term_count;
    double low, high; /* logarithms of the frequencies that it was made from */
    struct neph_cycle_scatter scatter;
    double median;  /* power over its mean */
    double widened; /* standard deviation of the scores of the probes, at least 1 */
    const struct neph_cycle_probe *probes; /* borrowed, in the order of their scores */
    int probe_count;
    double bin; /* 1 / N [cycles per frame] */
};

/* The curve is the regression of least absolute deviations of ln(power) on the polynomial (by
 * iteratively reweighted least squares: E. J. Schlossmacher, JASA 68, 1973). Scores are those of a
 * shifted gamma distribution of three moments (K. Pearson's type III) in the normal approximation
 * of E. B. Wilson and M. M. Hilferty (PNAS 17, 1931). They are divided by their own deviation: the
 * larger of that of the lower half, where no line is, and of the upper quartile, which holds what
 * the curve does not follow. `probes` come back in another order, and stay with the floor. */
struct neph_cycle_floor neph_cycle_floor_of(struct neph_cycle_probe *probes, int count, double bin,
                                            struct neph_cycle_scatter scatter);

/* The mean power of noise there. */
double neph_cycle_floor_at(const struct neph_cycle_floor *floor, double per_frame);

/* By how many standard deviations the power of `probe` is above the noise, and above the median of
 * the probes nearby where that is above the curve: a line stands alone, a curve that does not bend
 * enough is wrong for all of them. */
double neph_cycle_floor_z(const struct neph_cycle_floor *floor,
                          const struct neph_cycle_probe *probe);

/* Whether its power is above eight times the median of the probes nearby, whatever the curve says:
 * at the ends of the spectrum a strong line bends it. */
bool neph_cycle_floor_towers(const struct neph_cycle_floor *floor,
                             const struct neph_cycle_probe *probe);

/* The power over its mean that is `z` above it, for two degrees of freedom. */
double neph_cycle_floor_ratio(const struct neph_cycle_floor *floor, double z);

#endif
