/* SPDX-License-Identifier: MIT
 *
 * The columns of a scene for its fluxes.
 */
#include "truth/flux_domain.h"

#include "scenes/bounds.h"
#include "scenes/grid.h"
#include "scenes/media.h"
#include "scenes/solids.h"

#include <math.h>
#include <stdlib.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_MEDIUM_KIND_COUNT == 8, "a new kind");
_Static_assert(NEPH_SOLID_KIND_COUNT == 3, "a new kind");

/* Two periods or levels within this part of each other are equal. */
static const double rounding = 1e-9;

/* Between the bottom level and a ground at that level, as a part of the height. */
static const double hair = 1e-9;

struct extent {
    double low_m, high_m;
    bool is_open;
};

static struct extent find_extent(const struct neph_bounds *bounds, int axis)
{
    const double low[3] = {bounds->min_m.x, bounds->min_m.y, bounds->min_m.z};
    const double high[3] = {bounds->max_m.x, bounds->max_m.y, bounds->max_m.z};
    return (struct extent){low[axis], high[axis], true};
}

static bool is_endless_along(const struct neph_medium *medium, int axis)
{
    return medium->kind == NEPH_MEDIUM_GRID && medium->grid->is_endless[axis];
}

/* One period of an endless grid, from the lower side of its first cell. */
static struct extent find_period(const struct neph_grid *grid, int axis)
{
    const double origin[3] = {grid->origin_m.x, grid->origin_m.y, grid->origin_m.z};
    const double spacing[3] = {grid->spacing_m.x, grid->spacing_m.y, grid->spacing_m.z};
    const double low_m = origin[axis] - 0.5 * spacing[axis];
    return (struct extent){low_m, low_m + grid->size[axis] * spacing[axis], false};
}

static bool is_same_period(struct extent a, struct extent b)
{
    const double side_m = a.high_m - a.low_m;
    return fabs(side_m - (b.high_m - b.low_m)) <= rounding * side_m;
}

/* The extent of the domain along x (axis 0) or z (axis 2). */
static enum neph_status find_side(const struct neph_scene *scene, int axis, struct extent *side,
                                  struct neph_diag *diag)
{
    const char *name = axis == 0 ? "x" : "z";
    struct extent found = {INFINITY, -INFINITY, true};
    int endless = 0, ends = 0;
    for (int m = 0; m < scene->medium_count; m++) {
        const struct neph_bounds support = neph_medium_support(&scene->media[m]);
        struct extent own = find_extent(&support, axis);
        if (is_endless_along(&scene->media[m], axis)) {
            own = find_period(scene->media[m].grid, axis);
            if (endless++ > 0 && !is_same_period(found, own))
                return neph_fail(diag, NEPH_ERR_INPUT,
                                 "grids repeat along %s after %g m and after %g m: fluxes need one "
                                 "period",
                                 name, found.high_m - found.low_m, own.high_m - own.low_m);
            found = endless == 1 ? own : found;
        } else if (isfinite(own.low_m) && isfinite(own.high_m)) {
            ends++;
            if (endless == 0)
                found = (struct extent){fmin(found.low_m, own.low_m),
                                        fmax(found.high_m, own.high_m), true};
        }
    }
    if (endless > 0 && ends > 0) {
        neph_fail(diag, NEPH_ERR_INPUT,
                  "along %s a grid repeats without end, and another medium ends: it is in one "
                  "period only",
                  name);
        neph_hint(diag, "repeat both (repeat 0), or end both by bounds");
        return NEPH_ERR_INPUT;
    }
    const bool is_even = endless == 0 && ends == 0;
    *side = is_even ? (struct extent){-0.5, 0.5, false} : found;
    return NEPH_OK;
}

/* The top of the boxes that cover the domain from below, its ground: media inside it do not count.
 * -inf: none. */
static double find_ground_m(const struct neph_scene *scene, struct extent x, struct extent z)
{
    double top_m = -INFINITY;
    for (int i = 0; i < scene->solid_count; i++) {
        const struct neph_solid *solid = &scene->solids[i];
        const struct neph_bounds *box = &solid->box;
        if (solid->kind == NEPH_SOLID_BOX && !neph_is_turned(&solid->turn) &&
            box->min_m.x <= x.low_m && box->max_m.x >= x.high_m && box->min_m.z <= z.low_m &&
            box->max_m.z >= z.high_m)
            top_m = fmax(top_m, box->max_m.y);
    }
    return top_m;
}

