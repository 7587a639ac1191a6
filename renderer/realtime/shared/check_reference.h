/* SPDX-License-Identifier: MIT
 *
 * The passes of the real-time renderer once more, in plain C: what the shaders are tested against.
 * Decisions are made in the same float32 operations in the same order as in the shaders, and must
 * come out equal; values that are blended or interpolated are taken in double and rounded once.
 * Each function is the mirror of the shader of its name.
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

/* Element at a texel of the whole target; pixel of the view or of the picture, half-pixel or tile
 * held at its sides. */
void cpu_fetch(const struct reference *cpu, int target, int x, int y, float value[4]);
void cpu_fetch_full(const struct reference *cpu, int target, int x, int y, float value[4]);
void cpu_fetch_picture(const struct reference *cpu, int target, int x, int y, float value[4]);
void cpu_fetch_half(const struct reference *cpu, int target, int x, int y, float value[4]);
void cpu_fetch_tile(const struct reference *cpu, int target, int x, int y, float value[4]);
void cpu_put_full(const struct reference *cpu, int target, int x, int y, const float value[4]);
void cpu_put_picture(const struct reference *cpu, int target, int x, int y, const float value[4]);
void cpu_put_half(const struct reference *cpu, int target, int x, int y, const float value[4]);
void cpu_put_tile(const struct reference *cpu, int target, int x, int y, const float value[4]);

/* is_sound() of shaders/realtime.glsl. */
bool cpu_is_sound(const float value[4]);

/* Depth of an edge of the froxels' slices [m]. */
double cpu_froxel_edge_m(const struct reference *cpu, int edge);

/* One for each shader, in the order of the pipeline. */
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
void cpu_taa(const struct reference *cpu);               /* and upsampling, by RT_TAA */
void cpu_locks(const struct reference *cpu);

#endif
