/* SPDX-License-Identifier: MIT
 *
 * An exponential atmosphere around a sphere: extinction e^{-(r - R) / H} outside, nothing inside.
 *
 * A ray is measured from its lowest point: with x the distance from it, r - r_low =
 * x^2 / (r + r_low), which does not cancel (at Earth's size, sqrt(r_low^2 + x^2) - r_low would lose
 * nine digits). One leg of a ray, from x0 to x1 on one side of the lowest point, is the integral of
 * e^{-(r(x) - r0) / H} from the denser end r0: analytic, monotone and of known scale, so that
 * 16-point Gauss-Legendre over pieces of at most two e-foldings is exact to rounding (tested).
 * Chapman's function (Proc. Phys. Soc. 43, 1931) is the leg to infinity, divided by H.
 */
#include "scenes/medium_kind.h"

#include <math.h>

static const double nodes[8] = {0.0950125098376374402, 0.2816035507792589132, 0.4580167776572273863,
                                0.6178762444026437484, 0.7554044083550030339, 0.8656312023878317439,
                                0.9445750230732325761, 0.9894009349916499326};
static const double weights[8] = {
    0.1894506104550684963, 0.1826034150449235889, 0.1691565193950025382, 0.1495959888165767321,
    0.1246289712555338720, 0.0951585116824927848, 0.0622535239386478929, 0.0271524594117540949};

/* After 42 e-foldings nothing is left in double. */
static const double folds_max = 42.0;
static const double folds_per_piece = 2.0;

static double extinction_per_m(const struct neph_medium *medium, struct neph_vec3 point_m)
{
    const struct neph_shell *shell = &medium->shell;
    const double r_m = neph_vec3_length(neph_vec3_sub(point_m, shell->center_m));
    if (r_m < shell->radius_m)
        return 0.0;
    return medium->extinction_per_m * exp(-(r_m - shell->radius_m) / shell->scale_height_m);
}

/* A ray by its lowest point: radius `low_m`, the radius at a distance x from it. */
static double radius_m(double low_m, double x_m)
{
    return hypot(low_m, x_m);
}

/* r(x) - r(x0), without cancellation. */
static double climb_m(double low_m, double x0_m, double x_m)
{
    return (x_m - x0_m) * (x_m + x0_m) / (radius_m(low_m, x_m) + radius_m(low_m, x0_m));
}

/* The x at which the ray has climbed `height_m` above x0 >= 0. */
static double x_at_climb_m(double low_m, double x0_m, double height_m)
{
    return sqrt(x0_m * x0_m + height_m * (2.0 * radius_m(low_m, x0_m) + height_m));
}

/* The integral of e^{-climb / H} over x in [x0, x1], 0 <= x0 <= x1 [m]. */
static double leg_m(double low_m, double scale_height_m, double x0_m, double x1_m)
{
    double sum_m = 0.0, from_m = x0_m;
    for (double folds = folds_per_piece; folds <= folds_max && from_m < x1_m;
         folds += folds_per_piece) {
        const double to_m = fmin(x_at_climb_m(low_m, x0_m, folds * scale_height_m), x1_m);
        const double middle_m = 0.5 * (from_m + to_m), half_m = 0.5 * (to_m - from_m);
        for (int i = 0; i < 8; i++)
            for (int side = -1; side <= 1; side += 2)
                sum_m += half_m * weights[i] *
                         exp(-climb_m(low_m, x0_m, middle_m + side * nodes[i] * half_m) /
                             scale_height_m);
        from_m = to_m;
    }
    return sum_m;
}

/* Optical depth over x in [x0, x1], 0 <= x0 <= x1, of which what is below the radius is empty. */
static double leg_depth(const struct neph_medium *medium, double low_m, double x0_m, double x1_m)
{
    const struct neph_shell *shell = &medium->shell;
    if (low_m < shell->radius_m) {
        const double floor_m = sqrt((shell->radius_m - low_m) * (shell->radius_m + low_m));
        x0_m = fmax(x0_m, floor_m);
    }
    if (!(x0_m < x1_m))
        return 0.0;
    const double height_m = fmax(0.0, radius_m(low_m, x0_m) - shell->radius_m);
    return medium->extinction_per_m * exp(-height_m / shell->scale_height_m) *
           leg_m(low_m, shell->scale_height_m, x0_m, x1_m);
}

static double optical_depth(const struct neph_medium *medium, struct neph_vec3 origin_m,
                            struct neph_vec3 direction, double t0_m, double t1_m)
{
    const struct neph_vec3 from_center_m = neph_vec3_sub(origin_m, medium->shell.center_m);
    const double nearest_m = -neph_vec3_dot(from_center_m, direction);
    const double low_m = neph_vec3_length(neph_vec3_along(from_center_m, direction, nearest_m));
    const double x0_m = t0_m - nearest_m, x1_m = t1_m - nearest_m;
    if (x0_m >= 0.0)
        return leg_depth(medium, low_m, x0_m, x1_m);
    if (x1_m <= 0.0)
        return leg_depth(medium, low_m, -x1_m, -x0_m);
    return leg_depth(medium, low_m, 0.0, -x0_m) + leg_depth(medium, low_m, 0.0, x1_m);
}

static double distance_to_range(double x, double low, double high)
{
    return fmax(0.0, fmax(low - x, x - high));
}

static double farther_end(double x, double low, double high)
{
    return fmax(fabs(low - x), fabs(high - x));
}

/* Densest at the smallest radius of the box, but for what lies below the ground. */
static double bound_per_m(const struct neph_medium *medium, const struct neph_bounds *box)
{
    const struct neph_shell *shell = &medium->shell;
    const struct neph_vec3 c = shell->center_m;
    const struct neph_vec3 near_m = {distance_to_range(c.x, box->min_m.x, box->max_m.x),
                                     distance_to_range(c.y, box->min_m.y, box->max_m.y),
                                     distance_to_range(c.z, box->min_m.z, box->max_m.z)};
    const struct neph_vec3 far_m = {farther_end(c.x, box->min_m.x, box->max_m.x),
                                    farther_end(c.y, box->min_m.y, box->max_m.y),
                                    farther_end(c.z, box->min_m.z, box->max_m.z)};
    if (neph_vec3_length(far_m) < shell->radius_m)
        return 0.0;
    const double height_m = fmax(0.0, neph_vec3_length(near_m) - shell->radius_m);
    return medium->extinction_per_m * exp(-height_m / shell->scale_height_m);
}

static struct neph_bounds support(const struct neph_medium *medium)
{
    return medium->bounds;
}

const struct neph_medium_kind_ops neph_medium_shell = {
    .name = "spherical shell",
    .closed_form = true,
    .extinction_per_m = extinction_per_m,
    .optical_depth = optical_depth,
    .bound_per_m = bound_per_m,
    .support = support,
};