/* The levels, given or of the media above the ground. */
static enum neph_status find_levels(const struct neph_scene *scene,
                                    const struct neph_fluxes_params *params, double ground_m,
                                    struct extent *levels, struct neph_diag *diag)
{
    struct extent media = {INFINITY, -INFINITY, true};
    for (int m = 0; m < scene->medium_count; m++) {
        const struct neph_bounds support = neph_medium_support(&scene->media[m]);
        media.low_m = fmin(media.low_m, support.min_m.y);
        media.high_m = fmax(media.high_m, support.max_m.y);
    }
    if (ground_m < media.high_m)
        media.low_m = fmax(media.low_m, ground_m);
    if (!(isfinite(media.low_m) && isfinite(media.high_m))) {
        neph_fail(diag, NEPH_ERR_INPUT, "media without end along y have no top and bottom level");
        neph_hint(diag, "bounds of the medium end it");
        return NEPH_ERR_INPUT;
    }
    levels->low_m = isnan(params->bottom_m) ? media.low_m : params->bottom_m;
    levels->high_m = isnan(params->top_m) ? media.high_m : params->top_m;
    const double hair_m = rounding * (media.high_m - media.low_m);
    if (levels->low_m <= media.low_m + hair_m && levels->high_m >= media.high_m - hair_m &&
        levels->low_m < levels->high_m)
        return NEPH_OK;
    return neph_fail(diag, NEPH_ERR_INPUT,
                     "levels at %g m and %g m: the media are between %g m and %g m, above any "
                     "ground, and must be between the levels",
                     levels->low_m, levels->high_m, media.low_m, media.high_m);
}

/* Solids are a ground below the bottom level. */
static enum neph_status check_solids(const struct neph_scene *scene, struct extent levels,
                                     struct neph_diag *diag)
{
    const double hair_m = rounding * (levels.high_m - levels.low_m);
    for (int i = 0; i < scene->solid_count; i++) {
        const struct neph_bounds box = neph_solid_bounds(&scene->solids[i]);
        if (box.max_m.y > levels.low_m + hair_m) {
            neph_fail(diag, NEPH_ERR_INPUT,
                      "solid %d reaches up to %g m, above the bottom level of %g m", i + 1,
                      box.max_m.y, levels.low_m);
            neph_hint(diag, "fluxes have solids only as a ground below all media");
            return NEPH_ERR_INPUT;
        }
    }
    return NEPH_OK;
}

static enum neph_status check_params(const struct neph_fluxes_params *params,
                                     struct neph_diag *diag)
{
    if (params->columns_x < 1 || params->columns_x > NEPH_FLUX_COLUMNS_MAX ||
        params->columns_z < 1 || params->columns_z > NEPH_FLUX_COLUMNS_MAX)
        return neph_fail(diag, NEPH_ERR_USAGE, "%d x %d columns: must be 1..%d along each side",
                         params->columns_x, params->columns_z, NEPH_FLUX_COLUMNS_MAX);
    if (params->paths < NEPH_FLUX_PATHS_MIN || params->paths > NEPH_FLUX_PATHS_MAX)
        return neph_fail(diag, NEPH_ERR_USAGE, "%d paths of a column: must be %d..%d",
                         params->paths, NEPH_FLUX_PATHS_MIN, NEPH_FLUX_PATHS_MAX);
    return NEPH_OK;
}

enum neph_status neph_flux_domain_find(const struct neph_scene *scene,
                                       const struct neph_fluxes_params *params,
                                       struct neph_flux_domain *domain, struct neph_diag *diag)
{
    struct extent x, levels, z;
    enum neph_status status = check_params(params, diag);
    if (!status && !(scene->sun.present && scene->sun.direction.y > 0.0)) {
        status = neph_fail(diag, NEPH_ERR_INPUT,
                           "fluxes are parts of the sunlight on a level plane: scene %s has no sun "
                           "above the horizon",
                           scene->name);
        neph_hint(diag, "sun: {direction: [0, 1, 0], irradiance_w_per_m2: [1, 1, 1]}");
    }
    if (!status && scene->medium_count == 0)
        status = neph_fail(diag, NEPH_ERR_INPUT, "scene %s has no medium", scene->name);
    if (!status)
        status = find_side(scene, 0, &x, diag);
    if (!status)
        status = find_side(scene, 2, &z, diag);
    if (!status)
        status = find_levels(scene, params, find_ground_m(scene, x, z), &levels, diag);
    if (!status)
        status = check_solids(scene, levels, diag);
    if (!status)
        *domain = (struct neph_flux_domain){
            {{x.low_m, levels.low_m, z.low_m}, {x.high_m, levels.high_m, z.high_m}},
            params->columns_x,
            params->columns_z,
            x.is_open,
            z.is_open};
    return status;
}

struct neph_scene neph_flux_scene(const struct neph_scene *scene)
{
    struct neph_scene lit = *scene;
    lit.sun.irradiance_w_per_m2 = (struct neph_rgb){1.0, 1.0, 1.0};
    lit.background_w_per_m2_sr = (struct neph_rgb){0.0, 0.0, 0.0};
    lit.environment_light = false;
    lit.light_count = 0;
    lit.scattering = NEPH_SCATTERING_MULTIPLE;
    for (int m = 0; m < lit.medium_count; m++)
        lit.media[m].emission_w_per_m2_sr = (struct neph_rgb){0.0, 0.0, 0.0};
    return lit;
}

double neph_flux_bottom_m(const struct neph_flux_domain *domain)
{
    return domain->box.min_m.y + hair * (domain->box.max_m.y - domain->box.min_m.y);
}
