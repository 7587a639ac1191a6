/* SPDX-License-Identifier: MIT
 *
 * An exponential atmosphere on a sphere, empty below its radius. A line is split into legs on which
 * the distance r from the centre grows. With p the impact parameter, X = p / H and r = p + H v^2,
 * the optical depth of a leg from v1 is a Chapman function of finite length (S. Chapman, Proc.
 * Phys. Soc. 43, 1931) without its singularity at the nearest point:
 *
 *   tau = sigma(r1) H Int_0^W e^{-w (w + 2 v1)} 2 g(v1 + w) dw,   g(v) = (X + v^2)/sqrt(2X + v^2).
 *
 * The exponential of the altitude is taken at the leg's lowest point, so it cannot overflow, and
 * the integral is a Gauss rule on few pieces. erfcx is no alternative: g is nearly linear for a
 * planet (X ~ 800), but the series around that fails for small X, and short legs would cancel. The
 * rule has neither problem and is accurate to rounding (tests/scenes/test_shell.c).
 */
#include "scenes/bounds.h"
#include "scenes/medium_kind.h"
#include "scenes/quadrature.h"
#include "scenes/radial.h"
#include "scenes/solids.h"

#include <math.h>
#include <stddef.h>

#define AT(member) offsetof(struct neph_medium, member)

/* Beyond e^-42 of its start a leg adds nothing in double. */
static const double decay_end = 42.0;
/* Size of a piece of the rule: this much of the exponent, and at most this multiple of the distance
 * to the branch points of g at v = +-i sqrt(2X). */
static const double decay_of_piece = 14.0;
static const double branch_distances_of_piece = 2.0;
static const double branch_distance_min = 1e-150; /* limits the number of pieces */

struct leg {
    double v1, x;
};

static double leg_integrand(double w, const void *context)
{
    const struct leg *leg = context;
    const double v = leg->v1 + w, v2 = v * v;
    return exp(-w * (w + 2.0 * leg->v1)) * (leg->x + v2) / sqrt(2.0 * leg->x + v2);
}

/* Int_0^W of the head comment, with W where the exponent w (w + 2 v1) reaches `decay`. */
static double leg_integral(const struct leg *leg, double decay)
{
    const double v1 = leg->v1, total = fmin(decay, decay_end);
    double sum = 0.0, from = 0.0, done = 0.0;
    while (done < total) {
        const double branch = fmax(branch_distance_min,
                                   sqrt((v1 + from) * (v1 + from) + 2.0 * leg->x));
        const double reach = from + branch_distances_of_piece * branch;
        const double next = fmin(fmin(total, done + decay_of_piece), reach * (reach + 2.0 * v1));
        const double to = next / (v1 + sqrt(v1 * v1 + next));
        sum += neph_gauss(leg_integrand, leg, from, to);
        from = to;
        done = next;
    }
    return 2.0 * sum;
}

/* Optical depth from s = near_m >= 0 over length_m; `altitude_m`: of the near end. */
static double leg_optical_depth(const struct neph_medium *medium, long double impact_m,
                                long double near_m, long double length_m, long double altitude_m)
{
    const long double height_m = medium->shell.scale_height_m;
    const long double near_r_m = sqrtl(impact_m * impact_m + near_m * near_m);
    const long double far_m = near_m + length_m;
    const long double far_r_m = sqrtl(impact_m * impact_m + far_m * far_m);
    /* (r - r1) / H, as a product. */
    const double decay = isinf(far_m) ? INFINITY
                                      : (double)(length_m / height_m *
                                                 ((far_m + near_m) / (far_r_m + near_r_m)));
    const struct leg leg = {
        .v1 = (double)(near_m / sqrtl(height_m * (near_r_m + impact_m))),
        .x = (double)(impact_m / height_m),
    };
    return medium->extinction_per_m * exp((double)(-altitude_m / height_m)) *
           (medium->shell.scale_height_m * leg_integral(&leg, decay));
}

/* Optical depth of the part of a line above the ground on one side of its nearest point, |s| from
 * low_m to high_m. */
