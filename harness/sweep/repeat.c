/* SPDX-License-Identifier: MIT
 *
 * Seeds of repetitions, and means over them.
 */
#include "harness/sweep/repeat.h"

#include "metrics/significance.h"

#include <math.h>

static const uint64_t seeds_apart = (uint64_t)1 << 20;
static const double alpha = 0.05;

uint64_t neph_sweep_seed(uint64_t seed, int repeat)
{
    return seed + seeds_apart * (uint64_t)repeat;
}

static double average_values(const struct neph_sweep_value *values, int count)
{
    double sum = 0.0;
    for (int i = 0; i < count; i++)
        sum += values[i].value;
    return sum / count;
}

/* Half width of the interval over seeds; 0 for one seed. */
static double interval_over_seeds(const struct neph_sweep_value *values, int count, double mean)
{
    double squares = 0.0;
    if (count < 2)
        return 0.0;
    for (int i = 0; i < count; i++)
        squares += (values[i].value - mean) * (values[i].value - mean);
    return neph_student_critical(alpha, count - 1) * sqrt(squares / (count - 1) / count);
}

/* Mean distance of one end of the frames' intervals from their values; 0 for a value without one.
 */
static double interval_over_frame(const struct neph_sweep_value *values, int count, bool up)
{
    double sum = 0.0;
    for (int i = 0; i < count; i++) {
        const double end = up ? values[i].high : values[i].low;
        sum += isnan(end) ? 0.0 : fabs(end - values[i].value);
    }
    return sum / count;
}

struct neph_sweep_value neph_sweep_average_seeds(const struct neph_sweep_value *values, int count)
{
    const double mean = average_values(values, count),
                 seeds = interval_over_seeds(values, count, mean);
    if (count == 1)
        return values[0];
    return (struct neph_sweep_value){
        .value = mean,
        .low = mean - hypot(seeds, interval_over_frame(values, count, false)),
        .high = mean + hypot(seeds, interval_over_frame(values, count, true)),
    };
}
