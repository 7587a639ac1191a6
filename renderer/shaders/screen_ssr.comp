#version 450
// SPDX-License-Identifier: MIT
//
// Screen-space reflections of metal. Rays are sampled from the visible normals of the GGX
// distribution (E. Heitz 2018); a mirror needs one ray. A hit surface has this frame's light of
// diffuse surfaces, and the reflections of the frame before, as the camera saw them. Back faces are
// not hit.
//
// Output SCREEN_SSR_RAW: rgb reflected light of surfaces, w fraction that comes from the sky, both
// for a white metal.
#extension GL_GOOGLE_include_directive : require

#include "screen_before.glsl"
#include "screen_lights.glsl"

// Bilinear interpolation of SCREEN_LIT over pixels of the same depth.
vec3 lit_at(vec2 place_px, ivec2 pixel)
{
    const float SAME = 0.05; // relative to the depth
    ivec2 corner = ivec2(floor(place_px - 0.5));
    vec2 way = place_px - 0.5 - vec2(corner);
    float depth_m = depth_at_m(pixel);
    vec4 sum = vec4(0.0);
    for (int i = 0; i < 4; i++) {
        ivec2 side = ivec2(i & 1, i >> 1), at = corner + side;
        vec2 share = mix(1.0 - way, way, equal(side, ivec2(1)));
        if (is_inside(at) && abs(depth_at_m(at) - depth_m) < SAME * depth_m)
            sum += share.x * share.y * vec4(load(SCREEN_LIT, at).rgb, 1.0);
    }
    return sum.w > 0.01 ? sum.rgb / sum.w : load(SCREEN_LIT, pixel).rgb;
}

// rgb light of the surface that the ray hits, or w = 1 when it reaches the sky.
vec4 reflected_along(ScreenRay ray, float offset)
{
    ScreenHit hit = screen_march(ray, choice(SCREEN_SSR_STEPS), offset);
    if (!hit.is_found || dot(normal_at(hit.pixel), ray.direction) >= 0.0)
        return vec4(0.0, 0.0, 0.0, 1.0);
    if (view.has_bounces == 0u)
        return vec4(0.0);
    if (!(load(SCREEN_BASE, hit.pixel).w > 0.0))
        return vec4(lit_at(project_to_pixel(hit.point_m), hit.pixel), 0.0);
    vec3 diffuse = load(SCREEN_LIT, hit.pixel).rgb - load(SCREEN_DIRECT, hit.pixel).rgb;
    return vec4(max(diffuse, 0.0) + direct_into(ray.direction, hit.pixel) +
                    indirect_before(hit, false), 0.0);
}

void main()
{
    ivec2 cell;
    if (!get_thread_cell(cell))
        return;
    ivec2 pixel = pixel_in(cell);
    float depth_m = depth_at_m(pixel), metalness = load(SCREEN_BASE, pixel).w;
    if (is_sky(depth_m) || !(metalness > 0.0)) {
        store(SCREEN_SSR_RAW, cell, vec4(0.0));
        return;
    }
    float roughness = load(SCREEN_NORMAL, pixel).w, alpha = roughness * roughness;
    if (roughness > setting(SCREEN_SSR_ROUGHEST)) {
        float open = view.open_at != SCREEN_NONE ? load(int(view.open_at), pixel).x : 1.0;
        store(SCREEN_SSR_RAW, cell, vec4(0.0, 0.0, 0.0, open));
        return;
    }
    vec3 point_m = place_m(pixel_centre_px(pixel), depth_m), normal = normal_at(pixel);
    vec3 first, second, eye = to_camera(point_m);
    basis_across(normal, first, second);
    vec3 own_eye = vec3(dot(eye, first), dot(eye, second), max(1e-4, dot(eye, normal)));
    uint rays = alpha > 0.0 ? uint(choice(SCREEN_SSR_RAYS)) : 1u;
    vec4 sum = vec4(0.0);
    for (uint i = 0; i < rays; i++) {
        vec3 facet = alpha > 0.0 ? visible_facet(alpha, own_eye,
                                                 ray_noise(cell, 3u, view.frame * rays + i))
                                 : vec3(0.0, 0.0, 1.0);
        vec3 own = reflect(-own_eye, facet);
        if (!(own.z > 0.0))
            continue;
        vec3 direction = normalize(own.x * first + own.y * second + own.z * normal);
        ScreenRay ray = screen_ray(pixel, point_m, direction, FAR_M);
        float weight = alpha > 0.0 ? masking(alpha, own.z) : 1.0;
        sum += weight * reflected_along(ray, ray_offset(cell, 4u, view.frame + i));
    }
    store(SCREEN_SSR_RAW, cell, sum / float(rays));
}
