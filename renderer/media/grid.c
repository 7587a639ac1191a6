/* SPDX-License-Identifier: MIT */
#include "renderer/media/grid.h"

#include "base/threads.h"
#include "renderer/media/kind.h"
#include "renderer/relative.h"
#include "scenes/grid.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Limit of densities on the device: a denser medium is opaque in any case. */
static float compute_density_limit(const struct neph_medium *medium)
{
    return (float)(NEPH_GPU_EXTINCTION_MAX / fmax(1.0, medium->extinction_per_m));
}

float neph_gpu_grid_maximum(const struct neph_medium *medium)
{
    return fminf(medium->grid->maximum, compute_density_limit(medium));
}

void neph_gpu_grid_size(const struct neph_grid *grid, int size[3])
{
    for (int axis = 0; axis < 3; axis++)
        size[axis] = grid->size[axis] + 2;
}

/* The node of the grid for a node of the padded grid; -1: padding with 0. Along a periodic axis the
 * padding repeats the grid. */
static int map_padded_node(const struct neph_grid *grid, int axis, int padded)
{
    const int node = padded - 1;
    if (grid->is_endless[axis])
        return neph_grid_wrapped(grid, axis, node);
    return node < grid->size[axis] ? node : -1;
}

void neph_gpu_grid_slab(const struct neph_medium *medium, int z, float *slab)
{
    const struct neph_grid *grid = medium->grid;
    const float most = compute_density_limit(medium);
    const size_t nx = (size_t)grid->size[0], ny = (size_t)grid->size[1];
    const int layer = map_padded_node(grid, 2, z);
    for (int y = 0; y < grid->size[1] + 2; y++)
        for (int x = 0; x < grid->size[0] + 2; x++) {
            const int row = map_padded_node(grid, 1, y), column = map_padded_node(grid, 0, x);
            const bool is_zero = layer < 0 || row < 0 || column < 0;
            *slab++ =
                is_zero
                    ? 0.0f
                    : fminf(grid->values[((size_t)layer * ny + (size_t)row) * nx + (size_t)column],
                            most);
        }
}

/* Offset from the origin of a periodic grid to the repetition nearest the camera, in whole periods,
 * so that float32 can count cells there. */
static struct neph_vec3 compute_period_offset(const struct neph_grid *grid,
                                              struct neph_vec3 camera_m)
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
    const struct neph_vec3 origin_m = neph_vec3_add(grid->origin_m,
                                                    compute_period_offset(grid, camera_m));
    gpu->shape.grid = (struct neph_gpu_grid){.first = first,
                                             .full = neph_gpu_grid_maximum(medium),
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

/* Slabs of the padded grid in the layout of a kernel: values, or pairs of each value and its
 * successor in the row (0 after the last value of a slab). */
struct slabs {
    const struct neph_medium *medium;
    size_t count_each; /* values of a slab */
    bool are_pairs;
    int first;
    float *values; /* beginning with slab `first`; owned */
};

/* Pairs are made in place, from the last value backwards. */
static void fill_slab(int i, void *context)
{
    const struct slabs *slabs = context;
    const size_t count = slabs->count_each;
    float *values = slabs->values + (size_t)i * count * (slabs->are_pairs ? 2 : 1);
    neph_gpu_grid_slab(slabs->medium, slabs->first + i, values);
    if (!slabs->are_pairs)
        return;
    float behind = 0.0f;
    for (size_t k = count; k-- > 0;) {
        const float value = values[k];
        values[2 * k] = value;
        values[2 * k + 1] = behind;
        behind = value;
    }
}

/* Upload a few megabytes of slabs at a time: this avoids a second copy of the whole grid in memory,
 * and a wait for the device after each slab. */
static enum neph_status upload_slabs(const struct neph_vulkan *vulkan,
                                     const struct neph_medium *medium, bool are_pairs,
                                     uint32_t first, const struct neph_buffer *buffer,
                                     struct neph_diag *diag)
{
    const size_t group_bytes = (size_t)4 << 20;
    int size[3];
    neph_gpu_grid_size(medium->grid, size);
    struct slabs slabs = {medium, (size_t)size[0] * (size_t)size[1], are_pairs, 0, NULL};
    const size_t slab_bytes = slabs.count_each * (are_pairs ? 2 : 1) * sizeof(*slabs.values);
    const int group = group_bytes < slab_bytes ? 1 : (int)(group_bytes / slab_bytes);
    slabs.values = malloc((size_t)(group < size[2] ? group : size[2]) * slab_bytes);
    enum neph_status status = slabs.values ? NEPH_OK : neph_fail_memory(diag);
    for (; slabs.first < size[2] && !status; slabs.first += group) {
        const int left = size[2] - slabs.first, now = left < group ? left : group;
        status = neph_parallel_rows(now, fill_slab, &slabs, diag);
        if (!status)
            status = neph_buffer_upload(vulkan, buffer,
                                        (are_pairs ? 2 : 1) * (size_t)first *
                                                sizeof(*slabs.values) +
                                            (size_t)slabs.first * slab_bytes,
                                        slabs.values, (size_t)now * slab_bytes, diag);
    }
    free(slabs.values);
    return status;
}

static enum neph_status upload(const struct neph_vulkan *vulkan, const struct neph_medium *medium,
                               uint32_t first, const struct neph_buffer *buffer,
                               struct neph_diag *diag)
{
    return upload_slabs(vulkan, medium, false, first, buffer, diag);
}

static enum neph_status upload_pairs(const struct neph_vulkan *vulkan,
                                     const struct neph_medium *medium, uint32_t first,
                                     const struct neph_buffer *buffer, struct neph_diag *diag)
{
    return upload_slabs(vulkan, medium, true, first, buffer, diag);
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

/* If the density rises linearly from 0 within one cell, optical depth 1 is reached at the distance
 * sqrt(2 cell / extinction). */
static double surface_extinction_per_m(const struct neph_medium *medium, double largest_per_m)
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
    .surface_extinction_per_m = surface_extinction_per_m,
};
