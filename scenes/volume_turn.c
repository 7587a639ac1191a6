/* SPDX-License-Identifier: MIT */
#include "scenes/volume_turn.h"

const struct neph_axis_turn neph_axis_turn_none = {{0, 1, 2}, {false, false, false}};
const struct neph_axis_turn neph_axis_turn_z_up = {{0, 2, 1}, {false, true, false}};

/* Vectors by the number of an axis. */
struct axes {
    double at[3];
};

static struct axes to_axes(struct neph_vec3 v)
{
    return (struct axes){{v.x, v.y, v.z}};
}

static struct neph_vec3 to_vec3(const struct axes *axes)
{
    return (struct neph_vec3){axes->at[0], axes->at[1], axes->at[2]};
}

bool neph_axis_turn_is_sound(const struct neph_axis_turn *turn)
{
    bool is_used[3] = {false};
    for (int i = 0; i < 3; i++) {
        if (turn->axis[i] < 0 || turn->axis[i] > 2 || is_used[turn->axis[i]])
            return false;
        is_used[turn->axis[i]] = true;
    }
    return true;
}

struct neph_axis_turn neph_axis_turn_join(const struct neph_axis_turn *first,
                                          const struct neph_axis_turn *second)
{
    struct neph_axis_turn joined;
    for (int i = 0; i < 3; i++) {
        joined.axis[i] = second->axis[first->axis[i]];
        joined.is_reversed[i] = first->is_reversed[i] != second->is_reversed[first->axis[i]];
    }
    return joined;
}

struct neph_vec3 neph_axis_turn_point(const struct neph_axis_turn *turn, struct neph_vec3 point)
{
    const struct axes from = to_axes(point);
    struct axes to;
    for (int i = 0; i < 3; i++)
        to.at[turn->axis[i]] = turn->is_reversed[i] ? -from.at[i] : from.at[i];
    return to_vec3(&to);
}

struct neph_turned_block neph_axis_turn_block(const struct neph_axis_turn *turn,
                                              const struct neph_block *block)
{
    const struct axes spacing = to_axes(block->spacing);
    struct axes origin = to_axes(block->origin), turned_spacing;
    struct neph_turned_block turned = {.first = 0};
    for (int i = 0; i < 3; i++) {
        turned.block.size[turn->axis[i]] = block->size[i];
        turned_spacing.at[turn->axis[i]] = spacing.at[i];
    }
    const ptrdiff_t row = turned.block.size[0], strides[3] = {1, row, row * turned.block.size[1]};
    for (int i = 0; i < 3; i++) {
        const int last = block->size[i] - 1;
        const ptrdiff_t stride = strides[turn->axis[i]];
        turned.step[i] = turn->is_reversed[i] ? -stride : stride;
        if (!turn->is_reversed[i])
            continue;
        turned.first += (size_t)(last * stride); /* last node of the file, first of the world */
        origin.at[turn->axis[i]] -= last * spacing.at[i];
    }
    turned.block.origin = to_vec3(&origin);
    turned.block.spacing = to_vec3(&turned_spacing);
    return turned;
}
