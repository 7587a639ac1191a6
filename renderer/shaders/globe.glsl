// SPDX-License-Identifier: MIT
//
// Heights above a sphere of planetary size, without cancellation. In float32 the difference r - R
// is accurate to half a metre at Earth's size. Every height here is instead the camera's altitude,
// subtracted in double precision on the CPU, plus a climb relative to the camera:
//
//   r - r0 = (r^2 - r0^2) / (r + r0)
#ifndef NEPH_GLOBE_GLSL
#define NEPH_GLOBE_GLSL

#include "numbers.glsl"

struct Globe {
    vec3 up;                 // from the sphere's centre to the camera, unit
    float camera_radius_m;   // the camera's distance from the centre
    float camera_altitude_m; // camera_radius_m - radius_m, computed in double
    float radius_m;
};

// Climb r - r0 from the radius r0, for growth = r^2 - r0^2.
float globe_climb_m(float r0_m, float growth_m2)
{
    float r_m = sqrt(max(r0_m * r0_m + growth_m2, 0.0));
    return growth_m2 / max(r0_m + r_m, 1e-20); // avoids 0 / 0 at the sphere's centre
}

// Height above the sphere of a point relative to the camera; negative inside.
float globe_altitude_m(Globe globe, vec3 point_m)
{
    float growth_m2 = 2.0 * globe.camera_radius_m * dot(globe.up, point_m) + dot(point_m, point_m);
    return globe.camera_altitude_m + globe_climb_m(globe.camera_radius_m, growth_m2);
}

// A ray relative to the sphere: r(t)^2 = r^2 + 2 rise t + t^2.
struct GlobeRay {
    float altitude_m; // of its origin
    float rise_m;     // r times the cosine to the vertical, at its origin; lowest at t = -rise
};

GlobeRay globe_ray(Globe globe, vec3 origin_m, vec3 direction)
{
    return GlobeRay(globe_altitude_m(globe, origin_m),
                    globe.camera_radius_m * dot(globe.up, direction) + dot(origin_m, direction));
}

// The part of the ray inside the sphere of radius R + height; false when there is none. The ends
// are the roots of t^2 + 2 rise t + c, with c = r^2 - (R + height)^2 factored against cancellation.
// The root of larger magnitude is computed first, the other one as c over it.
bool globe_interval(Globe globe, GlobeRay ray, float height_m, out float t0_m, out float t1_m)
{
    float above_m = ray.altitude_m - height_m;
    float c = above_m * (2.0 * (globe.radius_m + height_m) + above_m);
    float discriminant = ray.rise_m * ray.rise_m - c;
    float root_m = sqrt(max(discriminant, 0.0));
    float large_m = ray.rise_m > 0.0 ? -ray.rise_m - root_m : -ray.rise_m + root_m;
    float small_m = abs(large_m) > 0.0 ? c / large_m : 0.0;
    t0_m = min(large_m, small_m);
    t1_m = max(large_m, small_m);
    return discriminant > 0.0;
}

// The hull of the ray's parts between two heights, clipped to [t0, t1]; empty when t1 <= t0. The
// lower sphere only shortens the hull when one of its ends is inside that sphere.
void globe_hull(Globe globe, vec3 origin_m, vec3 direction, float low_m, float high_m,
                inout float t0_m, inout float t1_m)
{
    GlobeRay ray = globe_ray(globe, origin_m, direction);
    float a_m, b_m;
    if (!globe_interval(globe, ray, high_m, a_m, b_m)) {
        t1_m = t0_m;
        return;
    }
    float from_m = max(t0_m, a_m), to_m = min(t1_m, b_m);
    if (globe_interval(globe, ray, low_m, a_m, b_m)) { // one end may be inside the lower sphere
        if (a_m <= from_m)
            from_m = max(from_m, b_m);
        if (b_m >= to_m)
            to_m = min(to_m, a_m);
    }
    t0_m = from_m;
    t1_m = to_m;
}

#endif
