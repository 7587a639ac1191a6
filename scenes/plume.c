/* SPDX-License-Identifier: MIT
 *
 * A plume of smoke: it begins at a foot, thins out exponentially along its axis, and across the
 * axis as a Gaussian. With s along the axis and r across it, the density is e^-(s/L + r^2/(2 w^2))
 * where s >= 0. Along a line the exponent is a parabola. So from its minimum to either side
 *
 *   tau = sigma(minimum) Int_0^W e^{-x (rise + bend x)} dx,   rise >= 0, bend >= 0.
 *
 * The closed forms are erf where bend dominates and expm1 where it is negligible; both cancel in
 * between. A Gauss rule on pieces of 14 units of the exponent is accurate to rounding everywhere.
 */
#include "scenes/media.h"
#include "scenes/medium_bounds.h"
#include "scenes/medium_kind.h"
#include "scenes/quadrature.h"

#include <math.h>
#include <stddef.h>

#define AT(member) offsetof(struct neph_medium, member)

/* Beyond e^-42 of its start a leg adds nothing in double. */
static const double decay_end = 42.0, decay_of_piece = 14.0;

static const double support_level = 1e-12;
static const double support_folds = 27.6310211159285482;  /* ln 1e12 */
static const double support_radius = 7.43384437769967690; /* in widths: sqrt(2 ln 1e12) */

/* --- density --- */

struct plume_place {
    double along_m;            /* along the axis, from the foot */
    struct neph_vec3 across_m; /* perpendicular to the axis */
};

static struct plume_place find_place(const struct neph_plume *plume, struct neph_vec3 point_m)
{
    const struct neph_vec3 offset_m = neph_vec3_sub(point_m, plume->foot_m);
    const double along_m = neph_vec3_dot(offset_m, plume->axis);
    return (struct plume_place){along_m, neph_vec3_along(offset_m, plume->axis, -along_m)};
}

/* The density is e^-folds. */
static double exponent_at(const struct neph_plume *plume, const struct plume_place *plume_place)
{
    const double r = neph_vec3_length(plume_place->across_m) / plume->width_m;
    return plume_place->along_m / plume->scale_height_m + 0.5 * r * r;
}

static double extinction_per_m(const struct neph_medium *medium, struct neph_vec3 point_m)
{
    const struct plume_place plume_place = find_place(&medium->plume, point_m);
    return plume_place.along_m < 0.0
               ? 0.0
               : medium->extinction_per_m * exp(-exponent_at(&medium->plume, &plume_place));
}

/* --- along a line --- */

/* The part of a line above the foot, relative to its densest place. */
struct line {
    double t0_m, t1_m, densest_m;
    double folds;
    double rise_per_m;  /* slope of folds at the densest place: > 0 if that is the start, < 0 if it
                          is the end */
    double bend_per_m2; /* half the second derivative of folds */
};

static bool find_line(const struct neph_plume *plume, struct neph_vec3 origin_m,
                      struct neph_vec3 direction, double t0_m, double t1_m, struct line *line)
{
    const struct plume_place start = find_place(plume, origin_m);
    const double slope = neph_vec3_dot(direction, plume->axis);
    const struct neph_vec3 across = neph_vec3_along(direction, plume->axis, -slope);
    const double width2_m2 = plume->width_m * plume->width_m;
    if (!neph_clip_axis(0.0, INFINITY, start.along_m, slope, &t0_m, &t1_m))
        return false;
    const double rise_per_m = slope / plume->scale_height_m +
                              neph_vec3_dot(start.across_m, across) / width2_m2;
    const double bend_per_m2 = 0.5 * neph_vec3_dot(across, across) / width2_m2;
    const double lowest_m = bend_per_m2 > 0.0  ? -0.5 * rise_per_m / bend_per_m2
                            : rise_per_m > 0.0 ? -INFINITY
                                               : INFINITY;
    *line = (struct line){.t0_m = t0_m, .t1_m = t1_m, .bend_per_m2 = bend_per_m2};
    line->densest_m = fmin(t1_m, fmax(t0_m, lowest_m));
    const struct plume_place densest = find_place(
        plume, neph_vec3_along(origin_m, direction, line->densest_m));
    line->folds = exponent_at(plume, &densest);
    line->rise_per_m = slope / plume->scale_height_m +
                       neph_vec3_dot(densest.across_m, across) / width2_m2;
    return isfinite(line->densest_m);
}

/* One direction from the densest place, in which folds grow by x (rise + bend x). */
struct leg {
    double rise_per_m, bend_per_m2;
};

static double leg_integrand(double x_m, const void *context)
{
    const struct leg *leg = context;
    return exp(-x_m * (leg->rise_per_m + leg->bend_per_m2 * x_m));
}

/* The distance at which folds have grown by this number. */
static double leg_place_m(const struct leg *leg, double folds)
{
    const double root = sqrt(leg->rise_per_m * leg->rise_per_m + 4.0 * leg->bend_per_m2 * folds);
    return 2.0 * folds / (leg->rise_per_m + root);
}

