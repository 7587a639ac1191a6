/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/noise.h"

#include "renderer/blue_noise.h"

enum { MASK_FRAMES = 32, GRADIENT_FRAMES = 64 }; /* of realtime/shared/dither.glsl */

/* `frame_count` slices of 64x64. */
static enum neph_status load_mask(uint32_t seed, int frame_count, const char *cache_folder,
                                  uint32_t *ranks, struct neph_diag *diag)
{
    const struct neph_blue_noise_request request = {64, 64, frame_count, seed};
    struct neph_blue_noise *mask = NULL;
    const enum neph_status status = neph_blue_noise_load(&request, cache_folder, &mask, diag);
    if (status)
        return status;
    for (int i = 0; i < frame_count * NEPH_RT_NOISE_SPATIAL; i++)
        ranks[i] = mask->ranks[i];
    neph_blue_noise_destroy(mask);
    return NEPH_OK;
}

enum neph_status neph_rt_noise_ranks(uint32_t seed, const char *cache_folder,
                                     uint32_t ranks[NEPH_RT_NOISE_COUNT], struct neph_diag *diag)
{
    const enum neph_status status = load_mask(seed, 1, cache_folder, ranks, diag);
    return status ? status
                  : load_mask(seed, MASK_FRAMES, cache_folder, ranks + NEPH_RT_NOISE_SPATIAL, diag);
}

int neph_rt_dither_period(int kind)
{
    return kind == RT_DITHER_INTERLEAVED      ? GRADIENT_FRAMES
           : kind == RT_DITHER_SPATIOTEMPORAL ? MASK_FRAMES
                                              : 0;
}
