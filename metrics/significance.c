/* SPDX-License-Identifier: MIT */
#include "metrics/significance.h"

#include "metrics/statistics.h"

#include <math.h>

double neph_normal_p(double z)
{
    return erfc(fabs(z) / sqrt(2.0));
}

double neph_normal_critical(double alpha)
{
    /* neph_normal_p falls monotonically from 1 at 0 to 0 (in double) at 39. */
    double low = 0.0, high = 39.0;
    for (int i = 0; i < 100; i++) {
        const double middle = 0.5 * (low + high);
        if (neph_normal_p(middle) > alpha)
            low = middle;
        else
            high = middle;
    }
    return 0.5 * (low + high);
}

double neph_sidak_alpha(double family_alpha, int count)
{
    return -expm1(log1p(-family_alpha) / count);
}

struct neph_z_moments neph_z_scores(const float *test, const float *truth, const float *variance,
                                    size_t count, double floor)
{
    struct neph_sum sum = {0.0, 0.0}, squares = {0.0, 0.0};
    struct neph_z_moments moments = {0, NAN, NAN};
    for (size_t i = 0; i < count; i++) {
        const double difference = (double)test[i] - (double)truth[i];
        const double error = sqrt((double)variance[i]);
        if (error == 0.0 && fabs(difference) > floor)
            return (struct neph_z_moments){count, INFINITY, INFINITY};
        if (error == 0.0 || error < floor)
            continue;
        const double z = difference / error;
        moments.count++;
        neph_sum_add(&sum, z);
        neph_sum_add(&squares, z * z);
    }
    if (moments.count == 0)
        return moments;
    const double n = (double)moments.count;
    moments.mean = neph_sum_value(&sum) / n;
    moments.variance = neph_sum_value(&squares) / n - moments.mean * moments.mean;
    return moments;
}

struct neph_z_moments neph_z_merge(struct neph_z_moments a, struct neph_z_moments b)
{
    if (a.count == 0 || b.count == 0)
        return a.count == 0 ? b : a;
    const double n = (double)(a.count + b.count);
    const double wa = (double)a.count / n, wb = (double)b.count / n;
    const double apart = a.mean - b.mean;
    return (struct neph_z_moments){
        .count = a.count + b.count,
        .mean = wa * a.mean + wb * b.mean,
        .variance = wa * a.variance + wb * b.variance + wa * wb * apart * apart,
    };
}