static double leg_integral_m(const struct leg *leg, double length_m)
{
    const double bend = leg->bend_per_m2 > 0.0 ? leg->bend_per_m2 * length_m : 0.0; /* 0 * inf */
    const double decay = length_m * (leg->rise_per_m + bend);
    const double total = fmin(decay_end, decay);
    double sum_m = 0.0, from_m = 0.0;
    for (double done = 0.0; done < total; done += decay_of_piece) {
        const double next = fmin(total, done + decay_of_piece);
        const double to_m = next < decay ? leg_place_m(leg, next) : length_m;
        sum_m += neph_gauss(leg_integrand, leg, from_m, to_m);
        from_m = to_m;
    }
    return decay > 0.0 ? sum_m : length_m;
}

static void find_legs(const struct line *line, struct leg legs[2], double lengths_m[2])
{
    legs[0] = (struct leg){fmax(0.0, line->rise_per_m), line->bend_per_m2};
    legs[1] = (struct leg){fmax(0.0, -line->rise_per_m), line->bend_per_m2};
    lengths_m[0] = line->t1_m - line->densest_m;
    lengths_m[1] = line->densest_m - line->t0_m;
}

static double optical_depth(const struct neph_medium *medium, struct neph_vec3 origin_m,
                            struct neph_vec3 direction, double t0_m, double t1_m)
{
    struct line line;
    struct leg legs[2];
    double lengths_m[2];
    if (!find_line(&medium->plume, origin_m, direction, t0_m, t1_m, &line))
        return 0.0;
    find_legs(&line, legs, lengths_m);
    return medium->extinction_per_m * exp(-line.folds) *
           (leg_integral_m(&legs[0], lengths_m[0]) + leg_integral_m(&legs[1], lengths_m[1]));
}

/* Splits at scales of folds on the ray, and at widths of the shadow: the distance of the sun ray
 * from the axis is linear along the ray. */
static void cut_scales(struct neph_cuts *cuts, const struct neph_medium *medium)
{
    const struct neph_plume *plume = &medium->plume;
    struct line line;
    struct leg legs[2];
    double lengths_m[2];
    if (find_line(plume, cuts->origin_m, cuts->direction, cuts->t0_m, cuts->t1_m, &line)) {
        find_legs(&line, legs, lengths_m);
        neph_cuts_add(cuts, line.t0_m);
        neph_cuts_add(cuts, line.t1_m);
        neph_cuts_add(cuts, line.densest_m);
        for (double folds = 4.0; folds <= decay_end; folds += 4.0) {
            neph_cuts_add(cuts, line.densest_m + leg_place_m(&legs[0], folds));
            neph_cuts_add(cuts, line.densest_m - leg_place_m(&legs[1], folds));
        }
    }
    const struct neph_vec3 normal = neph_vec3_cross(cuts->scene->sun.direction, plume->axis);
    const double slope = neph_vec3_dot(cuts->direction, normal);
    if (slope == 0.0 || cuts->scene->medium_count == 1) /* no medium receives the shadow */
        return;
    const struct neph_vec3 to_foot_m = neph_vec3_sub(plume->foot_m, cuts->origin_m);
    const double middle_m = neph_vec3_dot(to_foot_m, normal) / slope;
    const double width_m = plume->width_m * neph_vec3_length(normal) / fabs(slope);
    for (int k = -10; k <= 10; k += 2)
        neph_cuts_add(cuts, middle_m + k * width_m);
}

/* --- boxes --- */

/* A lower bound of folds, which are convex: the tangent plane at any point of the box is a lower
 * bound, and is tighter the nearer the point is to the minimum. Below the foot the formula is
 * negative but the density is 0: hence at least 0. */
static double find_least_exponent(const struct neph_plume *plume, const struct neph_bounds *box)
{
    const double *low_m = &box->min_m.x, *high_m = &box->max_m.x, *axis = &plume->axis.x;
    struct neph_vec3 point_m = neph_bounds_nearest(box, plume->foot_m);
    double *point = &point_m.x, bound = 0.0;
    for (int step = 0; step <= 24; step++) {
        const struct plume_place plume_place = find_place(plume, point_m);
        const double *across_m = &plume_place.across_m.x,
                     width2_m2 = plume->width_m * plume->width_m;
        double folds = exponent_at(plume, &plume_place);
        for (int i = 0; i < 3; i++) {
            const double slope = axis[i] / plume->scale_height_m + across_m[i] / width2_m2;
            folds += slope * ((slope > 0.0 ? low_m[i] : high_m[i]) - point[i]);
        }
        bound = fmax(bound, folds);
        const int i = step % 3; /* to the minimum along one axis of the world */
        const double slope = axis[i] / plume->scale_height_m + across_m[i] / width2_m2;
        const double bend = (1.0 - axis[i] * axis[i]) / width2_m2;
        const double to_m = bend > 0.0    ? point[i] - slope / bend
                            : slope > 0.0 ? low_m[i]
                                          : high_m[i];
        point[i] = fmin(high_m[i], fmax(low_m[i], to_m));
    }
    return bound;
}

