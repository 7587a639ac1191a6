/* SPDX-License-Identifier: MIT
 *
 * Diffused light: what media scatter more than once, by P1 diffusion of the similar medium through
 * a coarse lattice on the device (shaders/diffusion.glsl has the equations, diffused_light.glsl
 * what a march makes of them). The lattice lies over the bounds of all shapes; where there are none
 * it is the column of the fogs, cells along one axis alone. Multigrid cycles balance the cells,
 * from where the picture before has left them: at rest nothing is left to be done.
 *
 * What the sun gives is absorbed or leaves, to what the cycles leave of it. P1 itself is an
 * approximation, best in thick media and worst in thin ones (docs/light.md has numbers).
 */
#ifndef NEPH_RENDERER_DIFFUSED_LIGHT_H
#define NEPH_RENDERER_DIFFUSED_LIGHT_H

#include "renderer/march_cut.h"
#include "renderer/skip_cells.h"

enum { NEPH_DIFFUSED_LEVELS_MAX = 10 };

struct neph_diffused_light {
    struct neph_vulkan *vulkan; /* borrowed */
    struct neph_march_params params;
    bool is_shown;  /* by the march; else paths of traced light look ahead to it */
    bool is_column; /* of fogs: endless along x and z */
    struct neph_gpu_diffusion_level levels[NEPH_DIFFUSED_LEVELS_MAX];
    int level_count;          /* 0: there is no lattice */
    struct neph_bounds box;   /* that it covers */
    struct neph_buffer cells; /* of all levels */
    struct neph_buffer field; /* at binding 8 of a march */
    struct neph_march_cut cut;
    bool is_filled;
    struct neph_sun sun;                              /* what it was filled for */
    struct neph_gpu_medium media[NEPH_GPU_MEDIA_MAX]; /* in the world */
    struct neph_solid *solids;                        /* owned */
    int solid_count;
    int settled;   /* cycles since, or since the fluence was forgotten */
    bool is_alone; /* what is there began from none, for a picture by itself */
};

/* For a march with these parameters: nothing unless its lighting is NEPH_MARCH_DIFFUSED, or
 * NEPH_MARCH_TRACED that looks ahead, which takes media as they are in the first channel.
 * Zero-initialise `light`; free with _destroy, also after an error. NEPH_ERR_UNSUPPORTED: a shape
 * has no finite bounds, or the points of a cell are more than a dispatch may hold. */
enum neph_status
neph_diffused_light_create(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                           const struct neph_gpu_scene *gpu, const struct neph_march_params *params,
                           struct neph_diffused_light *light, struct neph_diag *diag);

/* A zero one is fine. */
void neph_diffused_light_destroy(struct neph_diffused_light *light);

/* Place the lattice in a frame of the scene, and send on their way its filling, if sun, media or
 * solids have changed, and the cycles of a picture; `*gpu_s` receives what the device takes for
 * them when they are home, and is borrowed until then. `bound` is what a march of the picture is
 * bound to (march_scene.h). A picture that `continues` the one before goes on from its fluence,
 * others from none. `will_change`: sunlight is not yet what it will be in the next picture
 * (sun_cache.h), and is then filled in anew. NEPH_ERR_INTERRUPTED: neph_interrupted() between two
 * dispatches. */
enum neph_status neph_diffused_light_solve(struct neph_diffused_light *light,
                                           const struct neph_scene *scene, double frame,
                                           const struct neph_gpu_scene *gpu,
                                           const struct neph_dispatch *bound, bool continues,
                                           bool will_change, double *gpu_s, struct neph_diag *diag);

/* Place the lattice in a frame of the scene, and leave what it holds as it is. */
void neph_diffused_light_place(struct neph_diffused_light *light, const struct neph_scene *scene,
                               double frame, const struct neph_gpu_scene *gpu);

#endif
