/* SPDX-License-Identifier: MIT
 *
 * Limits from repeated runs: n runs of an unchanged renderer give one value each of m metrics; a
 * further run should stay within all m limits.
 *
 * Each limit is the upper prediction bound for one further value of a normal population: mean + k s
 * with k = t(n - 1; 1 - a / m) sqrt(1 + 1/n) (G. Hahn and W. Meeker, Statistical Intervals, 1991,
 * section 4.8), where a = (1 - share)(1 - confidence). Two statements follow, for any dependence
 * between the m numbers:
 *
 * - A further run exceeds any of the limits with probability at most a, in the mean over all sets
 *   of n runs (Bonferroni).
 * - So the share of further runs that exceed any limit is above 1 - share in at most a / (1 -
 *   share) = 1 - confidence of the sets (Markov's inequality): with this confidence the limits hold
 *   for this share of further runs.
 *
 * For one number this bound is wider than the tolerance bound by the noncentral t distribution (for
 * 10 runs, 95 % and 95 %: 3.87 instead of 2.91); for more than about ten it is narrower than that
 * bound with Bonferroni's correction of share and confidence.
 *
 * Noise of errors is often skewed, and few runs cannot show its shape. So positive values also have
 * the bound of their logarithms, and the larger bound is the limit: it holds for normal and for
 * log-normal values, and for gamma distributions, which are between the two.
 * tests/metrics/test_run_limit.c measures the coverage. An event that fewer than one run in n has,
 * such as a rare firefly, is not covered: no method can see it in n runs.
 */
#ifndef NEPH_METRICS_RUN_LIMIT_H
#define NEPH_METRICS_RUN_LIMIT_H

#include <stdbool.h>

/* With fewer runs k is above 20, and the bounds of logarithms exceed the range of most metrics. */
enum { NEPH_RUN_LIMIT_RUNS_MIN = 5 };

enum neph_run_limit_side {
    NEPH_RUN_LIMIT_ABOVE,  /* values above the limit fail; all values are >= 0 */
    NEPH_RUN_LIMIT_BELOW,  /* values below the limit fail */
    NEPH_RUN_LIMIT_EITHER, /* |value| above the limit fails; values have a sign */
    NEPH_RUN_LIMIT_SIDE_COUNT,
};

/* `share` and `confidence` in (0, 1). `limit_count` >= 1: numbers that a run is checked by. */
struct neph_run_limit_family {
    double share, confidence;
    int limit_count;
};

/* The probability a. */
double neph_run_limit_alarm_rate(const struct neph_run_limit_family *family);

/* The factor k for `run_count` >= 2 runs. */
double neph_run_limit_factor(const struct neph_run_limit_family *family, int run_count,
                             enum neph_run_limit_side side);

/* True when all values are the same. */
bool neph_run_values_are_equal(const double *values, int count);

/* The limit of `count` >= 2 finite values. `best`: with NEPH_RUN_LIMIT_BELOW, the value of equal
 * frames, 1 for SSIM (the logarithm is of the difference from it); infinite: values in dB, which
 * are logarithms already. NULL and `*limit`, or the reason why there is none. */
const char *neph_run_limit(const struct neph_run_limit_family *family, const double *values,
                           int count, enum neph_run_limit_side side, double best, double *limit);

#endif
