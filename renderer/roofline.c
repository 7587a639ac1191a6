/* SPDX-License-Identifier: MIT */
#include "renderer/roofline.h"

#include "base/clock.h"
#include "renderer/compute.h"
#include "renderer/texture.h"
#include "shaders/structs.h"

#include <math.h>
#include <stdlib.h>

static const uint32_t copy_code[] = {
#include "shaders/ceiling_copy.comp.inc"
};
static const uint32_t samples_code[] = {
#include "shaders/ceiling_samples.comp.inc"
};

static const uint32_t arithmetic_code[] = {
#include "shaders/ceiling_arithmetic.comp.inc"
};

enum { local_size = 64, copy_buffers = 2, sample_buffers = 3, word_bytes = 16 };

/* Sizes for about 10 ms on two CPU cores, and to fill a GPU. The copied buffers exceed the largest
 * caches: 50 MB on GPUs, 32 MB on common CPUs. */
static const struct sizes {
    size_t copy_bytes;
    uint32_t line_count, sample_count;
    uint32_t thread_count, turns; /* each with arithmetic_rows operations */
} cpu_sizes = {(size_t)64 << 20, 1u << 12, 64, 1u << 12, 256},
  gpu_sizes = {(size_t)512 << 20, 1u << 20, 256, 1u << 21, 1024};

/* Operations of a thread's turn, in shaders/ceiling_arithmetic.comp. */
enum { arithmetic_rows = 8 };

enum { grid_side = 128 };

/* --- the fastest of many runs ------------------------------------------------------------- */

static enum neph_status find_fastest_run(struct neph_vulkan *vulkan,
                                         const struct neph_kernel_params *params,
                                         const struct neph_dispatch *dispatch, double seconds,
                                         double *least_s, struct neph_diag *diag)
{
    const struct neph_kernel *kernel;
    enum neph_status status = neph_kernel_get(vulkan, params, &kernel, diag);
    const double start_s = neph_wall_s();
    *least_s = status ? NAN : INFINITY;
    while (!status && neph_wall_s() - start_s < 2.0 * seconds) {
        double gpu_s;
        status = neph_kernel_run(vulkan, kernel, dispatch, &gpu_s, diag);
        if (!status && isnan(gpu_s))
            *least_s = NAN;
        else if (!status && neph_wall_s() - start_s > seconds)
            *least_s = fmin(*least_s, gpu_s);
    }
    return status;
}

/* --- copies ------------------------------------------------------------------------------- */

static enum neph_status run_copies(struct neph_vulkan *vulkan,
                                   const struct neph_buffer buffers[copy_buffers], double seconds,
                                   double *least_s, struct neph_diag *diag)
{
    const struct neph_kernel_params params = {
        .name = "ceiling_copy",
        .code = copy_code,
        .code_bytes = sizeof(copy_code),
        .buffer_count = copy_buffers,
    };
    const struct neph_dispatch dispatch = {
        .buffers = {&buffers[0], &buffers[1]},
        .group_count = (uint32_t)(buffers[0].size_bytes / (word_bytes * local_size)),
    };
    return find_fastest_run(vulkan, &params, &dispatch, seconds, least_s, diag);
}

/* Reduced to the largest buffer and to the largest copy by one dispatch of groups along x. */
static size_t choose_copy_bytes(const struct neph_vulkan *vulkan, const struct sizes *sizes)
{
    const size_t groups_max = vulkan->limits.maxComputeWorkGroupCount[0];
    const size_t dispatch_max = groups_max * local_size * word_bytes;
    size_t bytes = sizes->copy_bytes;
    while (bytes > vulkan->limits.maxStorageBufferRange || bytes > dispatch_max)
        bytes /= 2;
    return bytes;
}

