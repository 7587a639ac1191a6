// SPDX-License-Identifier: MIT
//
// Light of lamps (scenes/lights.h) in a march: scattered once, and reflected by solids. What a step
// gets of 1/d^2 is its exact mean over the step, (theta1 - theta0) / (h length), with the angles
// and the height h of the lamp's triangle over the step: a step may pass a lamp closely and neither
// misses nor overrates it. All else is taken where the bisector of the triangle meets the step:
// of parts of it where it is long or seen under a large angle, by march_lamp_steps.glsl in a march
// and by lamp_light() in a froxel, which is short.
#ifndef NEPH_MARCH_LAMPS_GLSL
#define NEPH_MARCH_LAMPS_GLSL

#include "march_light.glsl"

// The radius of the ball around a lamp whose light who includes this takes out; see LampPass.
#ifndef LAMP_BALL_M
#define LAMP_BALL_M(lamp) 0.0
#endif

vec3 lamp_optical_depth(vec3 point_m, vec3 direction, float distance_m)
{
    vec3 optical_depth = vec3(0.0);
    if (SUN == EXACT)
        optical_depth = exact_optical_depth(point_m, direction, distance_m);
    if (SUN_MARCHED != 0u)
        optical_depth += marched_optical_depth(SUN_MARCHED, point_m, direction, distance_m,
                                               own(frame.sun_steps));
    return optical_depth;
}

// A ray as a lamp sees it. Within a ball around the lamp, where there is one, light is left out,
// more of it the nearer it is, all at the lamp (froxels.glsl: it is found a pixel at a time).
struct LampPass {
    float foot_m, height_m;
    float ball_m; // 0: none
};

LampPass lamp_pass(vec3 lamp_m, ViewRay ray, float ball_m)
{
    vec3 way_m = lamp_m - ray.origin_m;
    float foot_m = dot(way_m, ray.direction);
    // A ray through the lamp would have no bound; this far it passes by in single precision anyway.
    return LampPass(foot_m, max(length(way_m - foot_m * ray.direction),
                                1e-6 * length(way_m) + 1e-12), ball_m);
}

// The angle between two places on the ray, by their distances behind the foot and their own.
float lamp_angle_over(LampPass pass, float s0_m, float s1_m, float length_m)
{
    return atan(pass.height_m * length_m, pass.height_m * pass.height_m + s0_m * s1_m);
}

float lamp_angle(LampPass pass, float s0_m, float s1_m)
{
    return lamp_angle_over(pass, s0_m, s1_m, s1_m - s0_m);
}

// 1/d^2 over a stretch, its integral: all of it.
float lamp_whole(LampPass pass, float s0_m, float s1_m)
{
    return lamp_angle(pass, s0_m, s1_m) / pass.height_m;
}

// 1/d^2 that the ball leaves, which takes (1 - d^2 / R^2)^2 of it: 2 / R^2 - d^2 / R^4 within.
float lamp_outside(LampPass pass, float s0_m, float s1_m)
{
    float square = pass.ball_m * pass.ball_m, rest = square - pass.height_m * pass.height_m;
    if (rest <= 0.0)
        return lamp_whole(pass, s0_m, s1_m);
    float half_m = sqrt(rest);
    float in0_m = clamp(s0_m, -half_m, half_m), in1_m = clamp(s1_m, -half_m, half_m);
    float length_m = in1_m - in0_m, height = pass.height_m / pass.ball_m;
    float cubes = (in0_m * in0_m + in0_m * in1_m + in1_m * in1_m) / (3.0 * square);
    return lamp_whole(pass, min(s0_m, in0_m), min(s1_m, in0_m)) +
           lamp_whole(pass, max(s0_m, in1_m), max(s1_m, in1_m)) +
           length_m * ((2.0 - height * height - cubes) / square);
}

vec3 scattered_from(vec3 direction)
{
    vec3 sum = vec3(0.0);
    [[unroll]] for (uint m = 0; m < media_count(); m++)
        sum += scattering_per_m[m] * phase_per_sr(own(frame.media[m].phase_kind),
                                                  frame.media[m].g, view_direction, direction);
    return sum;
}

