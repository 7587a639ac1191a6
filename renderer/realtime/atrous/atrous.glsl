// SPDX-License-Identifier: MIT
//
// One step of an edge-avoiding a-trous filter of the volume at half resolution, as in C. Schied et
// al., "Spatiotemporal Variance-Guided Filtering", HPG 2017: 5x5 texels, ATROUS_STEP apart,
// weighted by a B-spline, by depth, and by the difference of luma relative to its deviation:
//
//     w_i = h_x h_y exp(-|l_i - l| / (4 sigma)) exp(-|z_i - z| / (0.1 z))
//     h   = 1/16  1/4  3/8  1/4  1/16
//     out = sum w_i v_i / sum w_i
//
// with luma l, its deviation sigma and eye depth z. Steps of 1, 2 and 4 texels follow each other,
// so the filter reaches 2 + 4 + 8 texels with three times 25 taps:
//
//     ATROUS_STEP 1     . . x x x x x . .
//     ATROUS_STEP 2     x . x . x . x . x
//
// Differences from SVGF:
// - The deviation is computed in the 3x3 around a texel of the step's input, from the plane through
//   them: there are no moments over time here.
// - Depth is weighted by its relative difference, without its slope.
// - There are no normals.
// - The history for the next frame is not filtered.
//
// A file that includes this one defines the target to read, INPUT, and the target to write, OUTPUT.
#ifndef RT_ATROUS_GLSL
#define RT_ATROUS_GLSL

#include "renderer/realtime/shared/pass.glsl"

const float SPLINE[3] = {0.375, 0.25, 0.0625};
// Differences that reduce a weight to 1 / e: luma in standard deviations of the 3x3 around, depth
// relative to the depth.
const float LUMA_SIGMAS = 4.0, DEPTH_PART = 0.1;

float compute_luma(vec4 volume) { return volume.r + 2.0 * volume.g + volume.b; }

bool is_there(vec4 volume, ivec2 half_pixel)
{
    return fetch_half(RT_HISTORY_STATE, half_pixel).x > 0.0 && is_sound(volume);
}

// Deviation of the lumas of 3x3 neighbouring texels from the plane through them (least squares),
// because a slope is no noise; where some of the nine are invalid, from the mean of the others.
// With offsets -1, 0, 1 the slope along x is sum l x / sum x^2 = sum l x / 6. The plane has three
// parameters, so the variance of nine lumas has 9 - 3 = 6 degrees of freedom.
float deviation_at(ivec2 half_pixel)
{
    float sum = 0.0, squares = 0.0, count = 0.0;
    vec2 slope = vec2(0.0);
    float lumas[9];
    for (int i = 0; i < 9; i++) {
        ivec2 way = ivec2(i % 3, i / 3) - 1;
        vec4 volume = fetch_half(INPUT, half_pixel + way);
        bool counts = is_there(volume, half_pixel + way);
        lumas[i] = counts ? compute_luma(volume) : -1.0;
        sum += counts ? lumas[i] : 0.0;
        slope += lumas[i] * vec2(way) / 6.0;
        count += counts ? 1.0 : 0.0;
    }
    bool is_plane = count == 9.0;
    for (int i = 0; i < 9; i++) {
        vec2 way = vec2(i % 3, i / 3) - 1.0;
        float off = lumas[i] - sum / count - (is_plane ? dot(slope, way) : 0.0);
        squares += lumas[i] >= 0.0 ? off * off : 0.0;
    }
    return count > 0.0 ? sqrt(squares / (is_plane ? 6.0 : count)) : 0.0;
}

// exp(-difference / unit), and 1 for 0 / 0.
float falling(float difference, float unit)
{
    return difference > 0.0 ? exp(-difference / max(unit, 1e-20)) : 1.0;
}

void main()
{
    ivec2 half_pixel;
    if (!find_element(half_size(), half_pixel))
        return;
    vec4 center = fetch_half(INPUT, half_pixel);
    if (!is_there(center, half_pixel)) {
        put_half(OUTPUT, half_pixel, center);
        return;
    }
    float depth_m = fetch_half(RT_HALF_DEPTH, half_pixel).x, luma = compute_luma(center);
    float luma_unit = LUMA_SIGMAS * deviation_at(half_pixel);
    float depth_unit = DEPTH_PART * depth_m;
    vec4 sum = vec4(0.0);
    float weights = 0.0;
    for (int i = 0; i < 25; i++) {
        ivec2 way = ivec2(i % 5, i / 5) - 2, other = half_pixel + ATROUS_STEP * way;
        vec4 volume = fetch_half(INPUT, other);
        if (!is_there(volume, other))
            continue;
        float weight = SPLINE[abs(way.x)] * SPLINE[abs(way.y)] *
                       falling(abs(compute_luma(volume) - luma), luma_unit) *
                       falling(abs(fetch_half(RT_HALF_DEPTH, other).x - depth_m), depth_unit);
        sum += weight * volume;
        weights += weight;
    }
    put_half(OUTPUT, half_pixel, sum / weights);
}

#endif
