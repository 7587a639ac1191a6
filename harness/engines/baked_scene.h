/* SPDX-License-Identifier: MIT
 *
 * A scene for engines that know fog and voxels, but none of our other media: those are baked.
 */
#ifndef NEPH_HARNESS_ENGINES_BAKED_SCENE_H
#define NEPH_HARNESS_ENGINES_BAKED_SCENE_H

#include "harness/engines/engine.h"
#include "scenes/bake.h"

/* The option of such engines; 0: what the scene says. */
#define NEPH_OPTION_BAKE_RESOLUTION                                                                \
    {                                                                                              \
        .name = "bake_resolution", .kind = NEPH_OPTION_INTEGER, .default_value = 0, .minimum = 0,  \
        .maximum = NEPH_GRID_SIDE_MAX,                                                             \
        .help = "nodes along the longest side of media handed over as voxels (0: as the scene "    \
                "says; grids as they are)"                                                         \
    }

struct neph_baked_scene {
    struct neph_scene scene; /* a copy whose media are fogs and whole grids; the rest is borrowed */
    int bake_count;
    struct neph_bake bakes[NEPH_SCENE_MEDIA_MAX]; /* owned */
    double cut_error; /* bound on the error in transmittance of cutting media without an end */
};

/* Bake what must be; media of no extinction are left out. A `resolution` of 0 is the scene's.
 * NEPH_ERR_UNSUPPORTED, in words, when a medium does not fit on so coarse a grid: when the rms of
 * what is lost is more than half of the rms of its extinction. `scene` must outlive the result,
 * which neph_baked_scene_finish() ends. */
enum neph_status neph_baked_scene_make(const struct neph_scene *scene, int resolution,
                                       struct neph_baked_scene *baked, struct neph_diag *diag);

/* Extinction of a layer at a height, and of a medium where it is densest within bounds: of fog that
 * of their bottom. Both without the colour. */
double neph_fog_layer_per_m(const struct neph_fog_layer *layer, double y_m);
double neph_densest_per_m(const struct neph_medium *medium, const struct neph_bounds *bounds);

void neph_baked_scene_finish(struct neph_baked_scene *baked);

/* Whether an external renderer gets a medium of the scene as voxels. */
bool neph_scene_needs_voxels(const struct neph_scene *scene);

#endif
