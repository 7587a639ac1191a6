#version 450
// SPDX-License-Identifier: MIT
//
// Spatial filter of indirect light: one iteration of the edge-avoiding a-trous wavelet transform
// (H. Dammertz et al., "Edge-Avoiding A-Trous Wavelet Transform for fast Global Illumination
// Filtering", HPG 2010). Iteration k = run.turn filters 5x5 cells at a spacing of 2^k, with weights
// for cells of the same plane and orientation:
//
//   k = 0   . . x x x x x . .        k = 1   x . x . x . x . x
//
// Reflections are filtered at most over the width of the metal's reflection lobe.
#extension GL_GOOGLE_include_directive : require

#include "screen.glsl"

bool is_gi() { return run.from < SCREEN_LIT; }

// Filter radius of a metal's reflection [px]: half the width of its lobe, for a reflected surface
// at the same distance from the metal as the eye.
float spread_px(float roughness)
{
    float alpha = roughness * roughness;
    return 0.25 * alpha * float(size_px().y) / half_size().y;
}

void main()
{
    const float B3[3] = float[3](0.375, 0.25, 0.0625);
    const float STEEPEST = 0.1, NORMALS = 32.0;
    ivec2 cell;
    if (!get_thread_cell(cell))
        return;
    ivec2 pixel = pixel_in(cell);
    vec4 own = load(int(run.from), cell);
    float depth_m = depth_at_m(pixel);
    vec4 own_normal = load(SCREEN_NORMAL, pixel);
    float reach_px = is_gi() ? 1e6 : spread_px(own_normal.w);
    vec3 point_m = place_m(pixel_centre_px(pixel), depth_m), normal = normalize(own_normal.xyz);
    vec4 sum = vec4(0.0);
    float weights = 0.0;
    bool is_off = is_sky(depth_m) || is_left_out(pixel, !is_gi());
    for (int i = 0; i < 25 && !is_off; i++) {
        ivec2 offset = ivec2(i % 5, i / 5) - 2;
        ivec2 other = cell + (offset << int(run.turn)), at = pixel_in(other);
        if (!is_cell(other) || is_sky(depth_at_m(at)))
            continue;
        vec4 its_normal = load(SCREEN_NORMAL, at);
        vec3 way_m = surface_m(at) - point_m;
        float distance_m = length(way_m), off = abs(dot(way_m, normal));
        float plane = distance_m > 0.0 ? clamp(1.0 - off / (STEEPEST * distance_m), 0.0, 1.0) : 1.0;
        float facing = clamp(dot(normalize(its_normal.xyz), normal), 0.0, 1.0);
        float far = length(vec2(at - pixel)) / reach_px;
        float weight = B3[abs(offset.x)] * B3[abs(offset.y)] * plane * pow(facing, NORMALS);
        weight *= offset == ivec2(0) ? 1.0 : exp(-min(80.0, 0.5 * far * far));
        weight *= is_gi() || load(SCREEN_BASE, at).w > 0.0 ? 1.0 : 0.0;
        sum += weight * load(int(run.from), other);
        weights += weight;
    }
    store(int(run.to), cell, weights > 0.0 ? sum / weights : own);
}
