/* SPDX-License-Identifier: MIT
 *
 * Bakes a scene for engines that support fog and voxels only: every other medium becomes voxels.
 */
#ifndef NEPH_HARNESS_ENGINES_BAKED_SCENE_H
#define NEPH_HARNESS_ENGINES_BAKED_SCENE_H

#include "harness/engines/engine.h"
#include "scenes/bake.h"

/* The common option of such engines; 0: the scene's own resolution. */
#define NEPH_OPTION_BAKE_RESOLUTION                                                                \
    {                                                                                              \
        .name = "bake_resolution", .kind = NEPH_OPTION_INTEGER, .default_value = 0, .minimum = 0,  \
        .maximum = NEPH_GRID_SIDE_MAX,                                                             \
        .help = "nodes along the longest side of media handed over as voxels (0: as the scene "    \
                "says; grids as they are)"                                                         \
    }

struct neph_baked_scene {
    struct neph_scene scene; /* a copy with fogs and voxel grids as its only media; other members
                              * are borrowed */
    int bake_count;
    struct neph_bake bakes[NEPH_SCENE_MEDIA_MAX]; /* owned */
    double cut_error; /* error bound, in transmittance, of cutting unbounded media */
};

/* Bake the media that need it; media without extinction are removed. `resolution` 0: the scene's
 * own. NEPH_ERR_UNSUPPORTED: the grid is too coarse for a medium (the rms of the baking error
 * exceeds half of the rms of the extinction). `scene` must outlive the result. End with
 * neph_baked_scene_finish(). */
enum neph_status neph_baked_scene_make(const struct neph_scene *scene, int resolution,
                                       struct neph_baked_scene *baked, struct neph_diag *diag);

/* Extinction of a layer at a height, and largest extinction of a medium within bounds (for fog: at
 * their bottom). Both exclude extinction_color. */
double neph_fog_layer_per_m(const struct neph_fog_layer *layer, double y_m);
double neph_densest_per_m(const struct neph_medium *medium, const struct neph_bounds *bounds);

/* Whether an engine has to turn the container of a medium: a fog in turned bounds. Then its box
 * before the turn about its middle, from the box around it, whose two faces across the axis an
 * engine may have moved; else that box. */
bool neph_is_container_turned(const struct neph_medium *medium);
struct neph_bounds neph_own_container(const struct neph_medium *medium,
                                      const struct neph_bounds *container);

void neph_baked_scene_finish(struct neph_baked_scene *baked);

/* Whether external renderers get any medium of the scene as voxels. */
bool neph_scene_needs_voxels(const struct neph_scene *scene);

#endif
