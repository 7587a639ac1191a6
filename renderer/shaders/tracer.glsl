// SPDX-License-Identifier: MIT
//
// What the kernels of the path tracer share: renderer/tracer.c is the mirror of the buffers.
#ifndef NEPH_TRACER_GLSL
#define NEPH_TRACER_GLSL

#include "scene.glsl"
#include "low_discrepancy.glsl"
#include "sampling.glsl"

// All kernels get all constants (renderer/tracer.c), the first two being those of scene.glsl.
layout(constant_id = 3) const bool MULTIPLE = true;    // all orders of scattering
layout(constant_id = 4) const bool SURFACES = true;    // a solid reflects
layout(constant_id = 5) const bool ENVIRONMENT = true; // the background lights media and solids
layout(constant_id = 6) const uint MEDIA = 0;          // how many there are; 0: any number
// Media that are tracked through their majorant grids: how many, and a hexadecimal digit for each,
// the first one lowest.
layout(constant_id = 7) const uint TRACKED_COUNT = 0;
layout(constant_id = 8) const uint TRACKED_ORDER = 0x76543210;
layout(constant_id = 10) const bool SOLIDS = true; // there are some

// First collisions are drawn by the light that comes from there: light is scattered once, and the
// sun shines, or MEDIA_DIFFER.
layout(constant_id = 11) const bool LIT = false;
layout(constant_id = 12) const bool EMITS = false; // some medium does

layout(constant_id = 13) const bool SOBOL = false; // the first decisions of a sample are not random

// How much sunlight arrives at an event is looked up (tracer_sun.glsl).
layout(constant_id = 14) const bool SUN_BY_TABLE = false;

// Media differ in brightness (scenes/sources.h): collisions in proportion to extinction would miss
// the bright ones, so each has a share of the first collisions for itself.
layout(constant_id = 15) const bool MEDIA_DIFFER = false;

// Some medium's optical depth has no closed form: then the view ray is a matter of chance too.
const bool OPEN = (KINDS & OPEN_KINDS) != 0u;

// Where paths go on anyway, what they find out of the sun costs less than the walk through a voxel
// grid that knows exactly what arrives at a first collision, and adds little to the noise of all
// orders.
const bool HAS_GRID = (KINDS & 1u << MEDIUM_GRID) != 0u;
const bool CLOSED = !OPEN;
const bool CLOSED_GRID = HAS_GRID && CLOSED;
const bool FIRST_BY_PATH = MULTIPLE && CLOSED_GRID; // step by step: a compiler's bug

// First collisions may be chosen by a guess (tracer_guess.glsl).
const bool GUESSED = LIT && OPEN;

layout(push_constant) uniform TracerRun {
    uint seed_low;
    uint seed_high;
    uint first_pixel;  // of the chunk of the frame that is in work, in raster order
    uint pixel_count;  // of the chunk
    uint part_pixel;   // the first that `pixels` has
    uint first_sample; // of the round
    uint samples;      // of the round, per pixel: whole batches
    uint queue_pixels; // that one work group works on
    uint first_queue;  // of this dispatch
    uint turns;        // of the outer loop, at most
    uint is_fresh;     // 1: the states hold nothing yet
} run;

const uint STRATA = NEPH_GPU_STRATA;
const uint BATCH_SAMPLES = 2 * STRATA; // per pixel: a pair in each stratum

// A work group's items, an item being one sample of one pixel.
uint queue_items() { return run.queue_pixels * run.samples; }

// One sample's light [W m^-2 sr^-1]; the fourth components are its estimate of the view's
// transmittance, red, green and blue, if OPEN.
struct Result {
    vec4 order1;  // scattered once, by a medium
    vec4 higher;  // scattered by a medium first, and then again
    vec4 surface; // from a surface first, without direct sunlight, before the view's transmittance;
                  // if OPEN, all that no medium has scattered first, as it arrives
};

layout(std430, binding = 6) buffer Results {
    Result results[];
};

// Per queue: the next item that nobody has taken. There is room for a queue of each pixel of the
// chunk: how many there are may change from round to round.
layout(std430, binding = 7) buffer Queues {
    uint next_items[];
};

// Per pixel of a part of the frame: what needs no chance, and the sums over all samples so far,
// each with its rounding error (numbers.glsl).
struct TracerPixel {
    vec4 behind;        // background, or sunlight reflected by the surface; black if OPEN;
                        // w: eye depth [m]
    vec4 transmittance; // w: free
    vec4 sums[4];       // of the results: order1, higher, surface; then of all light the squared
                        // differences of pairs
    vec4 excess[4];     // what they have too much
};

layout(std430, binding = 8) buffer Pixels {
    TracerPixel pixels[];
};

// What the rounds have cost and how far they are. Only ever added to.
layout(std430, binding = 9) buffer Progress {
    uint items_done;
    uint collisions;
    uint lookups;
    uint closed_forms;
} progress;

