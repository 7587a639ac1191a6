// SPDX-License-Identifier: MIT
//
// A ray through what the picture shows: along its line on the screen (M. McGuire, M. Mara,
// "Efficient GPU Screen-Space Ray Tracing", JCGT 3(4), 2014), to the first surface that it goes
// behind. A pixel's surface is its plane, so that a hit is where the ray meets the plane, not
// where the steps are.
#ifndef NEPH_SCREEN_RAY_GLSL
#define NEPH_SCREEN_RAY_GLSL

#include "screen.glsl"

struct ScreenHit {
    bool is_found;
    ivec2 pixel;   // whose surface it is
    vec3 point_m;  // where the ray meets it
};

struct ScreenRay {
    ivec2 own; // the pixel that it leaves
    vec3 from_m, direction;
    float length_m;         // as far as it is before the camera
    vec2 from_px, to_px;    // of its ends
    float per_from, per_to; // 1 / depth there; of an orthographic camera 1
    float share;            // of the way on the screen that is in the picture
};

ScreenRay screen_ray(ivec2 own, vec3 from_m, vec3 direction, float most_m)
{
    const float NEAREST = 0.01; // of the depth where it begins
    ScreenRay ray;
    ray.own = own;
    ray.from_m = from_m;
    ray.direction = direction;
    ray.length_m = direction.z < 0.0 ? min(most_m, (1.0 - NEAREST) * from_m.z / -direction.z)
                                     : most_m;
    vec3 to_m = from_m + ray.length_m * direction;
    ray.from_px = pixel_of(from_m);
    ray.to_px = pixel_of(to_m);
    ray.per_from = is_orthographic() ? 1.0 : 1.0 / from_m.z;
    ray.per_to = is_orthographic() ? 1.0 : 1.0 / to_m.z;
    vec2 way = ray.to_px - ray.from_px;
    vec2 edge = mix(vec2(0.0), vec2(size_px()), greaterThan(way, vec2(0.0)));
    vec2 shares = mix((edge - ray.from_px) / way, vec2(1.0), lessThan(abs(way), vec2(1e-6)));
    ray.share = clamp(min(shares.x, shares.y), 0.0, 1.0);
    return ray;
}

// How far along the ray a share of its way on the screen is.
float along_m(ScreenRay ray, float share)
{
    float end = share * ray.per_to;
    return ray.length_m * end / ((1.0 - share) * ray.per_from + end);
}

// How much deeper a place on the ray is than what is seen there [m], and in which pixel; very
// negative where that is the sky, the ray's own pixel or none.
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

// Between two places, before and behind a surface, halves the way until they are near; how far the
// second is behind it then.
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

// Where the ray meets the plane of a pixel; where it does not, the place that is behind it.
vec3 meeting_m(ScreenRay ray, ivec2 pixel, float share)
{
    vec3 normal = normal_at(pixel), surface = surface_m(pixel);
    float falling = dot(normal, ray.direction), at_m = along_m(ray, share);
    float meets_m = falling < 0.0 ? dot(normal, surface - ray.from_m) / falling : at_m;
    const float SLACK = 1.5; // a plane's place is that of its own pixel, not of the step's
    return ray.from_m + (meets_m > 0.0 && meets_m < SLACK * at_m ? meets_m : at_m) * ray.direction;
}

// `offset`: in [0, 1), of a step. Where the ray is first behind something it has either met a
// surface, which is near there, or gone behind its edge, farther than the thickness: then it passes
// by, and what it meets until it comes out is not known.
ScreenHit screen_march(ScreenRay ray, int steps, float offset)
{
    const float SAME = 1e-4; // of the depth, that floats leave
    float way_px = ray.share * length(ray.to_px - ray.from_px);
    float power = setting(SCREEN_RAY_STEP_POWER);
    int count = int(min(float(steps), ceil(power * way_px))); // the last steps are so much longer
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
