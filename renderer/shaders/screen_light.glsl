// SPDX-License-Identifier: MIT
//
// What comes along a ray through the picture.
#ifndef NEPH_SCREEN_LIGHT_GLSL
#define NEPH_SCREEN_LIGHT_GLSL

#include "screen_ray.glsl"

// Where in its first step a ray begins.
float ray_offset(ivec2 pixel, uint salt, uint index)
{
    return choice(SCREEN_RAY_NOISE) != 0 ? ray_noise(pixel, salt, index).x : 0.0;
}

// Where a place was seen in the frame before; false: it was not.
bool seen_before(vec3 point_m, vec3 normal, out ivec2 pixel)
{
    const float OFF_PLANE = 0.02; // of its depth
    vec3 was_m = place_before_m(point_m);
    if (view.has_before == 0u || !(was_m.z > 0.0))
        return false;
    pixel = ivec2(floor(pixel_of(was_m)));
    if (!is_inside(pixel) || is_sky(depth_before_m(pixel)))
        return false;
    vec3 seen_m = place_m(centre_of(pixel), depth_before_m(pixel));
    return abs(dot(direction_before(normal), seen_m - was_m)) < OFF_PLANE * was_m.z;
}

// Of a surface in the picture, what its diffuse part had as indirect light in the frame before.
vec3 indirect_before(ScreenHit hit)
{
    ivec2 was;
    vec4 base = load(SCREEN_BASE, hit.pixel);
    if (!seen_before(hit.point_m, normal_at(hit.pixel), was))
        return vec3(0.0);
    return base.rgb * (1.0 - base.w) * load(SCREEN_GI_BEFORE, was).rgb;
}

// RGB and in w 1 where it met something. A ray that meets nothing sees the sky.
vec4 light_along(ScreenRay ray, int steps, float offset, bool with_indirect)
{
    ScreenHit hit = screen_march(ray, steps, offset);
    if (!hit.is_found)
        return vec4(sky_light(), 0.0);
    if (dot(normal_at(hit.pixel), ray.direction) >= 0.0)
        return vec4(0.0, 0.0, 0.0, 1.0);
    vec3 light = load(SCREEN_DIRECT, hit.pixel).rgb;
    return vec4(with_indirect ? light + indirect_before(hit) : light, 1.0);
}

#endif
