// SPDX-License-Identifier: MIT
//
// Parameters, nodes and directions of the two passes that compute the field (renderer/sky/solve.h).
#ifndef NEPH_SKY_GATHER_GLSL
#define NEPH_SKY_GATHER_GLSL

#include "sky.glsl"

layout(push_constant) uniform SkyPass {
    uint has_field; // 0: no field yet, the first order
    // Numbers of directions: rows above and below the horizon, and directions per row.
    uint above, below, around;
    uint steps;
} pass;

// Gauss-Legendre cosines in -1..1 and their weights: the rows above the horizon first.
layout(std430, binding = 2) readonly buffer Caps {
    vec2 caps[];
};

uint direction_count() { return (pass.above + pass.below) * pass.around; }

struct SkyDirection {
    float x, y, z; // x towards the sun (horizontally), z up
    float solid_angle_sr;
};

// Altitudes are dense at the ground, sun angles at the horizon: both axes are squares.
float node_altitude_m(uint node)
{
    float part = float(node / air.suns) / float(air.altitudes - 1u);
    return air.top_m * part * part;
}

float node_sun_cosine(uint node)
{
    float root = mix(air.deepest_root, 1.0, float(node % air.suns) / float(air.suns - 1u));
    return sin(root * abs(root) * PI / 2.0);
}

// A direction, its solid angle included. Rows above and below the horizon have separate
// quadratures, because the radiance is discontinuous there; azimuths cover half a turn, by
// symmetry.
SkyDirection node_direction(float altitude_m, uint index)
{
    uint cap = index / pass.around;
    float horizon = -sqrt(sky_growth_m2(altitude_m)) / (air.radius_m + altitude_m);
    float low = cap < pass.above ? horizon : -1.0, high = cap < pass.above ? 1.0 : horizon;
    float z = 0.5 * (low + high) + 0.5 * (high - low) * caps[cap].x;
    float sine = sqrt(max(0.0, 1.0 - z * z));
    float azimuth = PI * (float(index % pass.around) + 0.5) / float(pass.around);
    return SkyDirection(sine * cos(azimuth), sine * sin(azimuth), z,
                        PI * (high - low) * caps[cap].y / float(pass.around));
}

#endif
