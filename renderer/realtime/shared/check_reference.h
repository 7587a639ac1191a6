/* SPDX-License-Identifier: MIT
 *
 * The passes of the real-time renderer once more, in plain C: what the shaders are tested against.
 * Decisions are made in the same float32 operations in the same order as in the shaders, and must
 * come out equal; values that are blended or interpolated are taken in double and rounded once.
 * Each function is the mirror of the shader of its name.
 */
#ifndef NEPH_TESTS_TWIN_H
#define NEPH_TESTS_TWIN_H

#include "renderer/realtime/view.h"

#include <stdbool.h>

/* All borrowed; targets that a pass neither reads nor writes may be NULL. */
struct twin {
    const struct neph_gpu_view *view;
    const uint32_t *noise_ranks; /* as at binding 1 of the passes */
    uint32_t *targets[RT_TARGET_COUNT];
};

/* Element at a texel of the whole target; pixel of the view or of the picture, half-pixel or tile
 * held at its sides. */
void twin_fetch(const struct twin *twin, int target, int x, int y, float value[4]);
void twin_fetch_full(const struct twin *twin, int target, int x, int y, float value[4]);
void twin_fetch_picture(const struct twin *twin, int target, int x, int y, float value[4]);
void twin_fetch_half(const struct twin *twin, int target, int x, int y, float value[4]);
void twin_fetch_tile(const struct twin *twin, int target, int x, int y, float value[4]);
void twin_put_full(const struct twin *twin, int target, int x, int y, const float value[4]);
void twin_put_picture(const struct twin *twin, int target, int x, int y, const float value[4]);
void twin_put_half(const struct twin *twin, int target, int x, int y, const float value[4]);
void twin_put_tile(const struct twin *twin, int target, int x, int y, const float value[4]);

/* is_sound() of shaders/realtime.glsl. */
bool twin_is_sound(const float value[4]);

/* Depth of an edge of the froxels' slices [m]. */
double twin_froxel_edge_m(const struct twin *twin, int edge);

/* One for each shader, in the order of the pipeline. */
void twin_min_max(const struct twin *twin);
void twin_tile_index(const struct twin *twin);
void twin_gradient(const struct twin *twin);
void twin_change(const struct twin *twin);
void twin_reconstruct(const struct twin *twin);
void twin_upscale(const struct twin *twin);
void twin_froxel_sum(const struct twin *twin);
void twin_froxel_apply(const struct twin *twin);
void twin_compose(const struct twin *twin);
void twin_atrous(const struct twin *twin, int apart); /* 1, 2 or 4 texels */
void twin_taa(const struct twin *twin);               /* and upsampling, by RT_TAA */
void twin_locks(const struct twin *twin);

#endif
