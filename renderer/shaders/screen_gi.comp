#version 450
// SPDX-License-Identifier: MIT
//
// Screen-space indirect light of diffuse surfaces. Cosine-distributed rays collect the light of the
// visible surface that they hit, or the sky's light where they hit none. Back faces give no light.
// With gi_bounces=all a hit surface also has its indirect light of the frame before.
//
// Output SCREEN_GI_RAW: rgb light of surfaces, w fraction of rays that reach the sky.
#extension GL_GOOGLE_include_directive : require

#include "screen_before.glsl"
#include "screen_lights.glsl"

// Radiance of a hit surface towards the ray's origin.
vec3 hit_radiance(ScreenHit hit, vec3 direction)
{
    bool is_front = dot(normal_at(hit.pixel), direction) < 0.0;
    if (!is_front || view.has_bounces == 0u)
        return vec3(0.0);
    vec3 light = direct_into(direction, hit.pixel);
    bool with_indirect = choice(SCREEN_GI_BOUNCES) == SCREEN_BOUNCES_ALL;
    return light + (with_indirect ? indirect_before(hit, true) : sky_reflected(hit.pixel));
}

void main()
{
    ivec2 cell;
    if (!get_thread_cell(cell))
        return;
    ivec2 pixel = pixel_in(cell);
    float depth_m = depth_at_m(pixel);
    if (is_sky(depth_m) || load(SCREEN_BASE, pixel).w >= 1.0) { // pure metal has no diffuse part
        store(SCREEN_GI_RAW, cell, vec4(0.0));
        return;
    }
    vec3 point_m = place_m(pixel_centre_px(pixel), depth_m), normal = normal_at(pixel);
    vec3 first, second;
    basis_across(normal, first, second);
    uint rays = uint(choice(SCREEN_GI_RAYS));
    float reach_m = setting(SCREEN_GI_REACH_M) > 0.0 ? setting(SCREEN_GI_REACH_M) : FAR_M;
    vec4 sum = vec4(0.0);
    for (uint i = 0; i < rays; i++) {
        vec2 u = ray_noise(cell, 1u, view.frame * rays + i);
        float side = sqrt(u.x), angle = 2.0 * PI * u.y;
        vec3 direction = normalize(side * cos(angle) * first + side * sin(angle) * second +
                                   sqrt(1.0 - u.x) * normal);
        ScreenRay ray = screen_ray(pixel, point_m, direction, reach_m);
        ScreenHit hit = screen_march(ray, choice(SCREEN_GI_STEPS),
                                     ray_offset(cell, 2u, view.frame + i));
        sum += hit.is_found ? vec4(hit_radiance(hit, direction), 0.0) : vec4(0.0, 0.0, 0.0, 1.0);
    }
    store(SCREEN_GI_RAW, cell, sum / float(rays));
}
