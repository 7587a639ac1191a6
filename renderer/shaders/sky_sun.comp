#version 450
// SPDX-License-Identifier: MIT
//
// Fills the table of transmittance to the sun; one thread per node. Coordinates:
// sky_sun_transmittance() in sky.glsl; CPU reference: renderer/sky/sun_table.h.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require

#define SKY_IS_KNOWN
#define SKY_IS_FILLED
#include "sky.glsl"
#include "shell.glsl"
#include "tent.glsl"

layout(local_size_x = 64) in;

// Integral of a layer's density to the top of the air [m].
float column_m(SkyLayer layer, Globe globe, vec3 direction)
{
    if (layer.is_tent != 0u)
        return tent_integral_m(Tent(globe, layer.middle_m, layer.scale_m), vec3(0.0), direction,
                               0.0, FAR_M);
    return shell_integral_m(Shell(globe, layer.scale_m, air.top_m), vec3(0.0), direction, 0.0,
                            FAR_M);
}

void main()
{
    uint index = gl_GlobalInvocationID.x;
    if (index >= air.sun_altitudes * air.sun_cosines)
        return;
    uint i = index % air.sun_cosines, j = index / air.sun_cosines;
    float most_m = sqrt(sky_growth_m2(air.top_m));
    float horizon_m = most_m * float(j) / float(air.sun_altitudes - 1u);
    float growth_m2 = horizon_m * horizon_m;
    float altitude_m = min(growth_m2 / (air.radius_m + sqrt(air.radius_m * air.radius_m +
                                                            growth_m2)), air.top_m);
    float r_m = air.radius_m + altitude_m, shortest_m = air.top_m - altitude_m;
    float length_m = mix(shortest_m, horizon_m + most_m, float(i) / float(air.sun_cosines - 1u));
    float left_m2 = max(most_m * most_m - growth_m2, 0.0);
    float cosine = length_m > 0.0 ? min(0.5 * (left_m2 / length_m - length_m) / r_m, 1.0) : 1.0;
    vec3 direction = vec3(sqrt(max(0.0, 1.0 - cosine * cosine)), cosine, 0.0);
    Globe globe = Globe(vec3(0.0, 1.0, 0.0), r_m, altitude_m, air.radius_m);
    vec3 depth = vec3(0.0);
    SKY_UNROLL for (uint n = 0u; n < sky_layers(); n++)
        depth += air.layers[n].extinction_per_m * column_m(air.layers[n], globe, direction);
    sky_nodes[index] = vec4(transmittance(depth), 0.0);
}
