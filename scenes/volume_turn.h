/* SPDX-License-Identifier: MIT
 *
 * Rotations by multiples of 90 degrees and mirrors, which only permute axes: each axis of a volume
 * file lies along an axis of the world, forwards or backwards. No value is resampled. Private to
 * scenes/volume_*.c.
 */
#ifndef NEPH_SCENES_VOLUME_TURN_H
#define NEPH_SCENES_VOLUME_TURN_H

#include "scenes/scene.h"

#include <stddef.h>

struct neph_axis_turn {
    int axis[3];         /* axis i of the file lies along this axis of the world */
    bool is_reversed[3]; /* axis i of the file runs against that axis */
};

/* From a world with z up to the world of neph with y up: (x, y, z) becomes (x, z, -y). */
extern const struct neph_axis_turn neph_axis_turn_z_up;
extern const struct neph_axis_turn neph_axis_turn_none;

/* Whether the axes are a permutation. */
bool neph_axis_turn_is_sound(const struct neph_axis_turn *turn);

/* The turn that applies `first` and then `second`. */
struct neph_axis_turn neph_axis_turn_join(const struct neph_axis_turn *first,
                                          const struct neph_axis_turn *second);

struct neph_vec3 neph_axis_turn_point(const struct neph_axis_turn *turn, struct neph_vec3 point);

/* A block of nodes. */
struct neph_block {
    int size[3];              /* nodes along the axes, in the order of the file before a turn */
    struct neph_vec3 origin;  /* the place of node (0, 0, 0) */
    struct neph_vec3 spacing; /* > 0, along the same axes as `size` */
};

/* A block after the turn, and the places of its values: value (i, j, k) of the file is
 * values[first + i * step[0] + j * step[1] + k * step[2]] of a grid of `block.size` nodes. */
struct neph_turned_block {
    struct neph_block block; /* along the axes of the world */
    size_t first;
    ptrdiff_t step[3];
};

/* `origin` of the block is the place of its first node after the turn. */
struct neph_turned_block neph_axis_turn_block(const struct neph_axis_turn *turn,
                                              const struct neph_block *block);

#endif
