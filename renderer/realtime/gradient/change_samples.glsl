// SPDX-License-Identifier: MIT
//
// What has changed around a tile, by the gradient samples of 3x3 tiles (gradient.comp): the common
// gain of their light, and the most that it leaves unexplained in one of them. A sun that sinks is
// a gain, which history takes along (relight); the edge of a shadow is a change.
//
// A place is not sampled in every frame: a change is remembered for a while (change_hold), or what
// changes would pass for unchanged by turns.
#ifndef NEPH_REALTIME_CHANGE_SAMPLES_GLSL
#define NEPH_REALTIME_CHANGE_SAMPLES_GLSL

#include "gradient_samples.glsl"

// Below it a change is forgotten: the least of normal halves.
const float CHANGE_LEAST = 6.103515625e-5;

// With what is left of that of the frame before.
vec4 remembered(float before, vec4 change)
{
    precise float held = setting(RT_CHANGE_HOLD) * before;
    bool is_known = has_past && !is_cut && held >= CHANGE_LEAST && held < 1.0;
    if (is_known && held > change.a)
        change.a = held;
    return change;
}

// One of the four gradient samples (RT_LOOK_*) of a tile, from wherever a shader has it.
vec4 load_sample(int target, ivec2 tile);

struct Around {
    vec3 now, then; // sums
    bool is_known;  // one of 3x3 was sampled a second time
    bool is_same;   // and the light of all that were is the same
};

void add(vec4 now, vec4 then, inout Around around)
{
    precise vec3 sum_now = around.now + now.rgb, sum_then = around.then + then.rgb;
    if (then.a > 0.0)
        around = Around(sum_now, sum_then, true, around.is_same && now.rgb == then.rgb);
}

// With what the gain leaves unexplained in one of them.
float most_unlike(vec4 now, vec4 then, vec3 gain, float most)
{
    float residue = then.a > 0.0 ? residue_between(now.rgb, then.rgb, gain) : 0.0;
    residue = now.a > residue ? now.a : residue;
    return residue > most ? residue : most;
}

// The change of one frame.
vec4 of_frame(vec3 gain, float frames, float most)
{
    precise vec3 gain_of_frame = 1.0 + (gain - 1.0) / frames;
    return vec4(gain_of_frame, most);
}

// What has changed around a tile by the samples of two targets: the gain of a frame, and the most
// that this leaves unexplained. `frames` are between two samples of a place. The change is
// `unknown` where none of 3x3 was sampled twice, and all of it where no sample can tell.
vec4 change_around(ivec2 tile, int target_now, int target_then, float frames, float unknown,
                   bool cannot_tell);

vec4 change_of_medium(ivec2 tile)
{
    float before = fetch_tile(RT_CHANGE, tile).a; // on its way as early as can be
    return remembered(before, change_around(tile, RT_LOOK_NOW, RT_LOOK_THEN, 4.0, 1.0,
                                            force_nonuniform(view.strobes_medium) != 0u));
}

vec4 change_behind(ivec2 tile)
{
    float before = fetch_tile(RT_CHANGE_BEHIND, tile).a;
    return remembered(before, change_around(tile, RT_LOOK_BEHIND_NOW, RT_LOOK_BEHIND_THEN,
                                            setting(RT_TAA_JITTER_LENGTH), 0.0,
                                            force_nonuniform(view.strobes_behind) != 0u));
}

#endif
