/* SPDX-License-Identifier: MIT
 *
 * CPU references of the passes of the real-time renderer in plain C, with which tests compare the
 * shaders. Decisions use the same float32 operations in the same order as the shaders and must be
 * equal; values that are blended or interpolated are computed in double and rounded once. Each
 * function mirrors the shader of its name.
 */
#ifndef NEPH_CHECK_REFERENCE_H
#define NEPH_CHECK_REFERENCE_H

#include "renderer/realtime/view.h"

#include <stdbool.h>

/* All borrowed; targets that a pass neither reads nor writes may be NULL. */
struct reference {
    const struct neph_gpu_view *view;
    const uint32_t *noise_ranks; /* as at binding 1 of the passes */
    uint32_t *targets[RT_TARGET_COUNT];
};

/* Elements at a texel of the whole target, or at a pixel of the view or of the output, a half-pixel
 * or a tile, clamped to its sides. */
void cpu_fetch(const struct reference *cpu, int target, int x, int y, float value[4]);
void cpu_fetch_full(const struct reference *cpu, int target, int x, int y, float value[4]);
void cpu_fetch_output(const struct reference *cpu, int target, int x, int y, float value[4]);
void cpu_fetch_half(const struct reference *cpu, int target, int x, int y, float value[4]);
void cpu_fetch_tile(const struct reference *cpu, int target, int x, int y, float value[4]);
void cpu_put_full(const struct reference *cpu, int target, int x, int y, const float value[4]);
void cpu_put_output(const struct reference *cpu, int target, int x, int y, const float value[4]);
void cpu_put_half(const struct reference *cpu, int target, int x, int y, const float value[4]);
void cpu_put_tile(const struct reference *cpu, int target, int x, int y, const float value[4]);

/* is_sound() of realtime/shared/view.glsl. */
bool cpu_is_valid(const float value[4]);

/* Depth of an edge of the froxels' slices [m]. */
double cpu_froxel_edge_m(const struct reference *cpu, int edge);

/* One for each shader, in the order of the passes. */
void cpu_min_max(const struct reference *cpu);
void cpu_tile_index(const struct reference *cpu);
void cpu_gradient(const struct reference *cpu);
void cpu_change(const struct reference *cpu);
void cpu_reconstruct(const struct reference *cpu);
void cpu_upscale(const struct reference *cpu);
void cpu_froxel_sum(const struct reference *cpu);
void cpu_froxel_apply(const struct reference *cpu);
void cpu_compose(const struct reference *cpu);
void cpu_atrous(const struct reference *cpu, int apart); /* 1, 2 or 4 texels */
void cpu_taa(const struct reference *cpu);               /* also upsampling, by RT_TAA */
void cpu_locks(const struct reference *cpu);

#endif
