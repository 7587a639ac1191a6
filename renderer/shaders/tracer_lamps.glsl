// SPDX-License-Identifier: MIT
//
// How paths look for lamps, as truth/lamp_draw.h has it: a place on each segment by 1/d^2
// (equiangular), for surfaces a lamp by its irradiance, and of directions a few by 1 / sin of the
// angle from a lamp. So no estimate is without a finite variance, however near a path comes.
#ifndef NEPH_TRACER_LAMPS_GLSL
#define NEPH_TRACER_LAMPS_GLSL

#include "tracer.glsl"

// The part of directions that are drawn towards lamps.
const float LAMP_DIRECTIONS = 1.0 / 8.0;

// A ray that passes a lamp nearer than this part of its distance passes it this far off.
const float LAMP_NEAREST = 1e-6;

struct LampPlace {
    uint lamp;
    float t_m;
    float density_per_m; // of this place and lamp; 0: there is nothing to look for
};

struct LampPass {
    float foot_m, height_m;
    float from, angle; // of the segment's start, and of all of it, seen from the lamp
};

LampPass lamp_pass(uint lamp, vec3 origin_m, vec3 direction, float t0_m, float t1_m)
{
    vec3 way_m = frame.lamps[lamp].position_m - origin_m;
    LampPass pass;
    pass.foot_m = dot(way_m, direction);
    pass.height_m = max(length(way_m - pass.foot_m * direction),
                        LAMP_NEAREST * length(way_m) + 1e-12);
    pass.from = atan((t0_m - pass.foot_m) / pass.height_m);
    pass.angle = max(atan((t1_m - pass.foot_m) / pass.height_m) - pass.from, 0.0);
    return pass;
}

// What a lamp would bring into the segment through clear air.
float lamp_weight(uint lamp, LampPass pass)
{
    return dot(frame.lamps[lamp].intensity, vec3(1.0)) * pass.angle / pass.height_m;
}

// The stretch of a ray that may scatter.
bool clip_to_media(vec3 origin_m, vec3 direction, float end_m, out float t0_m, out float t1_m)
{
    t0_m = end_m;
    t1_m = 0.0;
    for (uint m = 0; m < media_count(); m++) {
        float near_m = 0.0, far_m = end_m;
        if (clip_medium(m, origin_m, direction, near_m, far_m)) {
            t0_m = min(t0_m, near_m);
            t1_m = max(t1_m, far_m);
        }
    }
    return t0_m < t1_m;
}

LampPlace draw_lamp_place(vec3 origin_m, vec3 direction, float end_m, vec2 u)
{
    LampPlace place = LampPlace(0, 0.0, 0.0);
    float t0_m, t1_m, sum = 0.0;
    if (!clip_to_media(origin_m, direction, end_m, t0_m, t1_m))
        return place;
    for (uint i = 0; i < own(frame.lamp_count); i++)
        sum += lamp_weight(i, lamp_pass(i, origin_m, direction, t0_m, t1_m));
    float left = u.x * sum;
    LampPass chosen;
    float weight = 0.0;
    for (uint i = 0; i < own(frame.lamp_count); i++) {
        LampPass pass = lamp_pass(i, origin_m, direction, t0_m, t1_m);
        float own_weight = lamp_weight(i, pass);
        if (own_weight <= 0.0 || (weight > 0.0 && left < 0.0))
            continue;
        place.lamp = i;
        chosen = pass;
        weight = own_weight;
        left -= own_weight;
    }
    if (weight <= 0.0)
        return place;
    float s_m = chosen.height_m * tan(chosen.from + u.y * chosen.angle);
    place.t_m = clamp(chosen.foot_m + s_m, t0_m, t1_m);
    place.density_per_m = weight / sum * chosen.height_m /
                          (chosen.angle * (chosen.height_m * chosen.height_m + s_m * s_m));
    return place;
}

// What media scatter at a place from one direction into the one that `direction` comes from, per
// metre [1/(m sr)].
vec3 lamp_scattering(vec3 point_m, vec3 direction, vec3 to_lamp)
{
    vec3 sum = vec3(0.0);
    for (uint m = 0; m < media_count(); m++) {
        Medium medium = frame.media[m];
        sum += medium.albedo * medium.extinction_color *
               (medium_extinction_per_m(m, point_m) *
                phase_per_sr(medium.phase_kind, medium.g, direction, to_lamp));
    }
    return sum;
}

struct LampLook {
    vec3 light; // what comes from a place, were nothing in between, over its density
    vec3 direction;
    float distance_m;
};

// From a place on a segment that comes along `direction`; black where a solid is in between.
LampLook look_for_lamp(LampPlace place, vec3 point_m, vec3 direction)
{
    Lamp lamp = frame.lamps[place.lamp];
    vec3 way_m = lamp.position_m - point_m;
    LampLook look;
    look.distance_m = max(length(way_m), 1e-12);
    look.direction = way_m / look.distance_m;
    look.light = lamp_irradiance(lamp, look.direction,
                                 1.0 / (look.distance_m * look.distance_m * place.density_per_m)) *
                 lamp_scattering(point_m, direction, look.direction);
    if (SOLIDS && look.light != vec3(0.0) &&
        !sees_point(point_m, look.direction, look.distance_m, NO_SOLID))
        look.light = vec3(0.0);
    return look;
}

// For a surface: a lamp by its irradiance without cosine and obstacles.
uint pick_lamp(vec3 point_m, float u, out float probability)
{
    float sum = 0.0, weight = 0.0;
    uint picked = 0;
    for (uint i = 0; i < own(frame.lamp_count); i++) {
        vec3 way_m = frame.lamps[i].position_m - point_m;
        sum += dot(lamp_irradiance(frame.lamps[i], normalize(way_m), 1.0 / dot(way_m, way_m)),
                   vec3(1.0));
    }
    float left = u * sum;
    for (uint i = 0; i < own(frame.lamp_count); i++) {
        vec3 way_m = frame.lamps[i].position_m - point_m;
        float own_weight = dot(lamp_irradiance(frame.lamps[i], normalize(way_m),
                                               1.0 / dot(way_m, way_m)),
                               vec3(1.0));
        if (own_weight <= 0.0 || (weight > 0.0 && left < 0.0))
            continue;
        picked = i;
        weight = own_weight;
        left -= own_weight;
    }
    probability = sum > 0.0 ? weight / sum : 0.0;
    return picked;
}

vec3 draw_lamp_direction(vec3 point_m, vec3 u)
{
    uint lamp = min(uint(u.x * float(frame.lamp_count)), frame.lamp_count - 1u);
    float half_sine = sin(0.5 * PI * u.y);
    return direction_about(normalize(frame.lamps[lamp].position_m - point_m),
                           2.0 * half_sine * half_sine, 2.0 * PI * u.z);
}

float lamp_direction_per_sr(vec3 point_m, vec3 direction)
{
    float sum_per_sr = 0.0;
    for (uint i = 0; i < own(frame.lamp_count); i++) {
        vec3 towards = normalize(frame.lamps[i].position_m - point_m);
        sum_per_sr += 1.0 / (2.0 * PI * PI * max(length(cross(towards, direction)), LAMP_NEAREST));
    }
    return sum_per_sr / float(frame.lamp_count);
}

#endif
