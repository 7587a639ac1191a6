/* SPDX-License-Identifier: MIT
 *
 * The device data of each kind of medium. A kind has one file here, one line of the table in
 * kind.c, and a GLSL file used by shaders/media.glsl. Private to renderer/.
 */
#ifndef NEPH_RENDERER_MEDIA_KIND_H
#define NEPH_RENDERER_MEDIA_KIND_H

#include "renderer/compute.h"
#include "scenes/scene.h"
#include "shaders/structs.h"

/* Optical depth that a march may omit, THIN of shaders/fog.glsl. */
#define NEPH_GPU_THIN 1e-7

/* Limit of extinction [1/m]: such a medium is opaque within any step, and times FAR_M the value is
 * still a float32. */
#define NEPH_GPU_EXTINCTION_MAX 1e20

/* Buffers with data that do not fit struct Medium, one medium after the other. */
enum neph_gpu_data {
    NEPH_GPU_NO_DATA,
    NEPH_GPU_VALUES, /* grid_values[] */
    NEPH_GPU_TEXELS, /* horizon_texels[], four channels each */
    NEPH_GPU_DATA_COUNT,
};

struct neph_gpu_kind {
    /* Fog layers, at most; 0: the medium is not a fog. */
    int layers_max;
    /* Write the fields specific to the kind; the common ones are already set. `first` is the index
     * of its data. */
    void (*pack)(const struct neph_medium *medium, struct neph_vec3 camera_m, uint32_t first,
                 struct neph_gpu_medium *gpu);
    enum neph_gpu_data data;
    size_t (*data_count)(const struct neph_medium *medium);
    enum neph_status (*upload)(const struct neph_vulkan *vulkan, const struct neph_medium *medium,
                               uint32_t first, const struct neph_buffer *buffer,
                               struct neph_diag *diag);
    /* As upload, each value paired with its successor, in a buffer twice as large. NULL: no kernel
     * reads the kind's values in pairs. */
    enum neph_status (*upload_pairs)(const struct neph_vulkan *vulkan,
                                     const struct neph_medium *medium, uint32_t first,
                                     const struct neph_buffer *buffer, struct neph_diag *diag);
    /* Upper bound of loop iterations (compute.h) of its line integral. NULL: no loops. */
    uint64_t (*integral_turns)(const struct neph_medium *medium);
    /* The largest extinction anywhere [1/m]. NULL: `extinction_per_m`. */
    double (*largest_per_m)(const struct neph_medium *medium);
    /* Extinction scale of the visible surface as seen from outside (see float32_range.h) [1/m], at
     * most the largest extinction. NULL: the largest extinction. */
    double (*surface_extinction_per_m)(const struct neph_medium *medium, double largest_per_m);
    /* Extinction times distance, and that extinction. NULL: surface_extinction_per_m times the
     * distance of the bounds. */
    double (*reach)(const struct neph_medium *medium, const struct neph_bounds *support,
                    struct neph_vec3 camera_m, double *extinction_per_m);
};

extern const struct neph_gpu_kind neph_gpu_homogeneous, neph_gpu_height_fog, neph_gpu_gaussian,
    neph_gpu_shell, neph_gpu_grid, neph_gpu_horizon, neph_gpu_plume, neph_gpu_tent;

/* NULL: the shaders do not support the kind. */
const struct neph_gpu_kind *neph_gpu_get_kind(const struct neph_medium *medium);

double neph_gpu_largest_per_m(const struct neph_medium *medium);

#endif
