/* SPDX-License-Identifier: MIT
 *
 * Shadows of media and solids on the air between the camera and the scene: the sunlit fraction of
 * each froxel of the aerial table (shaders/sky_sunlit.comp), computed before that table is filled
 * (sky/tables.h). Uses the shadow map of clouds if there is one. Not for other folders.
 */
#ifndef NEPH_RENDERER_SKY_SHADE_H
#define NEPH_RENDERER_SKY_SHADE_H

#include "renderer/march_split.h"
#include "renderer/sky/tables.h"
#include "renderer/sun_fill.h"

struct neph_sky_shade {
    struct neph_vulkan *vulkan; /* borrowed; NULL: nothing casts shadows */
    struct neph_march_params params;
    struct neph_march_split cut; /* covers all froxels */
    struct neph_buffer counters;
    struct neph_buffer_ring counter_ring;
    struct neph_gpu_medium media[NEPH_GPU_MEDIA_MAX]; /* in world space, of the latest filling */
};

/* Create the shadows for the scene without its sky, `rest`; nothing when it has no other medium and
 * no solid except the ground. Zero-initialise `shade`; free with _destroy, also after an error. */
enum neph_status neph_sky_shade_create(struct neph_vulkan *vulkan, const struct neph_scene *rest,
                                       const struct neph_gpu_scene *gpu,
                                       const struct neph_march_params *params,
                                       struct neph_sky_shade *shade, struct neph_diag *diag);

/* A zero-initialised struct is fine. */
void neph_sky_shade_destroy(struct neph_sky_shade *shade);

/* Submit the computation, with the bindings `bound` of a march, and mark the table of air as stale;
 * nothing if all is unchanged. Counters go to `cost`, the device time is added to `*gpu_s`; both
 * are borrowed until the frame is collected. Errors as of neph_march_frame(). */
enum neph_status neph_sky_shade_fill(struct neph_sky_shade *shade, const struct neph_scene *rest,
                                     const struct neph_gpu_scene *gpu,
                                     const struct neph_dispatch *bound,
                                     struct neph_sky_tables *tables,
                                     struct neph_sun_fill_cost *cost, double *gpu_s,
                                     struct neph_diag *diag);

#endif
