// SPDX-License-Identifier: MIT
//
// Sampling of point and spot lights by paths (CPU version, with the derivation: truth/lamp_draw.h).
// The estimates have a finite variance however near a path passes a light:
// - On each segment a place is drawn by 1/d^2 (equiangular sampling: C. Kulla, M. Fajardo, EGSR
//   2012) or by 1/d, with d the distance from the light.
// - At surfaces a light is chosen by its irradiance.
// - Some scattered directions are drawn by 1 / sin of the angle to a light.
//
//               light
//                *  .
//                |    .  d         squares:  integral ds / d^2 = angle / h
//              h |      .          octaves:  integral ds / d   = asinh(s1/h) - asinh(s0/h)
//                |        .
//   ----|--------+---------|---->  s: distance from the foot of the perpendicular
//       s0     foot       s1
//
// Cancellation. Near a light three differences would lose all digits of a float32, and are avoided:
// - The angle of a segment is one arctangent of both ends. Small angles have their own series.
// - The distance from a light is the hypotenuse of (h, s), not a difference of two points.
// - The height of a light over a view ray comes from the light's position in the frame, which the
//   CPU has computed in double. Other segments have random directions: one in 10^5 passes a light
//   so near that its height has an error of 1 %.
#ifndef NEPH_TRACER_LAMPS_GLSL
#define NEPH_TRACER_LAMPS_GLSL

#include "tracer.glsl"

// Fraction of directions that are drawn towards lights.
const float LAMP_DIRECTIONS = 1.0 / 8.0;

// Fraction of places that are drawn by 1/d (uniform in octaves of the distance).
const float LAMP_BY_OCTAVE = 1.0 / 4.0;

// Smallest height of a light over a segment, relative to the distance; not for view rays.
const float LAMP_NEAREST = 1e-6;

// Smallest height over a view ray: 1/d^2 stays a float32.
const float LAMP_NEAREST_M = 1e-15;

// Position of a light in the frame (renderer/light_projection.c).
struct LampSight {
    ivec2 pixel;    // the nearest pixel
    vec2 beside_px; // offset from its centre
    float depth_m;  // along camera_forward; orthographic camera: 1; 0: not in view
};

layout(std430, binding = 17) readonly buffer LampSights {
    LampSight lamp_sights[];
};

const uint NO_PIXEL = 0xffffffffu; // for segments other than view rays

struct LampPlace {
    uint lamp;
    float t_m;
    vec3 to_lamp; // unit
    float distance_m;
    float density_per_m; // of this place and light; 0: no medium is lit on the segment
};

// A light relative to a segment. `s` is the distance along the segment from the foot of the light's
// perpendicular.
struct LampPass {
    float foot_m, height_m;
    vec3 across_m;        // from the foot to the light
    float squares_per_m;  // integral of 1/d^2 over the media's parts of the segment
    float octaves;        // integral of 1/d
};

// Perpendicular from a view ray to a light. In the plane at the light's depth both are some pixels
// apart, which gives a world-space vector; its part along the ray is removed.
vec3 view_across_m(LampSight sight, uint pixel, vec3 direction)
{
    ivec2 from = ivec2(pixel % frame.width_px, pixel / frame.width_px);
    vec2 apart_px = vec2(sight.pixel - from) + sight.beside_px;
    vec2 apart = 2.0 * apart_px * vec2(frame.half_width, frame.half_height) /
                 vec2(frame.width_px, frame.height_px);
    vec3 apart_m = sight.depth_m * (apart.x * frame.camera_right - apart.y * frame.camera_up);
    return apart_m - direction * dot(apart_m, direction);
}

LampPass lamp_pass(uint lamp, vec3 origin_m, vec3 direction, uint pixel)
{
    vec3 way_m = frame.lamps[lamp].position_m - origin_m;
    LampPass pass;
    pass.foot_m = dot(way_m, direction);
    pass.across_m = way_m - pass.foot_m * direction;
    float nearest_m = LAMP_NEAREST * length(way_m);
    if (pixel != NO_PIXEL && lamp_sights[lamp].depth_m > 0.0) {
        pass.across_m = view_across_m(lamp_sights[lamp], pixel, direction);
        nearest_m = 0.0;
    }
    pass.height_m = max(length(pass.across_m), nearest_m + LAMP_NEAREST_M);
    pass.squares_per_m = pass.octaves = 0.0;
    return pass;
}

// atan(y, x) for y >= 0. Drivers have an error of 2e-5 for small angles; the series has 1e-8.
float angle_at(float y, float x)
{
    float slope = y / x, square = slope * slope;
    bool is_small = x > 0.0 && slope < 0.1;
    return is_small ? slope * (1.0 - square * (1.0 / 3.0 - square * (1.0 / 5.0 - square / 7.0)))
                    : atan(y, x);
}

