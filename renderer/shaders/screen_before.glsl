// SPDX-License-Identifier: MIT
//
// What the frame before knew of a surface that a ray meets.
#ifndef NEPH_SCREEN_BEFORE_GLSL
#define NEPH_SCREEN_BEFORE_GLSL

#include "screen_ray.glsl"

// Where in its first step a ray begins.
float ray_offset(ivec2 cell, uint salt, uint index)
{
    return choice(SCREEN_RAY_NOISE) != 0 ? ray_noise(cell, salt, index).x : 0.0;
}

// Where a place of a solid was seen in the frame before; false: it was not.
bool seen_before(uint solid, vec3 point_m, vec3 normal, out ivec2 pixel)
{
    const float OFF_PLANE = 0.02; // of its depth
    vec3 was_m = place_before_m(solid, point_m);
    if (view.has_before == 0u || !(was_m.z > 0.0))
        return false;
    pixel = ivec2(floor(pixel_of(was_m)));
    if (!is_inside(pixel) || is_sky(depth_before_m(pixel)))
        return false;
    vec3 seen_m = place_m(centre_of(pixel), depth_before_m(pixel));
    return abs(dot(direction_before(solid, normal), seen_m - was_m)) < OFF_PLANE * was_m.z;
}

// What a surface in the picture reflects of the sky, where no frame before knows more: as much as
// its ambient occlusion leaves open.
vec3 sky_reflected(ivec2 pixel)
{
    float open = view.open_at != SCREEN_NONE ? load(int(view.open_at), pixel).x : 1.0;
    return load(SCREEN_BASE, pixel).rgb * open * sky_light();
}

// What a surface in the picture reflected of others and the sky in the frame before: off its
// diffuse part, if that is asked for, and off its metal, as the camera saw it.
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
