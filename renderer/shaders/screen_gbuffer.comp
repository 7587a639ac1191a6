#version 450
// SPDX-License-Identifier: MIT
//
// The solids of the scene as a screen has them: of the first one behind each pixel's centre its
// depth, normal, base colour, roughness and metalness, and the light that comes to it straight from
// the sun and from lamps.
#extension GL_GOOGLE_include_directive : require

#include "scene.glsl"
#include "screen.glsl"
#include "surface.glsl"

vec3 in_camera_axes(vec3 v)
{
    return vec3(dot(v, frame.camera_right), dot(v, frame.camera_up), dot(v, frame.camera_forward));
}

// --- what is there ------------------------------------------------------------------------------

struct Place {
    vec3 point_m, normal, to_eye;
    uint solid;
    vec3 base;
    float roughness, metalness;
};

// Where a box has its pattern's coordinates: the two axes of the face, from its middle.
vec2 face_place(Solid box, vec3 point_m, float cell_m)
{
    vec3 own_m = is_turned(box) ? own_point(box, point_m) : point_m;
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

Place place_of(ViewRay ray, Hit hit)
{
    Solid solid = solids[hit.solid];
    ScreenSurface surface = surfaces[hit.solid];
    Place place;
    place.point_m = view_point_m(ray, hit.t_m);
    place.normal = solid_normal(solid, place.point_m);
    if (dot(place.normal, ray.direction) > 0.0) // seen from within
        place.normal = -place.normal;
    place.to_eye = -ray.direction;
    place.solid = hit.solid;
    place.base = base_colour(solid, surface, place.point_m);
    place.roughness = surface.roughness;
    place.metalness = surface.metalness;
    return place;
}

// --- light that comes straight ------------------------------------------------------------------

// Radiance by light from a direction, of an irradiance across it.
vec3 reflected(Place place, vec3 direction, vec3 irradiance)
{
    float metal = metal_reflectance(place.roughness * place.roughness, place.normal, direction,
                                    place.to_eye);
    return place.base * mix(1.0 / PI, metal, place.metalness) * dot(place.normal, direction) *
           irradiance;
}

vec3 from_sun(Place place)
{
    bool is_lit = dot(place.normal, to_sun()) > 0.0 && sees_sun(place.point_m, place.solid);
    return is_lit ? reflected(place, to_sun(), frame.sun_irradiance) : vec3(0.0);
}

vec3 from_lamp(Place place, Lamp lamp)
{
    vec3 way_m = lamp.position_m - place.point_m;
    float distance_m = length(way_m);
    vec3 direction = way_m / distance_m;
    if (!(dot(place.normal, direction) > 0.0) ||
        !sees_point(place.point_m, direction, distance_m, place.solid))
        return vec3(0.0);
    float inverse_square = 1.0 / (distance_m * distance_m);
    return reflected(place, direction, lamp_irradiance(lamp, direction, inverse_square));
}

vec3 direct_light(Place place)
{
    vec3 sum = from_sun(place);
    for (uint i = 0; i < own(frame.lamp_count); i++)
        sum += from_lamp(place, frame.lamps[i]);
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
        store_one(SCREEN_DEPTH, pixel, FAR_M);
        store(SCREEN_NORMAL, pixel, vec4(0.0, 0.0, -1.0, 0.0));
        store(SCREEN_BASE, pixel, vec4(0.0));
        store(SCREEN_DIRECT, pixel, vec4(frame.background, 0.0));
        return;
    }
    Place place = place_of(ray, hit);
    store_one(SCREEN_DEPTH, pixel, hit.t_m * dot(ray.direction, frame.camera_forward));
    store(SCREEN_NORMAL, pixel, vec4(in_camera_axes(place.normal), place.roughness));
    store(SCREEN_BASE, pixel, vec4(place.base, place.metalness));
    store(SCREEN_DIRECT, pixel, vec4(direct_light(place), 1.0));
}
