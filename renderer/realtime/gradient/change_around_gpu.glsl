// SPDX-License-Identifier: MIT
//
// The change around a tile (change_samples.glsl) for a GPU that has the samples in shared memory:
// they are loaded again instead of kept in registers, three neighbours at a time. Where all samples
// are unchanged the search for a residue is skipped.
#ifndef NEPH_REALTIME_CHANGE_AROUND_GPU_GLSL
#define NEPH_REALTIME_CHANGE_AROUND_GPU_GLSL

#include "change_samples.glsl"

struct SampleRow {
    vec4 now[3], then[3];
};

SampleRow load_row(ivec2 middle, int target_now, int target_then)
{
    SampleRow row;
    [[unroll]] for (int i = 0; i < 3; i++) {
        row.now[i] = load_sample(target_now, middle + ivec2(i - 1, 0));
        row.then[i] = load_sample(target_then, middle + ivec2(i - 1, 0));
    }
    return row;
}

vec4 change_around(ivec2 tile, int target_now, int target_then, float frames, float unknown,
                   bool cannot_tell)
{
    Around around = Around(vec3(0.0), vec3(0.0), false, true);
    float residue = 0.0;
    [[dont_unroll]] for (int y = -1; y <= 1; y++) {
        SampleRow row = load_row(tile + ivec2(0, y), target_now, target_then);
        [[unroll]] for (int i = 0; i < 3; i++) {
            add(row.now[i], row.then[i], around);
            residue = row.now[i].a > residue ? row.now[i].a : residue;
        }
    }
    float most = cannot_tell ? 1.0 : around.is_known ? 0.0 : unknown;
    if (around.is_same)
        return vec4(vec3(1.0), residue > most ? residue : most);
    vec3 gain = gain_between(around.now, around.then);
    [[dont_unroll]] for (int y = -1; y <= 1; y++) {
        SampleRow row = load_row(tile + ivec2(0, y), target_now, target_then);
        [[unroll]] for (int i = 0; i < 3; i++)
            most = find_larger_residue(row.now[i], row.then[i], gain, most);
    }
    return scale_to_frame(gain, frames, most);
}

#endif