static enum neph_status measure_copies(struct neph_vulkan *vulkan, const struct sizes *sizes,
                                       double seconds, struct neph_roofline_limits *ceilings,
                                       struct neph_diag *diag)
{
    struct neph_buffer buffers[copy_buffers] = {{0}, {0}};
    double least_s = NAN;
    ceilings->copy_bytes = choose_copy_bytes(vulkan, sizes);
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < copy_buffers && !status; i++)
        status = neph_buffer_create(vulkan, NEPH_BUFFER_DEVICE, ceilings->copy_bytes, "copy",
                                    &buffers[i], diag);
    if (!status)
        status = run_copies(vulkan, buffers, seconds, &least_s, diag);
    ceilings->copy_bytes_per_s = 2.0 * (double)ceilings->copy_bytes / least_s;
    for (int i = 0; i < copy_buffers; i++)
        neph_buffer_destroy(vulkan, &buffers[i]);
    return status;
}

/* --- arithmetic --------------------------------------------------------------------------- */

static enum neph_status run_arithmetic(struct neph_vulkan *vulkan, const struct sizes *sizes,
                                       const struct neph_buffer *results, bool exponentials,
                                       double seconds, double *per_s, struct neph_diag *diag)
{
    const struct neph_kernel_params params = {
        .name = "ceiling_arithmetic",
        .code = arithmetic_code,
        .code_bytes = sizeof(arithmetic_code),
        .buffer_count = 1,
        .push_size_bytes = sizeof(struct neph_gpu_ceiling_turns),
        .constant_count = 1,
        .constants = {exponentials},
    };
    const struct neph_gpu_ceiling_turns run = {sizes->turns, 0.999f, 0.001f};
    const struct neph_dispatch dispatch = {
        .buffers = {results},
        .push = &run,
        .group_count = sizes->thread_count / local_size,
    };
    double least_s;
    const enum neph_status status = find_fastest_run(vulkan, &params, &dispatch, seconds, &least_s,
                                                     diag);
    *per_s = (double)sizes->thread_count * sizes->turns * arithmetic_rows / least_s;
    return status;
}

static enum neph_status measure_arithmetic(struct neph_vulkan *vulkan, const struct sizes *sizes,
                                           double seconds, struct neph_roofline_limits *ceilings,
                                           struct neph_diag *diag)
{
    struct neph_buffer results = {0};
    enum neph_status status = neph_buffer_create(vulkan, NEPH_BUFFER_DEVICE,
                                                 sizes->thread_count * sizeof(float), "arithmetic",
                                                 &results, diag);
    if (!status)
        status = run_arithmetic(vulkan, sizes, &results, false, seconds,
                                &ceilings->multiply_adds_per_s, diag);
    if (!status)
        status = run_arithmetic(vulkan, sizes, &results, true, seconds,
                                &ceilings->exponentials_per_s, diag);
    neph_buffer_destroy(vulkan, &results);
    return status;
}

/* --- samples ------------------------------------------------------------------------------ */

/* Rays through the grid from one face to the opposite one, in squares of 8 x 8 neighbours half a
 * node apart; each square has its own position. */
static void fill_rays(struct neph_gpu_ceiling_line *lines, const struct sizes *sizes)
{
    const float stride = (float)(grid_side - 4) / (float)sizes->sample_count;
    for (uint32_t i = 0; i < sizes->line_count; i++) {
        const uint32_t square = i / local_size * 2654435761u; /* Knuth's multiplicative hash */
        const float x = (float)(square >> 16 & 127u) / 128.0f, y = (float)(square >> 24) / 256.0f;
        const float width = (float)(grid_side - 24);
        lines[i] = (struct neph_gpu_ceiling_line){
            .start = {2.0f + width * x + 0.5f * (float)(i % 8),
                      2.0f + width * y + 0.5f * (float)(i / 8 % 8), 1.5f},
            .stride = {0.1f * stride * (1.0f - x), 0.1f * stride * (1.0f - y), stride},
        };
    }
}

static float compute_node_value(size_t node)
{
    return (float)(node % 97) / 97.0f;
}

static void write_node_slab(const void *context, int z, float *values)
{
    const size_t slab_count = (size_t)grid_side * grid_side;
    (void)context;
    for (size_t i = 0; i < slab_count; i++)
        values[i] = compute_node_value((size_t)z * slab_count + i);
}