static double side_optical_depth(const struct neph_medium *medium,
                                 const struct neph_radial_line *line, long double low_m,
                                 long double high_m)
{
    const long double radius_m = medium->shell.radius_m, impact_m = line->impact_m;
    const long double rise_m = (radius_m - impact_m) * (radius_m + impact_m);
    const long double ground_m = rise_m > 0.0L ? sqrtl(rise_m) : 0.0L;
    if (low_m >= ground_m) {
        const long double r_m = sqrtl(impact_m * impact_m + low_m * low_m);
        const long double altitude_m = fmaxl(r_m - radius_m, 0.0L);
        return leg_optical_depth(medium, impact_m, low_m, line->length_m, altitude_m);
    }
    if (!(high_m > ground_m))
        return 0.0;
    const long double lowest_m = fmaxl(radius_m, impact_m);
    return leg_optical_depth(medium, impact_m, ground_m, high_m - ground_m, lowest_m - radius_m);
}

static double optical_depth(const struct neph_medium *medium, struct neph_vec3 origin_m,
                            struct neph_vec3 direction, double t0_m, double t1_m)
{
    const struct neph_radial_line line = neph_radial_line(medium->shell.center_m, origin_m,
                                                          direction, t0_m, t1_m);
    return side_optical_depth(medium, &line, -line.s1_m, -line.s0_m) +
           side_optical_depth(medium, &line, line.s0_m, line.s1_m);
}

static double extinction_at_radius(const struct neph_medium *medium, long double r_m)
{
    const long double altitude_m = r_m - medium->shell.radius_m;
    if (altitude_m < 0.0L)
        return 0.0;
    return medium->extinction_per_m * exp((double)(-altitude_m / medium->shell.scale_height_m));
}

static double extinction_per_m(const struct neph_medium *medium, struct neph_vec3 point_m)
{
    return extinction_at_radius(medium, neph_radial_distance_m(medium->shell.center_m, point_m));
}

/* The density is largest at the lowest altitude above the ground. */
static double bound_per_m(const struct neph_medium *medium, const struct neph_bounds *box)
{
    const struct neph_vec3 c = medium->shell.center_m;
    const struct neph_vec3 nearest_m = neph_bounds_nearest(box, c);
    const struct neph_vec3 farthest_m = neph_bounds_farthest(box, c);
    if (neph_radial_distance_m(c, farthest_m) < medium->shell.radius_m)
        return 0.0;
    return extinction_at_radius(
        medium, fmaxl(neph_radial_distance_m(c, nearest_m), medium->shell.radius_m));
}

static struct neph_bounds support(const struct neph_medium *medium)
{
    return medium->bounds;
}

/* The largest optical depth of a line that stays above an altitude: the line that is level
 * there. */
static double level_optical_depth(const struct neph_medium *medium, double altitude_m)
{
    const long double lowest_m = (long double)medium->shell.radius_m + altitude_m;
    return 2.0 * leg_optical_depth(medium, lowest_m, 0.0L, INFINITY, altitude_m);
}

/* The cube around a sphere above which the medium is negligible. A line that misses the cube stays
 * above that sphere; a line that crosses it loses two ends of at most half a level line each. */
static struct neph_bounds container(const struct neph_scene *scene,
                                    const struct neph_medium *medium, double *cut_error)
{
    (void)scene;
    static const double lost_optical_depth = 1e-8, step_scale_heights = 0.125;
    const struct neph_vec3 c = medium->shell.center_m;
    const struct neph_rgb color = medium->extinction_color;
    const double strongest = fmax(color.r, fmax(color.g, color.b));
    double altitude_m = medium->shell.scale_height_m;
    double lost = strongest * level_optical_depth(medium, altitude_m);
    while (lost > lost_optical_depth) {
        altitude_m += step_scale_heights * medium->shell.scale_height_m;
        lost = strongest * level_optical_depth(medium, altitude_m);
    }
    *cut_error = lost;
    return neph_bounds_around(c, medium->shell.radius_m + altitude_m);
}

/* Scale heights between cuts, and number of cuts until the density is negligible. */
enum { FOLDS = 4, FOLD_CUTS = 11 };

/* The distance x from the lowest point of the ray at which its radius has grown by `height_m` since
 * x0. */
static double x_at_climb_m(double low_m, double x0_m, double height_m)
{
    return sqrt(x0_m * x0_m + height_m * (2.0 * hypot(low_m, x0_m) + height_m));
}

