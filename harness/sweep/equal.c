/* SPDX-License-Identifier: MIT
 *
 * Compares series at equal quality and at equal cost.
 */
#include "harness/sweep/equal.h"

#include <math.h>

double neph_sweep_interpolate(const double *x, const double *y, int count, double at)
{
    for (int i = 0; i < count; i++)
        if (x[i] == at)
            return y[i];
    for (int i = 0; i < count; i++)
        for (int k = 0; k < count; k++) {
            bool is_next = x[i] <= at && at <= x[k] && i != k;
            for (int other = 0; other < count && is_next; other++)
                is_next = other == i || other == k || x[other] < x[i] || x[other] > x[k];
            if (!is_next)
                continue;
            const double part = log(at / x[i]) / log(x[k] / x[i]);
            return exp((1.0 - part) * log(y[i]) + part * log(y[k]));
        }
    return NAN;
}

double neph_sweep_point_cost(const struct neph_sweep_point *point, enum neph_sweep_cost cost)
{
    return cost == NEPH_SWEEP_COST_TIME ? point->time.median : point->evaluations;
}

/* The points of a series that have both a cost and a value. */
struct cost_curve {
    double number[NEPH_SWEEP_VALUES_MAX], cost[NEPH_SWEEP_VALUES_MAX];
    int count;
};

static struct cost_curve list_cost_curve(const struct neph_sweep *sweep,
                                         const struct neph_sweep_series *series,
                                         enum neph_sweep_cost cost, enum neph_sweep_number number)
{
    struct cost_curve cost_curve = {.count = 0};
    for (int i = 0; i < sweep->point_count; i++) {
        const struct neph_sweep_point *point = &sweep->points[i];
        const double value = point->numbers[number].value,
                     price = neph_sweep_point_cost(point, cost);
        if (point->series != series || point->missing[0] || !(value > 0.0) || !(price > 0.0))
            continue;
        cost_curve.number[cost_curve.count] = value;
        cost_curve.cost[cost_curve.count++] = price;
    }
    return cost_curve;
}

static struct neph_sweep_comparison compare_point(const struct cost_curve *own, double number,
                                                  double cost)
{
    return (struct neph_sweep_comparison){
        .cost_ratio = cost / neph_sweep_interpolate(own->number, own->cost, own->count, number),
        .number_ratio = number / neph_sweep_interpolate(own->cost, own->number, own->count, cost),
        .at_number = number,
        .at_cost = cost,
    };
}

static int finite_count(const struct neph_sweep_comparison *equal)
{
    return (isfinite(equal->cost_ratio) != 0) + (isfinite(equal->number_ratio) != 0);
}

/* The best point of a series, among those with the most defined ratios. */
static struct neph_sweep_comparison compare_best_point(const struct cost_curve *own,
                                                       const struct cost_curve *other)
{
    struct neph_sweep_comparison best = compare_point(own, other->number[0], other->cost[0]);
    for (int i = 1; i < other->count; i++) {
        const struct neph_sweep_comparison next = compare_point(own, other->number[i],
                                                                other->cost[i]);
        const int more = finite_count(&next) - finite_count(&best);
        if (more > 0 || (more == 0 && next.at_number < best.at_number))
            best = next;
    }
    return best;
}

int neph_sweep_compare_series(const struct neph_sweep *sweep, const struct neph_sweep_series *base,
                              enum neph_sweep_cost cost, enum neph_sweep_number number,
                              struct neph_sweep_comparison *list)
{
    const struct cost_curve own = list_cost_curve(sweep, base, cost, number);
    int count = 0;
    for (int s = 0; s < sweep->plan->series_count; s++) {
        const struct neph_sweep_series *series = &sweep->plan->series[s];
        const struct cost_curve other = list_cost_curve(sweep, series, cost, number);
        if (series == base || other.count == 0 || own.count == 0)
            continue;
        const struct neph_sweep_comparison held = compare_best_point(&own, &other);
        if (own.count == 1 && finite_count(&held) == 0)
            continue;
        list[count] = held;
        list[count++].series = series;
    }
    return count;
}
