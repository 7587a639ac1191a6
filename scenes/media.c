/* SPDX-License-Identifier: MIT
 *
 * The table of kinds of media, and the functions that do not depend on the kind.
 */
#include "scenes/media.h"

#include "scenes/grid.h"

#include "scenes/emission.h"
#include "scenes/medium_bounds.h"
#include "scenes/medium_kind.h"

#include <math.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_MEDIUM_KIND_COUNT == 8, "a new kind");

static const struct neph_medium_row *const rows[NEPH_MEDIUM_KIND_COUNT] = {
    [NEPH_MEDIUM_HOMOGENEOUS] = &neph_medium_homogeneous,
    [NEPH_MEDIUM_HEIGHT_FOG] = &neph_medium_height_fog,
    [NEPH_MEDIUM_GAUSSIAN] = &neph_medium_gaussian,
    [NEPH_MEDIUM_SHELL] = &neph_medium_shell,
    [NEPH_MEDIUM_GRID] = &neph_medium_grid,
    [NEPH_MEDIUM_HORIZON] = &neph_medium_horizon,
    [NEPH_MEDIUM_PLUME] = &neph_medium_plume,
    [NEPH_MEDIUM_TENT] = &neph_medium_tent,
};

const struct neph_medium_row *neph_medium_row(enum neph_medium_kind kind)
{
    return rows[kind];
}

const struct neph_medium_facts *neph_medium_facts(enum neph_medium_kind kind)
{
    return &rows[kind]->facts;
}

bool neph_medium_is_fog(const struct neph_medium *medium)
{
    return rows[medium->kind]->facts.is_fog;
}

bool neph_medium_has_closed_form(const struct neph_medium *medium)
{
    return rows[medium->kind]->facts.has_closed_form;
}

/* --- one medium ------------------------------------------------------------------------------ */

double neph_medium_extinction_per_m(const struct neph_medium *medium, struct neph_vec3 point_m)
{
    if (!neph_medium_contains(medium, point_m))
        return 0.0;
    return rows[medium->kind]->extinction_per_m(medium, point_m);
}

double neph_medium_optical_depth(const struct neph_medium *medium, struct neph_vec3 origin_m,
                                 struct neph_vec3 direction, double t0_m, double t1_m)
{
    if (!neph_medium_clip(medium, origin_m, direction, &t0_m, &t1_m))
        return 0.0;
    return rows[medium->kind]->optical_depth(medium, origin_m, direction, t0_m, t1_m);
}

/* A bound is computed at one place and the extinction at another: this covers the rounding of both.
 * The largest errors come from the argument of exp, up to 745 * 2^-53 each. */
static const double bound_margin = 1.0 + 1e-12;

double neph_medium_extinction_bound_per_m(const struct neph_medium *medium,
                                          const struct neph_bounds *box)
{
    const struct neph_bounds inside = neph_bounds_intersect(medium->bounds, *box);
    return neph_bounds_are_empty(&inside)
               ? 0.0
               : bound_margin * rows[medium->kind]->bound_per_m(medium, &inside);
}

bool neph_medium_drifts(const struct neph_medium *medium)
{
    return rows[medium->kind]->drift != NULL;
}

void neph_medium_drift(struct neph_medium *medium, struct neph_vec3 by_m)
{
    if (neph_medium_drifts(medium))
        rows[medium->kind]->drift(medium, by_m);
}

bool neph_medium_can_shift(const struct neph_medium *medium)
{
    return medium->kind != NEPH_MEDIUM_HORIZON;
}

void neph_medium_shift(struct neph_medium *medium, struct neph_vec3 by_m)
{
    if (neph_medium_drifts(medium)) {
        neph_medium_drift(medium, by_m);
        return;
    }
    neph_medium_move_bounds(medium, by_m);
    medium->shell.center_m = neph_vec3_add(medium->shell.center_m, by_m);
    medium->tent.center_m = neph_vec3_add(medium->tent.center_m, by_m);
    for (int i = 0; i < medium->layer_count; i++)
        medium->layers[i].height_m += by_m.y;
}

void neph_medium_finish(struct neph_medium *medium)
{
    if (rows[medium->kind]->destroy)
        rows[medium->kind]->destroy(medium);
}

size_t neph_medium_storage_bytes(const struct neph_medium *medium)
{
    return rows[medium->kind]->room_size;
}

void neph_medium_borrow(struct neph_medium *medium, void *room)
{
    if (rows[medium->kind]->borrow)
        rows[medium->kind]->borrow(medium, room);
}

void neph_medium_cut_scales(struct neph_cuts *cuts, const struct neph_medium *medium)
{
    if (rows[medium->kind]->cut_scales)
        rows[medium->kind]->cut_scales(cuts, medium);
}

void neph_medium_cut_kinks(struct neph_cuts *cuts, const struct neph_medium *medium)
{
    if (rows[medium->kind]->cut_kinks)
        rows[medium->kind]->cut_kinks(cuts, medium);
}

struct neph_bounds neph_medium_support(const struct neph_medium *medium)
{
    return neph_bounds_narrow(medium->bounds, rows[medium->kind]->support(medium));
}

struct neph_bounds neph_medium_container(const struct neph_scene *scene,
                                         const struct neph_medium *medium, double *cut_error)
{
    const struct neph_medium_row *row = rows[medium->kind];
    *cut_error = 0.0;
    if (!row->container)
        return neph_medium_support(medium);
    double error;
    const struct neph_bounds box = row->container(scene, medium, &error);
    if (neph_bounds_contain(&box, medium->bounds.min_m) &&
        neph_bounds_contain(&box, medium->bounds.max_m))
        return medium->bounds;
    *cut_error = fmin(1.0, error);
    return neph_bounds_narrow(medium->bounds, box);
}

bool neph_medium_is_coloured(const struct neph_medium *medium)
{
    const struct neph_rgb color = medium->extinction_color;
    return color.r != color.g || color.g != color.b;
}

const char neph_endless_reason[] =
    "a grid that repeats without end (repeat 0): bounds, or a number of copies, end it";

bool neph_medium_is_endless(const struct neph_medium *medium)
{
    if (medium->kind != NEPH_MEDIUM_GRID)
        return false;
    const struct neph_bounds support = neph_medium_support(medium);
    const struct neph_vec3 side_m = neph_vec3_sub(support.max_m, support.min_m);
    const double far_m = NEPH_GRID_ENDLESS_M;
    const bool *endless = medium->grid->is_endless;
    return (endless[0] && side_m.x >= far_m) || (endless[1] && side_m.y >= far_m) ||
           (endless[2] && side_m.z >= far_m);
}

bool neph_scene_is_endless(const struct neph_scene *scene)
{
    for (int m = 0; m < scene->medium_count; m++)
        if (neph_medium_is_endless(&scene->media[m]))
            return true;
    return false;
}

static int count_grids(const struct neph_scene *scene, bool is_constant)
{
    int count = 0;
    for (int m = 0; m < scene->medium_count; m++)
        count += scene->media[m].kind == NEPH_MEDIUM_GRID &&
                 scene->media[m].grid->is_constant == is_constant;
    return count;
}

bool neph_scene_has_constant_cells(const struct neph_scene *scene)
{
    return count_grids(scene, true) > 0;
}

bool neph_scene_mixes_cells(const struct neph_scene *scene)
{
    return neph_scene_has_constant_cells(scene) && count_grids(scene, false) > 0;
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
        if (optical_depth > 0.0) /* avoids 0 * inf in a channel without extinction */
            sum = neph_rgb_add(sum, neph_rgb_attenuation(medium->extinction_color, optical_depth));
    }
    return sum;
}
