/* SPDX-License-Identifier: MIT */
#include "scenes/grid.h"
#include "renderer/media/kind.h"
#include "renderer/relative.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* With the layer of zeros that shaders/grid.glsl expects. */
static void pack(const struct neph_medium *medium, struct neph_vec3 camera_m, uint32_t first,
                 struct neph_gpu_medium *gpu)
{
    const struct neph_grid *grid = medium->grid;
    gpu->shape.grid = (struct neph_gpu_grid){.first = first,
                                             .nodes_per_m = {(float)(1.0 / grid->spacing_m.x),
                                                             (float)(1.0 / grid->spacing_m.y),
                                                             (float)(1.0 / grid->spacing_m.z)}};
    neph_relative_position(gpu->shape.grid.origin_m, neph_vec3_sub(grid->origin_m, grid->spacing_m),
                           camera_m);
    for (int axis = 0; axis < 3; axis++)
        gpu->shape.grid.size[axis] = (uint32_t)grid->size[axis] + 2;
}

static size_t data_count(const struct neph_medium *medium)
{
    const struct neph_grid *grid = medium->grid;
    return (size_t)(grid->size[0] + 2) * (size_t)(grid->size[1] + 2) * (size_t)(grid->size[2] + 2);
}

/* One slab of the padded lattice after the other: no second copy of the grid in memory. */
static enum neph_status upload(const struct neph_vulkan *vulkan, const struct neph_medium *medium,
                               uint32_t first, const struct neph_buffer *buffer,
                               struct neph_diag *diag)
{
    const struct neph_grid *grid = medium->grid;
    const float value_max = (float)(NEPH_GPU_EXTINCTION_MAX / fmax(1.0, medium->extinction_per_m));
    const size_t nx = (size_t)grid->size[0], ny = (size_t)grid->size[1], nz = (size_t)grid->size[2];
    const size_t slab_count = (nx + 2) * (ny + 2);
    float *slab = malloc(slab_count * sizeof(*slab));
    enum neph_status status = slab ? NEPH_OK : neph_fail_memory(diag);
    for (size_t z = 0; z < nz + 2 && !status; z++) {
        memset(slab, 0, slab_count * sizeof(*slab));
        for (size_t y = 0; z > 0 && z <= nz && y < ny; y++)
            for (size_t x = 0; x < nx; x++)
                slab[(y + 1) * (nx + 2) + 1 + x] = fminf(grid->values[((z - 1) * ny + y) * nx + x],
                                                         value_max);
        status = neph_buffer_upload(vulkan, buffer, (first + z * slab_count) * sizeof(*slab), slab,
                                    slab_count * sizeof(*slab), diag);
    }
    free(slab);
    return status;
}

static uint64_t integral_turns(const struct neph_medium *medium)
{
    const int *size = medium->grid->size;
    return (uint64_t)(size[0] + size[1] + size[2]) + 12;
}

static double largest_per_m(const struct neph_medium *medium)
{
    return medium->extinction_per_m * (double)medium->grid->maximum;
}

/* Where density rises from 0 in proportion to a way, as far as one cell, optical depth 1 is reached
 * at sqrt(2 cell / extinction). */
static double skin_per_m(const struct neph_medium *medium, double largest_per_m)
{
    const struct neph_vec3 spacing_m = medium->grid->spacing_m;
    return sqrt(2.0 * largest_per_m / fmin(spacing_m.x, fmin(spacing_m.y, spacing_m.z)));
}

const struct neph_gpu_kind neph_gpu_grid = {
    .pack = pack,
    .data = NEPH_GPU_VALUES,
    .data_count = data_count,
    .upload = upload,
    .integral_turns = integral_turns,
    .largest_per_m = largest_per_m,
    .skin_per_m = skin_per_m,
};
