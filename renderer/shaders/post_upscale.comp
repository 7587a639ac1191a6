#version 450
// SPDX-License-Identifier: MIT
//
// From the size that was rendered to that of the display: the filters of Unreal Engine 4.26. A
// texel's centre lies at a whole number + 1/2; between centres the unit of length is a texel.
//
//   nearest       the texel that the pixel's centre lies in
//   bilinear      four texels
//   directional   two samples along the edge, less a quarter of what four around have more
//   catmull_rom   4x4 texels; Unreal leaves out the corners
//   lanczos       6x6 texels in 5x5 samples, without the corners of these: 13
//   gaussian      6x6 texels with variance 1/2, less their Laplacian (unsharp mask)
//   smoothstep    bilinear, at places drawn to the texels' centres
//
// The gaussian's Laplacian does not sum to 0 over so few texels: it changes a constant by up to
// 0.25 % (softness 0.3). What lies between four texels is their bilinear sample, in float32: a
// texture unit's weights have 8 bits. Filters with negative weights may overshoot; what is below 0
// becomes 0.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require

#include "post.glsl"

vec3 bilinear(vec2 place)
{
    vec2 corner = floor(place - 0.5);
    vec2 way = place - 0.5 - corner;
    ivec2 at = ivec2(corner);
    return mix(mix(fetch(at), fetch(at + ivec2(1, 0)), way.x),
               mix(fetch(at + ivec2(0, 1)), fetch(at + ivec2(1, 1)), way.x), way.y);
}

float luma(vec3 c) { return 0.299 * c.r + 0.587 * c.g + 0.114 * c.b; }

// The edge runs across the gradient of luma: where that is 0 the direction is, too.
vec3 directional(vec2 place)
{
    const float UNSHARP = 0.25, LEAST = 6e-8, REACH = 0.125;
    vec3 upper_left = bilinear(place + vec2(-0.5, -0.5));
    vec3 upper_right = bilinear(place + vec2(0.5, -0.5));
    vec3 lower_left = bilinear(place + vec2(-0.5, 0.5));
    vec3 lower_right = bilinear(place + vec2(0.5, 0.5));
    float rising = luma(lower_left) - luma(upper_right);
    float falling = luma(lower_right) - luma(upper_left);
    vec2 along = vec2(rising + falling, rising - falling);
    along *= REACH * inversesqrt(dot(along, along) + LEAST);
    vec3 mean = 0.25 * (upper_left + upper_right + lower_left + lower_right);
    vec3 edge = 0.5 * (bilinear(place - along) + bilinear(place + along));
    return edge + UNSHARP * (edge - mean);
}

// Weights of the four texels around, the place `x` of the way from the second to the third.
vec4 catmull_rom_weights(float x)
{
    return vec4(x * (-0.5 + x * (1.0 - 0.5 * x)), 1.0 + x * x * (-2.5 + 1.5 * x),
                x * (0.5 + x * (2.0 - 1.5 * x)), x * x * (-0.5 + 0.5 * x));
}

vec3 catmull_rom(vec2 place)
{
    vec2 corner = floor(place - 0.5);
    vec2 way = place - 0.5 - corner;
    vec4 columns = catmull_rom_weights(way.x), rows = catmull_rom_weights(way.y);
    vec3 sum = vec3(0.0);
    float total = 0.0;
    [[unroll]] for (int i = 0; i < 16; i++) {
        bool is_corner = (i % 4 == 0 || i % 4 == 3) && (i / 4 == 0 || i / 4 == 3);
        float weight = is_corner ? 0.0 : columns[i % 4] * rows[i / 4];
        sum += weight * fetch(ivec2(corner) + ivec2(i % 4, i / 4) - 1);
        total += weight;
    }
    return sum / total;
}

