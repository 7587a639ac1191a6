/* SPDX-License-Identifier: MIT
 *
 * Shadows of media and solids on the air of a planet before the camera: how much of the sun each
 * froxel of its table sees (shaders/sky_sunlit.comp), before that table is filled
 * (sky/tables.h). From the shadow map of clouds where there is one. Not for other folders.
 */
#ifndef NEPH_RENDERER_SKY_SHADE_H
#define NEPH_RENDERER_SKY_SHADE_H

#include "renderer/march_cut.h"
#include "renderer/sky/tables.h"
#include "renderer/sun_fill.h"

struct neph_sky_shade {
    struct neph_vulkan *vulkan; /* borrowed; NULL: nothing throws shadows */
    struct neph_march_params params;
    struct neph_march_cut cut; /* of all froxels */
    struct neph_buffer counters;
    struct neph_turns counter_turns;
    struct neph_gpu_medium media[NEPH_GPU_MEDIA_MAX]; /* in the world, of the newest filling */
};

/* For what is marched under a sky; nothing without another medium or solid than the ground.
 * Zero-initialise `shade`; free with _destroy, also after an error. */
enum neph_status neph_sky_shade_create(struct neph_vulkan *vulkan, const struct neph_scene *rest,
                                       const struct neph_gpu_scene *gpu,
                                       const struct neph_march_params *params,
                                       struct neph_sky_shade *shade, struct neph_diag *diag);

/* A zero one is fine. */
void neph_sky_shade_destroy(struct neph_sky_shade *shade);

/* Send it on its way, `bound` to what a march is bound to, and make the table of air stale; nothing
 * where all is as it was. Costs as of neph_sun_fill_run(). */
enum neph_status neph_sky_shade_fill(struct neph_sky_shade *shade, const struct neph_scene *rest,
                                     const struct neph_gpu_scene *gpu,
                                     const struct neph_dispatch *bound,
                                     struct neph_sky_tables *tables,
                                     struct neph_sun_fill_cost *cost, struct neph_diag *diag);

#endif
