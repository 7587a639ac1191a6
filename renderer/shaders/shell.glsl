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

// One leg upwards from a distance x0 >= 0 off the ray's lowest point, at radius `low_m`: the integral
// of e^(-(r(x0 + s) - r(x0)) / H) over s in [0, length], by six-point Gauss-Legendre over pieces of
// three e-foldings each, six of them (e^-18 = 1.5e-8 is left out). Counted from x0, because
// differences of distances of 6e6 m are good to half a metre only.
float shell_leg_m(float low_m, float scale_height_m, float x0_m, float length_m)
{
    const float node[3] = float[3](0.238619186083197, 0.661209386466265, 0.932469514203152);
    const float weight[3] = float[3](0.467913934572691, 0.360761573048139, 0.171324492379170);
    float r0_m = length(vec2(low_m, x0_m));
    float sum_m = 0.0, from_m = 0.0;
    for (int piece = 1; piece <= 6 && from_m < length_m; piece++) {
        float climb_m = 3.0 * float(piece) * scale_height_m;
        float rise = climb_m * (2.0 * r0_m + climb_m); // of x^2
        float to_m = min(rise / (sqrt(x0_m * x0_m + rise) + x0_m), length_m);
        float middle_m = 0.5 * (from_m + to_m), half_m = 0.5 * (to_m - from_m);
        for (int i = 0; i < 3; i++) {
            vec2 s_m = middle_m + vec2(-1.0, 1.0) * node[i] * half_m;
            vec2 r_m = vec2(length(vec2(low_m, x0_m + s_m.x)), length(vec2(low_m, x0_m + s_m.y)));
            vec2 climbed = s_m * (2.0 * x0_m + s_m) / (r_m + r0_m) / scale_height_m;
            sum_m += half_m * weight[i] * (exp(-climbed.x) + exp(-climbed.y));
        }
        from_m = to_m;
    }
    return sum_m;
}

// The part of a leg above the ground; it starts at an altitude (which is negative below ground).
float shell_leg_integral_m(Shell shell, float low_m, float low_altitude_m, float x0_m,
                           float altitude_m, float length_m)
{
    if (altitude_m < 0.0) {
        // R^2 - low^2 = -a (2 low - a), a the (negative) altitude of the lowest point
        float ground_m = sqrt(max(-low_altitude_m * (2.0 * low_m - low_altitude_m), 0.0));
        length_m -= max(ground_m - x0_m, 0.0);
        x0_m = max(x0_m, ground_m);
        altitude_m = 0.0;
    }
    if (length_m <= 0.0)
        return 0.0;
    return exp(max(-altitude_m / shell.scale_height_m, EXPONENT_MIN)) *
           shell_leg_m(low_m, shell.scale_height_m, x0_m, length_m);
}

// The integral of the density over t in [t0, t1] [m].
float shell_integral_m(Shell shell, vec3 origin_m, vec3 direction, float t0_m, float t1_m)
{
    // The lowest point of the line, from the camera: where (c + p) . direction = 0.
    float nearest_m = -dot(origin_m, direction) - shell.camera_radius_m * dot(shell.up, direction);
    float low_altitude_m = shell_altitude_m(shell, origin_m + nearest_m * direction);
    float low_m = shell.camera_radius_m - shell.camera_altitude_m + low_altitude_m;
    float start_altitude_m = shell_altitude_m(shell, origin_m + t0_m * direction);
    float end_altitude_m = shell_altitude_m(shell, origin_m + t1_m * direction);
    float x0_m = t0_m - nearest_m, x1_m = t1_m - nearest_m;
    if (x0_m >= 0.0)
        return shell_leg_integral_m(shell, low_m, low_altitude_m, x0_m, start_altitude_m,
                                    t1_m - t0_m);
    if (x1_m <= 0.0)
        return shell_leg_integral_m(shell, low_m, low_altitude_m, -x1_m, end_altitude_m,
                                    t1_m - t0_m);
    return shell_leg_integral_m(shell, low_m, low_altitude_m, 0.0, low_altitude_m, -x0_m) +
           shell_leg_integral_m(shell, low_m, low_altitude_m, 0.0, low_altitude_m, x1_m);
}

#endif
