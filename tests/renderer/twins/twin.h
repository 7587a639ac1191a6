/* SPDX-License-Identifier: MIT
 *
 * The passes of the real-time renderer once more, in plain C: what the shaders are tested against.
 * Decisions are made in the same float32 operations in the same order as in the shaders, and must
 * come out equal; values that are blended or interpolated are taken in double and rounded once.
 * Each function is the mirror of the shader of its name.
 */
#ifndef NEPH_RENDERER_REALTIME_ORACLE_H
#define NEPH_RENDERER_REALTIME_ORACLE_H

#include "renderer/realtime/view.h"

#include <stdbool.h>

/* All borrowed; targets that a pass neither reads nor writes may be NULL. */
struct neph_rt_oracle {
    const struct neph_rt_view *view;
    const uint32_t *noise_ranks; /* as at binding 1 of the passes */
    uint32_t *targets[RT_TARGET_COUNT];
};

/* Element at a texel of the whole target; pixel of the view, half-pixel or tile held at its sides.
 */
void neph_rt_fetch(const struct neph_rt_oracle *oracle, int target, int x, int y, float value[4]);
void neph_rt_fetch_full(const struct neph_rt_oracle *oracle, int target, int x, int y,
                        float value[4]);
void neph_rt_fetch_half(const struct neph_rt_oracle *oracle, int target, int x, int y,
                        float value[4]);
void neph_rt_fetch_tile(const struct neph_rt_oracle *oracle, int target, int x, int y,
                        float value[4]);
void neph_rt_put_full(const struct neph_rt_oracle *oracle, int target, int x, int y,
                      const float value[4]);
void neph_rt_put_half(const struct neph_rt_oracle *oracle, int target, int x, int y,
                      const float value[4]);
void neph_rt_put_tile(const struct neph_rt_oracle *oracle, int target, int x, int y,
                      const float value[4]);

/* is_sound() of shaders/realtime.glsl. */
bool neph_rt_is_sound(const float value[4]);

/* One for each shader, in the order of the pipeline. */
void neph_rt_oracle_min_max(const struct neph_rt_oracle *oracle);
void neph_rt_oracle_tile_index(const struct neph_rt_oracle *oracle);
void neph_rt_oracle_reconstruct(const struct neph_rt_oracle *oracle);
void neph_rt_oracle_upscale(const struct neph_rt_oracle *oracle);
void neph_rt_oracle_compose(const struct neph_rt_oracle *oracle);
void neph_rt_oracle_taa(const struct neph_rt_oracle *oracle);

#endif
