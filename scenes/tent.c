/* SPDX-License-Identifier: MIT
 *
 * A layer around a ball, such as ozone: the density is a tent over the altitude, 1 at the peak and
 * 0 from half a width away on. Along a line the distance from the centre is sqrt(p^2 + s^2), with p
 * the impact parameter. So between the altitudes of the tent's foot, peak and top the density is
 * analytic up to |Im s| = p, and a Gauss rule on pieces no longer than two such distances is
 * accurate to rounding. (The closed form, s r + p^2 asinh(s / p), would cancel for a planet's
 * radius.)
 */
#include "scenes/bounds.h"
#include "scenes/medium_kind.h"
#include "scenes/quadrature.h"
#include "scenes/radial.h"
#include "scenes/solids.h"

#include <math.h>
#include <stddef.h>

#define AT(member) offsetof(struct neph_medium, member)

static const long double branch_distance_min_m = 1e-30L; /* limits the number of pieces */

static long double peak_m(const struct neph_tent *tent)
{
    return (long double)tent->radius_m + tent->altitude_m;
}

static double density_at_radius(const struct neph_tent *tent, long double radius_m)
{
    const double off_m = (double)fabsl(radius_m - peak_m(tent));
    return fmax(0.0, 1.0 - off_m / tent->half_width_m);
}

static double extinction_per_m(const struct neph_medium *medium, struct neph_vec3 point_m)
{
    return medium->extinction_per_m *
           density_at_radius(&medium->tent, neph_radial_distance_m(medium->tent.center_m, point_m));
}

/* --- along a line --- */

struct side {
    const struct neph_tent *tent;
    long double impact_m;
};

static double density_at(double s_m, const void *context)
{
    const struct side *side = context;
    const long double p_m = side->impact_m;
    return density_at_radius(side->tent, sqrtl(p_m * p_m + (long double)s_m * s_m));
}

/* The place on a side of the line at which it reaches a radius: 0 if it is never below. */
static long double place_m(const struct side *side, long double radius_m)
{
    const long double p_m = side->impact_m;
    return radius_m > p_m ? sqrtl((radius_m - p_m) * (radius_m + p_m)) : 0.0L;
}

/* The integral over a part without kinks. */
static double piece_integral_m(const struct side *side, long double from_m, long double to_m)
{
    double sum_m = 0.0;
    while (from_m < to_m) {
        const long double branch_m = hypotl(side->impact_m, from_m);
        const long double next_m = fminl(to_m,
                                         from_m + 2.0L * fmaxl(branch_m, branch_distance_min_m));
        sum_m += neph_gauss(density_at, side, (double)from_m, (double)next_m);
        from_m = next_m;
    }
    return sum_m;
}

/* The integral over the part of a line on one side of its nearest point, |s| from low_m to
 * high_m. */
static double side_integral_m(const struct side *side, long double low_m, long double high_m)
{
    const struct neph_tent *tent = side->tent;
    const long double foot_m = place_m(side, peak_m(tent) - tent->half_width_m);
    const long double middle_m = place_m(side, peak_m(tent));
    const long double top_m = place_m(side, peak_m(tent) + tent->half_width_m);
    return piece_integral_m(side, fmaxl(low_m, foot_m), fminl(high_m, middle_m)) +
           piece_integral_m(side, fmaxl(low_m, middle_m), fminl(high_m, top_m));
}

static double optical_depth(const struct neph_medium *medium, struct neph_vec3 origin_m,
                            struct neph_vec3 direction, double t0_m, double t1_m)
{
    const struct neph_radial_line line = neph_radial_line(medium->tent.center_m, origin_m,
                                                          direction, t0_m, t1_m);
    const struct side side = {&medium->tent, line.impact_m};
    return medium->extinction_per_m * (side_integral_m(&side, fmaxl(0.0L, -line.s1_m), -line.s0_m) +
                                       side_integral_m(&side, fmaxl(0.0L, line.s0_m), line.s1_m));
}

