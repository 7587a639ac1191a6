/* SPDX-License-Identifier: MIT */
#include "renderer/media/grid.h"

#include "renderer/media/kind.h"
#include "renderer/relative.h"
#include "scenes/grid.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The largest density that is told: beyond it a medium is opaque anyway. */
static float value_max(const struct neph_medium *medium)
{
    return (float)(NEPH_GPU_EXTINCTION_MAX / fmax(1.0, medium->extinction_per_m));
}

float neph_gpu_grid_full(const struct neph_medium *medium)
{
    return fminf(medium->grid->maximum, value_max(medium));
}

void neph_gpu_grid_size(const struct neph_grid *grid, int size[3])
{
    for (int axis = 0; axis < 3; axis++)
        size[axis] = grid->size[axis] + 2;
}

/* The node of the grid that one of the padded lattice is; -1: a zero. Along an axis without end the
 * padding is what comes before and behind. */
static int node_of(const struct neph_grid *grid, int axis, int padded)
{
    const int node = padded - 1;
    if (grid->is_endless[axis])
        return neph_grid_wrapped(grid, axis, node);
    return node < grid->size[axis] ? node : -1;
}

void neph_gpu_grid_slab(const struct neph_medium *medium, int z, float *slab)
{
    const struct neph_grid *grid = medium->grid;
    const float most = value_max(medium);
    const size_t nx = (size_t)grid->size[0], ny = (size_t)grid->size[1];
    const int layer = node_of(grid, 2, z);
    for (int y = 0; y < grid->size[1] + 2; y++)
        for (int x = 0; x < grid->size[0] + 2; x++) {
            const int row = node_of(grid, 1, y), column = node_of(grid, 0, x);
            const bool is_zero = layer < 0 || row < 0 || column < 0;
            *slab++ =
                is_zero
                    ? 0.0f
                    : fminf(grid->values[((size_t)layer * ny + (size_t)row) * nx + (size_t)column],
                            most);
        }
}

/* Whole periods of a grid without end from its own origin to one that is near the camera: float32
 * has digits to count cells by there. */
static struct neph_vec3 periods_to(const struct neph_grid *grid, struct neph_vec3 camera_m)
{
    const double origin_m[3] = {grid->origin_m.x, grid->origin_m.y, grid->origin_m.z},
                 spacing_m[3] = {grid->spacing_m.x, grid->spacing_m.y, grid->spacing_m.z},
                 eye_m[3] = {camera_m.x, camera_m.y, camera_m.z};
    double way_m[3] = {0.0, 0.0, 0.0};
    for (int axis = 0; axis < 3; axis++) {
        const double period_m = spacing_m[axis] * grid->size[axis];
        if (grid->is_endless[axis])
            way_m[axis] = period_m * floor((eye_m[axis] - origin_m[axis]) / period_m);
    }
    return (struct neph_vec3){way_m[0], way_m[1], way_m[2]};
}

static void pack(const struct neph_medium *medium, struct neph_vec3 camera_m, uint32_t first,
                 struct neph_gpu_medium *gpu)
{
    const struct neph_grid *grid = medium->grid;
    const struct neph_vec3 origin_m = neph_vec3_add(grid->origin_m, periods_to(grid, camera_m));
    gpu->shape.grid = (struct neph_gpu_grid){.first = first,
                                             .full = neph_gpu_grid_full(medium),
                                             .nodes_per_m = {(float)(1.0 / grid->spacing_m.x),
                                                             (float)(1.0 / grid->spacing_m.y),
                                                             (float)(1.0 / grid->spacing_m.z)}};
    neph_relative_position(gpu->shape.grid.origin_m, neph_vec3_sub(origin_m, grid->spacing_m),
                           camera_m);
    int size[3];
    neph_gpu_grid_size(grid, size);
    for (int axis = 0; axis < 3; axis++) {
        gpu->shape.grid.size[axis] = (uint32_t)size[axis];
        gpu->shape.grid.texel[axis] = 1.0f / (float)size[axis];
        gpu->shape.grid.period[axis] = grid->is_endless[axis] ? (float)grid->size[axis] : 0.0f;
    }
}

static size_t data_count(const struct neph_medium *medium)
{
    int size[3];
    neph_gpu_grid_size(medium->grid, size);
    return (size_t)size[0] * (size_t)size[1] * (size_t)size[2];
}

/* One slab of the padded lattice after the other: no second copy of the grid in memory. */
static enum neph_status upload(const struct neph_vulkan *vulkan, const struct neph_medium *medium,
                               uint32_t first, const struct neph_buffer *buffer,
                               struct neph_diag *diag)
{
    int size[3];
    neph_gpu_grid_size(medium->grid, size);
    const size_t slab_count = (size_t)size[0] * (size_t)size[1];
    float *slab = malloc(slab_count * sizeof(*slab));
    enum neph_status status = slab ? NEPH_OK : neph_fail_memory(diag);
    for (int z = 0; z < size[2] && !status; z++) {
        neph_gpu_grid_slab(medium, z, slab);
        status = neph_buffer_upload(vulkan, buffer,
                                    (first + (size_t)z * slab_count) * sizeof(*slab), slab,
                                    slab_count * sizeof(*slab), diag);
    }
    free(slab);
    return status;
}

/* Each value and the one behind it in its row. */
static enum neph_status upload_pairs(const struct neph_vulkan *vulkan,
                                     const struct neph_medium *medium, uint32_t first,
                                     const struct neph_buffer *buffer, struct neph_diag *diag)
{
    int size[3];
    neph_gpu_grid_size(medium->grid, size);
    const size_t slab_count = (size_t)size[0] * (size_t)size[1];
    float *slab = calloc(slab_count + 1, sizeof(*slab));
    float *pairs = calloc(slab_count, 2 * sizeof(*pairs));
    enum neph_status status = slab && pairs ? NEPH_OK : neph_fail_memory(diag);
    for (int z = 0; z < size[2] && !status; z++) {
        neph_gpu_grid_slab(medium, z, slab);
        for (size_t i = 0; i < slab_count; i++)
            memcpy(&pairs[2 * i], &slab[i], 2 * sizeof(*slab));
        status = neph_buffer_upload(vulkan, buffer,
                                    2 * (first + (size_t)z * slab_count) * sizeof(*slab), pairs,
                                    2 * slab_count * sizeof(*slab), diag);
    }
    free(pairs);
    free(slab);
    return status;
}

static uint64_t integral_turns(const struct neph_medium *medium)
{
    const int *size = medium->grid->size;
    if (neph_grid_is_endless(medium->grid))
        return NEPH_GPU_ENDLESS_CELLS + 16;
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
    .upload_pairs = upload_pairs,
    .integral_turns = integral_turns,
    .largest_per_m = largest_per_m,
    .skin_per_m = skin_per_m,
};
