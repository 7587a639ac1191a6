/* SPDX-License-Identifier: MIT */
#include "truth/lit_flight.h"

#include "scenes/media.h"

#include <math.h>

/* Limit of the optical depth: no light from the near side gets deeper, and on an infinite ray none
 * comes from the far side. */
static const double dark_depth = 60.0;

/* Darker than e^-this relative to the brightest edge counts as dark; free flight covers the
 * difference. */
static const double log_light_range = 200.0;

/* ---- the table ---- */

/* Position in 0..1 of edge number i: two exponential series, back to back. */
static double ladder(int i, double stretch)
{
    const double x = (double)i / NEPH_LIT_CELLS;
    const double from_end = 2.0 * fmin(x, 1.0 - x);
    const double part = stretch > 0.0 ? expm1(stretch * from_end) / expm1(stretch) : from_end;
    return x <= 0.5 ? 0.5 * part : 1.0 - 0.5 * part;
}

void neph_lit_flight_edges(struct neph_lit_flight *lit, double end)
{
    /* Up to here cells are even and at most 1/2 deep; beyond, the first and last stay below 1. */
    const double even = 8.0;
    lit->end = end;
    const double last = isinf(end) ? dark_depth : end;
    const double stretch = last > even ? 1.45 * log(last / even) : 0.0;
    for (int i = 0; i <= NEPH_LIT_CELLS; i++)
        lit->s[i] = last * ladder(i, stretch);
}

/* The light of a cell: the integral of a log-linear function. */
static double cell_light(const struct neph_lit_flight *lit, int i)
{
    const double a = lit->log_light[i], b = lit->log_light[i + 1];
    return (lit->s[i + 1] - lit->s[i]) * exp(fmax(a, b)) * neph_phi(fabs(b - a));
}

void neph_lit_flight_complete(struct neph_lit_flight *lit, bool also_ambient)
{
    double most = -INFINITY;
    for (int i = 0; i <= NEPH_LIT_CELLS; i++)
        most = fmax(most, lit->log_light[i]);
    const bool is_dark = !(most > -INFINITY);
    lit->lit_share = is_dark ? 0.0 : also_ambient ? 0.4 : 0.8;
    lit->free_share = is_dark || also_ambient ? 0.5 : 0.1;
    lit->below[0] = 0.0;
    for (int i = 0; i <= NEPH_LIT_CELLS; i++)
        lit->log_light[i] = is_dark ? 0.0 : fmax(lit->log_light[i] - most, -log_light_range);
    for (int i = 0; i < NEPH_LIT_CELLS; i++)
        lit->below[i + 1] = lit->below[i] + cell_light(lit, i);
    lit->log_whole = is_dark ? -INFINITY : most + log(lit->below[NEPH_LIT_CELLS]);
    for (int i = 0; i <= NEPH_LIT_CELLS; i++)
        lit->below[i] /= lit->below[NEPH_LIT_CELLS];
    lit->is_known = true;
}

/* ---- sampling -------------------------------------------------------------------------------- */

/* The index of the last edge at or before a value, except the very last edge. */
static int find_cell(const double edges[NEPH_LIT_CELLS + 1], double value)
{
    int low = 0, high = NEPH_LIT_CELLS;
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        if (edges[middle] <= value)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* The position in 0..1 at which the integral of e^(slope x) reaches the part u of the whole. */
static double exponential_quantile(double slope, double u)
{
    if (fabs(slope) < 1e-9)
        return u;
    if (slope > 0.0) /* the same from the other end, to avoid overflow */
        return 1.0 - exponential_quantile(-slope, 1.0 - u);
    return log1p(u * expm1(slope)) / slope;
}

static double draw_lit(const struct neph_lit_flight *lit, double u)
{
    const int i = find_cell(lit->below, u);
    const double part = (u - lit->below[i]) / (lit->below[i + 1] - lit->below[i]);
    const double x = exponential_quantile(lit->log_light[i + 1] - lit->log_light[i],
                                          fmin(fmax(part, 0.0), 1.0));
    return lit->s[i] + (lit->s[i + 1] - lit->s[i]) * x;
}

double neph_lit_flight_sample(const struct neph_lit_flight *lit, struct neph_random *random)
{
    const double share = neph_random_uniform(random), u = neph_random_uniform(random);
    double s = u * lit->s[NEPH_LIT_CELLS];
    if (share < lit->lit_share)
        s = draw_lit(lit, u);
    else if (share < lit->lit_share + lit->free_share)
        s = -log1p(u * expm1(-lit->end));
    return fmin(s, lit->end * (1.0 - 1e-12)); /* just before the end, which may be infinitely far */
}

double neph_lit_flight_density(const struct neph_lit_flight *lit, double s)
{
    double density = lit->free_share * exp(-s) / -expm1(-lit->end);
    const double last = lit->s[NEPH_LIT_CELLS];
    if (s > last)
        return density;
    density += (1.0 - lit->lit_share - lit->free_share) / last;
    const int i = find_cell(lit->s, s);
    const double a = lit->log_light[i], b = lit->log_light[i + 1];
    const double cell = lit->s[i + 1] - lit->s[i], x = (s - lit->s[i]) / cell;
    const double shape = exp(a + (b - a) * x - fmax(a, b)) / neph_phi(fabs(b - a)) / cell;
    return density + lit->lit_share * (lit->below[i + 1] - lit->below[i]) * shape;
}