/* Splits at the tent's kinks on the ray, and where its sun rays are tangent to these spheres. */
static void cut_scales(struct neph_cuts *cuts, const struct neph_medium *medium)
{
    const struct neph_tent *tent = &medium->tent;
    const struct neph_radial_line line = neph_radial_line(tent->center_m, cuts->origin_m,
                                                          cuts->direction, 0.0, 1.0);
    const struct side side = {tent, line.impact_m};
    for (int k = -1; k <= 1; k++) {
        const long double radius_m = peak_m(tent) + k * tent->half_width_m;
        neph_cuts_add(cuts, (double)(-line.s0_m - place_m(&side, radius_m)));
        neph_cuts_add(cuts, (double)(-line.s0_m + place_m(&side, radius_m)));
        const struct neph_solid ball = {
            .kind = NEPH_SOLID_SPHERE, .center_m = tent->center_m, .radius_m = (double)radius_m};
        double low_t_m, high_t_m;
        if (neph_solid_shadow(&ball, cuts->scene->sun.direction, cuts->origin_m, cuts->direction,
                              cuts->t0_m, cuts->t1_m, &low_t_m, &high_t_m)) {
            neph_cuts_add(cuts, low_t_m);
            neph_cuts_add(cuts, high_t_m);
        }
    }
}

/* --- boxes --- */

/* The density is largest at the altitude of the box that is nearest to the peak. */
static double bound_per_m(const struct neph_medium *medium, const struct neph_bounds *box)
{
    const struct neph_vec3 c = medium->tent.center_m;
    const long double low_m = neph_radial_distance_m(c, neph_bounds_nearest(box, c));
    const long double high_m = neph_radial_distance_m(c, neph_bounds_farthest(box, c));
    const long double nearest_m = fmaxl(low_m, fminl(high_m, peak_m(&medium->tent)));
    return medium->extinction_per_m * density_at_radius(&medium->tent, nearest_m);
}

static struct neph_bounds support(const struct neph_medium *medium)
{
    const struct neph_tent *tent = &medium->tent;
    return neph_bounds_around(tent->center_m, (double)peak_m(tent) + tent->half_width_m);
}

/* --- in a scene file --- */

/* The ball below the ground is empty. */
static struct neph_column column(const struct neph_medium *medium, int axis)
{
    (void)axis;
    return (struct neph_column){.point_m = medium->tent.center_m, .begins_there = true};
}

/* The order of the rows is the order in the hash. */
static const struct neph_field fields[] = {
    {"extinction_per_m", NEPH_NUMBER, AT(extinction_per_m), "1/m", 0, 1e4,
     .note = "at the altitude of the peak", .standard = NEPH_OR_ANOTHER_DENSITY},
    {"center_m", NEPH_THREE, AT(tent.center_m), "m", -NEPH_PLANET_M, NEPH_PLANET_M,
     .note = "of the ball"},
    {"radius_m", NEPH_NUMBER, AT(tent.radius_m), "m", 1, 1e8,
     .note = "of the ground, from which altitudes count"},
    {"altitude_m", NEPH_NUMBER, AT(tent.altitude_m), "m", 1e-2, 1e7, .note = "of the peak"},
    {"half_width_m", NEPH_NUMBER, AT(tent.half_width_m), "m", 1e-2, 1e7,
     .note = "from the peak to the end of the layer; no more than altitude_m"},
    {"bounds", NEPH_RECORD, AT(bounds), .record = &neph_planet_bounds_record,
     .standard = "unbounded"},
    {0},
};

static enum neph_status finish(struct neph_reader *reader, const yaml_node_t *node, void *written)
{
    const struct neph_medium *medium = written;
    (void)node;
    if (medium->tent.half_width_m > medium->tent.altitude_m)
        return neph_refuse(reader, "half_width_m",
                           "more than altitude_m: it would reach below the "
                           "ground");
    return NEPH_OK;
}

const struct neph_medium_row neph_medium_tent = {
    .facts = {.name = "tent layer",
              .place = "at the peak",
              .has_closed_form = true,
              .has_kinks = true,
              .needs_majorants = true,
              .majorant_cells = NEPH_MAJORANT_CELLS},
    .forms = {{"tent",
               "a layer around a ball, such as ozone: extinction_per_m * max(0, 1 - |r - radius_m "
               "- altitude_m| / half_width_m)",
               fields, .finish = finish}},
    .extinction_per_m = extinction_per_m,
    .optical_depth = optical_depth,
    .bound_per_m = bound_per_m,
    .column = column,
    .support = support,
    .cut_scales = cut_scales,
};
