// SPDX-License-Identifier: MIT
//
// A plume of smoke (scenes/plume.c): its density and the exact integral along a ray. The density is
//
//   e^-(s / scale height + r^2 / (2 width^2))      s: along the axis from the foot, r: across it
//
// and 0 below the foot. Along a ray the exponent is a parabola. From the densest place on the ray
// it only decreases, by x (rise + bend x) at the distance x. Each of the two legs from there is
// integrated by eight-point Gauss-Legendre quadrature over its first 3 and next 14 e-foldings, as
// in shell.glsl.
#ifndef NEPH_PLUME_GLSL
#define NEPH_PLUME_GLSL

#include "solids.glsl"
#include "stretch.glsl"

struct Plume {
    vec3 foot_m; // relative to the camera
    float width_m;
    vec3 axis; // unit
    float scale_height_m;
    float reach_m; // above this height a ray meets less than 1e-7 of optical depth
};

// -log of the density, relative to the foot.
float plume_folds(Plume plume, vec3 from_foot_m)
{
    float along_m = dot(from_foot_m, plume.axis);
    vec3 across = (from_foot_m - along_m * plume.axis) / plume.width_m;
    return along_m / plume.scale_height_m + 0.5 * dot(across, across);
}

float plume_density(Plume plume, vec3 point_m)
{
    vec3 from_foot_m = point_m - plume.foot_m;
    return dot(from_foot_m, plume.axis) >= 0.0 ? transmittance(plume_folds(plume, from_foot_m))
                                               : 0.0;
}

// One side of the densest place: the exponent grows by x (rise + bend x).
struct PlumeLeg {
    float rise_per_m;  // >= 0
    float bend_per_m2; // >= 0
};

vec4 plume_fall(PlumeLeg leg, vec4 x_m)
{
    return exp(max(-x_m * (leg.rise_per_m + leg.bend_per_m2 * x_m), EXPONENT_MIN));
}

float plume_panel_m(PlumeLeg leg, float x0_m, float x1_m)
{
    const vec4 NODES = vec4(0.183434642, 0.525532410, 0.796666477, 0.960289856);
    const vec4 WEIGHTS = vec4(0.181341892, 0.156853323, 0.111190517, 0.0506142681);
    float middle_m = 0.5 * (x0_m + x1_m), half_m = 0.5 * (x1_m - x0_m);
    return 2.0 * half_m * (dot(plume_fall(leg, middle_m - half_m * NODES), WEIGHTS) +
                           dot(plume_fall(leg, middle_m + half_m * NODES), WEIGHTS));
}

// Distance on a leg until the density has fallen by some e-foldings.
float plume_distance_m(PlumeLeg leg, float folds)
{
    float root = sqrt(leg.rise_per_m * leg.rise_per_m + 4.0 * leg.bend_per_m2 * folds);
    return min(2.0 * folds / max(leg.rise_per_m + root, 1e-20), FAR_M);
}

float plume_leg_m(PlumeLeg leg, float length_m)
{
    float near_m = min(length_m, plume_distance_m(leg, 3.0));
    float far_m = min(length_m, plume_distance_m(leg, 17.0));
    return plume_panel_m(leg, 0.0, near_m) + plume_panel_m(leg, near_m, far_m);
}

// Integral of the density along origin + t direction over [t0, t1] [m].
float plume_integral_m(Plume plume, vec3 origin_m, vec3 direction, float t0_m, float t1_m)
{
    vec3 from_foot_m = origin_m - plume.foot_m;
    float slope = dot(direction, plume.axis);
    if (!clip_axis(0.0, FAR_M, dot(from_foot_m, plume.axis), slope, t0_m, t1_m))
        return 0.0;
    float width2_m2 = plume.width_m * plume.width_m, climb_per_m = slope / plume.scale_height_m;
    vec3 across = direction - slope * plume.axis;
    float bend_per_m2 = 0.5 * dot(across, across) / width2_m2;
    float rise_per_m = climb_per_m + dot(from_foot_m, across) / width2_m2; // at the ray's origin
    float densest_m = clamp(-0.5 * rise_per_m / max(bend_per_m2, 1e-30), t0_m, t1_m);
    vec3 densest = from_foot_m + densest_m * direction;
    rise_per_m = climb_per_m + dot(densest, across) / width2_m2;
    PlumeLeg on = PlumeLeg(max(rise_per_m, 0.0), bend_per_m2);
    PlumeLeg back = PlumeLeg(max(-rise_per_m, 0.0), bend_per_m2);
    return transmittance(max(plume_folds(plume, densest), 0.0)) *
           (plume_leg_m(on, t1_m - densest_m) + plume_leg_m(back, densest_m - t0_m));
}

// Clips a stretch to the heights 0..reach_m above the foot.
void plume_narrow(Plume plume, vec3 origin_m, vec3 direction, inout Stretch inside)
{
    if (!clip_axis(0.0, plume.reach_m, dot(origin_m - plume.foot_m, plume.axis),
                   dot(direction, plume.axis), inside.t0_m, inside.t1_m))
        inside.t1_m = inside.t0_m;
}

#endif
