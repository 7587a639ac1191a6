// SPDX-License-Identifier: MIT
//
// What has changed around a tile, by the looks of 3x3 of them (gradient.comp): what their light
// has been multiplied with in common, and the most that this leaves unexplained in one of them. A
// sun that sinks is a gain, which history takes along (relight); the edge of a shadow is a change.
//
// A place is not looked at in every frame: a change is remembered for a while (change_hold), or
// what changes would pass for unchanged by turns.
#ifndef NEPH_REALTIME_CHANGE_AROUND_GLSL
#define NEPH_REALTIME_CHANGE_AROUND_GLSL

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

// One of the four looks (RT_LOOK_*) at a tile, from where the pass has it.
vec4 look_of(int target, ivec2 tile);

ivec2 tile_around(ivec2 tile, int i) { return tile + ivec2(i % 3, i / 3) - 1; }

struct Around {
    vec3 now, then; // sums
    bool is_known;  // one of 3x3 was a second look
    bool is_same;   // and all that were saw the same
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

// Three side by side, on their way together.
struct LookRow {
    vec4 now[3], then[3];
};

LookRow look_row(ivec2 middle, int target_now, int target_then)
{
    LookRow row;
    [[unroll]] for (int i = 0; i < 3; i++) {
        row.now[i] = look_of(target_now, middle + ivec2(i - 1, 0));
        row.then[i] = look_of(target_then, middle + ivec2(i - 1, 0));
    }
    return row;
}

// `frames` are between two looks; the change is `unknown` where none of 3x3 was a second one, and
// all of it where no look can tell. On a GPU looks are in shared memory, and better read again than
// kept in registers; and where all saw the same there is nothing to explain.
vec4 change_around(ivec2 tile, int target_now, int target_then, float frames, float unknown,
                   bool cannot_tell)
{
    vec4 now[9], then[9];
    Around around = Around(vec3(0.0), vec3(0.0), false, true);
    float unlike = 0.0;
    if (ON_GPU) {
        [[dont_unroll]] for (int y = -1; y <= 1; y++) {
            LookRow row = look_row(tile + ivec2(0, y), target_now, target_then);
            [[unroll]] for (int i = 0; i < 3; i++) {
                add(row.now[i], row.then[i], around);
                unlike = row.now[i].a > unlike ? row.now[i].a : unlike;
            }
        }
    } else {
        for (int i = 0; i < 9; i++) {
            now[i] = look_of(target_now, tile_around(tile, i));
            then[i] = look_of(target_then, tile_around(tile, i));
            add(now[i], then[i], around);
        }
    }
    float most = cannot_tell ? 1.0 : around.is_known ? 0.0 : unknown;
    if (ON_GPU && around.is_same)
        return vec4(vec3(1.0), unlike > most ? unlike : most);
    vec3 gain = gain_between(around.now, around.then);
    if (ON_GPU) {
        [[dont_unroll]] for (int y = -1; y <= 1; y++) {
            LookRow row = look_row(tile + ivec2(0, y), target_now, target_then);
            [[unroll]] for (int i = 0; i < 3; i++)
                most = most_unlike(row.now[i], row.then[i], gain, most);
        }
    } else {
        for (int i = 0; i < 9; i++)
            most = most_unlike(now[i], then[i], gain, most);
    }
    precise vec3 of_frame = 1.0 + (gain - 1.0) / frames;
    return vec4(of_frame, most);
}

vec4 change_of_medium(ivec2 tile)
{
    float before = fetch_tile(RT_CHANGE, tile).a; // on its way as early as can be
    return remembered(before, change_around(tile, RT_LOOK_NOW, RT_LOOK_THEN, 4.0, 1.0,
                                            of_thread(view.strobes_medium) != 0u));
}

vec4 change_behind(ivec2 tile)
{
    float before = fetch_tile(RT_CHANGE_BEHIND, tile).a;
    return remembered(before, change_around(tile, RT_LOOK_BEHIND_NOW, RT_LOOK_BEHIND_THEN,
                                            setting(RT_TAA_JITTER_LENGTH), 0.0,
                                            of_thread(view.strobes_behind) != 0u));
}

#endif
