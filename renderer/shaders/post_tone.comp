#version 450
// SPDX-License-Identifier: MIT
//
// Tone mapping: exposure, vignette, tone curve, display encoding and film grain. Curve and encoding
// are computed (tone.glsl) or read from the colour table (post_lut.comp).
#extension GL_GOOGLE_include_directive : require

#include "eye.glsl"
#include "random.glsl"
#include "tone.glsl"

const vec3 BRIGHTEST = vec3(65504.0);

layout(std430, binding = 3) readonly buffer Table {
    vec4 table[];
};

// Natural vignetting: cos^4 of the angle between the lens axis and the pixel's ray. At the image's
// corner the tangent of the angle is the setting `vignette`, for every aspect ratio.
float vignette(ivec2 pixel)
{
    vec2 size = vec2(to_size());
    vec2 place = (2.0 * (vec2(pixel) + 0.5) - size) / length(size) * setting(POST_VIGNETTE);
    float cosine_squared = 1.0 / (1.0 + dot(place, place));
    return cosine_squared * cosine_squared;
}

// Trilinear lookup in the colour table.
vec3 sample_colour_table(vec3 colour)
{
    const int LAST = POST_LUT_SIDE - 1;
    vec3 place = colour_to_table(colour) * float(LAST);
    ivec3 low = min(ivec3(place), ivec3(LAST - 1));
    vec3 way = place - vec3(low);
    vec3 sum = vec3(0.0);
    for (int corner = 0; corner < 8; corner++) {
        ivec3 step = ivec3(corner, corner >> 1, corner >> 2) & 1;
        vec3 weight = mix(1.0 - way, way, equal(step, ivec3(1)));
        ivec3 node = low + step;
        sum += weight.x * weight.y * weight.z *
               table[(node.z * POST_LUT_SIDE + node.y) * POST_LUT_SIDE + node.x].rgb;
    }
    return sum;
}

void main()
{
    ivec2 pixel;
    if (!get_thread_pixel(pixel))
        return;
    // The bound keeps products of several values in the curves finite; the largest half is far
    // beyond every white point.
    float exposure = exp2(exposure_ev()) * vignette(pixel);
    vec3 exposed = min(exposure * fetch(pixel), BRIGHTEST);
    vec3 colour = choice(POST_LUT) != 0 ? sample_colour_table(exposed) : develop_colour(exposed);
    float noise = uniform_from(pcg4d(uvec4(pixel, view.frame, view.seed)).xyz).x;
    colour += setting(POST_GRAIN) / 255.0 * (noise - 0.5);
    put(pixel, clamp(colour, 0.0, 1.0));
}
