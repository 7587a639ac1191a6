#version 450
// SPDX-License-Identifier: MIT
//
// Probe of the media (renderer/shaders/scene.glsl), for tests/renderer/test_shader_media.c: one
// thread is one ray.
#extension GL_GOOGLE_include_directive : require

#include "scene.glsl"

layout(local_size_x = 64) in;

struct Probe {
    vec3 origin_m; // relative to the camera
    float length_m;
    vec3 direction;
    uint medium;
};

struct Answer {
    float extinction_per_m; // at the origin
    float optical_depth;    // over the length
    float stretch_t0_m, stretch_t1_m; // of the scene
    float without_detail, height; // of a Horizon cloud at the origin
};

layout(std430, binding = 5) readonly buffer Probes {
    Probe probes[];
};

layout(std430, binding = 6) writeonly buffer Answers {
    Answer answers[];
};

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i >= probes.length())
        return;
    Probe p = probes[i];
    Stretch stretch = scene_stretch(p.origin_m, p.direction, p.length_m);
    HorizonSample cloud = HorizonSample(0.0, 0.0, 0.0);
    if (is_among(1u << MEDIUM_HORIZON, p.medium))
        cloud = horizon_sample(frame.media[p.medium].shape.horizon, p.origin_m);
    answers[i] = Answer(medium_extinction_per_m(p.medium, p.origin_m),
                        medium_optical_depth(p.medium, p.origin_m, p.direction,
                                             p.length_m),
                        stretch.t0_m, stretch.t1_m, cloud.without_detail, cloud.height);
}
