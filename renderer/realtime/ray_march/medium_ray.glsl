// SPDX-License-Identifier: MIT
//
// A ray through the media, up to a solid or the sky, marched by the code of march.comp: for passes
// with rays of all steps.
//
// The distance of a ray is the mean distance of the medium's light along it. A ray without such
// light has the distance of its end, or sky_m where that is the sky: a distance to reproject with,
// at most the largest half.
#ifndef NEPH_REALTIME_MEDIUM_RAY_GLSL
#define NEPH_REALTIME_MEDIUM_RAY_GLSL

#define SEES_GRID_TEXELS
#define KNOWS_SOLIDS
#define MARCH_STARTS_LATE // behind froxels

#include "renderer/realtime/shared/rays.glsl"

// With a closed-form transmittance and no light from the media there are no steps to march
// (march.comp).
layout(constant_id = RT_DARK_CONSTANT) const bool IS_DARK = false;

struct Ray {
    ViewRay view;
    vec2 place_px;  // in the frame
    float length_m; // FAR_M: to the sky
    float place;    // of the sample in each step, 0 .. 1
};

struct MarchedRay {
    vec4 value; // RGB of in-scattered radiance, transmittance
    float distance_m;
};

Camera camera = frame_camera(); // read before any branch, like the view (shared/view.glsl)

// The ray through a place of the frame, up to an eye depth; FAR_M: to the sky.
Ray make_ray(vec2 place_px, float depth_m, float place)
{
    Ray ray;
    ray.place_px = place_px;
    ray.view = camera_ray_at(camera, place_px);
    float cosine = dot(ray.view.direction, camera.forward);
    ray.length_m = depth_m < FAR_M ? depth_m / cosine : FAR_M;
    ray.place = place;
    return ray;
}

// view_optical_depth() from the end of the froxels on.
vec3 optical_depth_behind(Ray ray, Sums sums)
{
    ViewRay rest = ViewRay(view_point_m(ray.view, march_from_m), ray.view.direction);
    return IS_SOLVED ? exact_optical_depth(rest.origin_m, rest.direction,
                                           max(ray.length_m - march_from_m, 0.0))
                     : marched_depth(sums);
}

// Mean place at which light is lost in a homogeneous medium, relative to its length:
// (1 / tau) - 1 / (e^tau - 1).
float mean_place(float optical_depth)
{
    float of_one = phi(optical_depth);
    float place = ((1.0 + optical_depth) * of_one - 1.0) / (optical_depth * of_one);
    return optical_depth > 1e-3 ? place : 0.5; // the difference cancels; off by less than 1e-4
}

// Mean distance as for a homogeneous medium along the media's part of the ray.
float dark_distance_m(Ray ray, vec3 optical_depth)
{
    float depth = min(mean(optical_depth), OPAQUE);
    Stretch stretch = scene_stretch(ray.view.origin_m, ray.view.direction, ray.length_m);
    return depth > 0.0 ? mix(stretch.t0_m, stretch.t1_m, mean_place(depth)) : FAR_M;
}

MarchedRay make_marched_ray(Ray ray, vec4 value, float distance_m)
{
    float end_m = min(min(ray.length_m, setting(RT_SKY_M)), HALF_MAX);
    return MarchedRay(value, min(distance_m, end_m));
}

MarchedRay solve_dark(Ray ray)
{
    vec3 optical_depth = exact_optical_depth(ray.view.origin_m, ray.view.direction, ray.length_m);
    return make_marched_ray(ray, vec4(vec3(0.0), fraction_through(optical_depth).x),
                            dark_distance_m(ray, optical_depth));
}

MarchedRay collect_light(Ray ray, Sums sums)
{
    vec3 optical_depth = choice(RT_FROXEL_VOLUME) == 0
                             ? view_optical_depth(ray.view, ray.length_m, sums)
                             : optical_depth_behind(ray, sums);
    return make_marched_ray(ray,
                            vec4(view_scattered(sums, optical_depth, ray.view, ray.place_px),
                                 fraction_through(optical_depth).x),
                            view_distance_m(sums));
}

// Marches the steps of this dispatch along the ray of a thread. False: steps are left for a later
// dispatch, and the sums so far are kept.
bool march_ray(uint thread, Ray ray, out MarchedRay marched)
{
    if (choice(RT_FROXEL_VOLUME) != 0)
        march_from_m = setting(RT_FROXEL_END_M) / dot(ray.view.direction, camera.forward);
    Sums sums = sums_at_start(thread);
    if (!IS_DARK)
        march(ray.view, ray.length_m, ray.place, sums);
    if (run.end_step < make_nonuniform(frame.steps)) {
        sums_keep(thread, sums);
        return false;
    }
    if (IS_DARK)
        marched = solve_dark(ray);
    else
        marched = collect_light(ray, sums);
    return true;
}

#endif
