/* SPDX-License-Identifier: MIT */
#include "harness/sweep/equal.h"

#include <math.h>

double neph_sweep_between(const double *x, const double *y, int count, double at)
{
    for (int i = 0; i < count; i++)
        for (int k = 0; k < count; k++) {
            bool is_next = x[i] <= at && at <= x[k] && i != k;
            for (int other = 0; other < count && is_next; other++)
                is_next = other == i || other == k || x[other] < x[i] || x[other] > x[k];
            if (!is_next)
                continue;
            const double part = x[k] > x[i] ? log(at / x[i]) / log(x[k] / x[i]) : 0.0;
            return exp((1.0 - part) * log(y[i]) + part * log(y[k]));
        }
    return NAN;
}

/* The points of a series that have both, as its ladder. */
struct ladder {
    double error[NEPH_SWEEP_VALUES_MAX], time_s[NEPH_SWEEP_VALUES_MAX];
    int count;
};

static struct ladder ladder_of(const struct neph_sweep *sweep,
                               const struct neph_sweep_series *series)
{
    struct ladder ladder = {.count = 0};
    for (int i = 0; i < sweep->point_count; i++) {
        const struct neph_sweep_point *point = &sweep->points[i];
        const double error = point->numbers[NEPH_SWEEP_ERROR].value;
        if (point->series != series || point->missing[0] || !(error > 0.0) ||
            !(point->time.median > 0.0))
            continue;
        ladder.error[ladder.count] = error;
        ladder.time_s[ladder.count++] = point->time.median;
    }
    return ladder;
}

static int best_of(const struct ladder *ladder)
{
    int best = 0;
    for (int i = 1; i < ladder->count; i++)
        if (ladder->error[i] < ladder->error[best])
            best = i;
    return best;
}

int neph_sweep_equals(const struct neph_sweep *sweep, const struct neph_sweep_series *base,
                      struct neph_sweep_equal *list)
{
    const struct ladder own = ladder_of(sweep, base);
    int count = 0;
    for (int s = 0; s < sweep->plan->series_count; s++) {
        const struct neph_sweep_series *series = &sweep->plan->series[s];
        const struct ladder other = ladder_of(sweep, series);
        if (series == base || other.count == 0 || own.count < 2)
            continue;
        const int best = best_of(&other);
        const double error = other.error[best], time_s = other.time_s[best];
        list[count++] = (struct neph_sweep_equal){
            .series = series,
            .time_ratio = time_s / neph_sweep_between(own.error, own.time_s, own.count, error),
            .error_ratio = error / neph_sweep_between(own.time_s, own.error, own.count, time_s),
            .at_error = error,
            .at_s = time_s,
        };
    }
    return count;
}
