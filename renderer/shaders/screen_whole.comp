#version 450
// SPDX-License-Identifier: MIT
//
// From one pixel of each cell to all: between the four cells around a pixel, as far as they show
// its surface (J. Kopf et al., "Joint Bilateral Upsampling", SIGGRAPH 2007).
#extension GL_GOOGLE_include_directive : require

#include "screen.glsl"

const uint OF_AO = 0u, OF_GI = 1u, OF_SSR = 2u; // turns

bool has_signal(ivec2 pixel)
{
    return run.turn == OF_AO ? !is_sky(depth_at_m(pixel)) : has_light(pixel, run.turn == OF_SSR);
}

// 1 on the plane of a surface; off it, facing the same way, a little, for where nothing is on it.
float likeness(vec3 point_m, vec3 normal, ivec2 at)
{
    const float LEAST = 1e-4;
    float facing = clamp(dot(normal_at(at), normal), 0.0, 1.0);
    float squared = facing * facing, fourth = squared * squared;
    return max(LEAST, same_surface(point_m, normal, at)) * fourth * fourth;
}

// Where no cell around has the signal or faces that way: nothing stands near, and no rays were
// cast.
vec4 unknown(ivec2 pixel)
{
    float open = view.open_at != SCREEN_NONE ? load(int(view.open_at), pixel).x : 1.0;
    return run.turn == OF_AO ? vec4(1.0) : vec4(0.0, 0.0, 0.0, open);
}

vec4 whole(ivec2 pixel)
{
    vec3 point_m = surface_m(pixel), normal = normal_at(pixel);
    vec2 place = vec2(pixel - own_px()) / float(run.cell_px);
    ivec2 corner = ivec2(floor(place));
    vec2 way = place - vec2(corner);
    vec4 sum = vec4(0.0);
    float weights = 0.0;
    for (int i = 0; i < 4; i++) {
        ivec2 side = ivec2(i & 1, i >> 1), cell = corner + side, at = pixel_in(cell);
        vec2 share = mix(1.0 - way, way, equal(side, ivec2(1)));
        if (!is_cell(cell) || !has_signal(at))
            continue;
        float weight = share.x * share.y * likeness(point_m, normal, at);
        sum += weight * load(int(run.from), cell);
        weights += weight;
    }
    return weights > 0.0 ? sum / weights : unknown(pixel);
}

void main()
{
    ivec2 pixel;
    if (!own_pixel(pixel))
        return;
    vec4 none = vec4(run.turn == OF_AO ? 1.0 : 0.0);
    store(int(run.to), pixel, has_signal(pixel) ? whole(pixel) : none);
}
