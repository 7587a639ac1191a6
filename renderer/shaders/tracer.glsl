// SPDX-License-Identifier: MIT
//
// What the kernels of the path tracer share: renderer/tracer.c is the mirror of the buffers.
#ifndef NEPH_TRACER_GLSL
#define NEPH_TRACER_GLSL

#include "scene.glsl"
#include "sampling.glsl"

layout(push_constant) uniform Run {
    uint seed_low;
    uint seed_high;
    uint first_pixel;  // of the chunk of the frame that is in work, in raster order
    uint pixel_count;  // of the chunk
    uint first_sample; // of the batch
    uint first_pool;   // of this dispatch
    uint turns;        // of the outer loop, at most
    uint is_fresh;     // 1: the states hold nothing yet
} run;

const uint STRATA = 4;                 // NEPH_TRACER_STRATA
const uint BATCH_SAMPLES = 2 * STRATA; // per pixel: a pair in each stratum
const uint POOL_PIXELS = 8;            // the pixels that one work group works on
const uint POOL_ITEMS = POOL_PIXELS * BATCH_SAMPLES;

// One sample's light [W m^-2 sr^-1].
struct Result {
    vec4 order1;  // scattered once, by a medium
    vec4 higher;  // scattered by a medium first, and then again
    vec4 surface; // from a surface first, without direct sunlight; before the view's transmittance
};

layout(std430, binding = 6) buffer Results {
    Result results[];
};

// Per pool: the next item that nobody has taken.
layout(std430, binding = 7) buffer Pools {
    uint next_items[];
};

// Per pixel of the chunk: what needs no chance, and the sums of a batch.
struct Pixel {
    vec4 behind;        // background, or sunlight reflected by the surface; w: eye depth [m]
    vec4 transmittance; // w: free
    vec4 sums[3];       // of the batch's results: order1, higher, surface
    vec4 spread;        // sum over the batch's pairs of their squared difference, all light
    vec4 padding;
};

layout(std430, binding = 8) buffer Pixels {
    Pixel pixels[];
};

// What a batch has cost and how far it is. Only ever added to.
layout(std430, binding = 9) buffer Progress {
    uint items_done;
    uint collisions;
    uint lookups;
    uint closed_forms;
} progress;

// A sample's first collision on the view ray, when it is chosen where it counts (forced collision).
struct First {
    float t_m;
    float weight; // 0: there is none
    uint medium;
    uint padding;
};

layout(std430, binding = 10) buffer Firsts {
    First firsts[];
};

// Per pixel and layer of a medium: the part of a beam along the view ray that the layer alone would
// take out.
const uint PARTS = MEDIA_MAX * LAYERS_MAX;
layout(std430, binding = 11) buffer Absorbed {
    float absorbed[];
};

// The numbers of a sample that do not belong to its path.
const uint KEY_FIRST = 0x46697273u; // apart from the path's own numbers

uvec4 sample_key(uint pixel, uint sample_index)
{
    return pcg4d(uvec4(pixel, sample_index, run.seed_low, run.seed_high));
}

vec3 pixel_ray(uint pixel)
{
    return camera_ray(pixel % frame.width_px, pixel / frame.width_px);
}

#endif
