/* SPDX-License-Identifier: MIT
 *
 * Traced light: multiple scattering by paths on the device that start on the rays of a coarse grid
 * of texels over the frame (method in shaders/traced_light.glsl). Each frame has a few rounds of
 * paths. Sums decay exponentially over the frames of a sequence and are reprojected; paths continue
 * from frame to frame.
 *
 * Sources of bias: the blur over a few texels, reprojection while anything moves, surfaces (not lit
 * by it), and the similarity transform where it is used (neph_light_paths.similar). In a static
 * scene it converges to the path tracer's result otherwise.
 */
#ifndef NEPH_RENDERER_TRACED_LIGHT_H
#define NEPH_RENDERER_TRACED_LIGHT_H

#include "renderer/march_split.h"

/* Camera, frame and wind of a view. */
struct neph_traced_light_view {
    struct neph_camera camera;
    struct neph_vec3 drift_m;
    float half_width; /* of the frame, as in struct neph_gpu_frame */
};

struct neph_traced_light {
    struct neph_vulkan *vulkan; /* borrowed */
    struct neph_march_params params;
    uint32_t events;              /* of a path in a round, upper limit */
    uint32_t size_px[2];          /* of the frame that the buffers belong to; 0: no buffers */
    struct neph_buffer paths;     /* unfinished paths */
    struct neph_buffer found;     /* results of each path in a round */
    struct neph_buffer texels[2]; /* sums of this round and of the one before */
    struct neph_buffer smoothed;  /* at binding 8 of a march, with or without tracing */
    uint32_t round;               /* rounds so far */
    bool has_past;
    struct neph_traced_light_view past;
};

/* Create the paths for a march with these parameters; none unless its lighting is
 * NEPH_MARCH_TRACED. Zero-initialise `light`; free with _destroy, also after an error.
 * NEPH_ERR_UNSUPPORTED: one loop iteration of a path exceeds the limits of a dispatch. */
enum neph_status neph_traced_light_create(struct neph_vulkan *vulkan,
                                          const struct neph_scene *scene,
                                          const struct neph_gpu_scene *gpu,
                                          const struct neph_march_params *params,
                                          struct neph_traced_light *light, struct neph_diag *diag);

/* A zero-initialised struct is fine. */
void neph_traced_light_destroy(struct neph_traced_light *light);

/* Submit the rounds of a frame of this size. `bound` has the bindings of a march of the frame
 * (march_scene.h). If the view `continues` a sequence, history and paths are kept; else they
 * restart. `*gpu_s` receives the device time when the frame is collected, and must stay valid until
 * then. NEPH_ERR_INTERRUPTED: neph_interrupted() between two rounds. */
enum neph_status neph_traced_light_trace(struct neph_traced_light *light,
                                         const struct neph_scene *scene,
                                         const struct neph_gpu_scene *gpu,
                                         const struct neph_dispatch *bound,
                                         const struct neph_traced_light_view *view, bool continues,
                                         double *gpu_s, struct neph_diag *diag);

#endif
