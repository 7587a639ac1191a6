// SPDX-License-Identifier: MIT
//
// Direct light of sun and lamps at a surface. Visibility is one bit per light: bit 0 is the sun,
// bit i + 1 is lamp i. The G-buffer pass finds it with rays; other passes read it from a target.
// Positions are in world axes, relative to the camera.
#ifndef NEPH_SCREEN_LIGHTS_GLSL
#define NEPH_SCREEN_LIGHTS_GLSL

#include "scene.glsl"
#include "screen.glsl"
#include "surface.glsl"

struct Place {
    vec3 point_m, normal, to_eye;
    uint solid;
    vec3 base;
    float roughness, metalness;
};

// A light as seen from a point: direction, distance, and irradiance on a plane across the
// direction.
struct Beam {
    vec3 to_light;
    float distance_m;
    vec3 irradiance;
};

uint light_count() { return make_nonuniform(frame.lamp_count) + 1u; }

Beam beam_at(uint light, vec3 point_m)
{
    if (light == 0u)
        return Beam(to_sun(), FAR_M, frame.sun_irradiance);
    Lamp lamp = frame.lamps[light - 1u];
    vec3 way_m = lamp.position_m - point_m;
    float distance_m = length(way_m);
    vec3 direction = way_m / distance_m;
    float inverse_square = 1.0 / (distance_m * distance_m);
    return Beam(direction, distance_m, lamp_irradiance(lamp, direction, inverse_square));
}

bool is_lit(Place place, Beam beam)
{
    if (!(dot(place.normal, beam.to_light) > 0.0))
        return false;
    return beam.distance_m < FAR_M
               ? sees_point(place.point_m, beam.to_light, beam.distance_m, place.solid)
               : sees_sun(place.point_m, place.solid);
}

uint lights_seen(Place place)
{
    uint seen = 0u;
    for (uint i = 0; i < light_count(); i++)
        seen |= is_lit(place, beam_at(i, place.point_m)) ? 1u << i : 0u;
    return seen;
}

vec3 reflected(Place place, Beam beam)
{
    float metal = metal_reflectance(place.roughness * place.roughness, place.normal, beam.to_light,
                                    place.to_eye);
    return place.base * mix(1.0 / PI, metal, place.metalness) *
           max(0.0, dot(place.normal, beam.to_light)) * beam.irradiance;
}

// Radiance towards the eye, from the lights in the bits `seen`.
vec3 direct_light(Place place, uint seen)
{
    vec3 sum = vec3(0.0);
    for (uint i = 0; i < light_count(); i++)
        if ((seen >> i & 1u) != 0u)
            sum += reflected(place, beam_at(i, place.point_m));
    return sum;
}

vec3 in_world_axes(vec3 v)
{
    return v.x * frame.camera_right + v.y * frame.camera_up + v.z * frame.camera_forward;
}

// Direct light that a pixel's surface reflects along a ray that hits it. Diffuse light does not
// depend on the direction, so the stored radiance towards the camera is used; it is also used for
// metal with the setting ray_metal=camera.
vec3 direct_into(vec3 direction, ivec2 pixel)
{
    vec4 base = load(SCREEN_BASE, pixel);
    if (!(base.w > 0.0) || choice(SCREEN_RAY_METAL) == SCREEN_METAL_CAMERA)
        return load(SCREEN_DIRECT, pixel).rgb;
    Place place;
    place.point_m = in_world_axes(surface_m(pixel));
    place.normal = in_world_axes(normal_at(pixel));
    place.to_eye = -in_world_axes(direction);
    place.base = base.rgb;
    place.roughness = load(SCREEN_NORMAL, pixel).w;
    place.metalness = base.w;
    return direct_light(place, targets[SCREEN_MARKS].words[texel_index(pixel)]);
}

#endif