/* Splits one leg of the ray, on one side (+1 or -1) of its lowest point at t = middle_m: at the
 * ground and at heights above the densest point of the leg. */
static void cut_leg(struct neph_cuts *cuts, const struct neph_shell *shell, double low_m,
                    double middle_m, double side)
{
    const double start_m = side > 0.0 ? cuts->t0_m - middle_m : middle_m - cuts->t1_m;
    double x0_m = fmax(0.0, start_m);
    if (low_m < shell->radius_m)
        x0_m = fmax(x0_m, sqrt((shell->radius_m - low_m) * (shell->radius_m + low_m)));
    for (int k = 0; k <= FOLD_CUTS; k++)
        neph_cuts_add(
            cuts, middle_m + side * x_at_climb_m(low_m, x0_m, k * FOLDS * shell->scale_height_m));
}

/* Splits on the ray, and where its sun rays are tangent to a sphere of some height: the edges of
 * the shadows of spheres. The lowest sphere, the ground, is a kink, because the medium ends
 * there. */
static void cut_scales(struct neph_cuts *cuts, const struct neph_medium *medium)
{
    const struct neph_shell *shell = &medium->shell;
    const struct neph_vec3 from_center_m = neph_vec3_sub(cuts->origin_m, shell->center_m);
    const double middle_m = -neph_vec3_dot(from_center_m, cuts->direction);
    const double low_m = neph_vec3_length(
        neph_vec3_along(from_center_m, cuts->direction, middle_m));
    cut_leg(cuts, shell, low_m, middle_m, 1.0);
    cut_leg(cuts, shell, low_m, middle_m, -1.0);
    for (int k = 0; k <= FOLD_CUTS; k++) {
        const struct neph_solid ball = {.kind = NEPH_SOLID_SPHERE,
                                        .center_m = shell->center_m,
                                        .radius_m = shell->radius_m +
                                                    k * FOLDS * shell->scale_height_m};
        double low_t_m, high_t_m;
        if (neph_solid_shadow(&ball, cuts->scene->sun.direction, cuts->origin_m, cuts->direction,
                              cuts->t0_m, cuts->t1_m, &low_t_m, &high_t_m)) {
            neph_cuts_add(cuts, low_t_m);
            neph_cuts_add(cuts, high_t_m);
        }
    }
}

/* The ball below the ground is empty. */
static struct neph_column column(const struct neph_medium *medium, int axis)
{
    (void)axis;
    return (struct neph_column){.point_m = medium->shell.center_m, .begins_there = true};
}

/* The order of the rows is the order in the hash. */
static const struct neph_field fields[] = {
    {"extinction_per_m", NEPH_NUMBER, AT(extinction_per_m), "1/m", 0, 1e4, .note = "at the radius",
     .standard = NEPH_OR_ANOTHER_DENSITY},
    {"center_m", NEPH_THREE, AT(shell.center_m), "m", -NEPH_PLANET_M, NEPH_PLANET_M,
     .note = "of the ball"},
    {"radius_m", NEPH_NUMBER, AT(shell.radius_m), "m", 1, 1e8,
     .note = "of the ground: no medium below it"},
    {"scale_height_m", NEPH_NUMBER, AT(shell.scale_height_m), "m", 1e-2, 1e7,
     .note = "in which the density falls to 1/e"},
    {"bounds", NEPH_RECORD, AT(bounds),
     .note = "an atmosphere needs finite bounds, for trackers and other engines",
     .record = &neph_planet_bounds_record},
    {0},
};

const struct neph_medium_row neph_medium_shell = {
    .facts = {.name = "spherical shell",
              .place = "at the radius",
              .has_closed_form = true,
              .has_kinks = true,
              .majorant_cells = NEPH_MAJORANT_CELLS},
    .forms =
        {{"shell",
          "an atmosphere around a ball: extinction_per_m * exp(-(r - radius_m) / scale_height_m)",
          fields}},
    .extinction_per_m = extinction_per_m,
    .optical_depth = optical_depth,
    .bound_per_m = bound_per_m,
    .column = column,
    .support = support,
    .cut_scales = cut_scales,
    .container = container,
};