// A sample's first collision on the view ray, when it is chosen where it counts (forced collision).
struct First {
    vec3 weight; // f / p per channel, if OPEN without the transmittance; 0: there is none
    float t_m;
    vec3 channels; // p per channel, relative to the hero
    uint medium;   // MEDIA_MAX: the path has to find it
    float view_depth, sun_depth; // if OPEN: guessed optical depths to the camera and to the sun
};

First no_first() { return First(vec3(0.0), 0.0, vec3(1.0), 0, 0.0, 0.0); }

layout(std430, binding = 10) buffer Firsts {
    First firsts[];
};

// Per pixel and layer of a medium (one of a medium without layers): the scalar optical depth of the
// view ray.
const uint PARTS = MEDIA_MAX * LAYERS_MAX;
layout(std430, binding = 11) buffer Depths {
    float depths[];
};

uvec4 sample_key(uint pixel, uint sample_index)
{
    return pcg4d(uvec4(pixel, sample_index, run.seed_low, run.seed_high));
}

// The first decisions of a sample: a pair of numbers for each.
const uint PAIR_PLACE = 0;      // of the first collision, and its medium where that is guessed
const uint PAIR_SCATTERED = 1;  // the direction from there
const uint PAIR_REFLECTED = 2;  // the direction from a first surface
const uint PAIR_FREE_PATH = 3;  // after the first event; one number

// If SOBOL. The samples of a pair come from two sequences that know nothing of each other, so that
// the means over both are independent, too (tracer_sum.comp).
uvec2 low_discrepancy(uint pixel, uint sample_index, uint decision)
{
    uvec2 own = pcg4d(uvec4(pixel, 2u * decision + (sample_index & 1u), run.seed_low,
                            ~run.seed_high)).xy;
    return sobol_pair(sample_index >> 1, uvec4(own, run.seed_low, run.seed_high));
}

// The channel that distances are drawn for, from the first numbers of a sample.
uint hero_of(uvec3 bits)
{
    return COLOURED ? min(uint(3.0 * uniform_from(bits).z), 2u) : 0u;
}

// One path stands for all three channels: its density is the mean of theirs (single-sample multiple
// importance sampling; Miller, Georgiev, Jarosz 2019).
vec3 channel_weights(vec3 channels)
{
    return COLOURED ? channels * (3.0 / (channels.r + channels.g + channels.b)) : vec3(1.0);
}

// A scene without colour needs one exponential instead of three.
vec3 colour_transmittance(vec3 optical_depth)
{
    return COLOURED ? transmittance(optical_depth) : vec3(transmittance(optical_depth.r));
}

vec3 colour_absorbed_fraction(vec3 optical_depth)
{
    return COLOURED ? absorbed_fraction(optical_depth) : vec3(absorbed_fraction(optical_depth.r));
}

float brightest_of(vec3 channels) { return max(channels.r, max(channels.g, channels.b)); }

float mean_of(vec3 channels) { return dot(channels, vec3(1.0 / 3.0)); }

// What scenes/sources.h says: light that a collision brings [W m^-2 sr^-1].
struct Source {
    vec3 sun;     // before it is attenuated on its way
    vec3 ambient; // emitted, or scattered and not the sun's
};

// That is not the sun's; a lamp is taken to be a metre away.
vec3 incident_light()
{
    vec3 light = ENVIRONMENT ? frame.background : vec3(0.0);
    for (uint m = 0; MULTIPLE && m < media_count(); m++)
        light += frame.media[m].glow;
    for (uint i = 0; MULTIPLE && LAMPS && i < own(frame.lamp_count); i++)
        light += frame.lamps[i].intensity / (4.0 * PI);
    return light;
}

Source source_of(uint m)
{
    vec3 scattered = frame.media[m].albedo * sign(frame.media[m].extinction_color);
    return Source(scattered * frame.sun_irradiance / (4.0 * PI),
                  frame.media[m].glow + scattered * incident_light());
}

bool is_bright(uint m)
{
    Source source = source_of(m);
    return source.sun + source.ambient != vec3(0.0);
}

// Optical depth of all but one medium, or layer of a fog, up to a distance on the view ray.
vec3 others_depth(uint but_medium, uint but_layer, ViewRay ray, float length_m)
{
    vec3 sum = vec3(0.0);
    if (media_count() == 1 && layers_of(0) == 1)
        return sum;
    for (uint m = 0; m < media_count(); m++) {
        float depth = 0.0;
        for (uint l = 0; l < layers_of(m); l++)
            if (m != but_medium || l != but_layer)
                depth += layer_optical_depth(m, l, ray.origin_m, ray.direction, length_m);
        sum += frame.media[m].extinction_color * depth;
    }
    return sum;
}

ViewRay pixel_ray(uint pixel)
{
    return camera_ray(pixel % frame.width_px, pixel / frame.width_px);
}

#endif
