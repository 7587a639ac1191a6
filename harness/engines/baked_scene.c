/* SPDX-License-Identifier: MIT */
#include "harness/engines/baked_scene.h"

#include "scenes/media.h"
#include "scenes/solids.h"

#include <math.h>

static const double rms_max = 0.5;

static enum neph_status bake_medium(const struct neph_scene *scene, int index, int resolution,
                                    struct neph_baked_scene *baked, struct neph_diag *diag)
{
    const struct neph_medium *medium = &scene->media[index];
    struct neph_bake *bake = &baked->bakes[baked->bake_count];
    double cut_error;
    const struct neph_bounds box = neph_medium_container(scene, medium, &cut_error);
    enum neph_status status = neph_medium_bake(
        medium, &box, neph_medium_is_whole_grid(medium) ? 0 : resolution, bake, diag);
    if (status)
        return status;
    baked->bake_count++;
    baked->cut_error += cut_error;
    baked->scene.media[baked->scene.medium_count++] = neph_medium_from_bake(medium, bake);
    if (bake->error.extinction_rms_relative <= rms_max)
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_UNSUPPORTED,
              "medium %d: a %s on a grid of %d x %d x %d nodes, which would miss %.0f %% of its "
              "extinction (rms)",
              index + 1, neph_medium_facts(medium->kind)->name, bake->grid->size[0],
              bake->grid->size[1], bake->grid->size[2],
              100.0 * bake->error.extinction_rms_relative);
    neph_hint(diag, "raise bake_resolution, or give the medium narrower bounds");
    return NEPH_ERR_UNSUPPORTED;
}

enum neph_status neph_baked_scene_make(const struct neph_scene *scene, int resolution,
                                       struct neph_baked_scene *baked, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    struct neph_baked_scene made = {.scene = *scene};
    made.scene.medium_count = 0;
    for (int i = 0; i < scene->medium_count && !status; i++) {
        const struct neph_medium *medium = &scene->media[i];
        const struct neph_bounds support = neph_medium_support(medium);
        if (neph_medium_is_fog(medium))
            made.scene.media[made.scene.medium_count++] = *medium;
        else if (neph_medium_extinction_bound_per_m(medium, &support) > 0.0)
            status = bake_medium(scene, i, resolution ? resolution : scene->bake_resolution, &made,
                                 diag);
    }
    if (status)
        neph_baked_scene_finish(&made);
    else
        *baked = made;
    return status;
}

void neph_baked_scene_finish(struct neph_baked_scene *baked)
{
    for (int i = 0; i < baked->bake_count; i++)
        neph_bake_finish(&baked->bakes[i]);
    baked->bake_count = 0;
}

double neph_fog_layer_per_m(const struct neph_fog_layer *layer, double y_m)
{
    if (layer->extinction_per_m <= 0.0)
        return 0.0; /* avoids 0 * inf */
    return layer->extinction_per_m * exp(-layer->falloff_per_m * (y_m - layer->height_m));
}

bool neph_is_container_turned(const struct neph_medium *medium)
{
    return neph_medium_is_fog(medium) && neph_is_turned(&medium->turn);
}

struct neph_bounds neph_own_container(const struct neph_medium *medium,
                                      const struct neph_bounds *container)
{
    const struct neph_bounds *across[3] = {&medium->box, &medium->box, &medium->box};
    if (!neph_is_container_turned(medium))
        return *container;
    across[medium->turn.axis] = container;
    return (struct neph_bounds){{across[0]->min_m.x, across[1]->min_m.y, across[2]->min_m.z},
                                {across[0]->max_m.x, across[1]->max_m.y, across[2]->max_m.z}};
}

double neph_densest_per_m(const struct neph_medium *medium, const struct neph_bounds *bounds)
{
    if (!neph_medium_is_fog(medium))
        return neph_medium_extinction_bound_per_m(medium, bounds);
    double sum_per_m = 0.0;
    for (int i = 0; i < medium->layer_count; i++)
        sum_per_m += neph_fog_layer_per_m(&medium->layers[i], bounds->min_m.y);
    return sum_per_m;
}

bool neph_scene_needs_voxels(const struct neph_scene *scene)
{
    bool needs = false;
    for (int i = 0; i < scene->medium_count; i++) {
        const struct neph_medium *medium = &scene->media[i];
        needs |= !neph_medium_is_fog(medium) && medium->extinction_per_m > 0.0;
    }
    return needs;
}
