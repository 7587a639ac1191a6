/* SPDX-License-Identifier: MIT
 *
 * Fits exponents of cost over size and judges them.
 */
#include "harness/sweep/scaling.h"

#include "metrics/significance.h"

#include <math.h>

/* Fails to compile when a verdict is added, as the table of words needs a row for it. */
_Static_assert(NEPH_EXPONENT_VERDICTS == 4, "a new kind");

const char *const neph_exponent_verdict_words[NEPH_EXPONENT_VERDICTS] = {
    [NEPH_EXPONENT_NONE] = "no exponent",
    [NEPH_EXPONENT_EXPECTED] = "as expected",
    [NEPH_EXPONENT_OTHER] = "not as expected",
    [NEPH_EXPONENT_UNCERTAIN] = "cannot be told",
};

struct sums {
    int count;
    double x, y, xx, xy, yy; /* means, and sums of squared deviations */
};

static struct sums sum_up(const double *x, const double *y, int count)
{
    struct sums sums = {.count = 0};
    for (int i = 0; i < count; i++) {
        if (!(x[i] > 0.0) || !(y[i] > 0.0))
            continue;
        sums.count++;
        const double dx = log(x[i]) - sums.x, dy = log(y[i]) - sums.y;
        const double part = (double)(sums.count - 1) / sums.count;
        sums.x += dx / sums.count;
        sums.y += dy / sums.count;
        sums.xx += part * dx * dx;
        sums.xy += part * dx * dy;
        sums.yy += part * dy * dy;
    }
    return sums;
}

struct neph_exponent neph_exponent_fit(const double *x, const double *y, int count)
{
    const struct sums sums = sum_up(x, y, count);
    if (sums.count < 3 || !(sums.xx > 0.0))
        return (struct neph_exponent){NAN, NAN, NAN, sums.count};
    const double slope = sums.xy / sums.xx, dof = sums.count - 2;
    /* Rounding can make a residual of 0 slightly negative. */
    const double rest = fmax(sums.yy - slope * sums.xy, 0.0);
    const double half = neph_student_critical(0.05, dof) * sqrt(rest / dof / sums.xx);
    return (struct neph_exponent){slope, slope - half, slope + half, sums.count};
}

enum neph_exponent_verdict neph_exponent_judge(const struct neph_exponent *exponent,
                                               struct neph_exponent_range range)
{
    const double low = range.low - NEPH_EXPONENT_SAME, high = range.high + NEPH_EXPONENT_SAME;
    if (isnan(exponent->value))
        return NEPH_EXPONENT_NONE;
    if (low <= exponent->low && exponent->high <= high)
        return NEPH_EXPONENT_EXPECTED;
    return exponent->high < low || exponent->low > high ? NEPH_EXPONENT_OTHER
                                                        : NEPH_EXPONENT_UNCERTAIN;
}
