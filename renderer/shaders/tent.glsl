// SPDX-License-Identifier: MIT
//
// A layer around a sphere with a tent profile over altitude, and its integral along a ray.
//
//   density 1         .
//                    / \       peak
//                   /   \      at the centre
//   density 0  ____/     \____      over altitude
//                  |--|
//                  half_width_m
//
// The ray is split at its lowest point and where it crosses the altitudes of foot, peak and top. In
// each piece the altitude is nearly a parabola, so four-point Gauss-Legendre quadrature is accurate
// to 1e-6 of the integral for a radius of at least half the width, and to rounding for a planet.
#ifndef NEPH_TENT_GLSL
#define NEPH_TENT_GLSL

#include "globe.glsl"
#include "stretch.glsl"

struct Tent {
    Globe globe;
    float altitude_m; // of the peak
    float half_width_m;
};

float tent_density(Tent tent, vec3 point_m)
{
    float off_m = abs(globe_altitude_m(tent.globe, point_m) - tent.altitude_m);
    return max(1.0 - off_m / tent.half_width_m, 0.0);
}

// Integral over [t0, t1], in which the density has no kink.
float tent_piece_m(Tent tent, GlobeRay ray, float t0_m, float t1_m)
{
    const vec4 NODES = vec4(-0.861136312, -0.339981044, 0.339981044, 0.861136312);
    const vec4 WEIGHTS = vec4(0.347854845, 0.652145155, 0.652145155, 0.347854845);
    float middle_m = 0.5 * (t0_m + t1_m), half_m = 0.5 * (t1_m - t0_m);
    float r_m = tent.globe.radius_m + ray.altitude_m;
    vec4 t_m = middle_m + half_m * NODES;
    vec4 growth_m2 = t_m * (2.0 * ray.rise_m + t_m);
    vec4 climb_m = growth_m2 / max(r_m + sqrt(max(r_m * r_m + growth_m2, 0.0)), 1e-20);
    vec4 off_m = abs(ray.altitude_m + climb_m - tent.altitude_m);
    return max(half_m, 0.0) * dot(WEIGHTS, max(1.0 - off_m / tent.half_width_m, 0.0));
}

// The part of the ray below an altitude; empty, at the lowest point, when there is none.
vec2 tent_below_m(Tent tent, GlobeRay ray, float height_m)
{
    float t0_m, t1_m;
    return globe_interval(tent.globe, ray, height_m, t0_m, t1_m) ? vec2(t0_m, t1_m)
                                                                 : vec2(-ray.rise_m);
}

// Integral of the density along origin + t direction over [t0, t1] [m].
float tent_integral_m(Tent tent, vec3 origin_m, vec3 direction, float t0_m, float t1_m)
{
    GlobeRay ray = globe_ray(tent.globe, origin_m, direction);
    vec2 top_m = tent_below_m(tent, ray, tent.altitude_m + tent.half_width_m);
    vec2 middle_m = tent_below_m(tent, ray, tent.altitude_m);
    vec2 foot_m = tent_below_m(tent, ray, tent.altitude_m - tent.half_width_m);
    return tent_piece_m(tent, ray, max(t0_m, top_m.x), min(t1_m, middle_m.x)) +
           tent_piece_m(tent, ray, max(t0_m, middle_m.x), min(t1_m, foot_m.x)) +
           tent_piece_m(tent, ray, max(t0_m, foot_m.y), min(t1_m, middle_m.y)) +
           tent_piece_m(tent, ray, max(t0_m, middle_m.y), min(t1_m, top_m.y));
}

void tent_narrow(Tent tent, vec3 origin_m, vec3 direction, inout Stretch inside)
{
    globe_hull(tent.globe, origin_m, direction, tent.altitude_m - tent.half_width_m,
               tent.altitude_m + tent.half_width_m, inside.t0_m, inside.t1_m);
}

#endif
