/* SPDX-License-Identifier: MIT
 *
 * What a scene asks of its media, whatever their kind: the table of kinds, the bounds, phase
 * functions.
 */
#include "scenes/grid.h"
#include "scenes/horizon.h"
#include "scenes/medium_kind.h"

#include <math.h>

/* --- voxel grids, which have their own module ------------------------------------------------ */

static double grid_extinction_per_m(const struct neph_medium *medium, struct neph_vec3 point_m)
{
    return medium->extinction_per_m * neph_grid_density(medium->grid, point_m);
}

static double grid_optical_depth(const struct neph_medium *medium, struct neph_vec3 origin_m,
                                 struct neph_vec3 direction, double t0_m, double t1_m)
{
    return medium->extinction_per_m *
           neph_grid_integral_m(medium->grid, origin_m, direction, t0_m, t1_m);
}

static double grid_bound_per_m(const struct neph_medium *medium, const struct neph_bounds *box)
{
    return medium->extinction_per_m * neph_grid_maximum_in(medium->grid, box);
}

static void grid_drift(struct neph_medium *medium, struct neph_vec3 by_m)
{
    medium->grid->origin_m = neph_vec3_add(medium->grid->origin_m, by_m);
    medium->bounds = neph_bounds_moved(medium->bounds, by_m);
}

static struct neph_bounds grid_support(const struct neph_medium *medium)
{
    return neph_grid_support(medium->grid);
}

const struct neph_medium_kind_ops neph_medium_grid = {
    .name = "voxel grid",
    .closed_form = true,
    .extinction_per_m = grid_extinction_per_m,
    .optical_depth = grid_optical_depth,
    .bound_per_m = grid_bound_per_m,
    .drift = grid_drift,
    .support = grid_support,
};

/* --- Horizon clouds, which have theirs ------------------------------------------------------- */

static double horizon_extinction_per_m(const struct neph_medium *medium, struct neph_vec3 point_m)
{
    return medium->extinction_per_m * neph_horizon_density(medium->horizon, point_m, NULL);
}

static double horizon_optical_depth(const struct neph_medium *medium, struct neph_vec3 origin_m,
                                    struct neph_vec3 direction, double t0_m, double t1_m)
{
    return medium->extinction_per_m *
           neph_horizon_integral_m(medium->horizon, origin_m, direction, t0_m, t1_m, NULL);
}

static double horizon_bound_per_m(const struct neph_medium *medium, const struct neph_bounds *box)
{
    return medium->extinction_per_m * neph_horizon_bound(medium->horizon, box);
}

static void horizon_drift(struct neph_medium *medium, struct neph_vec3 by_m)
{
    struct neph_vec3 *wind_m = &medium->horizon->params.wind_m;
    *wind_m = neph_vec3_add(*wind_m, by_m);
}

static struct neph_bounds horizon_support(const struct neph_medium *medium)
{
    return neph_horizon_support(medium->horizon, &medium->bounds);
}

const struct neph_medium_kind_ops neph_medium_horizon = {
    .name = "Horizon cloud layer",
    .closed_form = false,
    .extinction_per_m = horizon_extinction_per_m,
    .optical_depth = horizon_optical_depth,
    .bound_per_m = horizon_bound_per_m,
    .drift = horizon_drift,
    .support = horizon_support,
};

static const struct neph_medium_kind_ops *const kinds[NEPH_MEDIUM_KIND_COUNT] = {
    [NEPH_MEDIUM_HOMOGENEOUS] = &neph_medium_fog,   [NEPH_MEDIUM_HEIGHT_FOG] = &neph_medium_fog,
    [NEPH_MEDIUM_GAUSSIAN] = &neph_medium_gaussian, [NEPH_MEDIUM_SHELL] = &neph_medium_shell,
    [NEPH_MEDIUM_GRID] = &neph_medium_grid,         [NEPH_MEDIUM_HORIZON] = &neph_medium_horizon,
};

/* --- bounds ---------------------------------------------------------------------------------- */

