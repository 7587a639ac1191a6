// SPDX-License-Identifier: MIT
//
// Light of point and spot lights that a march step scatters towards the camera.
//
// A step may be much longer than the distance from the ray to the light: in an unbounded fog 64
// steps cover kilometres. Near a light 1/d^2, the phase function and both transmittances change
// over that distance, so a long step is divided into parts of equal extent in
//
//   u = asinh(s / h)        s: distance along the ray from the foot of the light's perpendicular
//                           h: length of the perpendicular
//
//             light
//               *
//               | h
//   ray  --|----+--|-----|----------|---->       parts grow with the distance from the foot
//             foot
//
// The light sees a part of extent du under an angle of less than du, and the part is no longer than
// sinh(du) times its distance from the light. Each part has its own extinction, scattering and
// optical depth. With more march steps the parts get shorter, so the method is of second order
// however near a ray passes a light.
#ifndef NEPH_MARCH_LAMP_STEPS_GLSL
#define NEPH_MARCH_LAMP_STEPS_GLSL

#include "march_lamps.glsl"

// Upper bound of the additional parts of all steps of a ray for one light, beside one part per
// step. lamp_parts() of renderer/march_split.c plans the loop iterations for them.
const uint LAMP_RAY_PARTS = SHORTCUTS >> 16u;

// Distance from the foot, in units of h, beyond which no step is divided: 1e-9 of the light is
// there.
const float LAMP_END = 1e9;

// u of a place.
float lamp_place(LampPass pass, float s_m)
{
    float slope = min(abs(s_m) / pass.height_m, LAMP_END);
    return sign(s_m) * log(slope + sqrt(1.0 + slope * slope));
}

// Extent of a part in u. With 64 steps or fewer it is LAMP_PART, as in a froxel.
float lamp_step_part(LampPass pass, Stretch stretch)
{
    float whole = lamp_place(pass, stretch.t1_m - pass.foot_m) -
                  lamp_place(pass, stretch.t0_m - pass.foot_m);
    return max(LAMP_PART * min(1.0, 64.0 / float(make_nonuniform(frame.steps))),
               whole / float(LAMP_RAY_PARTS));
}

float lamp_place_m(LampPass pass, float place) { return pass.height_m * sinh(place); }

vec3 lamp_part_depth(Mixture mixture, vec3 start_m, vec3 direction, float length_m)
{
    vec3 depth = mixture.marched_per_m * length_m;
    if (TRANSMITTANCE == EXACT)
        depth += exact_optical_depth(start_m, direction, length_m);
    return depth;
}

// Light that a step sends to its near end. An undivided step uses the given mixture, length and
// optical depth: float32 rounds its end points, and their difference loses more digits the farther
// the step is from the foot, by the same amount in all steps of a ray. A divided step samples its
// own mixtures and so overwrites the globals of the last one (scattering_per_m).
vec3 lamp_step_light(Lamp lamp, LampPass pass, Mixture mixture, ViewRay ray, Stretch stretch,
                     float start_m, float length_m, vec3 step_depth, out bool is_divided)
{
    float s0_m = start_m - pass.foot_m, end_m = s0_m + length_m;
    float first = lamp_place(pass, s0_m), extent = lamp_place(pass, end_m) - first;
    uint parts = 1u + uint(max(extent, 0.0) / lamp_step_part(pass, stretch));
    is_divided = parts > 1u;
    vec3 sum = vec3(0.0), depth = vec3(0.0);
    for (uint i = 1; i <= parts; i++) {
        float s1_m = i == parts ? end_m
                                : clamp(lamp_place_m(pass, first + extent * float(i) /
                                                                       float(parts)),
                                        s0_m, end_m);
        float part_m = is_divided ? s1_m - s0_m : length_m;
        if (part_m <= 0.0)
            continue;
        vec3 part_depth = step_depth;
        if (is_divided) {
            float middle_m = pass.foot_m + lamp_bisector_m(pass, s0_m, s1_m);
            mixture = mixture_at(view_point_m(ray, middle_m));
            part_depth = lamp_part_depth(mixture, view_point_m(ray, pass.foot_m + s0_m),
                                         ray.direction, part_m);
        }
        float inverse_square = lamp_angle_over(pass, s0_m, s1_m, part_m) /
                               (pass.height_m * part_m);
        if (mixture.extinction_per_m != vec3(0.0))
            sum += lamp_scattered_per_m(lamp, pass, ray, s0_m, s1_m, inverse_square) *
                   fraction_through(depth) * fraction_lost(part_depth) /
                   max(mixture.extinction_per_m, LEAST);
        depth += part_depth;
        s0_m = s1_m;
    }
    return sum;
}

// Light of all lights in a step. Before and after, the globals belong to the step's own mixture.
vec3 lamps_step_light(Mixture mixture, ViewRay ray, Stretch stretch, float start_m, float length_m,
                      vec3 step_depth)
{
    vec3 sum = vec3(0.0);
    vec3 step_scattering_per_m[MEDIA_MAX] = scattering_per_m;
    for (uint i = 0; i < make_nonuniform(frame.lamp_count); i++) {
        bool is_divided;
        LampPass pass = lamp_pass(frame.lamps[i].position_m, ray, 0.0);
        sum += lamp_step_light(frame.lamps[i], pass, mixture, ray, stretch, start_m, length_m,
                               step_depth, is_divided);
        if (is_divided)
            scattering_per_m = step_scattering_per_m;
    }
    return sum;
}

#endif