// Where the bisector of the lamp's triangle over two places meets the ray, behind the foot.
float lamp_bisector_m(LampPass pass, float s0_m, float s1_m)
{
    float d0_m = length(vec2(pass.height_m, s0_m)), d1_m = length(vec2(pass.height_m, s1_m));
    return s0_m + (s1_m - s0_m) * (d0_m / (d0_m + d1_m));
}

// Light of a lamp that the last mixture scatters between two places, of a mean of 1/d^2.
vec3 lamp_scattered_per_m(Lamp lamp, LampPass pass, ViewRay ray, float s0_m, float s1_m,
                          float inverse_square)
{
    vec3 point_m = view_point_m(ray, pass.foot_m + lamp_bisector_m(pass, s0_m, s1_m));
    vec3 way_m = lamp.position_m - point_m;
    float distance_m = max(length(way_m), 1e-12);
    vec3 direction = way_m / distance_m;
    vec3 light = lamp_irradiance(lamp, direction, inverse_square) * scattered_from(direction);
    if (light == vec3(0.0) || !sees_point(point_m, direction, distance_m, NO_SOLID))
        return vec3(0.0);
    return light * fraction_through(lamp_optical_depth(point_m, direction, distance_m));
}

// The angle that a part of a step spans, about.
const float LAMP_PART = PI / 8.0;
const uint LAMP_PARTS_MAX = NEPH_GPU_LAMP_PARTS;

// What a froxel sends to its near end, of a source that is constant in each part of it.
vec3 lamp_light(Lamp lamp, LampPass pass, vec3 extinction_per_m, ViewRay ray, float start_m,
                float length_m, vec3 step_depth)
{
    float s0_m = start_m - pass.foot_m, end_m = s0_m + length_m;
    float angle = lamp_angle(pass, s0_m, end_m), first = atan(s0_m / pass.height_m);
    uint parts = min(1u + uint(angle / LAMP_PART), LAMP_PARTS_MAX);
    vec3 sum = vec3(0.0), depth = vec3(0.0);
    for (uint i = 1; i <= parts; i++) {
        float turned = first + angle * float(i) / float(parts);
        float s1_m = i == parts ? end_m : clamp(pass.height_m * tan(turned), s0_m, end_m);
        if (s1_m <= s0_m)
            continue;
        vec3 part_depth = step_depth * ((s1_m - s0_m) / length_m);
        float inverse_square =
            pass.ball_m > 0.0 ? lamp_outside(pass, s0_m, s1_m) / (s1_m - s0_m)
                              : lamp_angle(pass, s0_m, s1_m) / (pass.height_m * (s1_m - s0_m));
        sum += lamp_scattered_per_m(lamp, pass, ray, s0_m, s1_m, inverse_square) *
               fraction_through(depth) * fraction_lost(part_depth);
        depth += part_depth;
        s0_m = s1_m;
    }
    return sum / max(extinction_per_m, LEAST);
}

// That of all lamps, of a froxel whose mixture is the last that was looked up.
vec3 lamps_light(Mixture mixture, ViewRay ray, float start_m, float length_m, vec3 step_depth)
{
    vec3 sum = vec3(0.0);
    if (mixture.extinction_per_m == vec3(0.0))
        return sum;
    for (uint i = 0; i < own(frame.lamp_count); i++) {
        LampPass pass = lamp_pass(frame.lamps[i].position_m, ray, LAMP_BALL_M(frame.lamps[i]));
        sum += lamp_light(frame.lamps[i], pass, mixture.extinction_per_m, ray, start_m, length_m,
                          step_depth);
    }
    return sum;
}

// What a surface of albedo 1 reflects.
vec3 lamps_reflected(vec3 point_m, vec3 normal, uint on_solid)
{
    vec3 sum = vec3(0.0);
    for (uint i = 0; i < own(frame.lamp_count); i++) {
        Lamp lamp = frame.lamps[i];
        vec3 way_m = lamp.position_m - point_m;
        float distance_m = max(length(way_m), 1e-12);
        vec3 direction = way_m / distance_m;
        float cosine = dot(normal, direction);
        vec3 light = lamp_irradiance(lamp, direction, 1.0 / (distance_m * distance_m));
        if (cosine > 0.0 && light != vec3(0.0) &&
            sees_point(point_m, direction, distance_m, on_solid))
            sum += light * (cosine / PI) *
                   fraction_through(lamp_optical_depth(point_m, direction, distance_m));
    }
    return sum;
}

#endif