static enum neph_status create_texture(const struct neph_vulkan *vulkan,
                                       enum neph_texel_format format, struct neph_texture *texture,
                                       struct neph_diag *diag)
{
    const struct neph_texture_params params = {
        .format = format,
        .size = {grid_side, grid_side, grid_side},
        .slab = write_node_slab,
        .name = "samples",
    };
    return neph_texture_create(vulkan, &params, texture, diag);
}

static enum neph_status fill_samples(const struct neph_vulkan *vulkan, const struct sizes *sizes,
                                     const struct neph_buffer buffers[sample_buffers],
                                     struct neph_diag *diag)
{
    const size_t node_count = (size_t)grid_side * grid_side * grid_side;
    float *nodes = malloc(node_count * sizeof(*nodes));
    struct neph_gpu_ceiling_line *lines = malloc(sizes->line_count * sizeof(*lines));
    enum neph_status status = nodes && lines ? NEPH_OK : neph_fail_memory(diag);
    for (size_t i = 0; i < node_count && !status; i++)
        nodes[i] = compute_node_value(i);
    if (!status)
        status = neph_buffer_upload(vulkan, &buffers[0], 0, nodes, node_count * sizeof(*nodes),
                                    diag);
    if (!status) {
        fill_rays(lines, sizes);
        status = neph_buffer_upload(vulkan, &buffers[1], 0, lines,
                                    sizes->line_count * sizeof(*lines), diag);
    }
    free(lines);
    free(nodes);
    return status;
}

/* Pairs of each node and its successor, read together on a CPU (neph_buffer_create_texel_views()).
 * */
static enum neph_status fill_pairs(const struct neph_vulkan *vulkan, struct neph_buffer *pairs,
                                   struct neph_diag *diag)
{
    const size_t node_count = (size_t)grid_side * grid_side * grid_side;
    const size_t bytes = 2 * node_count * sizeof(float);
    float *nodes = malloc(bytes);
    enum neph_status status = nodes ? NEPH_OK : neph_fail_memory(diag);
    for (size_t i = 0; i < 2 * node_count && !status; i++)
        nodes[i] = compute_node_value(i / 2 + i % 2);
    if (!status)
        status = neph_buffer_create(vulkan, NEPH_BUFFER_DEVICE, bytes, "samples in pairs", pairs,
                                    diag);
    if (!status)
        status = neph_buffer_upload(vulkan, pairs, 0, nodes, bytes, diag);
    if (!status)
        status = neph_buffer_create_texel_views(vulkan, pairs, diag);
    free(nodes);
    return status;
}

/* The grid in all forms that the kernel samples. */
struct sample_source {
    const struct sizes *sizes;
    struct neph_buffer buffers[sample_buffers];
    struct neph_buffer pairs; /* only on a CPU */
    struct neph_texture texture;
};

static enum neph_status run_samples(struct neph_vulkan *vulkan,
                                    const struct sample_source *sample_source, bool by_texture,
                                    bool waits, double seconds, double *samples_per_s,
                                    struct neph_diag *diag)
{
    const struct neph_kernel_params params = {
        .name = "ceiling_samples",
        .code = samples_code,
        .code_bytes = sizeof(samples_code),
        .buffer_count = sample_buffers,
        .image_count = 1,
        .texels_count = {[1] = 1}, /* pairs */
        .push_size_bytes = sizeof(struct neph_gpu_ceiling_run),
        .constant_count = 3,
        .constants = {by_texture, waits, vulkan->description.is_cpu},
    };
    const struct sizes *sizes = sample_source->sizes;
    const struct neph_gpu_ceiling_run run = {grid_side, sizes->sample_count};
    const struct neph_dispatch dispatch = {
        .buffers = {&sample_source->buffers[0], &sample_source->buffers[1],
                    &sample_source->buffers[2]},
        .images = {&sample_source->texture},
        .push = &run,
        .group_count = sizes->line_count / local_size,
    };
    double least_s;
    const enum neph_status status = find_fastest_run(vulkan, &params, &dispatch, seconds, &least_s,
                                                     diag);
    *samples_per_s = (double)sizes->line_count * sizes->sample_count / least_s;
    return status;
}

