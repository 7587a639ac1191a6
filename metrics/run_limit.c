/* SPDX-License-Identifier: MIT */
#include "metrics/run_limit.h"

#include "metrics/significance.h"

#include <math.h>
#include <stddef.h>

/* Compiles only when this file handles every kind. */
_Static_assert(NEPH_RUN_LIMIT_SIDE_COUNT == 3, "a new kind");

double neph_run_limit_alarm_rate(const struct neph_run_limit_family *family)
{
    return (1.0 - family->share) * (1.0 - family->confidence);
}

double neph_run_limit_factor(const struct neph_run_limit_family *family, int run_count,
                             enum neph_run_limit_side side)
{
    const double tail = neph_run_limit_alarm_rate(family) / family->limit_count;
    const double two_sided = side == NEPH_RUN_LIMIT_EITHER ? tail : 2.0 * tail;
    return neph_student_critical(two_sided, run_count - 1) * sqrt(1.0 + 1.0 / run_count);
}

bool neph_run_values_are_equal(const double *values, int count)
{
    for (int i = 1; i < count; i++)
        if (values[i] != values[0])
            return false;
    return true;
}

/* Whether more than half of the values are the same: their spread is then unknown. */
static bool are_mostly_equal(const double *values, int count)
{
    for (int i = 0; i < count; i++) {
        int same = 0;
        for (int j = 0; j < count; j++)
            same += values[j] == values[i];
        if (2 * same > count)
            return true;
    }
    return false;
}

/* A scale on which values are bounded from above: x = sign * value + offset, or log(x). */
struct scale {
    double sign, offset;
    bool is_log;
};

struct moments { /* on a scale */
    double mean, deviation;
};

static double to_scale(const struct scale *scale, double value)
{
    const double x = scale->sign * value + scale->offset;
    return scale->is_log ? log(x) : x;
}

static double from_scale(const struct scale *scale, double x)
{
    return scale->sign * ((scale->is_log ? exp(x) : x) - scale->offset);
}

static struct moments compute_moments(const struct scale *scale, const double *values, int count)
{
    struct moments moments = {0.0, 0.0};
    double squares = 0.0;
    for (int i = 0; i < count; i++)
        moments.mean += to_scale(scale, values[i]) / count;
    for (int i = 0; i < count; i++) {
        const double d = to_scale(scale, values[i]) - moments.mean;
        squares += d * d;
    }
    moments.deviation = sqrt(squares / (count - 1));
    return moments;
}

/* The bound on a scale, as a value. NaN where a value has no logarithm. */
static double compute_bound(const struct scale *scale, const double *values, int count,
                            double factor)
{
    const struct moments moments = compute_moments(scale, values, count);
    return isfinite(moments.mean) ? from_scale(scale, moments.mean + factor * moments.deviation)
                                  : NAN;
}

const char *neph_run_limit(const struct neph_run_limit_family *family, const double *values,
                           int count, enum neph_run_limit_side side, double best, double *limit)
{
    const double factor = neph_run_limit_factor(family, count, side);
    const bool is_below = side == NEPH_RUN_LIMIT_BELOW;
    const struct scale plain = {is_below ? -1.0 : 1.0, 0.0, false};
    const struct scale logarithm = {plain.sign, is_below ? best : 0.0, true};
    if (are_mostly_equal(values, count))
        return "more than half of the runs have the same value: the spread is not known";
    double bound = compute_bound(&plain, values, count, factor);
    if (side == NEPH_RUN_LIMIT_EITHER) {
        const struct scale mirrored = {-1.0, 0.0, false};
        bound = fmax(bound, -compute_bound(&mirrored, values, count, factor));
    } else if (!is_below || isfinite(best)) {
        const double skewed = compute_bound(&logarithm, values, count, factor);
        bound = is_below ? fmin(bound, skewed) : fmax(bound, skewed);
    }
    if (!isfinite(bound) || bound <= 0.0)
        return "the runs differ too much for a limit: more runs are needed";
    *limit = bound;
    return NULL;
}
