// SPDX-License-Identifier: MIT
//
// What the stages of the picture chain share: the pictures they hand on, and the settings. A stage
// is one thread an element of what it writes, row by row, row 0 on top.
#ifndef NEPH_POST_GLSL
#define NEPH_POST_GLSL

#extension GL_EXT_scalar_block_layout : require

#include "halves.glsl"
#include "numbers.glsl"
#include "post_names.h"

layout(local_size_x = 64) in;

layout(push_constant) uniform PostRun {
    uint first_thread;
    uint level; // of the pyramid, which is written
} run;

// Matrices row by row.
layout(scalar, binding = 0) readonly buffer PostView {
    float settings[POST_SETTING_COUNT]; // as in the table of options; choices as whole numbers
    uint from_px[2], to_px[2];          // of the picture before and after this stage
    uint frame, seed;                   // of the grain
    float white_balance[9];             // Rec.709 to Rec.709
    float rec709_to_ap1[9], ap1_to_rec709[9], ap1_to_ap0[9], ap0_to_ap1[9],
        rec709_to_rec2020[9];
    float toe_match, straight_match, shoulder_match; // of the film curve: renderer/post/film.h
    float step_s;                   // since the frame before, for the eye
    float eye_ev;                   // what it was adapted to
    uint is_eye_open;               // 0: it has not seen a frame
    uint meter_units;               // of a bin's width in the histogram
    uint level_px[2 * (POST_LEVELS_MAX + 1)]; // sizes in the pyramid; level 0 is the picture
    uint level_at[POST_LEVELS_MAX + 1];       // its first texel
    uint level_count;                         // besides the picture
    uint upscale_filter;                      // of this upscale, POST_UPSCALE_*
    uint target;                              // what this stage writes, POST_FLOAT32 ..
} view;

layout(std430, binding = 1) readonly buffer From {
    vec4 from_texels[];
};

layout(std430, binding = 2) writeonly buffer To {
    vec4 to_texels[];
};

float setting(int index) { return view.settings[index]; }
int choice(int index) { return int(view.settings[index]); }
ivec2 from_size() { return ivec2(view.from_px[0], view.from_px[1]); }
ivec2 to_size() { return ivec2(view.to_px[0], view.to_px[1]); }
uint own_thread() { return run.first_thread + gl_GlobalInvocationID.x; }

// The pixel of this thread; false when there is none left.
bool own_pixel(out ivec2 pixel)
{
    int width = to_size().x, thread = int(own_thread());
    pixel = ivec2(thread % width, thread / width);
    return pixel.y < to_size().y;
}

// What a target of fewer bits keeps of a colour.
vec3 kept(vec3 colour)
{
    const float HALF_MAX = 65504.0, LAST_CODE = 1023.0;
    vec3 held = clamp(colour, -HALF_MAX, HALF_MAX);
    switch (view.target) {
    case POST_FLOAT16:
        return from_words(uvec2(packHalf2x16(held.xy), packHalf2x16(held.zz))).xyz;
    case POST_UNORM10:
        return floor(clamp(colour, 0.0, 1.0) * LAST_CODE + 0.5) / LAST_CODE;
    default:
        return colour;
    }
}

void put(ivec2 pixel, vec3 colour)
{
    to_texels[pixel.y * to_size().x + pixel.x] = vec4(kept(colour), 1.0);
}

// The picture goes on beyond its edges as it ends there.
vec3 fetch(ivec2 texel)
{
    ivec2 inside = clamp(texel, ivec2(0), from_size() - 1);
    return from_texels[inside.y * from_size().x + inside.x].rgb;
}

vec3 multiplied(float rows[9], vec3 v)
{
    return vec3(rows[0] * v.x + rows[1] * v.y + rows[2] * v.z,
                rows[3] * v.x + rows[4] * v.y + rows[5] * v.z,
                rows[6] * v.x + rows[7] * v.y + rows[8] * v.z);
}

#endif
