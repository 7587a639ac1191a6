#version 450
// SPDX-License-Identifier: MIT
//
// Probe of the game-engine fog model, for tests/renderer/test_fog_look.c: one thread is one ray.
#extension GL_GOOGLE_include_directive : require

#include "fog_look.glsl"

layout(local_size_x = 64) in;

struct FogLookProbe {
    FogLook look;
    vec3 direction;
    float length_m;
    vec3 to_sun;
};

struct FogLookAnswer {
    vec3 volume;
    float through;
};

layout(std430, binding = 0) readonly buffer Probes {
    FogLookProbe probes[];
};

layout(std430, binding = 1) writeonly buffer Answers {
    FogLookAnswer answers[];
};

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i >= probes.length())
        return;
    FogLookLight light = fog_look_along(probes[i].look, probes[i].direction, probes[i].length_m,
                                        probes[i].to_sun);
    answers[i] = FogLookAnswer(light.volume, light.through);
}
