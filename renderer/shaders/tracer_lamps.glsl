// SPDX-License-Identifier: MIT
//
// How paths sample lamps, as truth/lamp_draw.h has it: places on each segment by 1/d^2
// (equiangular) and by 1/d of the distance d from a lamp, for surfaces a lamp by its irradiance,
// and of directions a few by 1 / sin of the angle from a lamp. So each estimate has a finite
// variance, however near a path comes to a lamp.
//
// Cancellation. Three differences lose all digits of a float32 near a lamp, and none of them is
// taken; small angles have series of their own. The angle of a segment, seen from a lamp, is one
// arctangent of both ends. The distance from a lamp is that of the triangle (height, place behind
// the foot), not of two points. The height of a lamp over a view ray comes from the lamp's place in
// the frame, which the CPU knows in double. Other segments have random directions: one of 10^5
// passes a lamp so near that its height is off by 1 %.
#ifndef NEPH_TRACER_LAMPS_GLSL
#define NEPH_TRACER_LAMPS_GLSL

#include "tracer.glsl"

// The part of directions that are drawn towards lamps.
const float LAMP_DIRECTIONS = 1.0 / 8.0;

// The part of places that are drawn by 1/d, in octaves of the distance.
const float LAMP_BY_OCTAVE = 1.0 / 4.0;

// A segment other than a view ray that passes a lamp nearer than this part of its distance passes
// it this far off.
const float LAMP_NEAREST = 1e-6;

// A view ray passes a lamp this far off, at least: 1/d^2 stays a float32.
const float LAMP_NEAREST_M = 1e-15;

// Where the frame has a lamp (renderer/lamp_sight.c).
struct LampSight {
    ivec2 pixel;    // the nearest one,
    vec2 beside_px; // and how far from its centre
    float depth_m;  // along camera_forward; of an orthographic camera 1; 0: not in view
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
    float density_per_m; // of this place and lamp; 0: no medium is lit on the segment
};

// A lamp as a segment passes it. `s` is the distance along the segment from the foot of the lamp's
// perpendicular.
struct LampPass {
    float foot_m, height_m;
    vec3 across_m;        // from the foot to the lamp
    float squares_per_m;  // integral of 1/d^2 over the media's stretches of the segment
    float octaves;        // integral of 1/d
};

// From a view ray to a lamp, across the ray. In the plane at the lamp's depth both are some pixels
// apart, and so far apart in world space; what of that lies along the ray is left out.
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

// atan(y, x) of y >= 0. Drivers have it to 2e-5 of small angles, which the series has to 1e-8.
float angle_at(float y, float x)
{
    float slope = y / x, square = slope * slope;
    bool is_small = x > 0.0 && slope < 0.1;
    return is_small ? slope * (1.0 - square * (1.0 / 3.0 - square * (1.0 / 5.0 - square / 7.0)))
                    : atan(y, x);
}

// 1 / tan(x) of x in 0..pi. GPUs have sine and cosine to 5e-7, which leaves a small angle no digit.
float cotangent(float x)
{
    float square = x * x;
    return x < 0.25
               ? (1.0 - square * (1.0 / 3.0 + square * (1.0 / 45.0 + square * (2.0 / 945.0)))) / x
               : 1.0 / tan(x);
}

// Integrals of 1/d^2 (1 / s0 - 1 / s1 at a height of 0) and of 1/d over a stretch.
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

// Where the part u of either integral lies.
float place_by_squares_m(float height_m, float s0_m, float s1_m, float u)
{
    bool is_before = s0_m + s1_m < 0.0; // then angles from the other side are the small ones
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
        float sum_m = d0_m + near_m; // sum e^more - h^2 / sum e^-more is 2 s
        s_m = 0.5 * (sum_m * exp(more) - height_m * (height_m / sum_m) * exp(-more));
    }
    return is_before ? -s_m : s_m;
}

// A medium's part of a segment.
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

// Choose a lamp, one of the media's stretches, and a place on it: by u.x and, on the stretch, by
// u.y. `pixel` is that of a view ray, or NO_PIXEL.
LampPlace draw_lamp_place(vec3 origin_m, vec3 direction, float end_m, vec2 u, uint pixel)
{
    LampPlace place = LampPlace(0, 0.0, vec3(0.0), 0.0, 0.0);
    float weight_sum = 0.0, shining = 0.0; // all lamps' 1/d^2, and how many lamps there are
    for (uint i = 0; i < own(frame.lamp_count); i++) {
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
    float share = 0.0, inside = 0.0; // the chosen lamp's, and where in it u.x is
    for (uint i = 0; i < own(frame.lamp_count); i++) {
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
    // Each stretch that has the place in it adds the same to the density.
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

// Light of a lamp that media scatter at a place on a segment, with nothing in between, over the
// place's density; black where a solid is in between.
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
