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
    /* neph_normal_p falls monotonically from 1 at 0 to 0 (in double precision) at 39. */
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

/* Modified Lentz (Thompson and Barnett, J. Comp. Phys. 64, 1986) on the continued fraction of the
 * incomplete beta function, A&S 26.5.8. Converges in O(sqrt(max(a, b))) steps for x below
 * (a + 1) / (a + b + 2). */
static double beta_fraction(double a, double b, double x)
{
    const double tiny = 1e-300; /* replaces a denominator of 0 */
    double c = 1.0, d = 1.0 - (a + b) * x / (a + 1.0);
    d = 1.0 / (d == 0.0 ? tiny : d);
    double fraction = d;
    for (int m = 1; m < 100000; m++) {
        const double even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        const double odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        double step = 1.0;
        for (int k = 0; k < 2; k++) {
            const double term = k == 0 ? even : odd;
            c = 1.0 + term / c;
            d = 1.0 + term * d;
            c = c == 0.0 ? tiny : c;
            d = 1.0 / (d == 0.0 ? tiny : d);
            step *= c * d;
        }
        fraction *= step;
        if (fabs(step - 1.0) < 1e-16)
            break;
    }
    return fraction;
}

/* I_x(a, b); y = 1 - x is a separate argument, because near 1 it cannot be computed from x. */
static double incomplete_beta(double a, double b, double x, double y)
{
    if (x <= 0.0 || y <= 0.0)
        return x <= 0.0 ? 0.0 : 1.0;
    int sign; /* lgamma() would store the sign in a global variable */
    const double gammas = lgamma_r(a + b, &sign) - lgamma_r(a, &sign) - lgamma_r(b, &sign);
    const double front = exp(gammas + a * log(x) + b * log(y));
    if (x < (a + 1.0) / (a + b + 2.0))
        return front * beta_fraction(a, b, x) / a;
    return 1.0 - front * beta_fraction(b, a, y) / b;
}

double neph_student_p(double t, double dof)
{
    const double square = t * t;
    if (isinf(square))
        return 0.0;
    return incomplete_beta(0.5 * dof, 0.5, dof / (dof + square), square / (dof + square));
}

/* Twice the density: the slope of neph_student_p(). */
static double student_slope(double t, double dof)
{
    int sign;
    const double gammas = lgamma_r(0.5 * (dof + 1.0), &sign) - lgamma_r(0.5 * dof, &sign);
    return 2.0 * exp(gammas - 0.5 * (dof + 1.0) * log1p(t * t / dof)) / sqrt(dof * M_PI);
}

double neph_student_critical(double alpha, double dof)
{
    /* The probability is convex for t > 0, so Newton's iteration from 0 rises to the root and
     * passes it only by rounding, which ends the iteration. */
    double t = 0.0;
    for (int i = 0; i < 10000; i++) {
        const double next = t + (neph_student_p(t, dof) - alpha) / student_slope(t, dof);
        if (!(next > t))
            break;
        t = next;
    }
    return t;
}

/* P(a, x) without its factor: 1 + x/(a+1) + ..., for x < a + 1. */
static double gamma_series(double a, double x)
{
    double term = 1.0, sum = 1.0;
    for (double n = a + 1.0; term > sum * 1e-17; n += 1.0)
        sum += term *= x / n;
    return sum;
}

/* Q(a, x) without its factor, by modified Lentz as in beta_fraction(), for x >= a + 1. */
static double gamma_fraction(double a, double x)
{
    double b = x + 1.0 - a, c = 1e300, d = 1.0 / b, fraction = d;
    for (int n = 1; n < 1000000; n++) {
        const double step = -n * (n - a);
        b += 2.0;
        d = 1.0 / (step * d + b);
        c = b + step / c;
        fraction *= c * d;
        if (fabs(c * d - 1.0) < 1e-16)
            break;
    }
    return fraction;
}

double neph_chi_squared_p(double value, double dof)
{
    const double a = 0.5 * dof, x = 0.5 * value;
    if (!(x > 0.0))
        return 1.0;
    int sign;
    const double logarithm = a * log(x) - x - lgamma_r(a, &sign);
    if (x < a + 1.0)
        return fmax(0.0, 1.0 - exp(logarithm) / a * gamma_series(a, x));
    return exp(logarithm) * gamma_fraction(a, x);
}

double neph_sign_p(int positive, int negative)
{
    const int few = positive < negative ? positive : negative;
    const int many = positive < negative ? negative : positive;
    if (few == many)
        return 1.0;
    /* P(at most `few` of few + many) = I_1/2(many, few + 1) */
    return fmin(1.0, 2.0 * incomplete_beta(many, few + 1.0, 0.5, 0.5));
}

/* The number of p-values tested before this one: smaller ones, and equal ones with a lower
 * index. */
static int holm_rank(const double *p, int count, int index)
{
    int rank = 0;
    for (int i = 0; i < count; i++)
        rank += p[i] < p[index] || (p[i] == p[index] && i < index);
    return rank;
}

void neph_holm(const double *p, int count, double *adjusted)
{
    for (int i = 0; i < count; i++)
        adjusted[i] = fmin(1.0, p[i] * (count - holm_rank(p, count, i)));
    /* Make the adjusted values monotonic. Works in place, because a raised value equals another
     * adjusted value. */
    for (int i = 0; i < count; i++)
        for (int k = 0; k < count; k++)
            if (p[k] <= p[i])
                adjusted[i] = fmax(adjusted[i], adjusted[k]);
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
