#version 450
// SPDX-License-Identifier: MIT
//
// The solids of the scene as a screen has them: of the first one behind each pixel's centre its
// depth, normal, base colour, and the light that comes to it straight from the sun and from lamps.
#extension GL_GOOGLE_include_directive : require

#include "scene.glsl"
#include "screen.glsl"

vec3 in_camera_axes(vec3 v)
{
    return vec3(dot(v, frame.camera_right), dot(v, frame.camera_up), dot(v, frame.camera_forward));
}

vec3 sun_irradiance_on(vec3 point_m, vec3 normal, uint solid)
{
    float cosine = dot(normal, to_sun());
    bool is_lit = cosine > 0.0 && sees_sun(point_m, solid);
    return is_lit ? cosine * frame.sun_irradiance : vec3(0.0);
}

vec3 lamp_irradiance_on(Lamp lamp, vec3 point_m, vec3 normal, uint solid)
{
    vec3 way_m = lamp.position_m - point_m;
    float distance_m = length(way_m);
    vec3 direction = way_m / distance_m;
    float cosine = dot(normal, direction);
    if (!(cosine > 0.0) || !sees_point(point_m, direction, distance_m, solid))
        return vec3(0.0);
    return cosine * lamp_irradiance(lamp, direction, 1.0 / (distance_m * distance_m));
}

vec3 direct_irradiance_on(vec3 point_m, vec3 normal, uint solid)
{
    vec3 sum = sun_irradiance_on(point_m, normal, solid);
    for (uint i = 0; i < own(frame.lamp_count); i++)
        sum += lamp_irradiance_on(frame.lamps[i], point_m, normal, solid);
    return sum;
}

void main()
{
    ivec2 pixel;
    if (!own_pixel(pixel))
        return;
    ViewRay ray = camera_ray(uint(pixel.x), uint(pixel.y));
    Hit hit = scene_hit(ray.origin_m, ray.direction);
    if (hit.solid == NO_SOLID) {
        targets[SCREEN_DEPTH].words[texel_of(pixel)] = floatBitsToUint(FAR_M);
        store(SCREEN_NORMAL, pixel, vec4(0.0, 0.0, -1.0, 0.0));
        store(SCREEN_BASE, pixel, vec4(0.0));
        store(SCREEN_DIRECT, pixel, vec4(frame.background, 0.0));
        return;
    }
    vec3 point_m = view_point_m(ray, hit.t_m);
    vec3 normal = solid_normal(solids[hit.solid], point_m);
    normal = dot(normal, ray.direction) > 0.0 ? -normal : normal; // seen from within
    vec3 base = solids[hit.solid].albedo.rgb;
    float depth_m = hit.t_m * dot(ray.direction, frame.camera_forward);
    targets[SCREEN_DEPTH].words[texel_of(pixel)] = floatBitsToUint(depth_m);
    store(SCREEN_NORMAL, pixel, vec4(in_camera_axes(normal), 0.0));
    store(SCREEN_BASE, pixel, vec4(base, 0.0));
    vec3 irradiance = direct_irradiance_on(point_m, normal, hit.solid);
    store(SCREEN_DIRECT, pixel, vec4(base / PI * irradiance, 1.0));
}
