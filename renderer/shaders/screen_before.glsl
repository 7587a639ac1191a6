// SPDX-License-Identifier: MIT
//
// Light of the frame before at a surface that a ray hits, for multiple bounces.
#ifndef NEPH_SCREEN_BEFORE_GLSL
#define NEPH_SCREEN_BEFORE_GLSL

#include "screen_ray.glsl"

// Start of a ray within its first step.
float ray_offset(ivec2 cell, uint salt, uint index)
{
    return choice(SCREEN_RAY_NOISE) != 0 ? ray_noise(cell, salt, index).x : 0.0;
}

// The pixel that showed a point of a solid in the frame before; false when it was not visible.
bool seen_before(uint solid, vec3 point_m, vec3 normal, out ivec2 pixel)
{
    const float OFF_PLANE = 0.02; // relative to the depth
    vec3 was_m = place_before_m(solid, point_m);
    if (view.has_before == 0u || !(was_m.z > 0.0))
        return false;
    pixel = ivec2(floor(project_to_pixel(was_m)));
    if (!is_inside(pixel) || is_sky(depth_before_m(pixel)))
        return false;
    vec3 seen_m = place_m(pixel_centre_px(pixel), depth_before_m(pixel));
    return abs(dot(direction_before(solid, normal), seen_m - was_m)) < OFF_PLANE * was_m.z;
}

// Sky light that a visible surface reflects, when the frame before has no result for it: the sky
// times the unoccluded fraction.
vec3 sky_reflected(ivec2 pixel)
{
    float open = view.open_at != SCREEN_NONE ? load(int(view.open_at), pixel).x : 1.0;
    return load(SCREEN_BASE, pixel).rgb * open * sky_light();
}

// Light of other surfaces and of the sky that a visible surface reflected in the frame before: from
// its metallic part as the camera saw it, and with `with_diffuse` also from its diffuse part.
vec3 indirect_before(ScreenHit hit, bool with_diffuse)
{
    ivec2 was;
    vec4 base = load(SCREEN_BASE, hit.pixel);
    if (!seen_before(solid_at(hit.pixel), hit.point_m, normal_at(hit.pixel), was))
        return (with_diffuse ? 1.0 : base.w) * sky_reflected(hit.pixel);
    vec3 light = vec3(0.0);
    if (with_diffuse && view.gi_at != SCREEN_NONE) {
        vec4 diffuse = load(SCREEN_GI_BEFORE, was / int(view.gi_cell_px));
        light += (1.0 - base.w) * (diffuse.rgb + diffuse.w * sky_light());
    }
    if (base.w > 0.0 && view.ssr_at != SCREEN_NONE) {
        vec4 glossy = load(SCREEN_SSR_BEFORE, was / int(view.ssr_cell_px));
        light += base.w * (glossy.rgb + glossy.w * sky_light());
    }
    return base.rgb * light;
}

#endif