// 1 / tan(x) for x in 0..pi. GPUs have an error of 5e-7 in sine and cosine, as large as a small
// angle.
float cotangent(float x)
{
    float square = x * x;
    return x < 0.25
               ? (1.0 - square * (1.0 / 3.0 + square * (1.0 / 45.0 + square * (2.0 / 945.0)))) / x
               : 1.0 / tan(x);
}

// Integrals over [s0, s1] of 1/d^2 (its limit for height 0 is 1 / s0 - 1 / s1) and of 1/d.
float squares_between(float height_m, float s0_m, float s1_m)
{
    return angle_at(height_m * (s1_m - s0_m), height_m * height_m + s0_m * s1_m) / height_m;
}

float octaves_between(float height_m, float s0_m, float s1_m)
{
    bool is_before = s1_m <= 0.0;
    float near_m = is_before ? -s1_m : s0_m, far_m = is_before ? -s0_m : s1_m;
    float d0_m = length(vec2(height_m, near_m)), d1_m = length(vec2(height_m, far_m));
    if (near_m < 0.0)
        return log((far_m + d1_m) / height_m) + log((d0_m - near_m) / height_m);
    float farther_m = (far_m - near_m) * (1.0 + (far_m + near_m) / (d0_m + d1_m));
    return log_1_plus(farther_m / (near_m + d0_m));
}

// Inverse of the integrals: the place at which the fraction u is reached.
float place_by_squares_m(float height_m, float s0_m, float s1_m, float u)
{
    bool is_before = s0_m + s1_m < 0.0; // angles from the other side are the small ones then
    float angle0 = angle_at(height_m, is_before ? -s1_m : s0_m);
    float angle1 = angle_at(height_m, is_before ? -s0_m : s1_m);
    float part = is_before ? 1.0 - u : u;
    float s_m = height_m * cotangent(mix(angle0, angle1, part));
    return is_before ? -s_m : s_m;
}

float place_by_octaves_m(float height_m, float s0_m, float s1_m, float u)
{
    bool is_before = s1_m <= 0.0;
    float near_m = is_before ? -s1_m : s0_m, far_m = is_before ? -s0_m : s1_m;
    float d0_m = length(vec2(height_m, near_m));
    float more = (is_before ? 1.0 - u : u) * octaves_between(height_m, near_m, far_m);
    float s_m;
    if (near_m < 0.0) {
        s_m = height_m * sinh(more - log((d0_m - near_m) / height_m));
    } else {
        float sum_m = d0_m + near_m; // 2 s = sum e^more - h^2 / sum e^-more
        s_m = 0.5 * (sum_m * exp(more) - height_m * (height_m / sum_m) * exp(-more));
    }
    return is_before ? -s_m : s_m;
}

// The part of a segment in a medium's box.
bool lamp_stretch(uint m, vec3 origin_m, vec3 direction, float end_m, out float t0_m,
                  out float t1_m)
{
    t0_m = 0.0;
    t1_m = end_m;
    return clip_medium(m, origin_m, direction, t0_m, t1_m) && t0_m < t1_m;
}

LampPass whole_lamp_pass(uint lamp, vec3 origin_m, vec3 direction, float end_m, uint pixel)
{
    LampPass pass = lamp_pass(lamp, origin_m, direction, pixel);
    for (uint m = 0; m < media_count(); m++) {
        float t0_m, t1_m;
        if (!lamp_stretch(m, origin_m, direction, end_m, t0_m, t1_m))
            continue;
        float s0_m = t0_m - pass.foot_m, s1_m = t1_m - pass.foot_m;
        pass.squares_per_m += squares_between(pass.height_m, s0_m, s1_m);
        pass.octaves += octaves_between(pass.height_m, s0_m, s1_m);
    }
    return pass;
}

float lamp_brightness(uint lamp) { return dot(frame.lamps[lamp].intensity, vec3(1.0)); }

