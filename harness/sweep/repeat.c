/* SPDX-License-Identifier: MIT */
#include "harness/sweep/repeat.h"

#include "metrics/significance.h"

#include <math.h>

static const uint64_t seeds_apart = (uint64_t)1 << 20;
static const double alpha = 0.05;

uint64_t neph_sweep_seed(uint64_t seed, int repeat)
{
    return seed + seeds_apart * (uint64_t)repeat;
}

static double mean_of(const struct neph_sweep_value *values, int count)
{
    double sum = 0.0;
    for (int i = 0; i < count; i++)
        sum += values[i].value;
    return sum / count;
}

/* How far an end of the interval over seeds is from their mean; 0: there is one seed. */
static double reach_of_seeds(const struct neph_sweep_value *values, int count, double mean)
{
    double squares = 0.0;
    if (count < 2)
        return 0.0;
    for (int i = 0; i < count; i++)
        squares += (values[i].value - mean) * (values[i].value - mean);
    return neph_student_critical(alpha, count - 1) * sqrt(squares / (count - 1) / count);
}

/* How far the ends are from the values, by their mean; 0 where a value has no interval. */
static double reach_of_picture(const struct neph_sweep_value *values, int count, bool up)
{
    double sum = 0.0;
    for (int i = 0; i < count; i++) {
        const double end = up ? values[i].high : values[i].low;
        sum += isnan(end) ? 0.0 : fabs(end - values[i].value);
    }
    return sum / count;
}

struct neph_sweep_value neph_sweep_repeated(const struct neph_sweep_value *values, int count)
{
    const double mean = mean_of(values, count), seeds = reach_of_seeds(values, count, mean);
    if (count == 1)
        return values[0];
    return (struct neph_sweep_value){
        .value = mean,
        .low = mean - hypot(seeds, reach_of_picture(values, count, false)),
        .high = mean + hypot(seeds, reach_of_picture(values, count, true)),
    };
}
