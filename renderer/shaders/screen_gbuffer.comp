#version 450
// SPDX-License-Identifier: MIT
//
// G-buffer: for the first solid behind each pixel's centre its depth, normal, base colour,
// roughness and metalness, and the direct light from sun and lamps. It also stores which lights the
// point sees.
#extension GL_GOOGLE_include_directive : require

#include "screen_lights.glsl"

vec3 in_camera_axes(vec3 v)
{
    return vec3(dot(v, frame.camera_right), dot(v, frame.camera_up), dot(v, frame.camera_forward));
}

// Coordinates of a box's pattern: the two axes of the face, from its centre.
vec2 face_place(Solid box, vec3 point_m, float cell_m)
{
    vec3 own_m = is_turned(box) ? to_box_axes(box, point_m) : point_m;
    vec3 across = abs(box_normal(box, own_m));
    vec3 place = (own_m - 0.5 * (box.low_m + box.high_m)) / cell_m;
    return vec2(across.x > 0.5 ? place.y : place.x, across.z > 0.5 ? place.y : place.z);
}

vec3 base_colour(Solid solid, ScreenSurface surface, vec3 point_m)
{
    if (!(surface.cell_m > 0.0))
        return solid.albedo.rgb;
    vec2 place = face_place(solid, point_m, surface.cell_m);
    float value = surface.is_noise != 0u ? noise_at(surface.seed, place) : checker_at(place);
    return mix(solid.albedo.rgb, surface.other, value);
}

Place make_surface_place(ViewRay ray, Hit hit)
{
    Solid solid = solids[hit.solid];
    ScreenSurface surface = surfaces[hit.solid];
    Place place;
    place.point_m = view_point_m(ray, hit.t_m);
    place.normal = solid_normal(solid, place.point_m);
    if (dot(place.normal, ray.direction) > 0.0) // seen from inside
        place.normal = -place.normal;
    place.to_eye = -ray.direction;
    place.solid = hit.solid;
    place.base = base_colour(solid, surface, place.point_m);
    place.roughness = surface.roughness;
    place.metalness = surface.metalness;
    return place;
}

void main()
{
    ivec2 pixel;
    if (!get_thread_pixel(pixel))
        return;
    ViewRay ray = camera_ray(uint(pixel.x), uint(pixel.y));
    Hit hit = scene_hit(ray.origin_m, ray.direction);
    if (hit.solid == NO_SOLID) {
        store_one(SCREEN_DEPTH, pixel, FAR_M);
        targets[SCREEN_MARKS].words[texel_index(pixel)] = 0u;
        store(SCREEN_NORMAL, pixel, vec4(0.0, 0.0, -1.0, 0.0));
        store(SCREEN_BASE, pixel, vec4(0.0));
        store(SCREEN_DIRECT, pixel, vec4(frame.background, 0.0));
        return;
    }
    Place place = make_surface_place(ray, hit);
    store_one(SCREEN_DEPTH, pixel, hit.t_m * dot(ray.direction, frame.camera_forward));
    store(SCREEN_NORMAL, pixel, vec4(in_camera_axes(place.normal), place.roughness));
    store(SCREEN_BASE, pixel, vec4(place.base, place.metalness));
    uint seen = lights_seen(place);
    targets[SCREEN_MARKS].words[texel_index(pixel)] = seen | hit.solid << SCREEN_LIGHT_BITS;
    store(SCREEN_DIRECT, pixel, vec4(direct_light(place, seen), 1.0));
}
