/* SPDX-License-Identifier: MIT
 *
 * Sums and percentiles for all metrics.
 */
#ifndef NEPH_METRICS_STATISTICS_H
#define NEPH_METRICS_STATISTICS_H

#include <math.h>
#include <stddef.h>

/* A compensated sum (Neumaier, ZAMM 54, 1974): a million small differences beside a large one are
 * not lost, and the accuracy does not depend on the size of the image. Start from {0}. */
struct neph_sum {
    double sum, lost;
};

static inline void neph_sum_add(struct neph_sum *total, double value)
{
    double sum = total->sum + value;
    total->lost += fabs(total->sum) >= fabs(value) ? (total->sum - sum) + value
                                                   : (value - sum) + total->sum;
    total->sum = sum;
}

static inline double neph_sum_value(const struct neph_sum *total)
{
    return total->sum + total->lost;
}

/* The percentile at `share` (0..1) of `count` >= 1 finite values: at position h = (count - 1) *
 * share of the sorted values, linear between neighbours. Type 7 of Hyndman and Fan, The American
 * Statistician 50, 1996; numpy's default. Reorders the values. */
double neph_percentile(double *values, size_t count, double share);

/* rel_bias and rel_rmse of the extractor `error`, over all planes jointly. */
struct neph_relative_error {
    double bias, rmse;
};

/* `count` finite samples per plane. NaN: the mean of the reference is not above 0. */
struct neph_relative_error neph_relative_error_compute(const float *const reference[],
                                                       const float *const test[], int plane_count,
                                                       size_t count);

#endif
