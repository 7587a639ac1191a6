// SPDX-License-Identifier: MIT
//
// What has changed around a tile, by the looks of 3x3 of them (rt_gradient.comp): what their light
// has been multiplied with in common, and the most that this leaves unexplained in one of them. A
// sun that sinks is a gain, which history takes along (relight); the edge of a shadow is a change.
//
// A place is not looked at in every frame: a change is remembered for a while (change_hold), or
// what changes would pass for unchanged by turns.
#ifndef NEPH_REALTIME_CHANGE_AROUND_GLSL
#define NEPH_REALTIME_CHANGE_AROUND_GLSL

#include "realtime_looks.glsl"

// Below it a change is forgotten: the least of normal halves.
const float CHANGE_LEAST = 6.103515625e-5;

// With what is left of that of the frame before.
vec4 remembered(int target, ivec2 tile, vec4 change)
{
    precise float held = setting(RT_CHANGE_HOLD) * fetch_tile(target, tile).a;
    bool is_known = has_past && !is_cut && held >= CHANGE_LEAST && held < 1.0;
    if (is_known && held > change.a)
        change.a = held;
    return change;
}

// One of the four looks (RT_LOOK_*) at a tile, from where the pass has it.
vec4 look_of(int target, ivec2 tile);

ivec2 tile_around(ivec2 tile, int i) { return tile + ivec2(i % 3, i / 3) - 1; }

struct Around {
    vec3 now, then; // sums
    bool is_known;  // one of 3x3 was a second look
};

void add(vec4 now, vec4 then, inout Around around)
{
    precise vec3 sum_now = around.now + now.rgb, sum_then = around.then + then.rgb;
    if (then.a > 0.0)
        around = Around(sum_now, sum_then, true);
}

// With what the gain leaves unexplained in one of them.
float most_unlike(vec4 now, vec4 then, vec3 gain, float most)
{
    float residue = then.a > 0.0 ? residue_between(now.rgb, then.rgb, gain) : 0.0;
    residue = now.a > residue ? now.a : residue;
    return residue > most ? residue : most;
}

// `frames` are between two looks; the change is `unknown` where none of 3x3 was a second one, and
// all of it where no look can tell. On a GPU looks are in shared memory, and better read again than
// kept in registers.
vec4 change_around(ivec2 tile, int target_now, int target_then, float frames, float unknown,
                   bool cannot_tell)
{
    vec4 now[9], then[9];
    Around around = Around(vec3(0.0), vec3(0.0), false);
    if (ON_GPU) {
        [[dont_unroll]] for (int i = 0; i < 9; i++)
            add(look_of(target_now, tile_around(tile, i)),
                look_of(target_then, tile_around(tile, i)), around);
    } else {
        for (int i = 0; i < 9; i++) {
            now[i] = look_of(target_now, tile_around(tile, i));
            then[i] = look_of(target_then, tile_around(tile, i));
            add(now[i], then[i], around);
        }
    }
    vec3 gain = gain_between(around.now, around.then);
    float most = cannot_tell ? 1.0 : around.is_known ? 0.0 : unknown;
    if (ON_GPU) {
        [[dont_unroll]] for (int i = 0; i < 9; i++)
            most = most_unlike(look_of(target_now, tile_around(tile, i)),
                               look_of(target_then, tile_around(tile, i)), gain, most);
    } else {
        for (int i = 0; i < 9; i++)
            most = most_unlike(now[i], then[i], gain, most);
    }
    precise vec3 of_frame = 1.0 + (gain - 1.0) / frames;
    return vec4(of_frame, most);
}

vec4 change_of_medium(ivec2 tile)
{
    return remembered(RT_CHANGE, tile,
                      change_around(tile, RT_LOOK_NOW, RT_LOOK_THEN, 4.0, 1.0,
                                    view.strobes_medium != 0u));
}

vec4 change_behind(ivec2 tile)
{
    return remembered(RT_CHANGE_BEHIND, tile,
                      change_around(tile, RT_LOOK_BEHIND_NOW, RT_LOOK_BEHIND_THEN,
                                    setting(RT_TAA_JITTER_LENGTH), 0.0,
                                    view.strobes_behind != 0u));
}

#endif
