// SPDX-License-Identifier: MIT
//
// Common part of the post-processing stages (renderer/post/): their images, settings and target
// formats. Each thread of a stage writes one element of its output, in row order, row 0 at the top.
#ifndef NEPH_POST_GLSL
#define NEPH_POST_GLSL

#extension GL_EXT_scalar_block_layout : require

#include "halves.glsl"
#include "numbers.glsl"
#include "post_names.h"

layout(local_size_x = 64) in;

layout(push_constant) uniform PostRun {
    uint first_thread;
    uint level; // level of the bloom pyramid that is written
} run;

// Parameters of a frame and a stage. Matrices are stored by rows.
layout(scalar, binding = 0) readonly buffer PostView {
    // In the order of the table of options; choices as whole numbers.
    float settings[POST_SETTING_COUNT];
    uint from_px[2], to_px[2];          // size of the input and of the output image
    uint frame, seed;                   // for the grain
    float white_balance[9];             // Rec.709 to Rec.709
    float rec709_to_ap1[9], ap1_to_rec709[9], ap1_to_ap0[9], ap0_to_ap1[9],
        rec709_to_rec2020[9];
    // Constants of the film curve: renderer/post/film.h.
    float toe_match, straight_match, shoulder_match;
    float step_s;                   // time since the frame before, for the eye's adaptation
    float eye_ev;                   // adapted luminance of the frame before, log2
    uint is_eye_open;               // 0: no frame before
    uint meter_units;               // integer units per bin width in the histogram
    uint level_px[2 * (POST_LEVELS_MAX + 1)]; // sizes of the bloom pyramid; level 0 is the image
    uint level_at[POST_LEVELS_MAX + 1];       // first texel of each level
    uint level_count;                         // without the image
    uint upscale_filter;                      // filter of this upscale, POST_UPSCALE_*
    uint target;                              // format that this stage writes, POST_FLOAT32 ..
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
uint get_thread_index() { return run.first_thread + gl_GlobalInvocationID.x; }

// The pixel of this thread; false when the thread has none.
bool get_thread_pixel(out ivec2 pixel)
{
    int width = to_size().x, thread = int(get_thread_index());
    pixel = ivec2(thread % width, thread / width);
    return pixel.y < to_size().y;
}

// A colour after rounding to the target's format.
vec3 quantize_to_target(vec3 colour)
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
    to_texels[pixel.y * to_size().x + pixel.x] = vec4(quantize_to_target(colour), 1.0);
}

// Reads a texel; beyond the edges the nearest texel of the image.
vec3 fetch(ivec2 texel)
{
    ivec2 inside = clamp(texel, ivec2(0), from_size() - 1);
    return from_texels[inside.y * from_size().x + inside.x].rgb;
}

vec3 multiply_rows(float rows[9], vec3 v)
{
    return vec3(rows[0] * v.x + rows[1] * v.y + rows[2] * v.z,
                rows[3] * v.x + rows[4] * v.y + rows[5] * v.z,
                rows[6] * v.x + rows[7] * v.y + rows[8] * v.z);
}

#endif