static double bound_per_m(const struct neph_medium *medium, const struct neph_bounds *box)
{
    const struct neph_vec3 side_m = neph_vec3_sub(box->max_m, box->min_m), a = medium->plume.axis;
    const struct neph_vec3 highest_m = {a.x > 0.0 ? box->max_m.x : box->min_m.x,
                                        a.y > 0.0 ? box->max_m.y : box->min_m.y,
                                        a.z > 0.0 ? box->max_m.z : box->min_m.z};
    if (!isfinite(side_m.x + side_m.y + side_m.z))
        return medium->extinction_per_m;
    if (find_place(&medium->plume, highest_m).along_m < 0.0)
        return 0.0;
    return medium->extinction_per_m * exp(-find_least_exponent(&medium->plume, box));
}

/* The box of the cylinder outside which the density is below the level. */
static struct neph_bounds support(const struct neph_medium *medium)
{
    const struct neph_plume *plume = &medium->plume;
    const double *axis = &plume->axis.x;
    struct neph_bounds box = {plume->foot_m, plume->foot_m};
    for (int i = 0; i < 3; i++) {
        const double end_m = axis[i] * support_folds * plume->scale_height_m;
        const double reach_m = support_radius * plume->width_m *
                               sqrt(fmax(0.0, 1.0 - axis[i] * axis[i]));
        (&box.min_m.x)[i] += fmin(0.0, end_m) - reach_m;
        (&box.max_m.x)[i] += fmax(0.0, end_m) + reach_m;
    }
    return box;
}

/* Outside the box the density is below the level l, and both e^{-s/L} and e^{-r^2/(2 w^2)} bound
 * it. A line within 45 degrees of the axis is at most sqrt 2 times as long as its s, and loses less
 * than the integral of min(l, e^{-s/L}); any other line is at most sqrt 2 times as long as its
 * r. */
static struct neph_bounds container(const struct neph_scene *scene,
                                    const struct neph_medium *medium, double *cut_error)
{
    (void)scene;
    const struct neph_rgb c = medium->extinction_color;
    const double along_m = (support_folds + 1.0) * medium->plume.scale_height_m;
    const double across_m = 2.0 * (support_radius + 1.0) * medium->plume.width_m;
    *cut_error = support_level * sqrt(2.0) * medium->extinction_per_m * fmax(along_m, across_m) *
                 fmax(c.r, fmax(c.g, c.b));
    return support(medium);
}

static void drift(struct neph_medium *medium, struct neph_vec3 by_m)
{
    medium->plume.foot_m = neph_vec3_add(medium->plume.foot_m, by_m);
    neph_medium_move_bounds(medium, by_m);
}

/* --- its densest place --- */

static struct neph_column column(const struct neph_medium *medium, int axis)
{
    (void)axis;
    return (struct neph_column){.point_m = medium->plume.foot_m};
}

/* --- in a scene file --- */

/* The order of the rows is the order in the hash. */
static const struct neph_field fields[] = {
    {"extinction_per_m", NEPH_NUMBER, AT(extinction_per_m), "1/m", 0, 1e4, .note = "at the foot",
     .standard = NEPH_OR_ANOTHER_DENSITY},
    {"foot_m", NEPH_THREE, AT(plume.foot_m), "m", -NEPH_FAR_M, NEPH_FAR_M,
     .note = "where it begins"},
    {"axis", NEPH_THREE, AT(plume.axis), "", -NEPH_FAR_M, NEPH_FAR_M,
     .note = "from the foot on; any length but 0"},
    {"width_m", NEPH_NUMBER, AT(plume.width_m), "m", 1e-3, NEPH_FAR_M,
     .note = "the standard deviation across the axis"},
    {"scale_height_m", NEPH_NUMBER, AT(plume.scale_height_m), "m", 1e-3, NEPH_FAR_M,
     .note = "in which the density falls to 1/e along the axis"},
    {"bounds", NEPH_RECORD, AT(bounds), .record = &neph_bounds_record, .standard = "unbounded"},
    {0},
};

static enum neph_status finish(struct neph_reader *reader, const yaml_node_t *node, void *written)
{
    struct neph_medium *medium = written;
    (void)node;
    if (neph_vec3_length(medium->plume.axis) < 1e-9)
        return neph_refuse(reader, "axis", "a direction of length 0");
    medium->plume.axis = neph_vec3_normalize(medium->plume.axis);
    return NEPH_OK;
}

const struct neph_medium_row neph_medium_plume = {
    .facts = {.name = "smoke plume",
              .place = "at the foot",
              .has_closed_form = true,
              .needs_majorants = true,
              .majorant_cells = NEPH_MAJORANT_CELLS},
    .forms = {{"plume", "smoke: extinction_per_m * exp(-s / scale_height_m - r^2 / (2 width_m^2))",
               fields, .finish = finish}},
    .extinction_per_m = extinction_per_m,
    .optical_depth = optical_depth,
    .bound_per_m = bound_per_m,
    .column = column,
    .support = support,
    .container = container,
    .cut_scales = cut_scales,
    .drift = drift,
};