// sinc(x) sinc(x / 3), less a factor 3 / pi^2: it has no number at 0 but by its limit.
float lanczos(float x)
{
    bool is_centre = choice(POST_LANCZOS_GUARD) != 0 && abs(x) < 1e-4;
    return is_centre ? PI * PI / 3.0 : sin(PI * x) * sin(PI / 3.0 * x) / (x * x);
}

// Weights of five samples, of which the third is two texels', and where that one lies between them.
void lanczos_weights(float x, out float weights[5], out float middle)
{
    float second = lanczos(x), third = lanczos(x - 1.0);
    weights[0] = lanczos(x + 2.0);
    weights[1] = lanczos(x + 1.0);
    weights[2] = second + third;
    weights[3] = lanczos(x - 2.0);
    weights[4] = lanczos(x - 3.0);
    middle = third / weights[2];
}

vec3 lanczos_13(vec2 place)
{
    vec2 centre = floor(place - 0.5) + 0.5;
    float columns[5], rows[5], column, row;
    lanczos_weights(place.x - centre.x, columns, column);
    lanczos_weights(place.y - centre.y, rows, row);
    float xs[5] = float[5](-2.0, -1.0, column, 2.0, 3.0);
    float ys[5] = float[5](-2.0, -1.0, row, 2.0, 3.0);
    vec3 sum = vec3(0.0);
    float total = 0.0;
    [[unroll]] for (int i = 0; i < 25; i++) {
        if (abs(i % 5 - 2) + abs(i / 5 - 2) > 2)
            continue;
        float weight = columns[i % 5] * rows[i / 5];
        sum += weight * bilinear(centre + vec2(xs[i % 5], ys[i / 5]));
        total += weight;
    }
    return sum / total;
}

// The picture is sharpened by as much as it is enlarged.
vec3 gaussian(vec2 place)
{
    const float RADIUS_SQUARED = 9.0;
    vec2 centre = floor(place) + 0.5;
    vec3 sum = vec3(0.0), laplacian = vec3(0.0);
    float total = 0.0;
    [[unroll]] for (int i = 0; i < 36; i++) {
        vec2 offset = vec2(i % 6, i / 6) - 2.5;
        if (dot(offset, offset) > RADIUS_SQUARED)
            continue;
        vec2 texel = centre + offset;
        vec2 from = place - texel;
        float distance_squared = 2.0 * dot(from, from); // in units of the variance
        vec3 weighted = exp(-0.5 * distance_squared) * bilinear(texel);
        sum += weighted;
        total += exp(-0.5 * distance_squared);
        laplacian += (distance_squared - 2.0) * weighted;
    }
    vec2 ratio = vec2(from_size()) / vec2(to_size());
    return (sum - setting(POST_UPSCALE_SOFTNESS) * (1.0 - ratio.x * ratio.y) * laplacian) / total;
}

vec3 smooth_steps(vec2 place)
{
    vec2 corner = floor(place - 0.5);
    vec2 way = place - 0.5 - corner;
    return bilinear(corner + way * way * (3.0 - 2.0 * way) + 0.5);
}

vec3 filtered(vec2 place)
{
    switch (choice(POST_UPSCALE)) {
    case POST_UPSCALE_NEAREST:
        return fetch(ivec2(floor(place)));
    case POST_UPSCALE_DIRECTIONAL:
        return directional(place);
    case POST_UPSCALE_CATMULL_ROM:
        return catmull_rom(place);
    case POST_UPSCALE_LANCZOS:
        return lanczos_13(place);
    case POST_UPSCALE_GAUSSIAN:
        return gaussian(place);
    case POST_UPSCALE_SMOOTHSTEP:
        return smooth_steps(place);
    default:
        return bilinear(place);
    }
}

void main()
{
    ivec2 pixel;
    if (!own_pixel(pixel))
        return;
    vec2 place = (vec2(pixel) + 0.5) * vec2(from_size()) / vec2(to_size());
    vec3 colour = filtered(place);
    put(pixel, mix(colour, vec3(0.0), lessThan(colour, vec3(0.0)))); // max() could hide a NaN
}
