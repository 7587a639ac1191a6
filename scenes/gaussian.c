/* SPDX-License-Identifier: MIT
 *
 * A Gaussian blob. Along a line the density is a Gaussian of the same width times the density at
 * the impact parameter, so the optical depth is a difference of error functions. Three forms avoid
 * cancellation: across the centre a sum of two erf; on one side a difference of erfc; over an
 * interval too short for that, Gauss quadrature.
 */
#include "scenes/medium_bounds.h"
#include "scenes/medium_kind.h"
#include "scenes/quadrature.h"
#include "scenes/radial.h"

#include <math.h>
#include <stddef.h>

#define AT(member) offsetof(struct neph_medium, member)

/* In widths: e^{-r^2/2} = support_level. */
static const double support_level = 1e-12;
static const double support_radius = 7.43384437769967690; /* sqrt(2 ln 1e12) */

/* Over intervals on which x^2 grows by less than this, erfc(a) - erfc(b) would lose digits, and the
 * quadrature rule is exact to rounding. */
static const double short_stretch = 2.0;

/* e^{-(x^2 - a^2)} at x = a + w. */
static double decay(double w, const void *context)
{
    const double *a = context;
    return exp(-w * (w + 2.0 * *a));
}

/* The integral of e^{-x^2} over [a, a + width], a >= 0. */
static double one_sided_integral(double a, double width)
{
    if (width * (2.0 * a + width) > short_stretch)
        return 0.5 * sqrt(M_PI) * (erfc(a) - erfc(a + width));
    return exp(-a * a) * neph_gauss(decay, &a, 0.0, width);
}

/* The integral of e^{-x^2} over [a, b] of any signs; width = b - a, computed before either was
 * rounded. */
static double integral(double a, double b, double width)
{
    if (a >= 0.0)
        return one_sided_integral(a, width);
    if (b <= 0.0)
        return one_sided_integral(-b, width);
    return 0.5 * sqrt(M_PI) * (erf(b) + erf(-a));
}

static double extinction_at(const struct neph_medium *medium, struct neph_vec3 point_m)
{
    const struct neph_vec3 offset_m = neph_vec3_sub(point_m, medium->gaussian.center_m);
    const double r = neph_vec3_length(offset_m) / medium->gaussian.width_m;
    return medium->extinction_per_m * exp(-0.5 * r * r);
}

static double optical_depth(const struct neph_medium *medium, struct neph_vec3 origin_m,
                            struct neph_vec3 direction, double t0_m, double t1_m)
{
    const struct neph_radial_line line = neph_radial_line(medium->gaussian.center_m, origin_m,
                                                          direction, t0_m, t1_m);
    const double width_m = medium->gaussian.width_m, unit_m = sqrt(2.0) * width_m;
    const double impact = (double)line.impact_m / width_m;
    const double a = (double)(line.s0_m / unit_m), b = (double)(line.s1_m / unit_m);
    return medium->extinction_per_m * exp(-0.5 * impact * impact) *
           (unit_m * integral(a, b, (double)(line.length_m / unit_m)));
}

static double bound_per_m(const struct neph_medium *medium, const struct neph_bounds *box)
{
    return extinction_at(medium, neph_bounds_nearest(box, medium->gaussian.center_m));
}

static void drift(struct neph_medium *medium, struct neph_vec3 by_m)
{
    medium->gaussian.center_m = neph_vec3_add(medium->gaussian.center_m, by_m);
    neph_medium_move_bounds(medium, by_m);
}

static struct neph_bounds support(const struct neph_medium *medium)
{
    return neph_bounds_around(medium->gaussian.center_m, support_radius * medium->gaussian.width_m);
}

/* The error is at most the optical depth of a line at impact c, where c is half a side: a ray that
 * misses the box has a larger impact, a ray that crosses it loses two tails of at most
 * e^{-c^2/2} erfc(0) / 2 each, and transmittance changes by no more than optical depth. */
static struct neph_bounds container(const struct neph_scene *scene,
                                    const struct neph_medium *medium, double *cut_error)
{
    (void)scene;
    const struct neph_rgb c = medium->extinction_color;
    const double line_m = sqrt(2.0 * M_PI) * medium->gaussian.width_m;
    *cut_error = support_level * medium->extinction_per_m * line_m * fmax(c.r, fmax(c.g, c.b));
    return support(medium);
}

static struct neph_column column(const struct neph_medium *medium, int axis)
{
    (void)axis;
    return (struct neph_column){.point_m = medium->gaussian.center_m};
}

/* Splits at every second width, to where e^-50 of the density remains. */
static void cut_widths(struct neph_cuts *cuts, double middle_m, double width_m)
{
    for (int k = -10; k <= 10; k += 2)
        neph_cuts_add(cuts, middle_m + k * width_m);
}

/* Splits on the ray itself, and where the blob's shadow crosses it: the distance of the sun ray
 * from the centre is a hyperbola in t, with its own centre and width. */
static void cut_scales(struct neph_cuts *cuts, const struct neph_medium *medium)
{
    const struct neph_vec3 s = cuts->scene->sun.direction, d = cuts->direction;
    const struct neph_vec3 to_center_m = neph_vec3_sub(medium->gaussian.center_m, cuts->origin_m);
    const struct neph_vec3 across = neph_vec3_along(d, s, -neph_vec3_dot(d, s));
    const double slope2 = neph_vec3_dot(across, across);
    cut_widths(cuts, neph_vec3_dot(to_center_m, d), medium->gaussian.width_m);
    if (slope2 > 0.0 && cuts->scene->medium_count > 1) /* the shadow falls on other media */
        cut_widths(cuts, neph_vec3_dot(to_center_m, across) / slope2,
                   medium->gaussian.width_m / sqrt(slope2));
}

/* The order of the rows is the order in the hash. */
static const struct neph_field fields[] = {
    {"extinction_per_m", NEPH_NUMBER, AT(extinction_per_m), "1/m", 0, 1e4, .note = "at the centre",
     .standard = NEPH_OR_ANOTHER_DENSITY},
    {"center_m", NEPH_THREE, AT(gaussian.center_m), "m", -NEPH_FAR_M, NEPH_FAR_M,
     .note = "of the blob"},
    {"width_m", NEPH_NUMBER, AT(gaussian.width_m), "m", 1e-3, NEPH_FAR_M,
     .note = "the standard deviation"},
    {"bounds", NEPH_RECORD, AT(bounds), .record = &neph_bounds_record, .standard = "unbounded"},
    {0},
};

const struct neph_medium_row neph_medium_gaussian = {
    .facts = {.name = "Gaussian blob",
              .place = "at the centre",
              .has_closed_form = true,
              .needs_majorants = true,
              .majorant_cells = NEPH_MAJORANT_CELLS},
    .forms = {{"gaussian", "extinction_per_m * exp(-r^2 / (2 width_m^2))", fields}},
    .extinction_per_m = extinction_at,
    .optical_depth = optical_depth,
    .bound_per_m = bound_per_m,
    .column = column,
    .drift = drift,
    .support = support,
    .cut_scales = cut_scales,
    .container = container,
};
