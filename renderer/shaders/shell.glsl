// SPDX-License-Identifier: MIT
//
// An exponential atmosphere around a sphere: density e^(-height / scale height), 0 inside the
// sphere; and the integral along a ray.
//
// A ray only rises on either side of its lowest point. Each of these two legs is integrated from
// its denser end by eight-point Gauss-Legendre quadrature, over the first 3 and the next 14
// e-foldings. The relative error is below 5e-7 for a radius of at least the scale height, and below
// 5e-8 for at least 10 scale heights.
#ifndef NEPH_SHELL_GLSL
#define NEPH_SHELL_GLSL

#include "globe.glsl"
#include "stretch.glsl"

struct Shell {
    Globe globe;
    float scale_height_m;
    float reach_m; // a ray above this height meets less than 1e-7 of optical depth
};

float shell_density(Shell shell, vec3 point_m)
{
    float height_m = globe_altitude_m(shell.globe, point_m);
    return height_m >= 0.0 ? transmittance(height_m / shell.scale_height_m) : 0.0;
}

// e^(-climb / scale height) at four distances along a leg from the radius r0. `rise` is r0 times
// the cosine to the vertical, >= 0.
vec4 shell_fall(Shell shell, float r0_m, float rise_m, vec4 x_m)
{
    vec4 growth_m2 = x_m * (2.0 * rise_m + x_m);
    vec4 climb_m = growth_m2 / (r0_m + sqrt(r0_m * r0_m + growth_m2));
    return exp(max(-climb_m / shell.scale_height_m, EXPONENT_MIN));
}

// Integral of a leg's relative density over [x0, x1].
float shell_panel_m(Shell shell, float r0_m, float rise_m, float x0_m, float x1_m)
{
    const vec4 NODES = vec4(0.183434642, 0.525532410, 0.796666477, 0.960289856);
    const vec4 WEIGHTS = vec4(0.181341892, 0.156853323, 0.111190517, 0.0506142681);
    float middle_m = 0.5 * (x0_m + x1_m), half_m = 0.5 * (x1_m - x0_m);
    return 2.0 * half_m *
           (dot(shell_fall(shell, r0_m, rise_m, middle_m - half_m * NODES), WEIGHTS) +
            dot(shell_fall(shell, r0_m, rise_m, middle_m + half_m * NODES), WEIGHTS));
}

// Distance on a leg at which it has climbed some e-foldings.
float shell_distance_m(Shell shell, float r0_m, float rise_m, float folds)
{
    float climb_m = folds * shell.scale_height_m;
    float growth_m2 = climb_m * (2.0 * r0_m + climb_m);
    return growth_m2 / (rise_m + sqrt(rise_m * rise_m + growth_m2));
}

// Integral of the density over a leg that starts at a height, with `rise` >= 0 there.
float shell_leg_m(Shell shell, float height_m, float rise_m, float length_m)
{
    if (!(length_m > 0.0))
        return 0.0;
    float r0_m = shell.globe.radius_m + height_m;
    float near_m = min(length_m, shell_distance_m(shell, r0_m, rise_m, 3.0));
    float far_m = min(length_m, shell_distance_m(shell, r0_m, rise_m, 17.0));
    return transmittance(height_m / shell.scale_height_m) *
           (shell_panel_m(shell, r0_m, rise_m, 0.0, near_m) +
            shell_panel_m(shell, r0_m, rise_m, near_m, far_m));
}

// Integral of the density along origin + t direction over [t0, t1] [m].
float shell_integral_m(Shell shell, vec3 origin_m, vec3 direction, float t0_m, float t1_m)
{
    GlobeRay ray = globe_ray(shell.globe, origin_m, direction);
    float lowest_m = -ray.rise_m; // ray parameter of the lowest point
    float down_m = lowest_m, up_m = lowest_m; // ends of the legs: there, or at the ground
    bool grounded = globe_interval(shell.globe, ray, 0.0, down_m, up_m);
    if (!grounded)
        down_m = up_m = lowest_m;
    // The falling leg, from its end backwards.
    float end_m = min(t1_m, down_m);
    float height_m = grounded && end_m == down_m ? 0.0
                                                 : globe_altitude_m(shell.globe,
                                                                    origin_m + end_m * direction);
    float sum = shell_leg_m(shell, max(height_m, 0.0), max(-(ray.rise_m + end_m), 0.0),
                            end_m - t0_m);
    // The rising leg.
    float start_m = max(t0_m, up_m);
    height_m = grounded && start_m == up_m ? 0.0
                                           : globe_altitude_m(shell.globe,
                                                              origin_m + start_m * direction);
    return sum + shell_leg_m(shell, max(height_m, 0.0), max(ray.rise_m + start_m, 0.0),
                             t1_m - start_m);
}

// Clips a stretch to the heights 0..reach_m.
void shell_narrow(Shell shell, vec3 origin_m, vec3 direction, inout Stretch inside)
{
    globe_hull(shell.globe, origin_m, direction, 0.0, shell.reach_m, inside.t0_m, inside.t1_m);
}

#endif
