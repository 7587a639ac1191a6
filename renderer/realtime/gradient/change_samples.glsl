// SPDX-License-Identifier: MIT
//
// The change around a tile from the gradient samples of 3x3 tiles (gradient.comp): the common gain
// of their light, and the largest difference that it does not explain. A setting sun is a gain, by
// which history is multiplied (relight); the edge of a shadow is a residue.
//
// With samples s0 (earlier) and s1 (now) of 3x3 tiles and n frames between them:
//
//     gain      g = clamp(sum s1 / sum s0, 1 - relight, 1 + relight)     one for all nine tiles
//     residue   r = max over the tiles of |s1 - g s0| / max(s1, g s0)    0 .. 1
//     per frame 1 + (g - 1) / n, the nth root of g to first order
//
// A place is not sampled in every frame, so a residue decays over several frames (change_hold):
// it would else be 0 in the frames between two samples.
#ifndef NEPH_REALTIME_CHANGE_SAMPLES_GLSL
#define NEPH_REALTIME_CHANGE_SAMPLES_GLSL

#include "gradient_samples.glsl"

// Below this a change is set to 0: the least of normal halves.
const float CHANGE_LEAST = 6.103515625e-5;

// The larger of this frame's change and the decayed change of the frame before.
vec4 hold_change(float before, vec4 change)
{
    precise float held = setting(RT_CHANGE_HOLD) * before;
    bool is_known = has_past && !is_cut && held >= CHANGE_LEAST && held < 1.0;
    if (is_known && held > change.a)
        change.a = held;
    return change;
}

// One of the four gradient samples (RT_LOOK_*) of a tile; each shader defines its own access.
vec4 load_sample(int target, ivec2 tile);

struct Around {
    vec3 now, then; // sums
    bool is_known;  // at least one of 3x3 tiles has an earlier sample
    bool is_same;   // all these tiles have the same light in both samples
};

// Adds the pair of one tile to the sums, if its earlier sample exists.
void add(vec4 now, vec4 then, inout Around around)
{
    precise vec3 sum_now = around.now + now.rgb, sum_then = around.then + then.rgb;
    if (then.a > 0.0)
        around = Around(sum_now, sum_then, true, around.is_same && now.rgb == then.rgb);
}

// The larger of `most` and the residue of one tile.
float find_larger_residue(vec4 now, vec4 then, vec3 gain, float most)
{
    float residue = then.a > 0.0 ? residue_between(now.rgb, then.rgb, gain) : 0.0;
    residue = now.a > residue ? now.a : residue;
    return residue > most ? residue : most;
}

// RGB: the gain per frame, from the gain over `frames` frames; A: the residue.
vec4 scale_to_frame(vec3 gain, float frames, float most)
{
    precise vec3 gain_of_frame = 1.0 + (gain - 1.0) / frames;
    return vec4(gain_of_frame, most);
}

// The change around a tile from the samples of two targets: RGB: gain per frame, A: the largest
// residue. `frames`: number of frames between two samples of a place. The change is `unknown` where
// none of 3x3 has an earlier sample, and 1 where samples cannot find it (`cannot_tell`).
vec4 change_around(ivec2 tile, int target_now, int target_then, float frames, float unknown,
                   bool cannot_tell);

vec4 compute_medium_change(ivec2 tile)
{
    float before = fetch_tile(RT_CHANGE, tile).a; // fetched as early as possible
    return hold_change(before, change_around(tile, RT_SAMPLE_NOW, RT_SAMPLE_THEN, 4.0, 1.0,
                                            force_nonuniform(view.strobes_medium) != 0u));
}

vec4 change_behind(ivec2 tile)
{
    float before = fetch_tile(RT_CHANGE_BEHIND, tile).a;
    return hold_change(before, change_around(tile, RT_SAMPLE_BEHIND_NOW, RT_SAMPLE_BEHIND_THEN,
                                            setting(RT_TAA_JITTER_LENGTH), 0.0,
                                            force_nonuniform(view.strobes_behind) != 0u));
}

#endif
