/* SPDX-License-Identifier: MIT
 *
 * What all passes of one frame of the real-time renderer are told: struct View of
 * shaders/realtime.glsl and its mirror here, and how a target keeps its numbers.
 */
#ifndef NEPH_RENDERER_REALTIME_VIEW_H
#define NEPH_RENDERER_REALTIME_VIEW_H

#include "renderer/shaders/realtime_names.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Where the targets' sky lies, FAR_M of shaders/numbers.glsl [m]. */
#define NEPH_RT_FAR_M 1e15f

/* A camera of one frame; positions are relative to this frame's camera. */
struct neph_rt_camera {
    float right[3], tan_half_width;
    float up[3], tan_half_height;
    float forward[3], padding;
    float position_m[3],
        padding_2; /* 0 for this frame's, where the last frame's stood for that one */
};

/* Elements row by row, row 0 on top. */
struct neph_rt_target {
    uint32_t format; /* RT_R16F, .. */
    uint32_t width, height;
    uint32_t padding;
};

/* std430, binding 0 of the passes. A view is a rectangle of its targets: pixel (0, 0) of the view
 * is texel `origin` of the full-resolution targets, origin / 2 of the half, origin / 4 of the
 * quarter (`origin` is a multiple of 4). */
struct neph_rt_view {
    struct neph_rt_camera now, before;
    struct neph_rt_target targets[RT_TARGET_COUNT];
    float settings[RT_SETTING_COUNT]; /* as in the table of options; choices as whole numbers */
    uint32_t seed;
    uint32_t frame;       /* of the sequence that the pipeline has seen, from 0: phase and dither */
    uint32_t has_history; /* 0 in the first frame, after a resize, and after a cut if cut_reset */
    uint32_t is_cut;      /* the camera jumped since the frame before */
    uint32_t origin_px[2];
    uint32_t size_px[2];      /* of the view, full resolution */
    uint32_t half_size_px[2]; /* rounded up */
    uint32_t tile_count[2];   /* quarter resolution, rounded up */
    float jitter_px[2]; /* of this frame's rays, added to the pixel's centre; x right, y down */
    float wind_m[3];    /* displacement of the medium since the frame before */
    uint32_t resting;   /* no override in this frame (override_rest) */
    float jitter_before_px[2]; /* jitter_px of the frame before */
};

_Static_assert(sizeof(struct neph_rt_camera) == 64, "std430 Camera");
_Static_assert(offsetof(struct neph_rt_view, targets) == 128, "std430 View.targets");
_Static_assert(offsetof(struct neph_rt_view, settings) == 128 + 16 * RT_TARGET_COUNT,
               "std430 View.settings");
_Static_assert(offsetof(struct neph_rt_view, seed) ==
                   128 + 16 * RT_TARGET_COUNT + 4 * RT_SETTING_COUNT,
               "std430 View.seed");

/* Words of an element. */
uint32_t neph_rt_format_words(uint32_t format);

/* Bytes of an element in a texture of that format: what a GPU would move. */
uint32_t neph_rt_format_bytes(uint32_t format);

/* The nearest half, ties to even; beyond 65504 infinite from 65520 on; NaN stays NaN (0x7e00 with
 * the sign). The same rule as to_half() of shaders/realtime.glsl, which does not trust the driver's
 * packHalf2x16: Vulkan leaves its rounding open. */
uint16_t neph_rt_to_half(float value);
float neph_rt_from_half(uint16_t half);

/* Element `index` of a target, from and to its words; channels it has not got are read as 0. */
void neph_rt_load(const struct neph_rt_target *target, const uint32_t *words, size_t index,
                  float value[4]);
void neph_rt_store(const struct neph_rt_target *target, uint32_t *words, size_t index,
                   const float value[4]);

#endif
