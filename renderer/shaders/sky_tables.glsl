// SPDX-License-Identifier: MIT
//
// Both tables, to be read.
#ifndef NEPH_SKY_TABLES_GLSL
#define NEPH_SKY_TABLES_GLSL

#include "sky.glsl"

layout(std430, binding = 1) readonly buffer SunNodes {
    vec4 sun_nodes[];
};

// [altitude][sun][moment], and the ground's irradiance by [sun] behind them.
layout(std430, binding = 2) readonly buffer FieldNodes {
    vec4 field_nodes[];
};

vec3 sky_sun_node(uint index) { return sun_nodes[index].rgb; }
vec3 sky_field_node(uint index) { return field_nodes[index].rgb; }

#endif
