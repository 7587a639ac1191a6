/* SPDX-License-Identifier: MIT
 *
 * The device data of Horizon clouds.
 */
#include "scenes/horizon.h"

#include "renderer/media/kind.h"
#include "renderer/relative.h"

#include <math.h>
#include <stdlib.h>

/* Coordinate along one axis of a periodic texture, relative to the first texel [texels]. */
static float compute_texel_position(double place_m, double repeats_per_m, int side)
{
    const double repeats = place_m * repeats_per_m;
    return (float)((repeats - floor(repeats)) * side - 0.5);
}

/* Upper bound of the density: 1, or more with the density parameter. */
static double density_max(const struct neph_medium *medium)
{
    return fmax(1.0, 2.0 * medium->horizon->params.density);
}

static void pack(const struct neph_medium *medium, struct neph_vec3 camera_m, uint32_t first,
                 struct neph_gpu_medium *gpu)
{
    enum { BASE = NEPH_HORIZON_BASE_SIDE, DETAIL = NEPH_HORIZON_DETAIL_SIDE };
    const struct neph_horizon_params *params = &medium->horizon->params;
    const struct neph_vec3 center_m = {0.0, params->bottom_m - params->planet_radius_m, 0.0};
    const struct neph_vec3 from_m = neph_vec3_sub(camera_m, params->wind_m);
    const double from[3] = {from_m.x, from_m.y, from_m.z};
    const double weather_per_m = 1.0 / params->texture_scale_m;
    const double base_per_m = params->base_repeats * weather_per_m;
    const double detail_per_m = params->detail_repeats * weather_per_m;
    struct neph_gpu_horizon *horizon = &gpu->shape.horizon;
    *horizon = (struct neph_gpu_horizon){
        .globe = neph_gpu_globe_from(center_m, params->planet_radius_m, camera_m),
        .base_per_m = (float)(base_per_m * BASE),
        .detail_per_m = (float)(detail_per_m * DETAIL),
        .weather_at = {compute_texel_position(from_m.x, weather_per_m, NEPH_HORIZON_WEATHER_SIDE),
                       compute_texel_position(from_m.z, weather_per_m, NEPH_HORIZON_WEATHER_SIDE)},
        .weather_per_m = (float)(weather_per_m * NEPH_HORIZON_WEATHER_SIDE),
        .thickness_m = (float)params->thickness_m,
        .coverage = (float)params->coverage,
        .density = (float)params->density,
        .erosion = (float)(0.8 * exp(-0.75 * params->coverage)),
        .first = first,
    };
    for (int axis = 0; axis < 3; axis++) {
        horizon->base_at[axis] = compute_texel_position(from[axis], base_per_m, BASE);
        horizon->detail_at[axis] = compute_texel_position(from[axis], detail_per_m, DETAIL);
    }
    gpu->extinction_per_m = fminf(gpu->extinction_per_m,
                                  (float)(NEPH_GPU_EXTINCTION_MAX / density_max(medium)));
}

enum {
    base_texels = NEPH_HORIZON_BASE_SIDE * NEPH_HORIZON_BASE_SIDE * NEPH_HORIZON_BASE_SIDE,
    detail_texels = NEPH_HORIZON_DETAIL_SIDE * NEPH_HORIZON_DETAIL_SIDE * NEPH_HORIZON_DETAIL_SIDE,
    weather_texels = NEPH_HORIZON_WEATHER_SIDE * NEPH_HORIZON_WEATHER_SIDE,
    all_texels = base_texels + detail_texels + weather_texels,
};

_Static_assert(NEPH_HORIZON_BASE_SIDE == NEPH_GPU_HORIZON_BASE_SIDE &&
                   NEPH_HORIZON_DETAIL_SIDE == NEPH_GPU_HORIZON_DETAIL_SIDE &&
                   NEPH_HORIZON_WEATHER_SIDE == NEPH_GPU_HORIZON_WEATHER_SIDE,
               "the shader's textures");

/* Expand to four channels, the format of all textures in the shaders. */
static void expand_to_four_channels(const float *texels, int count, int channels, float *out)
{
    for (int i = 0; i < count; i++)
        for (int c = 0; c < 4; c++)
            *out++ = c < channels ? texels[i * channels + c] : 0.0f;
}

static size_t data_count(const struct neph_medium *medium)
{
    (void)medium;
    return all_texels;
}

static enum neph_status upload(const struct neph_vulkan *vulkan, const struct neph_medium *medium,
                               uint32_t first, const struct neph_buffer *buffer,
                               struct neph_diag *diag)
{
    const struct neph_horizon *horizon = medium->horizon;
    const size_t texel_bytes = 4 * sizeof(float);
    float *texels = malloc(all_texels * texel_bytes);
    if (!texels)
        return neph_fail_memory(diag);
    expand_to_four_channels(horizon->base, base_texels, 4, texels);
    expand_to_four_channels(horizon->detail, detail_texels, 3, texels + 4 * base_texels);
    expand_to_four_channels(horizon->weather, weather_texels, 4,
                            texels + 4 * (base_texels + detail_texels));
    const enum neph_status status = neph_buffer_upload(vulkan, buffer, first * texel_bytes, texels,
                                                       all_texels * texel_bytes, diag);
    free(texels);
    return status;
}

static double largest_per_m(const struct neph_medium *medium)
{
    return medium->extinction_per_m * density_max(medium);
}

const struct neph_gpu_kind neph_gpu_horizon = {
    .pack = pack,
    .data = NEPH_GPU_TEXELS,
    .data_count = data_count,
    .upload = upload,
    .largest_per_m = largest_per_m,
};
