// SPDX-License-Identifier: MIT
//
// An exponential atmosphere around a sphere, e^(-(r - R) / H) outside, nothing inside. Everything is
// told from the camera: a float32 knows a radius of 6.4e6 m to half a metre only, so altitudes are
// differences taken from the camera's own, which the CPU found in double.
#ifndef NEPH_SHELL_GLSL
#define NEPH_SHELL_GLSL

#include "numbers.glsl"

struct Shell {
    vec3 up;                 // unit, from the sphere's centre to the camera
    float camera_radius_m;   // of the camera's place, > 0
    float camera_altitude_m; // of the camera above the ground R
    float scale_height_m;
    uvec2 padding;
};

// Altitude above the ground of a point [m], from |p + c|^2 - |c|^2 = 2 c.p + p^2.
float shell_altitude_m(Shell shell, vec3 point_m)
{
    float rise = 2.0 * dot(point_m, shell.up) + dot(point_m, point_m) / shell.camera_radius_m;
    // r / r_camera = sqrt(1 + rise / r_camera)
    float ratio = sqrt(max(1.0 + rise / shell.camera_radius_m, 0.0));
    return shell.camera_altitude_m + rise / (1.0 + ratio);
}

// Density at a point, 1 on the ground.
float shell_density(Shell shell, vec3 point_m)
{
    float altitude_m = shell_altitude_m(shell, point_m);
    if (altitude_m < 0.0)
        return 0.0;
    return exp(max(-altitude_m / shell.scale_height_m, EXPONENT_MIN));
}

// One leg upwards: x is the distance from the ray's lowest point, at radius `low_m`. The integral of
// e^(-(r(x) - r(x0)) / H) over [x0, x1], 0 <= x0 <= x1: six-point Gauss-Legendre over pieces of
// three e-foldings each, six of them (e^-18 = 1.5e-8 is left out).
float shell_leg_m(float low_m, float scale_height_m, float x0_m, float x1_m)
{
    const float node[3] = float[3](0.238619186083197, 0.661209386466265, 0.932469514203152);
    const float weight[3] = float[3](0.467913934572691, 0.360761573048139, 0.171324492379170);
    float r0_m = length(vec2(low_m, x0_m));
    float sum_m = 0.0, from_m = x0_m;
    for (int piece = 1; piece <= 6 && from_m < x1_m; piece++) {
        float climb_m = 3.0 * float(piece) * scale_height_m;
        float to_m = min(sqrt(x0_m * x0_m + climb_m * (2.0 * r0_m + climb_m)), x1_m);
        float middle_m = 0.5 * (from_m + to_m), half_m = 0.5 * (to_m - from_m);
        for (int i = 0; i < 3; i++) {
            vec2 x_m = middle_m + vec2(-1.0, 1.0) * node[i] * half_m;
            vec2 r_m = vec2(length(vec2(low_m, x_m.x)), length(vec2(low_m, x_m.y)));
            vec2 climbed = (x_m - x0_m) * (x_m + x0_m) / (r_m + r0_m) / scale_height_m;
            sum_m += half_m * weight[i] * (exp(-climbed.x) + exp(-climbed.y));
        }
        from_m = to_m;
    }
    return sum_m;
}

// The part of a leg above the ground. `low_altitude_m` is that of the lowest point; `x0` starts it.
float shell_leg_integral_m(Shell shell, float low_m, float low_altitude_m, float x0_m, float x1_m)
{
    if (low_altitude_m < 0.0) // R^2 - low^2 = -a (2 low - a), a the (negative) altitude
        x0_m = max(x0_m, sqrt(-low_altitude_m * (2.0 * low_m - low_altitude_m)));
    if (x0_m >= x1_m)
        return 0.0;
    float r0_m = length(vec2(low_m, x0_m));
    float altitude_m = max(low_altitude_m + x0_m * x0_m / (r0_m + low_m), 0.0);
    return exp(max(-altitude_m / shell.scale_height_m, EXPONENT_MIN)) *
           shell_leg_m(low_m, shell.scale_height_m, x0_m, x1_m);
}

// The integral of the density over t in [t0, t1] [m].
float shell_integral_m(Shell shell, vec3 origin_m, vec3 direction, float t0_m, float t1_m)
{
    // The lowest point of the line, from the camera: where (c + p) . direction = 0.
    float nearest_m = -dot(origin_m, direction) - shell.camera_radius_m * dot(shell.up, direction);
    vec3 low_point_m = origin_m + nearest_m * direction;
    float low_altitude_m = shell_altitude_m(shell, low_point_m);
    float low_m = shell.camera_radius_m - shell.camera_altitude_m + low_altitude_m;
    float x0_m = t0_m - nearest_m, x1_m = t1_m - nearest_m;
    if (x0_m >= 0.0)
        return shell_leg_integral_m(shell, low_m, low_altitude_m, x0_m, x1_m);
    if (x1_m <= 0.0)
        return shell_leg_integral_m(shell, low_m, low_altitude_m, -x1_m, -x0_m);
    return shell_leg_integral_m(shell, low_m, low_altitude_m, 0.0, -x0_m) +
           shell_leg_integral_m(shell, low_m, low_altitude_m, 0.0, x1_m);
}

#endif
