#version 450
// SPDX-License-Identifier: MIT
//
// The peaks of point lights and spot lights, which froxels leave out (froxels.glsl): light that the
// media scatter within a ball of radius R around each light, (1 - d^2/R^2)^2 of it, along the
// pixel's own ray, seen through the froxels in front.
//
// The ray passes the light at height h. With s from the foot of the height, s = h tan theta:
//
//     d^2 = h^2 + s^2,   ds / d^2 = d theta / h
//
// Parts of equal angles theta therefore have equal integrals of 1/d^2 (C. Kulla, M. Fajardo,
// "Importance Sampling Techniques for Path Tracing in Participating Media", EGSR 2012).
#extension GL_GOOGLE_include_directive : require

#include "renderer/realtime/shared/rays.glsl"

#include "froxels.glsl"

// The part of a ray inside the ball, in front of the camera and of `end_m`; places as in
// lamp_pass().
Stretch stretch_in_ball(LampPass pass, float end_m)
{
    float half_m = sqrt(max(pass.ball_m * pass.ball_m - pass.height_m * pass.height_m, 0.0));
    return Stretch(max(-half_m, -pass.foot_m), min(half_m, end_m - pass.foot_m));
}

// The light of a short part with the media of its centre; like one step of a march.
vec3 integrate_peak_part(Lamp lamp, LampPass pass, ViewRay ray, float s0_m, float s1_m)
{
    float length_m = s1_m - s0_m;
    Mixture mixture = mixture_at(view_point_m(ray, pass.foot_m + 0.5 * (s0_m + s1_m)));
    float peak = max(lamp_whole(pass, s0_m, s1_m) - lamp_outside(pass, s0_m, s1_m), 0.0);
    if (mixture.extinction_per_m == vec3(0.0) || !(peak > 0.0))
        return vec3(0.0);
    return lamp_scattered_per_m(lamp, pass, ray, s0_m, s1_m, peak / length_m) * length_m;
}

// The visible light of one light's peak in front of `end_m`, by parts of at most LAMP_PART: each is
// dimmed by the froxels in front of its middle.
vec3 integrate_peak(Lamp lamp, ViewRay ray, vec2 place_px, float slope, float end_m)
{
    LampPass pass = lamp_pass(lamp.position_m, ray, froxel_ball_m(lamp.position_m));
    Stretch inside = stretch_in_ball(pass, end_m);
    if (inside.t1_m <= inside.t0_m)
        return vec3(0.0);
    float angle = lamp_angle(pass, inside.t0_m, inside.t1_m);
    float first = atan(inside.t0_m / pass.height_m);
    uint parts = min(1u + uint(angle / LAMP_PART), LAMP_PARTS_MAX);
    vec3 sum = vec3(0.0);
    float s0_m = inside.t0_m;
    for (uint i = 1; i <= parts; i++) {
        float turned = first + angle * float(i) / float(parts);
        float s1_m = i == parts ? inside.t1_m
                                : clamp(pass.height_m * tan(turned), s0_m, inside.t1_m);
        if (s1_m <= s0_m)
            continue;
        float middle_m = pass.foot_m + 0.5 * (s0_m + s1_m);
        sum += integrate_peak_part(lamp, pass, ray, s0_m, s1_m) *
               froxels_before(place_px, middle_m / slope, slope).a;
        s0_m = s1_m;
    }
    return sum;
}

void main()
{
    uint thread = gl_GlobalInvocationID.x;
    if (thread >= run.ray_count)
        return;
    ivec2 pixel = element_at(int(run.first_ray + thread), view_size().x);
    vec2 place_px = vec2(pixel) + 0.5 + jitter_px;
    ViewRay ray = camera_ray_at(frame_camera(), place_px);
    float slope = 1.0 / dot(ray.direction, frame.camera_forward);
    float end_m = min(fetch_full(RT_DEPTH, pixel).x, froxel_end_m()) * slope;
    vec3 sum = vec3(0.0);
    set_view_ray(ray);
    if (make_nonuniform(frame.scatters_lamps) != 0)
        for (uint i = 0; i < make_nonuniform(frame.lamp_count); i++)
            sum += integrate_peak(frame.lamps[i], ray, place_px, slope, end_m);
    vec4 volume = fetch_full(RT_VOLUME, pixel);
    put_full(RT_VOLUME, pixel, vec4(volume.rgb + sum, volume.a));
    count_cost();
}
