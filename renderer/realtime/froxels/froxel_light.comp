#version 450
// SPDX-License-Identifier: MIT
//
// In each froxel, light that the media scatter towards the camera per metre, and their extinction:
// sun with the shadows of solids and media, point and spot lights, emission. A froxel has one
// sample point, which is jittered within it, except for terms with a closed form along its ray
// (optical depth, and 1/d^2 of a light). The result is blended with the froxels of the frame before
// at the same place of the world, after their light was changed as the lights have changed. Where
// the surface seen through the sample point lies within the slice, the sample is taken in front of
// it: behind it may be another room.
#extension GL_GOOGLE_include_directive : require

// Defined below, because froxels.glsl needs the view.
float left_to_pixels_m(vec3 lamp_m);
#define DRAWS_COVERAGE
#define LAMP_BALL_M(lamp) left_to_pixels_m(lamp.position_m)

#include "renderer/realtime/shared/rays.glsl"

#include "froxels.glsl"

float left_to_pixels_m(vec3 lamp_m)
{
    return choice(RT_LAMP_PEAKS) != 0 ? froxel_ball_m(lamp_m) : 0.0;
}

// A low-discrepancy sequence by M. Roberts (R3, 2018): multiples of the inverse powers of the root
// of x^4 = x + 1, modulo 1.
vec3 froxel_jitter()
{
    uvec3 bits = (view_frame + 1u) * uvec3(3518319155u, 2882110345u, 2360945575u);
    return choice(RT_FROXEL_JITTER) != 0 ? vec3(bits >> 8) * exp2(-24.0) : vec3(0.5);
}

ivec3 find_froxel(uint index)
{
    ivec2 place = element_at(int(index), froxel_count.x);
    int slice = place.y / froxel_count.y;
    return ivec3(place.x, place.y - slice * froxel_count.y, slice);
}

// A froxel's part of its ray, and the part of that inside the media's hull, where the sample lies.
struct Reach {
    float start_m, length_m;
    Stretch inside;
};

// Mean extinction of a froxel; in closed form where there is one, so that edges of media count.
float mean_extinction_per_m(Mixture mixture, ViewRay ray, Reach reach)
{
    float marched_per_m = mixture.marched_per_m.x;
    if (TRANSMITTANCE == MARCHED)
        return marched_per_m;
    vec3 start_m = view_point_m(ray, reach.start_m);
    return marched_per_m +
           exact_optical_depth(start_m, ray.direction, reach.length_m).x / reach.length_m;
}

// Light that is scattered per metre at the froxel's sample point. As a constant along the froxel it
// gives the same radiance as the integral over the froxel.
vec3 scattered_per_m(Mixture mixture, ViewRay ray, vec3 point_m, Reach reach,
                     float extinction_per_m)
{
    vec3 light = vec3(0.0);
    if (make_nonuniform(frame.scatters) != 0)
        light = source_function(mixture, point_m) * extinction_per_m;
    if (make_nonuniform(frame.emits) != 0)
        light += mixture.glow * extinction_per_m;
    if (LAMPS && make_nonuniform(frame.scatters_lamps) != 0) {
        vec3 depth = vec3(extinction_per_m * reach.length_m);
        light += lamps_light(mixture, ray, reach.inside.t0_m,
                             reach.inside.t1_m - reach.inside.t0_m, depth) /
                 froxel_reach_m(extinction_per_m, reach.length_m);
    }
    return light;
}

// What lamps that differ from the frame before have added to the light of a froxel.
struct Change {
    vec3 added;    // light per metre of these lamps now minus then, at this frame's sample point
    vec3 possible; // the sum of both where nothing hides these lamps, without optical depth
};

vec3 lamp_light_per_m(Lamp lamp, Mixture mixture, ViewRay ray, Reach reach, float extinction_per_m)
{
    return lamp_light(lamp, lamp_pass(lamp.position_m, ray, LAMP_BALL_M(lamp)),
                      mixture.extinction_per_m, ray, reach.inside.t0_m,
                      reach.inside.t1_m - reach.inside.t0_m,
                      vec3(extinction_per_m * reach.length_m)) /
           froxel_reach_m(extinction_per_m, reach.length_m);
}

vec3 unhidden_light_per_m(Lamp lamp, vec3 point_m)
{
    vec3 way_m = lamp.position_m - point_m;
    float distance_m = max(length(way_m), 1e-12);
    vec3 direction = way_m / distance_m;
    return lamp_irradiance(lamp, direction, 1.0 / (distance_m * distance_m)) *
           scattered_from(direction);
}

Change find_change(Mixture mixture, ViewRay ray, vec3 point_m, Reach reach, float extinction_per_m)
{
    Change change = Change(vec3(0.0), vec3(0.0));
    uint changed = force_nonuniform(view.lamps_changed);
    if (!LAMPS || make_nonuniform(frame.scatters_lamps) == 0 ||
        mixture.extinction_per_m == vec3(0.0))
        return change;
    for (uint i = 0; i < 2u * make_nonuniform(frame.lamp_count); i++) {
        bool is_now = (i & 1u) == 0u;
        if ((changed >> (i / 2u) & 1u) == 0u)
            continue;
        Lamp lamp = frame.lamps[i / 2u];
        if (!is_now)
            lamp = view.lamps_before[i / 2u];
        vec3 light = lamp_light_per_m(lamp, mixture, ray, reach, extinction_per_m);
        change.added += is_now ? light : -light;
        change.possible += unhidden_light_per_m(lamp, point_m);
    }
    return change;
}

// Where history cannot follow: no lamp that has changed is visible from the sample point, but from
// the sample points of earlier frames they may have been. A tenth is as much as in
// renderer/realtime/light_history.h.
bool is_unknown(vec3 before, Change change)
{
    return change.added == vec3(0.0) && any(greaterThan(change.possible, 0.1 * before));
}

