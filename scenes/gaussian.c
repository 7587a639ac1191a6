/* SPDX-License-Identifier: MIT
 *
 * A Gaussian blob, extinction e^{-r^2 / 2 w^2}. Along a line at impact parameter p the density is
 * e^{-p^2 / 2 w^2} times a Gaussian in the distance from the nearest point, whose integral is a
 * difference of error functions.
 */
#include "scenes/medium_kind.h"

#include <math.h>

static const double sqrt_half = 0.707106781186547524400844362105;
static const double sqrt_half_pi = 1.25331413731550025120788264241;

static double extinction_per_m(const struct neph_medium *medium, struct neph_vec3 point_m)
{
    const struct neph_gaussian *blob = &medium->gaussian;
    const struct neph_vec3 r = neph_vec3_scale(neph_vec3_sub(point_m, blob->center_m),
                                               1.0 / blob->width_m);
    return medium->extinction_per_m * exp(-0.5 * neph_vec3_dot(r, r));
}

/* erf(b) - erf(a) for a <= b, without cancellation when both lie on one side of 0. */
static double erf_between(double a, double b)
{
    if (a > 0.0)
        return erfc(a) - erfc(b);
    if (b < 0.0)
        return erfc(-b) - erfc(-a);
    return erf(b) - erf(a);
}

static double optical_depth(const struct neph_medium *medium, struct neph_vec3 origin_m,
                            struct neph_vec3 direction, double t0_m, double t1_m)
{
    const struct neph_gaussian *blob = &medium->gaussian;
    const struct neph_vec3 to_center_m = neph_vec3_sub(blob->center_m, origin_m);
    const double nearest_m = neph_vec3_dot(to_center_m, direction);
    /* The vector of the impact, not sqrt(|c|^2 - t^2): that cancels for a blob far away. */
    const struct neph_vec3 impact = neph_vec3_scale(
        neph_vec3_along(to_center_m, direction, -nearest_m), 1.0 / blob->width_m);
    const double a = (t0_m - nearest_m) / blob->width_m * sqrt_half;
    const double b = (t1_m - nearest_m) / blob->width_m * sqrt_half;
    return medium->extinction_per_m * exp(-0.5 * neph_vec3_dot(impact, impact)) * blob->width_m *
           sqrt_half_pi * erf_between(a, b);
}

static double distance_to_range(double x, double low, double high)
{
    return fmax(0.0, fmax(low - x, x - high));
}

static double bound_per_m(const struct neph_medium *medium, const struct neph_bounds *box)
{
    const struct neph_vec3 c = medium->gaussian.center_m;
    const struct neph_vec3 nearest_m = {c.x + distance_to_range(c.x, box->min_m.x, box->max_m.x),
                                        c.y + distance_to_range(c.y, box->min_m.y, box->max_m.y),
                                        c.z + distance_to_range(c.z, box->min_m.z, box->max_m.z)};
    return extinction_per_m(medium, nearest_m);
}

/* Beyond 7.44 widths less than 1e-12 of the density is left. */
static struct neph_bounds support(const struct neph_medium *medium)
{
    const struct neph_vec3 c = medium->gaussian.center_m;
    const double reach_m = 7.44 * medium->gaussian.width_m;
    return (struct neph_bounds){{c.x - reach_m, c.y - reach_m, c.z - reach_m},
                                {c.x + reach_m, c.y + reach_m, c.z + reach_m}};
}

const struct neph_medium_kind_ops neph_medium_gaussian = {
    .name = "Gaussian blob",
    .closed_form = true,
    .extinction_per_m = extinction_per_m,
    .optical_depth = optical_depth,
    .bound_per_m = bound_per_m,
    .support = support,
};
