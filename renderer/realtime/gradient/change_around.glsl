// SPDX-License-Identifier: MIT
//
// The change around a tile (change_samples.glsl) from nine pairs of samples, each loaded once.
#ifndef NEPH_REALTIME_CHANGE_AROUND_GLSL
#define NEPH_REALTIME_CHANGE_AROUND_GLSL

#include "change_samples.glsl"

vec4 change_around(ivec2 tile, int target_now, int target_then, float frames, float unknown,
                   bool cannot_tell)
{
    vec4 now[9], then[9];
    Around around = Around(vec3(0.0), vec3(0.0), false, true);
    for (int i = 0; i < 9; i++) {
        ivec2 sampled = tile + ivec2(i % 3, i / 3) - 1;
        now[i] = load_sample(target_now, sampled);
        then[i] = load_sample(target_then, sampled);
        add(now[i], then[i], around);
    }
    float most = cannot_tell ? 1.0 : around.is_known ? 0.0 : unknown;
    vec3 gain = gain_between(around.now, around.then);
    for (int i = 0; i < 9; i++)
        most = find_larger_residue(now[i], then[i], gain, most);
    return scale_to_frame(gain, frames, most);
}

#endif
