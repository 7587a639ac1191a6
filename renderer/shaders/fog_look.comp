#version 450
// SPDX-License-Identifier: MIT
//
// Renders a frame with a game engine's fog model (fog_look.glsl): per pixel one ray to the first
// surface, which is lit by the sun, and the closed form of the fog in front of it.
#extension GL_GOOGLE_include_directive : require

#define DRAWS_COVERAGE

#include "fog_look.glsl"
#include "scene.glsl"

layout(local_size_x = 64) in;

layout(constant_id = 2) const bool SUN_IS_CLEAR = false; // no attenuation on the way to solids

layout(push_constant) uniform FogLookRun {
    FogLook look;
    uint first_ray;
    uint ray_count;
} run;

struct FogLookPixel {
    vec3 radiance; // fog, surfaces and background [W m^-2 sr^-1]
    float eye_depth_m; // FAR_M for the sky
    vec3 volume; // the fog's part of it
    float through; // transmittance of the fog
};

layout(std430, binding = 5) writeonly buffer Pixels {
    FogLookPixel pixels[];
};

// Sunlight reflected by a Lambertian surface.
vec3 sunlit_surface_radiance(Hit hit, vec3 point_m)
{
    Surface surface = surface_at(hit.solid, point_m);
    float cosine = hit_cosine(hit.solid, surface.normal, to_sun());
    if (cosine <= 0.0 || !sees_sun(point_m, hit.solid))
        return vec3(0.0);
    vec3 depth = SUN_IS_CLEAR ? vec3(0.0) : scene_optical_depth(point_m, to_sun(), FAR_M);
    return surface.albedo / PI * cosine * frame.sun_irradiance * transmittance(depth);
}

void main()
{
    uint thread = gl_GlobalInvocationID.x;
    if (thread >= run.ray_count)
        return;
    uint pixel = run.first_ray + thread;
    ViewRay ray = camera_ray(pixel % frame.width_px, pixel / frame.width_px);
    set_coverage(uvec2(pixel, 0u), frame.meshes.frame_number);
    Hit hit = scene_hit(ray.origin_m, ray.direction);
    bool is_sky = hit.solid == NO_SOLID;
    vec3 behind = is_sky ? frame.background
                         : sunlit_surface_radiance(hit, view_point_m(ray, hit.t_m));
    FogLookLight fog = fog_look_along(run.look, ray.direction, hit.t_m, to_sun());
    float eye_depth_m = is_sky ? FAR_M : hit.t_m * dot(ray.direction, frame.camera_forward);
    pixels[thread] = FogLookPixel(fog.volume + fog.through * behind, eye_depth_m, fog.volume,
                                  fog.through);
    check_loops();
}
