/* SPDX-License-Identifier: MIT
 *
 * Diffused light: multiple scattering by P1 diffusion of the similar medium on a coarse grid on the
 * device. The equations are in shaders/diffusion.glsl; diffused_light.glsl applies the result in
 * the ray marcher. The grid covers the bounds of all bounded media. If there are none, it is a
 * column of the fogs, with cells along one axis only. Multigrid cycles solve for the fluence,
 * starting from the previous frame, so that a static scene needs no further cycles once it has
 * converged.
 *
 * Energy of the sunlight is conserved (absorbed or lost at the boundary) up to the residual of the
 * cycles. P1 is an approximation, best in optically thick media and worst in thin ones (numbers in
 * docs/light.md).
 */
#ifndef NEPH_RENDERER_DIFFUSED_LIGHT_H
#define NEPH_RENDERER_DIFFUSED_LIGHT_H

#include "renderer/march_split.h"
#include "renderer/skip_cells.h"

enum { NEPH_DIFFUSED_LEVELS_MAX = 10 };

struct neph_diffused_light {
    struct neph_vulkan *vulkan; /* borrowed */
    struct neph_march_params params;
    bool is_shown;  /* rendered by the march; else it only estimates unfinished paths of traced
                       light */
    bool is_column; /* a column of fogs, infinite along x and z */
    struct neph_gpu_diffusion_level levels[NEPH_DIFFUSED_LEVELS_MAX];
    int level_count;          /* 0: no grid */
    struct neph_bounds box;   /* bounds of the grid */
    struct neph_buffer cells; /* of all levels */
    struct neph_buffer field; /* at binding 8 of a march */
    struct neph_march_split cut;
    bool is_filled;
    struct neph_sun sun;                              /* sun of the last filling */
    struct neph_gpu_medium media[NEPH_GPU_MEDIA_MAX]; /* in world space */
    struct neph_solid *solids;                        /* owned */
    int solid_count;
    int settled;   /* cycles since the last filling or reset of the fluence */
    bool is_alone; /* the fluence was computed from zero, for a frame without a sequence */
};

/* Create the grid for a march with these parameters. Creates nothing unless the lighting is
 * NEPH_MARCH_DIFFUSED, or NEPH_MARCH_TRACED with .looks_ahead, which uses the media's first channel
 * without the similarity transform. Zero-initialise `light`; free with _destroy, also after an
 * error. NEPH_ERR_UNSUPPORTED: a medium that is not a fog has no finite bounds, or one cell needs
 * more points than a dispatch may have. */
enum neph_status
neph_diffused_light_create(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                           const struct neph_gpu_scene *gpu, const struct neph_march_params *params,
                           struct neph_diffused_light *light, struct neph_diag *diag);

/* A zero-initialised struct is fine. */
void neph_diffused_light_destroy(struct neph_diffused_light *light);

/* Place the grid for a frame and submit the frame's work: a filling if sun, media or solids have
 * changed, then the cycles of one frame. `bound` has the bindings of a march of the frame
 * (march_scene.h). A frame that `continues` a sequence starts from the fluence of the frame before,
 * others from zero. `will_change`: the sunlight is not final yet (sun_cache.h), so the next frame
 * fills again. `*gpu_s` receives the device time when the frame is collected and must stay valid
 * until then. NEPH_ERR_INTERRUPTED: neph_interrupted() between two dispatches. */
enum neph_status neph_diffused_light_solve(struct neph_diffused_light *light,
                                           const struct neph_scene *scene, double frame,
                                           const struct neph_gpu_scene *gpu,
                                           const struct neph_dispatch *bound, bool continues,
                                           bool will_change, double *gpu_s, struct neph_diag *diag);

/* Place the grid for a frame of the scene without changing its contents. */
void neph_diffused_light_place(struct neph_diffused_light *light, const struct neph_scene *scene,
                               double frame, const struct neph_gpu_scene *gpu);

#endif
