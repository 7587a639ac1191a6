// SPDX-License-Identifier: MIT
//
// Point and spot lights (scenes/lights.h) in the ray marcher: single scattering in media, and
// reflection by solids.
//
// 1/d^2 enters as its exact mean over a step or part of a step of length l:
//
//   (1/l) integral ds / (h^2 + s^2) = (theta1 - theta0) / (h l)
//
//               light
//               /|\           h: height of the triangle over the step
//              / | \          theta1 - theta0: angle at the light
//             /  |h \         (an angle)
//   ray ----|----+---|---->
//
// so a step that passes close to a light neither misses it nor overestimates it. All other
// quantities are sampled where the bisector of the angle meets the step. Steps that are long or are
// seen under a large angle are divided: by march_lamp_steps.glsl in a march, by lamp_light() in a
// froxel.
#ifndef NEPH_MARCH_LAMPS_GLSL
#define NEPH_MARCH_LAMPS_GLSL

#include "march_light.glsl"

// Radius of the ball around a light in which the including shader removes light (struct LampPass).
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
                                               make_nonuniform(frame.sun_steps));
    return optical_depth;
}

// A ray relative to a light: distance of the foot of the perpendicular along the ray, and the
// perpendicular's length. Inside the ball, if any, light is removed: the fraction (1 - d^2 /
// R^2)^2, which is all of it at the light. The real-time froxels use this, because they compute the
// nearby light per pixel instead (froxels.glsl).
struct LampPass {
    float foot_m, height_m;
    float ball_m; // 0: none
};

LampPass lamp_pass(vec3 lamp_m, ViewRay ray, float ball_m)
{
    vec3 way_m = lamp_m - ray.origin_m;
    float foot_m = dot(way_m, ray.direction);
    // A ray through the light would give an infinite 1/h. The bound is the rounding error of a
    // position.
    return LampPass(foot_m, max(length(way_m - foot_m * ray.direction),
                                1e-6 * length(way_m) + 1e-12), ball_m);
}

// The angle at the light between two places on the ray, given relative to the foot, with their
// distance given separately.
float lamp_angle_over(LampPass pass, float s0_m, float s1_m, float length_m)
{
    return atan(pass.height_m * length_m, pass.height_m * pass.height_m + s0_m * s1_m);
}

float lamp_angle(LampPass pass, float s0_m, float s1_m)
{
    return lamp_angle_over(pass, s0_m, s1_m, s1_m - s0_m);
}

// Integral of 1/d^2 over a segment.
float lamp_whole(LampPass pass, float s0_m, float s1_m)
{
    return lamp_angle(pass, s0_m, s1_m) / pass.height_m;
}

// Integral of the part of 1/d^2 that the ball leaves. Inside the ball it is
//
//   (1 - (1 - d^2 / R^2)^2) / d^2 = 2 / R^2 - d^2 / R^4
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
        sum += scattering_per_m[m] * phase_rgb_per_sr(make_nonuniform(frame.media[m].phase_kind),
                                                      frame.media[m].g, view_direction, direction);
    return sum;
}

// Where the bisector of the angle at the light meets the ray, relative to the foot.
float lamp_bisector_m(LampPass pass, float s0_m, float s1_m)
{
    float d0_m = length(vec2(pass.height_m, s0_m)), d1_m = length(vec2(pass.height_m, s1_m));
    return s0_m + (s1_m - s0_m) * (d0_m / (d0_m + d1_m));
}

// Light of a lamp that the last mixture scatters towards the camera between two places, for a given
// mean of 1/d^2.
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

// Approximate angle of a part, seen from the light.
const float LAMP_PART = PI / 8.0;
const uint LAMP_PARTS_MAX = NEPH_GPU_LAMP_PARTS;

// Light that a froxel sends to its near end; the source is constant in each part of it.
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

// Light of all lights in a froxel with the mixture that was sampled last.
vec3 lamps_light(Mixture mixture, ViewRay ray, float start_m, float length_m, vec3 step_depth)
{
    vec3 sum = vec3(0.0);
    if (mixture.extinction_per_m == vec3(0.0))
        return sum;
    for (uint i = 0; i < make_nonuniform(frame.lamp_count); i++) {
        LampPass pass = lamp_pass(frame.lamps[i].position_m, ray, LAMP_BALL_M(frame.lamps[i]));
        sum += lamp_light(frame.lamps[i], pass, mixture.extinction_per_m, ray, start_m, length_m,
                          step_depth);
    }
    return sum;
}

// Radiance reflected by a surface of albedo 1.
vec3 lamps_reflected(vec3 point_m, vec3 normal, uint on_solid)
{
    vec3 sum = vec3(0.0);
    for (uint i = 0; i < make_nonuniform(frame.lamp_count); i++) {
        Lamp lamp = frame.lamps[i];
        vec3 way_m = lamp.position_m - point_m;
        float distance_m = max(length(way_m), 1e-12);
        vec3 direction = way_m / distance_m;
        float cosine = hit_cosine(on_solid, normal, direction);
        vec3 light = lamp_irradiance(lamp, direction, 1.0 / (distance_m * distance_m));
        if (cosine > 0.0 && light != vec3(0.0) &&
            sees_point(point_m, direction, distance_m, on_solid))
            sum += light * (cosine / PI) *
                   fraction_through(lamp_optical_depth(point_m, direction, distance_m));
    }
    return sum;
}

#endif
