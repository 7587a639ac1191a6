/* SPDX-License-Identifier: MIT
 *
 * What the device is told of a kind of medium: one file and one line of the table in kind.c each,
 * beside the kind's GLSL file, which shaders/media.glsl asks. Private to renderer/.
 */
#ifndef NEPH_RENDERER_MEDIA_KIND_H
#define NEPH_RENDERER_MEDIA_KIND_H

#include "renderer/compute.h"
#include "scenes/scene.h"
#include "shaders/structs.h"

/* What a march may leave out, THIN of shaders/fog.glsl. */
#define NEPH_GPU_THIN 1e-7

/* The extinction [1/m] beyond which a medium is opaque within any step, and which times FAR_M is
 * still a float32. */
#define NEPH_GPU_EXTINCTION_MAX 1e20

/* The buffers that hold more than fits struct Medium, of all media one after the other. */
enum neph_gpu_data {
    NEPH_GPU_NO_DATA,
    NEPH_GPU_VALUES, /* grid_values[] */
    NEPH_GPU_TEXELS, /* horizon_texels[], of four channels */
    NEPH_GPU_DATA_COUNT,
};

struct neph_gpu_kind {
    /* Layers of a fog, at most; 0: a shape. */
    int layers_max;
    /* Write what the kind has of its own; what all have is there already. `first` is the place of
     * its data. */
    void (*pack)(const struct neph_medium *medium, struct neph_vec3 camera_m, uint32_t first,
                 struct neph_gpu_medium *gpu);
    enum neph_gpu_data data;
    size_t (*data_count)(const struct neph_medium *medium);
    enum neph_status (*upload)(const struct neph_vulkan *vulkan, const struct neph_medium *medium,
                               uint32_t first, const struct neph_buffer *buffer,
                               struct neph_diag *diag);
    /* As upload, each value beside the one behind it, in a buffer twice as large. NULL: nobody
     * asks for its values in pairs. */
    enum neph_status (*upload_pairs)(const struct neph_vulkan *vulkan,
                                     const struct neph_medium *medium, uint32_t first,
                                     const struct neph_buffer *buffer, struct neph_diag *diag);
    /* Loop turns (compute.h) of its line integral, at most. NULL: it has no loops. */
    uint64_t (*integral_turns)(const struct neph_medium *medium);
    /* The largest extinction anywhere [1/m]. NULL: `extinction_per_m`. */
    double (*largest_per_m)(const struct neph_medium *medium);
    /* How fast a shape becomes opaque to one who looks at it from outside (see reach.h) [1/m], no
     * more than the largest extinction. NULL: as fast as that. */
    double (*skin_per_m)(const struct neph_medium *medium, double largest_per_m);
    /* Extinction times distance, and the extinction that counts. NULL: skin times distance. */
    double (*reach)(const struct neph_medium *medium, const struct neph_bounds *support,
                    struct neph_vec3 camera_m, double *extinction_per_m);
};

extern const struct neph_gpu_kind neph_gpu_homogeneous, neph_gpu_height_fog, neph_gpu_gaussian,
    neph_gpu_shell, neph_gpu_grid, neph_gpu_horizon, neph_gpu_plume, neph_gpu_tent;

/* NULL: the shaders do not know the kind. */
const struct neph_gpu_kind *neph_gpu_kind_of(const struct neph_medium *medium);

double neph_gpu_largest_per_m(const struct neph_medium *medium);

#endif
