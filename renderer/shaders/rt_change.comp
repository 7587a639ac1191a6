#version 450
// SPDX-License-Identifier: MIT
//
// What has changed around a tile, by the looks of 3x3 of them (rt_gradient.comp): what their light
// has been multiplied with in common, and the most that this leaves unexplained in one of them. A
// sun that sinks is a gain, which history takes along (relight); the edge of a shadow is a change.
//
// A place is not looked at in every frame: a change is remembered for a while (change_hold), or
// what changes would pass for unchanged by turns.
#extension GL_GOOGLE_include_directive : require

#include "realtime_looks.glsl"
#include "realtime_pass.glsl"

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

// `frames` are between two looks; the change is `unknown` where none of 3x3 was a second one, and
// all of it where no look can tell.
vec4 change_around(ivec2 tile, int target_now, int target_then, float frames, float unknown,
                   bool cannot_tell)
{
    vec4 now[9], then[9];
    precise vec3 sum_now = vec3(0.0), sum_then = vec3(0.0);
    bool is_known = false;
    for (int i = 0; i < 9; i++) {
        ivec2 other = tile + ivec2(i % 3, i / 3) - 1;
        now[i] = fetch_tile(target_now, other);
        then[i] = fetch_tile(target_then, other);
        if (then[i].a > 0.0) {
            sum_now += now[i].rgb;
            sum_then += then[i].rgb;
            is_known = true;
        }
    }
    vec3 gain = gain_between(sum_now, sum_then);
    float most = cannot_tell ? 1.0 : is_known ? 0.0 : unknown;
    for (int i = 0; i < 9; i++) {
        float residue = then[i].a > 0.0 ? residue_between(now[i].rgb, then[i].rgb, gain) : 0.0;
        residue = now[i].a > residue ? now[i].a : residue;
        most = residue > most ? residue : most;
    }
    precise vec3 of_frame = 1.0 + (gain - 1.0) / frames;
    return vec4(of_frame, most);
}

void main()
{
    ivec2 tile;
    if (!own_element(tile_count(), tile))
        return;
    vec4 of_medium = change_around(tile, RT_LOOK_NOW, RT_LOOK_THEN, 4.0, 1.0,
                                   view.strobes_medium != 0u);
    vec4 behind = change_around(tile, RT_LOOK_BEHIND_NOW, RT_LOOK_BEHIND_THEN,
                                setting(RT_TAA_JITTER_LENGTH), 0.0,
                                view.strobes_behind != 0u);
    put_tile(RT_CHANGE, tile, remembered(RT_CHANGE, tile, of_medium));
    put_tile(RT_CHANGE_BEHIND, tile, remembered(RT_CHANGE_BEHIND, tile, behind));
}