static bool bounds_contain(const struct neph_bounds *bounds, struct neph_vec3 p)
{
    return p.x >= bounds->min_m.x && p.x <= bounds->max_m.x && p.y >= bounds->min_m.y &&
           p.y <= bounds->max_m.y && p.z >= bounds->min_m.z && p.z <= bounds->max_m.z;
}

bool neph_clip_axis(double minimum, double maximum, double origin, double direction, double *t0,
                    double *t1)
{
    if (direction == 0.0)
        return origin >= minimum && origin <= maximum;
    double near = (minimum - origin) / direction;
    double far = (maximum - origin) / direction;
    if (direction < 0.0) {
        const double swap = near;
        near = far;
        far = swap;
    }
    *t0 = fmax(*t0, near);
    *t1 = fmin(*t1, far);
    return *t0 < *t1;
}

bool neph_bounds_clip(const struct neph_bounds *bounds, struct neph_vec3 origin_m,
                      struct neph_vec3 direction, double *t0_m, double *t1_m)
{
    return *t0_m < *t1_m &&
           neph_clip_axis(bounds->min_m.x, bounds->max_m.x, origin_m.x, direction.x, t0_m, t1_m) &&
           neph_clip_axis(bounds->min_m.y, bounds->max_m.y, origin_m.y, direction.y, t0_m, t1_m) &&
           neph_clip_axis(bounds->min_m.z, bounds->max_m.z, origin_m.z, direction.z, t0_m, t1_m);
}

struct neph_bounds neph_bounds_intersect(struct neph_bounds a, struct neph_bounds b)
{
    return (struct neph_bounds){
        {fmax(a.min_m.x, b.min_m.x), fmax(a.min_m.y, b.min_m.y), fmax(a.min_m.z, b.min_m.z)},
        {fmin(a.max_m.x, b.max_m.x), fmin(a.max_m.y, b.max_m.y), fmin(a.max_m.z, b.max_m.z)}};
}

/* The same, shrunk to a point where there is nothing. */
static struct neph_bounds narrow(struct neph_bounds a, struct neph_bounds b)
{
    struct neph_bounds box = neph_bounds_intersect(a, b);
    box.max_m.x = fmax(box.min_m.x, box.max_m.x);
    box.max_m.y = fmax(box.min_m.y, box.max_m.y);
    box.max_m.z = fmax(box.min_m.z, box.max_m.z);
    return box;
}

struct neph_vec3 neph_bounds_nearest(const struct neph_bounds *box, struct neph_vec3 point_m)
{
    return (struct neph_vec3){fmin(box->max_m.x, fmax(box->min_m.x, point_m.x)),
                              fmin(box->max_m.y, fmax(box->min_m.y, point_m.y)),
                              fmin(box->max_m.z, fmax(box->min_m.z, point_m.z))};
}

struct neph_bounds neph_bounds_moved(struct neph_bounds bounds, struct neph_vec3 by_m)
{
    return (struct neph_bounds){neph_vec3_add(bounds.min_m, by_m),
                                neph_vec3_add(bounds.max_m, by_m)};
}

struct neph_bounds neph_bounds_around(struct neph_vec3 center_m, double radius_m)
{
    const struct neph_vec3 reach_m = {radius_m, radius_m, radius_m};
    return (struct neph_bounds){neph_vec3_sub(center_m, reach_m), neph_vec3_add(center_m, reach_m)};
}

static bool is_empty(const struct neph_bounds *bounds)
{
    return !(bounds->min_m.x <= bounds->max_m.x && bounds->min_m.y <= bounds->max_m.y &&
             bounds->min_m.z <= bounds->max_m.z);
}

/* --- one medium ------------------------------------------------------------------------------ */

double neph_medium_extinction_per_m(const struct neph_medium *medium, struct neph_vec3 point_m)
{
    if (!bounds_contain(&medium->bounds, point_m))
        return 0.0;
    return kinds[medium->kind]->extinction_per_m(medium, point_m);
}

double neph_medium_optical_depth(const struct neph_medium *medium, struct neph_vec3 origin_m,
                                 struct neph_vec3 direction, double t0_m, double t1_m)
{
    if (!neph_bounds_clip(&medium->bounds, origin_m, direction, &t0_m, &t1_m))
        return 0.0;
    return kinds[medium->kind]->optical_depth(medium, origin_m, direction, t0_m, t1_m);
}

