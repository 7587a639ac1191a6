#version 450
// SPDX-License-Identifier: MIT
//
// The path tracer's first kernel: the light that comes to the camera without scattering, exact, one
// thread per pixel; and every pool at its first item.
#extension GL_GOOGLE_include_directive : require

#include "tracer.glsl"

layout(local_size_x = 64) in;

vec3 surface_sunlight(Hit hit, vec3 point_m)
{
    vec3 albedo = solids[hit.solid].albedo.rgb;
    float cosine = dot(solid_normal(solids[hit.solid], point_m), frame.sun_direction);
    if (cosine <= 0.0 || albedo == vec3(0.0) || frame.sun_irradiance == vec3(0.0) ||
        !sees_sun(point_m, hit.solid))
        return vec3(0.0);
    vec3 arriving = transmittance(scene_optical_depth(point_m, frame.sun_direction, FAR_M));
    return albedo / PI * cosine * arriving * frame.sun_irradiance;
}

// The parts that the layers take out of the view ray.
void find_absorbed(uint pixel, vec3 direction, float length_m)
{
    for (uint m = 0; m < frame.medium_count; m++) {
        float t0_m = 0.0, t1_m = length_m;
        bool is_met = clip_box(frame.media[m].low_m, frame.media[m].high_m, vec3(0.0), direction,
                               t0_m, t1_m);
        for (uint l = 0; l < frame.media[m].layer_count; l++) {
            float depth = is_met ? fog_optical_depth(frame.media[m].layers[l], t0_m * direction.y,
                                                     direction.y, t1_m - t0_m)
                                 : 0.0;
            absorbed[pixel * PARTS + m * LAYERS_MAX + l] = absorbed_fraction(depth);
        }
    }
}

void main()
{
    uint thread = gl_GlobalInvocationID.x;
    if (thread == 0) {
        progress.items_done = 0;
        progress.collisions = 0;
        progress.lookups = 0;
        progress.closed_forms = 0;
    }
    if (thread >= run.pixel_count)
        return;
    if (thread % POOL_PIXELS == 0)
        next_items[thread / POOL_PIXELS] = 0;
    vec3 direction = pixel_ray(run.first_pixel + thread);
    Hit hit = scene_hit(vec3(0.0), direction);
    vec3 behind = hit.solid == NO_SOLID ? frame.background
                                        : surface_sunlight(hit, hit.t_m * direction);
    float eye_depth_m =
        hit.solid == NO_SOLID ? FAR_M : hit.t_m * dot(direction, frame.camera_forward);
    vec3 arriving = transmittance(scene_optical_depth(vec3(0.0), direction, hit.t_m));
    find_absorbed(thread, direction, hit.t_m);
    pixels[thread].behind = vec4(behind, eye_depth_m);
    pixels[thread].transmittance = vec4(arriving, 0.0);
}
