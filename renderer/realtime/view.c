/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/view.h"
#include "base/half.h"

#include <string.h>

static const struct {
    uint32_t words, bytes, channels;
    int is_half;
} formats[RT_FORMAT_COUNT] = {
    [RT_R16F] = {1, 2, 1, 1},  [RT_R32F] = {1, 4, 1, 0},    [RT_RG16F] = {1, 4, 2, 1},
    [RT_RG32F] = {2, 8, 2, 0}, [RT_RGBA16F] = {2, 8, 4, 1}, [RT_RGBA32F] = {4, 16, 4, 0},
};

uint32_t neph_rt_format_words(uint32_t format)
{
    return formats[format].words;
}

uint32_t neph_rt_format_bytes(uint32_t format)
{
    return formats[format].bytes;
}

static uint32_t float_to_bits(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof(bits));
    return bits;
}

static float bits_to_float(uint32_t bits)
{
    float value;
    memcpy(&value, &bits, sizeof(value));
    return value;
}

/* Shifts right and rounds to nearest, ties to even. */
static uint32_t round_shift(uint32_t bits, uint32_t shift)
{
    const uint32_t half = 1u << (shift - 1), odd = (bits >> shift) & 1u;
    return (bits + half - 1u + odd) >> shift;
}

uint16_t neph_rt_to_half(float value)
{
    const uint32_t bits = float_to_bits(value);
    const uint32_t sign = bits >> 16 & 0x8000u, magnitude = bits & 0x7fffffffu;
    uint32_t half;
    if (magnitude > 0x7f800000u)
        half = 0x7e00u;
    else if (magnitude >= 0x477ff000u) /* 65520 */
        half = 0x7c00u;
    else if (magnitude >= 0x38800000u) /* 2^-14: normal */
        half = round_shift(magnitude - 0x38000000u, 13);
    else if (magnitude >= 0x33000000u) /* 2^-25: rounds to 0 or to the least half */
        half = round_shift((magnitude & 0x7fffffu) | 0x800000u, 126u - (magnitude >> 23));
    else
        half = 0;
    return (uint16_t)(sign | half);
}

void neph_rt_load(const struct neph_gpu_target *target, const uint32_t *words, size_t index,
                  float value[4])
{
    const uint32_t channels = formats[target->format].channels;
    words += index * formats[target->format].words;
    for (uint32_t c = 0; c < 4; c++) {
        if (c >= channels)
            value[c] = 0.0f;
        else if (formats[target->format].is_half)
            value[c] = neph_half_to_float((uint16_t)(words[c / 2] >> (c % 2 * 16)));
        else
            value[c] = bits_to_float(words[c]);
    }
}

void neph_rt_store(const struct neph_gpu_target *target, uint32_t *words, size_t index,
                   const float value[4])
{
    const uint32_t channels = formats[target->format].channels;
    words += index * formats[target->format].words;
    for (uint32_t c = 0; c < channels; c++) {
        if (!formats[target->format].is_half)
            words[c] = float_to_bits(value[c]);
        else if (c % 2 == 0)
            words[c / 2] = neph_rt_to_half(value[c]);
        else
            words[c / 2] |= (uint32_t)neph_rt_to_half(value[c]) << 16;
    }
}

static bool is_same(const float a[3], const float b[3])
{
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

bool neph_rt_is_medium_static(const struct neph_gpu_view *view)
{
    static const float nothing[3] = {0.0f, 0.0f, 0.0f};
    return view->settings[RT_WIND] == 0.0f || is_same(view->wind_m, nothing);
}

bool neph_rt_are_movers_static(const struct neph_gpu_view *view)
{
    bool rest = true;
    for (uint32_t m = 0; m < view->mover_count; m++) {
        const struct neph_gpu_mover *mover = &view->movers[m];
        rest &= mover->cosine == 1.0f && mover->sine == 0.0f &&
                is_same(mover->pivot_m, mover->pivot_before_m);
    }
    return rest;
}

bool neph_rt_is_view_static(const struct neph_gpu_view *view)
{
    static const float nothing[3] = {0.0f, 0.0f, 0.0f};
    const struct neph_gpu_view_camera *now = &view->now, *before = &view->before;
    const bool is_camera_static = is_same(before->position_m, nothing) &&
                                  is_same(now->forward, before->forward) &&
                                  is_same(now->right, before->right) &&
                                  now->half_width == before->half_width &&
                                  now->half_height == before->half_height;
    return is_camera_static && neph_rt_is_medium_static(view) &&
           view->settings[RT_SOLID_MOTION] == 0.0f;
}