// History as if the lamps of this frame had been there before. Light that lamps have added at the
// sample point is added; light that they have taken away is taken away in proportion, so that
// nothing remains of the only lamp where it has ended.
vec3 follow_lamps(vec3 before, vec3 now, vec3 added)
{
    vec3 dimmed = before * clamp(now / max(now - added, LEAST), 0.0, 1.0);
    return mix(before + added, dimmed, lessThan(added, vec3(0.0)));
}

Reach find_reach(int slice, ViewRay ray, vec2 place_px)
{
    float slope = 1.0 / dot(ray.direction, frame.camera_forward);
    float low_m = froxel_edge_m(slice), high_m = froxel_edge_m(slice + 1);
    float surface_m = fetch_full(RT_STEADY_DEPTH, ivec2(place_px)).x;
    if (choice(RT_FROXEL_HOLD) != 0 && surface_m > low_m && surface_m < high_m)
        high_m = surface_m;
    Stretch hull = scene_stretch(ray.origin_m, ray.direction, high_m * slope);
    return Reach(low_m * slope, (high_m - low_m) * slope,
                 Stretch(max(low_m * slope, hull.t0_m), min(high_m * slope, hull.t1_m)));
}

vec4 compute_froxel_light(ivec3 froxel, out Change change)
{
    change = Change(vec3(0.0), vec3(0.0));
    vec3 place = vec3(froxel) + froxel_jitter();
    vec2 place_px = place.xy * float(froxel_px);
    ViewRay ray = camera_ray_at(frame_camera(), place_px);
    Reach reach = find_reach(froxel.z, ray, place_px);
    if (reach.inside.t1_m <= reach.inside.t0_m)
        return vec4(0.0);
    set_view_ray(ray);
    float distance_m = mix(reach.inside.t0_m, reach.inside.t1_m, place.z - float(froxel.z));
    vec3 point_m = view_point_m(ray, distance_m);
    Mixture mixture = mixture_at(point_m);
    float extinction_per_m = mean_extinction_per_m(mixture, ray, reach);
    vec3 light = scattered_per_m(mixture, ray, point_m, reach, extinction_per_m);
    if (make_nonuniform(view.lamps_changed) != 0u)
        change = find_change(mixture, ray, point_m, reach, extinction_per_m);
    if (HAS_VEIL) { // as in a step of the march
        light = behind_veil(ray.direction, distance_m, light, vec3(extinction_per_m));
        change.added = behind_veil(ray.direction, distance_m, change.added, vec3(0.0));
    }
    return vec4(light, extinction_per_m);
}

vec4 mix_at(int section, vec3 place)
{
    vec3 low = floor(place), part = place - low;
    vec4 sum = vec4(0.0);
    for (int i = 0; i < 8; i++) {
        ivec3 step = ivec3(i & 1, i >> 1 & 1, i >> 2);
        vec3 weight = mix(1.0 - part, part, vec3(step));
        sum += weight.x * weight.y * weight.z * fetch_froxel(section, ivec3(low) + step);
    }
    return sum;
}

// Light of the frame before at the place of the froxel's centre; false: outside that frame.
bool light_before(ivec3 froxel, out vec4 light)
{
    vec3 middle = vec3(froxel) + 0.5;
    ViewRay ray = camera_ray_at(frame_camera(), middle.xy * float(froxel_px));
    float depth_m = 0.5 * (froxel_edge_m(froxel.z) + froxel_edge_m(froxel.z + 1));
    vec3 point_m = view_point_m(ray, depth_m / dot(ray.direction, frame.camera_forward));
    vec3 earlier = project(view_before, point_m - wind_m());
    light = vec4(0.0);
    vec3 place = vec3(earlier.xy / float(froxel_px), 0.0);
    if (!(earlier.z > 0.0) || earlier.z > froxel_end_m() || any(lessThan(place.xy, vec2(0.0))) ||
        any(greaterThan(place.xy, vec2(froxel_count.xy))))
        return false;
    // Between the centres of slices interpolation is in depth, not in slice numbers.
    int slice = clamp(int(froxel_place(earlier.z)), 0, froxel_count.z - 1);
    float middle_m = 0.5 * (froxel_edge_m(slice) + froxel_edge_m(slice + 1));
    int other = clamp(earlier.z < middle_m ? slice - 1 : slice + 1, 0, froxel_count.z - 1);
    float other_m = 0.5 * (froxel_edge_m(other) + froxel_edge_m(other + 1));
    float part = other == slice ? 0.0 : (earlier.z - middle_m) / (other_m - middle_m);
    place.z = float(slice) + part * float(other - slice);
    place.xy -= 0.5;
    light = mix_at(froxel_section_before(), place);
    return true;
}

void main()
{
    uint thread = gl_GlobalInvocationID.x;
    if (thread >= run.ray_count)
        return;
    ivec3 froxel = find_froxel(run.first_ray + thread);
    Change change;
    set_coverage(uvec2(run.first_ray + thread, 0u), view_frame);
    vec4 light = compute_froxel_light(froxel, change), before;
    bool has_history = is_set(RT_FROXEL_HISTORY) && has_past &&
                       force_nonuniform(view.sun_jumped) == 0u;
    if (has_history && light_before(froxel, before) && is_sound(before) &&
        !is_unknown(before.rgb, change)) {
        if (change.added != vec3(0.0))
            before.rgb = follow_lamps(before.rgb, light.rgb, change.added);
        light = mix(light, before, setting(RT_FROXEL_HISTORY));
    }
    put(RT_FROXELS, froxel_texel(froxel_section_now(), froxel), light);
    check_loops();
    count_cost();
}