// Chooses a light, a medium's part of the segment, and a place on it: u.x gives light and part, u.y
// the place. `pixel` is the view ray's pixel, or NO_PIXEL.
LampPlace draw_lamp_place(vec3 origin_m, vec3 direction, float end_m, vec2 u, uint pixel)
{
    LampPlace place = LampPlace(0, 0.0, vec3(0.0), 0.0, 0.0);
    // Sum over lights of weighted 1/d^2; number of lights with a weight.
    float weight_sum = 0.0, shining = 0.0;
    for (uint i = 0; i < make_nonuniform(frame.lamp_count); i++) {
        LampPass pass = whole_lamp_pass(i, origin_m, direction, end_m, pixel);
        float weight = lamp_brightness(i) * pass.squares_per_m;
        weight_sum += weight;
        shining += weight > 0.0 ? 1.0 : 0.0;
    }
    if (weight_sum <= 0.0)
        return place;
    bool by_octaves = u.x < LAMP_BY_OCTAVE;
    float left = by_octaves ? u.x / LAMP_BY_OCTAVE * shining
                            : (u.x - LAMP_BY_OCTAVE) / (1.0 - LAMP_BY_OCTAVE) * weight_sum;
    LampPass chosen;
    float share = 0.0, inside = 0.0; // weight of the chosen light, and the position of u.x in it
    for (uint i = 0; i < make_nonuniform(frame.lamp_count); i++) {
        LampPass pass = whole_lamp_pass(i, origin_m, direction, end_m, pixel);
        float weight = lamp_brightness(i) * pass.squares_per_m;
        float next = by_octaves ? (weight > 0.0 ? 1.0 : 0.0) : weight;
        if (weight <= 0.0 || (share > 0.0 && left < 0.0))
            continue;
        place.lamp = i;
        chosen = pass;
        share = next;
        inside = clamp(left / next, 0.0, 1.0);
        left -= next;
    }
    float of_stretches = inside * (by_octaves ? chosen.octaves : chosen.squares_per_m);
    float s0_m = 0.0, s1_m = 0.0;
    bool is_found = false;
    for (uint m = 0; m < media_count(); m++) {
        float t0_m, t1_m;
        if (is_found || !lamp_stretch(m, origin_m, direction, end_m, t0_m, t1_m))
            continue;
        s0_m = t0_m - chosen.foot_m;
        s1_m = t1_m - chosen.foot_m;
        of_stretches -= by_octaves ? octaves_between(chosen.height_m, s0_m, s1_m)
                                   : squares_between(chosen.height_m, s0_m, s1_m);
        is_found = of_stretches < 0.0;
    }
    float s_m = by_octaves ? place_by_octaves_m(chosen.height_m, s0_m, s1_m, u.y)
                           : place_by_squares_m(chosen.height_m, s0_m, s1_m, u.y);
    s_m = clamp(s_m, s0_m, s1_m);
    place.t_m = max(chosen.foot_m + s_m, 0.0);
    place.distance_m = length(vec2(chosen.height_m, s_m));
    place.to_lamp = (chosen.across_m - s_m * direction) / place.distance_m;
    // Each medium's part that contains the place adds the same density.
    float by_squares = lamp_brightness(place.lamp) / weight_sum / place.distance_m;
    float per_m = mix(by_squares, 1.0 / (shining * chosen.octaves), LAMP_BY_OCTAVE) /
                  place.distance_m;
    for (uint m = 0; m < media_count(); m++) {
        float t0_m, t1_m;
        if (lamp_stretch(m, origin_m, direction, end_m, t0_m, t1_m) &&
            s_m >= t0_m - chosen.foot_m && s_m <= t1_m - chosen.foot_m)
            place.density_per_m += per_m;
    }
    return place;
}

// Scattering of all media at a point, from one light into the path's direction [1/(m sr)].
vec3 lamp_scattering(vec3 point_m, vec3 direction, vec3 to_lamp)
{
    vec3 sum = vec3(0.0);
    for (uint m = 0; m < media_count(); m++) {
        Medium medium = frame.media[m];
        sum += medium.albedo * medium.extinction_color *
               (medium_extinction_per_m(m, point_m) *
                phase_rgb_per_sr(make_nonuniform(medium.phase_kind),
                                 make_nonuniform(medium.g), direction, to_lamp));
    }
    return sum;
}

// Lamp light scattered at a place on a segment, without attenuation, over the place's density; 0 if
// a solid is in between.
vec3 lamplight_at(LampPlace place, vec3 point_m, vec3 direction)
{
    float part = 1.0 / (place.distance_m * place.density_per_m) / place.distance_m;
    vec3 light = lamp_irradiance(frame.lamps[place.lamp], place.to_lamp, part) *
                 lamp_scattering(point_m, direction, place.to_lamp);
    if (SOLIDS && light != vec3(0.0) &&
        !sees_point(point_m, place.to_lamp, place.distance_m, NO_SOLID))
        light = vec3(0.0);
    return light;
}

// For a surface: chooses a light by its irradiance, without cosine and visibility.
uint pick_lamp(vec3 point_m, float u, out float probability)
{
    float sum = 0.0, weight = 0.0;
    uint picked = 0;
    for (uint i = 0; i < make_nonuniform(frame.lamp_count); i++) {
        vec3 way_m = frame.lamps[i].position_m - point_m;
        sum += dot(lamp_irradiance(frame.lamps[i], normalize(way_m), 1.0 / dot(way_m, way_m)),
                   vec3(1.0));
    }
    float left = u * sum;
    for (uint i = 0; i < make_nonuniform(frame.lamp_count); i++) {
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

// A direction with density 1 / (2 pi^2 sin(angle)) about the direction to a random light.
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
    for (uint i = 0; i < make_nonuniform(frame.lamp_count); i++) {
        vec3 towards = normalize(frame.lamps[i].position_m - point_m);
        sum_per_sr += 1.0 / (2.0 * PI * PI * max(length(cross(towards, direction)), LAMP_NEAREST));
    }
    return sum_per_sr / float(frame.lamp_count);
}

#endif
