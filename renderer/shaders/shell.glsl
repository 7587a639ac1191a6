// SPDX-License-Identifier: MIT
//
// An exponential atmosphere around a sphere: density e^(-height / scale height), none inside. On
// either side of its lowest point a ray only rises; such a leg is integrated from its denser end by
// eight-point Gauss-Legendre over the first 3 and the next 14 e-foldings. Relative error of the
// quadrature below 5e-7 when the radius is at least the scale height (5e-8 from 10 of them on).
#ifndef NEPH_SHELL_GLSL
#define NEPH_SHELL_GLSL

#include "globe.glsl"
#include "stretch.glsl"

struct Shell {
    Globe globe;
    float scale_height_m;
    float reach_m; // above this height a ray meets less than 1e-7 of optical depth
};

float shell_density(Shell shell, vec3 point_m)
{
    float height_m = globe_altitude_m(shell.globe, point_m);
    return height_m >= 0.0 ? transmittance(height_m / shell.scale_height_m) : 0.0;
}

// e^(-climb / scale height) at four distances along a leg from radius r0 with `rise` >= 0.
vec4 shell_fall(Shell shell, float r0_m, float rise_m, vec4 x_m)
{
    vec4 growth_m2 = x_m * (2.0 * rise_m + x_m);
    vec4 climb_m = growth_m2 / (r0_m + sqrt(r0_m * r0_m + growth_m2));
    return exp(max(-climb_m / shell.scale_height_m, EXPONENT_MIN));
}

// Integral of the density of a leg over [x0, x1].
float shell_panel_m(Shell shell, float r0_m, float rise_m, float x0_m, float x1_m)
{
    const vec4 NODES = vec4(0.183434642, 0.525532410, 0.796666477, 0.960289856);
    const vec4 WEIGHTS = vec4(0.181341892, 0.156853323, 0.111190517, 0.0506142681);
    float middle_m = 0.5 * (x0_m + x1_m), half_m = 0.5 * (x1_m - x0_m);
    return 2.0 * half_m *
           (dot(shell_fall(shell, r0_m, rise_m, middle_m - half_m * NODES), WEIGHTS) +
            dot(shell_fall(shell, r0_m, rise_m, middle_m + half_m * NODES), WEIGHTS));
}

// How far a leg goes until it has risen by some e-foldings.
float shell_distance_m(Shell shell, float r0_m, float rise_m, float folds)
{
    float climb_m = folds * shell.scale_height_m;
    float growth_m2 = climb_m * (2.0 * r0_m + climb_m);
    return growth_m2 / (rise_m + sqrt(rise_m * rise_m + growth_m2));
}

// A leg of some length from a denser end at a height, with `rise` >= 0 there.
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
    float lowest_m = -ray.rise_m; // where the ray is lowest; the legs end and begin there, or at
    float down_m = lowest_m, up_m = lowest_m; // the ground
    bool grounded = globe_interval(shell.globe, ray, 0.0, down_m, up_m);
    if (!grounded)
        down_m = up_m = lowest_m;
    // Falling leg, from its end backwards.
    float end_m = min(t1_m, down_m);
    float height_m = grounded && end_m == down_m ? 0.0
                                                 : globe_altitude_m(shell.globe,
                                                                    origin_m + end_m * direction);
    float sum = shell_leg_m(shell, max(height_m, 0.0), max(-(ray.rise_m + end_m), 0.0),
                            end_m - t0_m);
    // Rising leg.
    float start_m = max(t0_m, up_m);
    height_m = grounded && start_m == up_m ? 0.0
                                           : globe_altitude_m(shell.globe,
                                                              origin_m + start_m * direction);
    return sum + shell_leg_m(shell, max(height_m, 0.0), max(ray.rise_m + start_m, 0.0),
                             t1_m - start_m);
}

void shell_narrow(Shell shell, vec3 origin_m, vec3 direction, inout Stretch inside)
{
    globe_hull(shell.globe, origin_m, direction, 0.0, shell.reach_m, inside.t0_m, inside.t1_m);
}

#endif
