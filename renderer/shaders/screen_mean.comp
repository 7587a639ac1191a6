#version 450
// SPDX-License-Identifier: MIT
//
// Temporal accumulation of indirect light: the running mean of the reprojected history and this
// frame. All frames have the same weight until the history's maximum length is reached; then the
// mean becomes exponential.
#extension GL_GOOGLE_include_directive : require

#include "screen.glsl"

bool is_gi() { return run.turn == 0u; }

// The history, interpolated bilinearly over the four cells of the frame before that show the same
// plane. `count`: number of frames in it, 0 without history.
vec4 history(uint solid, vec3 point_m, vec3 normal, out float count)
{
    const float OFF_PLANE = 0.01, SAME_NORMAL = 0.9; // relative to the depth; a cosine
    vec3 was_m = place_before_m(solid, point_m), was_normal = direction_before(solid, normal);
    count = 0.0;
    if (view.has_before == 0u || !(was_m.z > 0.0))
        return vec4(0.0);
    int counts = is_gi() ? SCREEN_GI_COUNT_BEFORE : SCREEN_SSR_COUNT_BEFORE;
    vec2 place = (project_to_pixel(was_m) - 0.5 - vec2(before_px())) / float(run.cell_px);
    ivec2 corner = ivec2(floor(place));
    vec2 way = place - vec2(corner);
    vec4 sum = vec4(0.0);
    float weights = 0.0;
    for (int i = 0; i < 4; i++) {
        ivec2 side = ivec2(i & 1, i >> 1), cell = corner + side, at = pixel_before_in(cell);
        vec2 share = mix(1.0 - way, way, equal(side, ivec2(1)));
        if (!is_cell(cell) || is_sky(depth_before_m(at)))
            continue;
        vec3 offset_m = place_m(pixel_centre_px(at), depth_before_m(at)) - was_m;
        vec3 its_normal = normalize(load(SCREEN_NORMAL_BEFORE, at).xyz);
        if (abs(dot(offset_m, was_normal)) > OFF_PLANE * was_m.z ||
            dot(its_normal, was_normal) < SAME_NORMAL)
            continue;
        sum += share.x * share.y * load(int(run.before), cell);
        count += share.x * share.y * load_one(counts, cell);
        weights += share.x * share.y;
    }
    count = weights > 1e-3 ? floor(count / weights + 0.5) : 0.0;
    return weights > 1e-3 ? sum / weights : vec4(0.0);
}

void main()
{
    ivec2 cell;
    if (!get_thread_cell(cell))
        return;
    ivec2 pixel = pixel_in(cell);
    float depth_m = depth_at_m(pixel), count = 0.0;
    vec4 mean = vec4(0.0);
    if (!is_sky(depth_m) && !is_left_out(pixel, !is_gi())) {
        mean = history(solid_at(pixel), place_m(pixel_centre_px(pixel), depth_m), normal_at(pixel),
                       count);
        count = min(count, setting(is_gi() ? SCREEN_GI_HISTORY : SCREEN_SSR_HISTORY)) + 1.0;
        mean = mix(mean, load(int(run.from), cell), 1.0 / count);
    }
    store(int(run.to), cell, mean);
    store_one(is_gi() ? SCREEN_GI_COUNT : SCREEN_SSR_COUNT, cell, count);
}