/* A bound is computed at one place and the extinction at another: this covers the roundings of
 * both. The largest are those of the argument of exp, up to 745 * 2^-53 each. */
static const double bound_margin = 1.0 + 1e-12;

double neph_medium_extinction_bound_per_m(const struct neph_medium *medium,
                                          const struct neph_bounds *box)
{
    const struct neph_bounds inside = neph_bounds_intersect(medium->bounds, *box);
    return is_empty(&inside) ? 0.0
                             : bound_margin * kinds[medium->kind]->bound_per_m(medium, &inside);
}

bool neph_medium_has_closed_form(const struct neph_medium *medium)
{
    return kinds[medium->kind]->closed_form;
}

bool neph_medium_drifts(const struct neph_medium *medium)
{
    return kinds[medium->kind]->drift != NULL;
}

void neph_medium_drift(struct neph_medium *medium, struct neph_vec3 by_m)
{
    if (neph_medium_drifts(medium))
        kinds[medium->kind]->drift(medium, by_m);
}

struct neph_bounds neph_medium_support(const struct neph_medium *medium)
{
    return narrow(medium->bounds, kinds[medium->kind]->support(medium));
}

struct neph_bounds neph_medium_container(const struct neph_scene *scene,
                                         const struct neph_medium *medium, double *cut_error)
{
    const struct neph_medium_kind_ops *kind = kinds[medium->kind];
    *cut_error = 0.0;
    if (!kind->container)
        return neph_medium_support(medium);
    double error;
    const struct neph_bounds box = kind->container(scene, medium, &error);
    if (bounds_contain(&box, medium->bounds.min_m) && bounds_contain(&box, medium->bounds.max_m))
        return medium->bounds;
    *cut_error = fmin(1.0, error);
    return narrow(medium->bounds, box);
}

bool neph_medium_is_coloured(const struct neph_medium *medium)
{
    const struct neph_rgb color = medium->extinction_color;
    return color.r != color.g || color.g != color.b;
}

const char *neph_medium_kind_name(enum neph_medium_kind kind)
{
    return kind == NEPH_MEDIUM_HOMOGENEOUS ? "homogeneous medium" : kinds[kind]->name;
}

/* --- all media of a scene -------------------------------------------------------------------- */

struct neph_rgb neph_scene_optical_depth(const struct neph_scene *scene, struct neph_vec3 origin_m,
                                         struct neph_vec3 direction, double t0_m, double t1_m)
{
    struct neph_rgb sum = {0, 0, 0};
    for (int i = 0; i < scene->medium_count; i++) {
        const struct neph_medium *medium = &scene->media[i];
        const double optical_depth = neph_medium_optical_depth(medium, origin_m, direction, t0_m,
                                                               t1_m);
        if (optical_depth > 0.0) /* 0 * inf: a channel that is not attenuated stays so */
            sum = neph_rgb_add(sum, neph_rgb_attenuation(medium->extinction_color, optical_depth));
    }
    return sum;
}

/* --- phase functions ------------------------------------------------------------------------- */

static double henyey_greenstein_per_sr(double g, double cosine)
{
    /* 1 + g^2 - 2 g c without its cancellation at the peak, for either sign of g. */
    const double base = g >= 0.0 ? (1.0 - g) * (1.0 - g) + 2.0 * g * (1.0 - cosine)
                                 : (1.0 + g) * (1.0 + g) - 2.0 * g * (1.0 + cosine);
    return (1.0 - g) * (1.0 + g) / (4.0 * M_PI * base * sqrt(base));
}

double neph_phase_per_sr(const struct neph_phase *phase, double cosine)
{
    switch (phase->kind) {
    case NEPH_PHASE_HENYEY_GREENSTEIN:
        return henyey_greenstein_per_sr(phase->g, fmin(1.0, fmax(-1.0, cosine)));
    case NEPH_PHASE_RAYLEIGH:
        return 3.0 / (16.0 * M_PI) * (1.0 + cosine * cosine);
    case NEPH_PHASE_ISOTROPIC:
        break;
    }
    return 1.0 / (4.0 * M_PI);
}
