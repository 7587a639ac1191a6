/* SPDX-License-Identifier: MIT */
#include "harness/engines/povray_exposure.h"

#include "base/sort.h"

#include <math.h>
#include <stdlib.h>

static const double code_max = 65535.0;

const double neph_povray_bracket_scales[NEPH_POVRAY_BRACKETS] = {1.0, 8.0, 64.0};

struct neph_povray_reading neph_povray_read_brackets(const uint16_t codes[NEPH_POVRAY_BRACKETS],
                                                     double gain)
{
    for (int i = NEPH_POVRAY_BRACKETS - 1; i >= 0; i--) {
        double quantum = 1.0 / (code_max * neph_povray_bracket_scales[i] * gain);
        if (codes[i] < NEPH_POVRAY_CLAMP_CODE)
            return (struct neph_povray_reading){codes[i] * quantum, 0.5 * quantum};
    }
    return (struct neph_povray_reading){codes[0] / (code_max * gain), INFINITY};
}

struct neph_povray_reading neph_povray_finer_reading(struct neph_povray_reading a,
                                                     struct neph_povray_reading b)
{
    return b.error < a.error ? b : a;
}

static double find_largest_reading(const struct neph_povray_reading *readings, size_t count)
{
    double peak = 0.0;
    for (size_t i = 0; i < count; i++) {
        if (readings[i].value > peak)
            peak = readings[i].value;
    }
    return peak;
}

/* The median of the readings' upper bounds; INFINITY if memory is short: then the peak decides. */
static double compute_upper_median(const struct neph_povray_reading *readings, size_t count)
{
    double *values = malloc(count * sizeof(*values));
    if (!values)
        return INFINITY;
    for (size_t i = 0; i < count; i++)
        values[i] = readings[i].value + readings[i].error;
    neph_sort_doubles(values, count);
    const double median = values[count / 2];
    free(values);
    return median;
}

double neph_povray_next_gain(const struct neph_povray_reading *readings, size_t count, double gain,
                             const struct neph_povray_target *target)
{
    double absolute = target->absolute_of_peak * find_largest_reading(readings, count);
    if (target->absolute_of_median > 0.0)
        absolute = fmin(absolute,
                        target->absolute_of_median * compute_upper_median(readings, count));
    absolute = fmax(target->absolute, absolute);
    double brightest = 0.0; /* brightest reading that misses the target */
    for (size_t i = 0; i < count; i++) {
        struct neph_povray_reading reading = readings[i];
        if (isinf(reading.error))
            return gain / neph_povray_bracket_scales[NEPH_POVRAY_BRACKETS - 1];
        if (reading.error > fmax(target->relative * reading.value, absolute))
            brightest = fmax(brightest, reading.value + reading.error);
    }
    return brightest > 0.0 ? NEPH_POVRAY_HEADROOM / brightest : 0.0;
}

/* The number nearest to `coarse` whose position within a step is `digit`; both as parts of the
 * range of `steps` steps. */
static double refine(double coarse, double steps, double digit)
{
    return (nearbyint(coarse * steps - digit) + digit) / steps;
}

bool neph_povray_read_depth(const uint16_t codes[3], double range_m, double *depth_m)
{
    const double base = NEPH_POVRAY_DEPTH_BASE;
    double coarse = codes[0] / code_max;
    if (coarse > 0.5 * (1.0 + NEPH_POVRAY_DEPTH_TOP))
        return false;
    double finer = refine(coarse, base, codes[1] / code_max);
    *depth_m = range_m * refine(finer, base * base, codes[2] / code_max);
    return true;
}
