/* SPDX-License-Identifier: MIT
 *
 * Render time to a given error, from a benchmark's measured sample levels.
 */
#include "harness/run/rmse_time.h"

#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* Fails to compile when a kind is added, as the table of names needs it. */
_Static_assert(NEPH_RMSE_FOUND_COUNT == 5, "a new kind");

static const double least = 1e-30; /* smallest square that a logarithm is taken of */

/* Smallest squared spread of log times that a slope is fitted to: times a millionth apart. */
static const double same_times = 1e-12;

/* The 97.5 % quantiles of Student's t distribution for 1, 2, ... degrees of freedom. */
static const double student_95[NEPH_RMSE_LEVELS_MAX - 1] = {12.706, 4.303, 3.182, 2.776,
                                                            2.571,  2.447, 2.365};

static double log_square(double square)
{
    return log(fmax(square, least));
}

/* Slope of log noise^2 over log time, by least squares. */
static double noise_slope(const struct neph_rmse_level *rungs, int count)
{
    double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
    for (int k = 0; k < count; k++) {
        x += log(rungs[k].render_s) / count;
        y += log_square(rungs[k].noise2) / count;
    }
    for (int k = 0; k < count; k++) {
        const double dx = log(rungs[k].render_s) - x;
        xx += dx * dx;
        xy += dx * (log_square(rungs[k].noise2) - y);
    }
    return xx > same_times ? xy / xx : NAN;
}

/* Weighted mean of bias^2: the estimate of a level has a standard deviation proportional to its
 * noise^2. */
struct neph_rmse_law neph_rmse_law_fit(const struct neph_rmse_level *rungs, int count)
{
    assert(count >= 2 && count <= NEPH_RMSE_LEVELS_MAX);
    double weights = 0.0, mean = 0.0, square = 0.0;
    for (int k = 0; k < count; k++) {
        const double weight = 1.0 / fmax(rungs[k].noise2 * rungs[k].noise2, least);
        weights += weight;
        mean += weight * rungs[k].bias2;
    }
    mean /= weights;
    for (int k = 0; k < count; k++) {
        const double off = rungs[k].bias2 - mean;
        square += off * off / fmax(rungs[k].noise2 * rungs[k].noise2, least);
    }
    const double half = student_95[count - 2] * sqrt(square / ((count - 1.0) * weights));
    return (struct neph_rmse_law){.slope = noise_slope(rungs, count),
                                  .bias2 = mean,
                                  .bias2_low = mean - half,
                                  .bias2_high = mean + half};
}

/* Time at which the straight line through two levels reaches the error. */
static double line_time(const struct neph_rmse_level *a, const struct neph_rmse_level *b,
                        double square)
{
    const double from = log_square(a->error2), to = log_square(b->error2);
    const double part = (from - log(square)) / (from - to);
    return exp(log(a->render_s) + part * log(b->render_s / a->render_s));
}

/* Time at which noise^2, extrapolated by its slope, has fallen to square - bias^2. */
static double law_time(const struct neph_rmse_level *from, const struct neph_rmse_law *law,
                       double square)
{
    const double noise2 = square - fmax(law->bias2, 0.0);
    return from->render_s * pow(noise2 / fmax(from->noise2, least), 1.0 / law->slope);
}

static bool has_falling_noise(const struct neph_rmse_law *law)
{
    return isfinite(law->slope) && law->slope < 0.0;
}

/* With a slope near 0 the time can exceed the range of a double: unknown then. */
static struct neph_rmse_time make_extrapolated_time(double rmse, double render_s,
                                                    enum neph_rmse_found found)
{
    return isnormal(render_s) ? (struct neph_rmse_time){rmse, render_s, found}
                              : (struct neph_rmse_time){rmse, NAN, NEPH_RMSE_UNKNOWN};
}

static struct neph_rmse_time extrapolate_beyond_levels(const struct neph_rmse_level *last,
                                                       const struct neph_rmse_law *law, double rmse)
{
    const double square = rmse * rmse;
    if (law->bias2_low >= square)
        return (struct neph_rmse_time){rmse, NAN, NEPH_RMSE_NEVER};
    if (law->bias2_high >= square || !has_falling_noise(law))
        return (struct neph_rmse_time){rmse, NAN, NEPH_RMSE_UNKNOWN};
    /* The error of the last level is noisy, too: the result is never below that level's time. */
    return make_extrapolated_time(rmse, fmax(last->render_s, law_time(last, law, square)),
                                  NEPH_RMSE_BEYOND);
}

static int compare_level_times(const void *a_, const void *b_)
{
    const double a = ((const struct neph_rmse_level *)a_)->render_s;
    const double b = ((const struct neph_rmse_level *)b_)->render_s;
    return (a > b) - (a < b);
}

struct neph_rmse_time neph_rmse_time_to(const struct neph_rmse_level *measured, int count,
                                        double rmse)
{
    struct neph_rmse_level rungs[NEPH_RMSE_LEVELS_MAX];
    const struct neph_rmse_law law = neph_rmse_law_fit(measured, count);
    memcpy(rungs, measured, (size_t)count * sizeof(rungs[0]));
    qsort(rungs, (size_t)count, sizeof(rungs[0]), compare_level_times);
    const double square = rmse * rmse;
    int first = count; /* all levels from here on are below the error */
    while (first > 0 && rungs[first - 1].error2 <= square)
        first--;
    if (first == count)
        return extrapolate_beyond_levels(&rungs[count - 1], &law, rmse);
    if (first > 0)
        return (struct neph_rmse_time){rmse, line_time(&rungs[first - 1], &rungs[first], square),
                                       NEPH_RMSE_WITHIN};
    if (!has_falling_noise(&law) || law.bias2 >= square)
        return (struct neph_rmse_time){rmse, NAN, NEPH_RMSE_UNKNOWN};
    return make_extrapolated_time(rmse, fmin(rungs[0].render_s, law_time(&rungs[0], &law, square)),
                                  NEPH_RMSE_BEFORE);
}

const char *neph_rmse_found_name(enum neph_rmse_found found)
{
    static const char *const names[] = {[NEPH_RMSE_WITHIN] = "within",
                                        [NEPH_RMSE_BEFORE] = "before",
                                        [NEPH_RMSE_BEYOND] = "beyond",
                                        [NEPH_RMSE_NEVER] = "never",
                                        [NEPH_RMSE_UNKNOWN] = "unknown"};
    return names[found];
}
