#version 450
// SPDX-License-Identifier: MIT
//
// One order of the sky's scattered light, second half: each thread integrates the arriving radiance
// of a node over all directions, times one spherical harmonic. The threads behind them compute the
// irradiance of the ground.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require

#define SKY_IS_KNOWN
#define SKY_IS_FILLED
#include "sky_gather.glsl"

layout(local_size_x = 64) in;

layout(std430, binding = 3) readonly buffer Arrivals {
    vec4 arrivals[];
};

// Spherical harmonic number k in a direction: degree l and order m with k = l (l + 1) / 2 + m, by
// recurrence.
float harmonic(uint k, SkyDirection direction)
{
    uint degree = uint((sqrt(8.0 * float(k) + 1.5) - 1.0) * 0.5);
    uint order = k - degree * (degree + 1u) / 2u;
    float across2 = max(0.0, 1.0 - direction.z * direction.z);
    float wave = 1.0, before = 0.0, legendre = 1.0, lower = 0.0;
    for (uint m = 0u; m < order; m++) {
        float next = m == 0u ? direction.x : 2.0 * direction.x * wave - across2 * before;
        before = wave;
        wave = next;
        legendre *= float(2u * m + 1u);
    }
    for (uint l = order; l < degree; l++) {
        float next = (float(2u * l + 1u) * direction.z * legendre - float(l + order) * lower) /
                     float(l + 1u - order);
        lower = legendre;
        legendre = next;
    }
    return air.norms[k] * legendre * wave;
}

void main()
{
    uint index = gl_GlobalInvocationID.x, count = sky_moments();
    uint moments = air.altitudes * air.suns * count;
    if (index >= moments + air.suns)
        return;
    bool is_ground = index >= moments;
    uint node = is_ground ? index - moments : index / count; // ground: the node at altitude 0
    float altitude_m = node_altitude_m(node);
    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < direction_count(); i++) {
        SkyDirection direction = node_direction(altitude_m, i);
        float value = is_ground ? max(0.0, direction.z) : harmonic(index % count, direction);
        sum += value * direction.solid_angle_sr * arrivals[node * direction_count() + i].rgb;
    }
    sky_nodes[air.field_first + index] = vec4(sum, 0.0);
}
