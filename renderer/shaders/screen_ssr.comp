#version 450
// SPDX-License-Identifier: MIT
//
// Reflections of metal: rays by the facets that the camera sees (Heitz 2018), one for a mirror.
// What a ray meets has the light of diffuse surfaces of this frame, and what metal there reflected
// of others in the frame before, as the camera sees it. A surface that turns its back is not met.
#extension GL_GOOGLE_include_directive : require

#include "screen_before.glsl"
#include "screen_lights.glsl"

// Between the centres of pixels of the same depth.
vec3 lit_at(vec2 place_px, ivec2 pixel)
{
    const float SAME = 0.05; // of the depth
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

vec4 reflected_along(ScreenRay ray, float offset)
{
    ScreenHit hit = screen_march(ray, choice(SCREEN_SSR_STEPS), offset);
    if (!hit.is_found || dot(normal_at(hit.pixel), ray.direction) >= 0.0)
        return vec4(0.0, 0.0, 0.0, 1.0);
    if (view.has_bounces == 0u)
        return vec4(0.0);
    if (!(load(SCREEN_BASE, hit.pixel).w > 0.0))
        return vec4(lit_at(pixel_of(hit.point_m), hit.pixel), 0.0);
    vec3 diffuse = load(SCREEN_LIT, hit.pixel).rgb - load(SCREEN_DIRECT, hit.pixel).rgb;
    return vec4(max(diffuse, 0.0) + direct_into(ray.direction, hit.pixel) +
                    indirect_before(hit, false), 0.0);
}

void main()
{
    ivec2 cell;
    if (!own_cell(cell))
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
    vec3 point_m = place_m(centre_of(pixel), depth_m), normal = normal_at(pixel);
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
