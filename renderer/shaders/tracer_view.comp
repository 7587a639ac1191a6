#version 450
// SPDX-License-Identifier: MIT
//
// The path tracer's first kernel per pixel: unscattered light, exact; the optical depth of each
// medium on the view ray; and empty queues. One thread per pixel.
#extension GL_GOOGLE_include_directive : require

#include "tracer_way.glsl"

layout(local_size_x = 64) in;

vec3 surface_sunlight(Hit hit, vec3 point_m)
{
    Surface surface = surface_at(hit.solid, point_m);
    float cosine = hit_cosine(hit.solid, surface.normal, to_sun());
    if (cosine <= 0.0 || surface.albedo == vec3(0.0) ||
        make_nonuniform(frame.sun_irradiance == vec3(0.0)) || !sees_sun(point_m, hit.solid))
        return vec3(0.0);
    vec3 arriving = colour_transmittance(scene_optical_depth(point_m, to_sun(), FAR_M));
    return surface.albedo / PI * cosine * arriving * frame.sun_irradiance;
}

vec3 surface_lamplight(Hit hit, vec3 point_m)
{
    Surface surface = surface_at(hit.solid, point_m);
    vec3 sum = vec3(0.0);
    for (uint i = 0; i < make_nonuniform(frame.lamp_count); i++) {
        vec3 way_m = frame.lamps[i].position_m - point_m;
        float distance_m = max(length(way_m), 1e-12);
        vec3 direction = way_m / distance_m;
        float cosine = hit_cosine(hit.solid, surface.normal, direction);
        if (cosine > 0.0 && sees_point(point_m, direction, distance_m, hit.solid))
            sum += lamp_irradiance(frame.lamps[i], direction,
                                   cosine / (PI * distance_m * distance_m)) *
                   colour_transmittance(scene_optical_depth(point_m, direction, distance_m));
    }
    return surface.albedo * sum;
}

vec3 surface_light(Hit hit, vec3 point_m)
{
    vec3 light = surface_sunlight(hit, point_m);
    return LAMPS ? light + surface_lamplight(hit, point_m) : light;
}

// Stores the optical depths of a view ray; returns their sum per channel.
vec3 find_depths(uint pixel, ViewRay ray, float length_m)
{
    vec3 sum = vec3(0.0);
    for (uint m = 0; m < media_count(); m++) {
        uint part = pixel * PARTS + m * LAYERS_MAX;
        float depth = 0.0;
        for (uint l = 0; l < medium_layer_count(m); l++) {
            depths[part + l] = has_way(m) ? way_walk(pixel, m, ray, length_m)
                                          : layer_optical_depth(m, l, ray.origin_m, ray.direction,
                                                                length_m);
            depth += depths[part + l];
        }
        sum += frame.media[m].extinction_color * depth;
    }
    return sum;
}

void main()
{
    uint thread = gl_GlobalInvocationID.x;
    if (thread == 0) {
        progress.items_done = 0;
        progress.collisions = 0;
        progress.lookups = 0;
        progress.closed_forms = 0;
    }
    if (thread >= run.pixel_count)
        return;
    next_items[thread] = 0;
    ViewRay ray = pixel_ray(run.first_pixel + thread);
    Hit hit = scene_hit(ray.origin_m, ray.direction);
    vec3 behind = vec3(0.0);
    if (!OPEN)
        behind = hit.solid == NO_SOLID ? frame.background
                                       : surface_light(hit, view_point_m(ray, hit.t_m));
    float eye_depth_m =
        hit.solid == NO_SOLID ? FAR_M : hit.t_m * dot(ray.direction, frame.camera_forward);
    vec3 arriving = colour_transmittance(find_depths(thread, ray, hit.t_m));
    uint pixel = run.first_pixel + thread - run.part_pixel;
    pixels[pixel].behind = vec4(behind, eye_depth_m);
    pixels[pixel].transmittance = vec4(arriving, hit.t_m);
    check_loops();
}
