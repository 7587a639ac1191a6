#version 450
// SPDX-License-Identifier: MIT
//
// Filter of ambient occlusion: the mean over the neighbours in the same plane. It removes the noise
// that repeats over 4x4 pixels.
#extension GL_GOOGLE_include_directive : require

#include "screen.glsl"

// Window weights. A square with an even side contains all 16 rotations of the noise equally often;
// a square with side 5 gets that property by half weights at its rim.
float window(ivec2 offset, int radius)
{
    vec2 rim = vec2(equal(abs(offset), ivec2(radius)));
    return (1.0 - 0.5 * rim.x) * (1.0 - 0.5 * rim.y);
}

void main()
{
    ivec2 cell;
    if (!get_thread_cell(cell))
        return;
    ivec2 pixel = pixel_in(cell);
    float depth_m = depth_at_m(pixel);
    vec2 sums = vec2(load(SCREEN_OPEN, cell).x, 1.0);
    int radius = choice(SCREEN_AO_BLUR_PX), side = 2 * radius + 1;
    if (!is_sky(depth_m)) {
        vec3 point_m = place_m(pixel_centre_px(pixel), depth_m), normal = normal_at(pixel);
        sums = vec2(0.0);
        for (int i = 0; i < side * side; i++) {
            ivec2 offset = ivec2(i % side, i / side) - radius;
            ivec2 other = cell + offset, neighbour = pixel_in(other);
            if (!is_cell(other) || is_sky(depth_at_m(neighbour)))
                continue;
            float weight = window(offset, radius) * same_surface(point_m, normal, neighbour);
            sums += weight * vec2(load(SCREEN_OPEN, other).x, 1.0);
        }
    }
    store(SCREEN_OPEN_SMOOTH, cell, vec4(sums.x / sums.y));
}
