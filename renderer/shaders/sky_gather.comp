#version 450
// SPDX-License-Identifier: MIT
//
// One order of the sky's scattered light, first half: each thread marches one ray and stores the
// radiance that arrives at a node of the field from one direction. sky_sum.comp is the second half.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require

#define SKY_IS_KNOWN
#include "sky_gather.glsl"

layout(local_size_x = 64) in;

// [node][direction]
layout(std430, binding = 3) writeonly buffer Arrivals {
    vec4 arrivals[];
};

void main()
{
    uint index = gl_GlobalInvocationID.x;
    if (index >= air.altitudes * air.suns * direction_count())
        return;
    uint node = index / direction_count();
    float altitude_m = node_altitude_m(node), sun_cosine = node_sun_cosine(node);
    float sun_sine = sqrt(max(0.0, 1.0 - sun_cosine * sun_cosine));
    SkyDirection direction = node_direction(altitude_m, index % direction_count());
    SkyRay ray;
    ray.altitude_m = altitude_m;
    ray.cosine = direction.z;
    ray.sun_cosine = sun_cosine;
    ray.toward_sun = direction.x * sun_sine + direction.z * sun_cosine;
    sky_find_phases(ray, vec3(direction.x, direction.y, direction.z),
                    vec3(sun_sine, 0.0, sun_cosine));
    SkyLight light = sky_walk(ray, pass.steps, true, pass.has_field != 0u);
    arrivals[index] = vec4(light.radiance, 0.0);
}
