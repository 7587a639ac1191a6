#version 450
// SPDX-License-Identifier: MIT
//
// Micro-benchmark of trilinear samples of a voxel grid, for the roofline limits of
// renderer/roofline.h. The sample rate of the ray marcher is compared with this rate.
//
// Each thread samples along a line, either from a storage buffer with grid_density() (grid.glsl) or
// from a 3D texture as grid_texture.glsl does. Neighbouring threads sample neighbouring lines, as
// the rays of a camera do.
#extension GL_GOOGLE_include_directive : require

layout(local_size_x = 64) in;

layout(std430, binding = 0) readonly buffer Values {
    float grid_values[];
};

struct CeilingLine {
    vec3 start; // in nodes of the grid
    float padding;
    vec3 stride; // from one sample to the next, in nodes
    float padding_2;
};

layout(std430, binding = 1) readonly buffer Lines {
    CeilingLine lines[];
};

layout(std430, binding = 2) writeonly buffer Results {
    float results[];
};

layout(push_constant) uniform CeilingRun {
    uint side; // nodes along each axis
    uint sample_count;
} run;

layout(constant_id = 0) const bool TEXTURE = false;
// Whether the position of each sample depends on the sample before, so that no fetch can be issued
// ahead of time.
layout(constant_id = 1) const bool WAITS = false;
// Whether the grid is read from texels of two nodes, as media.glsl reads it on a CPU device.
layout(constant_id = 2) const bool PAIRS = false;

#define SEES_GRID_TEXELS
#include "constants.h"
layout(binding = NEPH_GPU_TEXEL_PAIRS_BINDING, rg32ui) uniform readonly uimageBuffer grid_pairs[1];

vec2 grid_pair(uint at)
{
    if (PAIRS)
        return uintBitsToFloat(imageLoad(grid_pairs[0], int(at)).xy);
    return vec2(grid_values[at], grid_values[at + 1]);
}

const uint TRAITS = 0u;
#include "grid.glsl"

layout(binding = NEPH_GPU_IMAGES_BINDING) uniform sampler3D grid_textures[1];

float density_at(Grid grid, vec3 point_m)
{
    return TEXTURE ? textureLod(grid_textures[0], (point_m + 0.5) * grid.texel, 0.0).r
                   : grid_density(grid, point_m);
}

void main()
{
    CeilingLine line = lines[gl_GlobalInvocationID.x];
    vec3 texel = vec3(1.0) / float(run.side);
    Grid grid = Grid(vec3(0.0), 0, vec3(1.0), 1.0, uvec3(run.side), 0.0, texel, vec3(0.0));
    float sum = 0.0;
    vec3 place = line.start;
    for (uint i = 0; i < run.sample_count; i++) {
        float density = density_at(grid, WAITS ? place : line.start + float(i) * line.stride);
        sum += density;
        place += (1.0 - 1e-6 * density) * line.stride;
    }
    results[gl_GlobalInvocationID.x] = sum;
}
