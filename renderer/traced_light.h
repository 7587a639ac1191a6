/* SPDX-License-Identifier: MIT
 *
 * Traced light: what media scatter more than once, by paths on the device that start on the rays of
 * a coarse grid of texels over the picture (shaders/traced_light.glsl says how, and what a march
 * makes of it). A picture has a few rounds of them; sums fade over pictures that follow each other,
 * looked up where each place was, and paths go on from picture to picture.
 *
 * Unbiased but for the blur over a few texels, for what lies between two pictures while anything
 * moves, for surfaces, which it does not light, and for similar media where it is told to take
 * them (neph_light_paths.similar). At rest it converges to the tracer's.
 */
#ifndef NEPH_RENDERER_TRACED_LIGHT_H
#define NEPH_RENDERER_TRACED_LIGHT_H

#include "renderer/march_cut.h"

/* The camera, its picture and the wind. */
struct neph_light_moment {
    struct neph_camera camera;
    struct neph_vec3 drift_m;
    float half_width; /* of the picture, as in struct neph_gpu_frame */
};

struct neph_traced_light {
    struct neph_vulkan *vulkan; /* borrowed */
    struct neph_march_params params;
    uint32_t events;              /* of a path in a round, at most */
    uint32_t size_px[2];          /* of the picture that the buffers are for; 0: there are none */
    struct neph_buffer paths;     /* under way */
    struct neph_buffer found;     /* by each in a round */
    struct neph_buffer texels[2]; /* sums, and those of the round before */
    struct neph_buffer smoothed;  /* at binding 8 of a march, whether it traces or not */
    uint32_t round;               /* ever */
    bool has_past;
    struct neph_light_moment past;
};

/* For a march with these parameters: without paths unless its lighting is NEPH_MARCH_TRACED.
 * Zero-initialise `light`; free with _destroy, also after an error. NEPH_ERR_UNSUPPORTED: a turn of
 * a path is more than a dispatch may hold. */
enum neph_status neph_traced_light_create(struct neph_vulkan *vulkan,
                                          const struct neph_scene *scene,
                                          const struct neph_gpu_scene *gpu,
                                          const struct neph_march_params *params,
                                          struct neph_traced_light *light, struct neph_diag *diag);

/* A zero one is fine. */
void neph_traced_light_destroy(struct neph_traced_light *light);

/* The rounds of a picture of this size, sent on their way; `*gpu_s` receives what the device takes
 * for them when they are home, and is borrowed until then. `bound` is what a march of the picture
 * is bound to (march_scene.h). The view `continues` the one before: else all starts anew.
 * NEPH_ERR_INTERRUPTED: neph_interrupted() between two rounds. */
enum neph_status neph_traced_light_trace(struct neph_traced_light *light,
                                         const struct neph_scene *scene,
                                         const struct neph_gpu_scene *gpu,
                                         const struct neph_dispatch *bound,
                                         const struct neph_light_moment *view, bool continues,
                                         double *gpu_s, struct neph_diag *diag);

#endif