/* Sampling from the buffer; the kernel also needs a texture bound, in a format of every device. */
static enum neph_status run_buffer(struct neph_vulkan *vulkan, struct sample_source *sample_source,
                                   double seconds, struct neph_roofline_limits *ceilings,
                                   struct neph_diag *diag)
{
    enum neph_status status = create_texture(vulkan, NEPH_TEXEL_R8, &sample_source->texture, diag);
    if (!status)
        status = run_samples(vulkan, sample_source, false, false, seconds,
                             &ceilings->buffer_samples_per_s, diag);
    if (!status)
        status = run_samples(vulkan, sample_source, false, true, seconds,
                             &ceilings->buffer_chain_per_s, diag);
    neph_texture_destroy(vulkan, &sample_source->texture);
    return status;
}

static enum neph_status run_textures(struct neph_vulkan *vulkan,
                                     struct sample_source *sample_source, double seconds,
                                     unsigned texel_formats, struct neph_roofline_limits *ceilings,
                                     struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int f = 0; f < NEPH_TEXEL_FORMAT_COUNT && !status; f++) {
        const enum neph_texel_format format = (enum neph_texel_format)f;
        ceilings->texture_samples_per_s[f] = ceilings->texture_chain_per_s[f] = NAN;
        if (!(texel_formats & 1u << f) || !neph_texture_can_filter(vulkan, format))
            continue;
        status = create_texture(vulkan, format, &sample_source->texture, diag);
        if (!status)
            status = run_samples(vulkan, sample_source, true, false, seconds,
                                 &ceilings->texture_samples_per_s[f], diag);
        if (!status)
            status = run_samples(vulkan, sample_source, true, true, seconds,
                                 &ceilings->texture_chain_per_s[f], diag);
        neph_texture_destroy(vulkan, &sample_source->texture);
    }
    return status;
}

static enum neph_status measure_samples(struct neph_vulkan *vulkan, const struct sizes *sizes,
                                        double seconds, unsigned texel_formats,
                                        struct neph_roofline_limits *ceilings,
                                        struct neph_diag *diag)
{
    const size_t sizes_bytes[sample_buffers] = {
        (size_t)grid_side * grid_side * grid_side * sizeof(float),
        sizes->line_count * sizeof(struct neph_gpu_ceiling_line),
        sizes->line_count * sizeof(float),
    };
    struct sample_source sample_source = {.sizes = sizes};
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < sample_buffers && !status; i++)
        status = neph_buffer_create(vulkan, NEPH_BUFFER_DEVICE, sizes_bytes[i], "samples",
                                    &sample_source.buffers[i], diag);
    if (!status)
        status = fill_samples(vulkan, sizes, sample_source.buffers, diag);
    if (!status && vulkan->description.is_cpu)
        status = fill_pairs(vulkan, &sample_source.pairs, diag);
    sample_source.buffers[0].texels = sample_source.pairs.texels;
    sample_source.pairs.texels = (struct neph_texel_views){{VK_NULL_HANDLE}};
    if (!status)
        status = run_buffer(vulkan, &sample_source, seconds, ceilings, diag);
    if (!status)
        status = run_textures(vulkan, &sample_source, seconds, texel_formats, ceilings, diag);
    ceilings->grid_side = grid_side;
    for (int i = 0; i < sample_buffers; i++)
        neph_buffer_destroy(vulkan, &sample_source.buffers[i]);
    neph_buffer_destroy(vulkan, &sample_source.pairs);
    return status;
}

enum neph_status neph_roofline_measure(struct neph_vulkan *vulkan, double seconds,
                                       unsigned texel_formats,
                                       struct neph_roofline_limits *ceilings,
                                       struct neph_diag *diag)
{
    const struct sizes *sizes = vulkan->description.is_cpu ? &cpu_sizes : &gpu_sizes;
    struct neph_roofline_limits measured;
    enum neph_status status = measure_copies(vulkan, sizes, seconds, &measured, diag);
    if (!status)
        status = measure_samples(vulkan, sizes, seconds, texel_formats, &measured, diag);
    if (!status)
        status = measure_arithmetic(vulkan, sizes, seconds, &measured, diag);
    if (!status)
        *ceilings = measured;
    return status;
}
