// SPDX-License-Identifier: MIT
//
// Screen-space ray tracing: marches a ray along its line in the image (M. McGuire and M. Mara,
// "Efficient GPU Screen-Space Ray Tracing", JCGT 3(4), 2014) to the first visible surface that it
// passes behind. A pixel's surface is its tangent plane, so the hit is the intersection with that
// plane, and does not depend on the steps.
//
//   eye depth
//      ^         ______     surface in the depth buffer
//      |   _____/    x      x: first step behind it
//      |        x  x
//      |  x  x              ray
//      +-----------------> along the line in the image
#ifndef NEPH_SCREEN_RAY_GLSL
#define NEPH_SCREEN_RAY_GLSL

#include "screen.glsl"

struct ScreenHit {
    bool is_found;
    ivec2 pixel;   // with the surface that is hit
    vec3 point_m;  // intersection of the ray with the surface
};

struct ScreenRay {
    ivec2 own; // pixel of the ray's origin
    vec3 from_m, direction;
    float length_m;         // limited to the part in front of the camera
    vec2 from_px, to_px;    // image positions of its ends
    float per_from, per_to; // 1 / depth of the ends; 1 for an orthographic camera
    float share;            // fraction of the line that is inside the image
};

ScreenRay screen_ray(ivec2 own, vec3 from_m, vec3 direction, float most_m)
{
    const float NEAREST = 0.01; // nearest depth, relative to the origin's
    ScreenRay ray;
    ray.own = own;
    ray.from_m = from_m;
    ray.direction = direction;
    ray.length_m = direction.z < 0.0 ? min(most_m, (1.0 - NEAREST) * from_m.z / -direction.z)
                                     : most_m;
    vec3 to_m = from_m + ray.length_m * direction;
    ray.from_px = project_to_pixel(from_m);
    ray.to_px = project_to_pixel(to_m);
    ray.per_from = is_orthographic() ? 1.0 : 1.0 / from_m.z;
    ray.per_to = is_orthographic() ? 1.0 : 1.0 / to_m.z;
    vec2 way = ray.to_px - ray.from_px;
    vec2 edge = mix(vec2(0.0), vec2(size_px()), greaterThan(way, vec2(0.0)));
    vec2 shares = mix((edge - ray.from_px) / way, vec2(1.0), lessThan(abs(way), vec2(1e-6)));
    ray.share = clamp(min(shares.x, shares.y), 0.0, 1.0);
    return ray;
}

// Distance along the ray at a fraction of the line in the image. 1 / depth is linear in the image,
// so (perspective-correct interpolation) t = L s w1 / ((1 - s) w0 + s w1).
float along_m(ScreenRay ray, float share)
{
    float end = share * ray.per_to;
    return ray.length_m * end / ((1.0 - share) * ray.per_from + end);
}

// Depth of the ray minus depth of the visible surface at the same image position [m], and the
// pixel. -FAR_M for the sky, outside the image, and in the ray's own pixel.
float behind_m(ScreenRay ray, float share, out ivec2 pixel, out float depth_m)
{
    vec2 place_px = mix(ray.from_px, ray.to_px, share);
    depth_m = ray.from_m.z + along_m(ray, share) * ray.direction.z;
    pixel = ivec2(floor(place_px));
    if (!is_inside(pixel) || pixel == ray.own || is_sky(depth_at_m(pixel)))
        return -FAR_M;
    vec3 seen_m;
    return depth_m - (plane_at(place_px, pixel, seen_m) ? seen_m.z : depth_at_m(pixel));
}

// Bisection between a place in front of a surface and one behind it. Returns the distance of the
// second behind the surface.
float refine(ScreenRay ray, float before, inout float behind, inout ivec2 pixel, float gap_m)
{
    for (int i = 0; i < choice(SCREEN_RAY_REFINE); i++) {
        float middle = 0.5 * (before + behind), depth_m;
        ivec2 seen;
        float found_m = behind_m(ray, middle, seen, depth_m);
        if (found_m > 0.0) {
            behind = middle;
            pixel = seen;
            gap_m = found_m;
        } else {
            before = middle;
        }
    }
    return gap_m;
}

// Intersection of the ray with a pixel's tangent plane; without one, the place behind the surface.
vec3 meeting_m(ScreenRay ray, ivec2 pixel, float share)
{
    vec3 normal = normal_at(pixel), surface = surface_m(pixel);
    float falling = dot(normal, ray.direction), at_m = along_m(ray, share);
    float meets_m = falling < 0.0 ? dot(normal, surface - ray.from_m) / falling : at_m;
    const float SLACK = 1.5; // the plane belongs to the pixel's centre, not to the step's position
    return ray.from_m + (meets_m > 0.0 && meets_m < SLACK * at_m ? meets_m : at_m) * ray.direction;
}

// Finds the first hit. `offset` in [0, 1) is the start within a step. Where the ray is first behind
// the depth buffer, it has either hit a surface, which is near, or passed behind an object's edge,
// when the distance exceeds the thickness. In the second case the ray goes on, and finds nothing
// until it is in front of the depth buffer again.
ScreenHit screen_march(ScreenRay ray, int steps, float offset)
{
    const float SAME = 1e-4; // relative to the depth: rounding
    float way_px = ray.share * length(ray.to_px - ray.from_px);
    float power = setting(SCREEN_RAY_STEP_POWER);
    // The last steps are longer by `power`.
    int count = int(min(float(steps), ceil(power * way_px)));
    float thickness_m = setting(SCREEN_RAY_THICKNESS_M);
    float before = 0.0;
    bool is_hidden = false;
    for (int i = 0; i < count; i++) {
        float share = ray.share * pow((float(i) + 1.0 - offset) / float(count), power), depth_m;
        ivec2 pixel;
        float gap_m = behind_m(ray, share, pixel, depth_m);
        if (gap_m > SAME * depth_m && !is_hidden) {
            float met = share;
            gap_m = refine(ray, before, met, pixel, gap_m);
            if (thickness_m == 0.0 || gap_m < thickness_m)
                return ScreenHit(true, pixel, meeting_m(ray, pixel, met));
        }
        is_hidden = gap_m > SAME * depth_m;
        before = share;
    }
    return ScreenHit(false, ivec2(0), vec3(0.0));
}

#endif
