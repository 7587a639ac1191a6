// SPDX-License-Identifier: MIT
//
// Common part of the path tracer's kernels: specialization constants, push constants, buffers,
// sample numbers. renderer/tracer.c has the C side. Kernels of a frame and their order:
//
//   tracer_sun    table of transmittance to the sun            if SUN_BY_TABLE
//   tracer_view   unscattered light, optical depths            per pixel
//   tracer_lit    distribution of first collisions by light    if LIT, and not OPEN
//   tracer_guess  the same from guessed optical depths         if LIT and OPEN
//   then per round of samples:
//   tracer_first  first collisions, order 1                    per sample
//   tracer        paths, higher orders                         per sample
//   tracer_check  correction of the sun table                  if SUN_BY_TABLE
//   tracer_sum    sums of the samples                          per pixel
#ifndef NEPH_TRACER_GLSL
#define NEPH_TRACER_GLSL

#include "scene.glsl"
#include "low_discrepancy.glsl"
#include "sampling.glsl"

// All kernels get all constants; the first two are in media.glsl and solids.glsl.
layout(constant_id = 3) const bool MULTIPLE = true;    // all orders of scattering
layout(constant_id = 4) const bool SURFACES = true;    // a solid reflects
// The background illuminates media and solids.
layout(constant_id = 5) const bool ENVIRONMENT = true;
layout(constant_id = 6) const uint MEDIA = 0;          // number of media; 0: any number
// Number of media that are tracked through majorant grids, and their order: one hexadecimal digit
// each, the first one lowest.
layout(constant_id = 7) const uint TRACKED_COUNT = 0;
layout(constant_id = 8) const uint TRACKED_ORDER = 0x76543210;
layout(constant_id = 10) const bool SOLIDS = true; // there are solids

// First collisions are drawn by the light that they scatter: for single scattering of sunlight, or
// if MEDIA_DIFFER.
layout(constant_id = 11) const bool LIT = false;
layout(constant_id = 12) const bool EMITS = false; // a medium emits light

// The first decisions of a sample are low-discrepancy numbers.
layout(constant_id = 13) const bool SOBOL = false;

// Sunlight at events comes from a table (tracer_sun.glsl).
layout(constant_id = 14) const bool SUN_BY_TABLE = false;

// Media differ in brightness (scenes/sources.h). Collisions in proportion to extinction would miss
// bright media, so each medium gets a share of the first collisions.
layout(constant_id = 15) const bool MEDIA_DIFFER = false;

// A medium's optical depth has no closed form, or the end of the view ray is random (alpha as
// coverage): so the transmittance of the view ray is estimated, too.
const bool HAS_OPEN = (KINDS & OPEN_KINDS) != 0u;
const bool OPEN = HAS_OPEN || MESH_COVERAGE;

// In grids with multiple scattering order 1 is left to the paths: a shadow ray by tracking costs
// less than the exact transmittance through a voxel grid, and adds little to the noise of all
// orders.
const bool HAS_GRID = (KINDS & 1u << MEDIUM_GRID) != 0u;
const bool CLOSED = !OPEN;
const bool CLOSED_GRID = HAS_GRID && CLOSED;
const bool FIRST_BY_PATH = MULTIPLE && CLOSED_GRID; // in steps, because of a compiler bug

// First collisions may be chosen by a guess (tracer_guess.glsl).
const bool GUESSED = LIT && OPEN;

layout(push_constant) uniform TracerRun {
    uint seed_low;
    uint seed_high;
    uint first_pixel;  // of the current chunk of the frame, in raster order
    uint pixel_count;  // of the chunk
    uint part_pixel;   // first pixel of the buffer `pixels`
    uint first_sample; // of the round
    uint samples;      // of the round, per pixel: whole batches
    uint queue_pixels; // pixels per work group
    uint first_queue;  // of this dispatch
    uint turns;        // iterations of the outer loop, at most
    uint is_fresh;     // 1: no unfinished paths
    float noise_scale; // of squared differences, whose squares are then within float32
} run;

const uint STRATA = NEPH_GPU_STRATA;
const uint BATCH_SAMPLES = 2 * STRATA; // per pixel: a pair of samples in each stratum

// Items of a work group; an item is one sample of one pixel.
uint queue_items() { return run.queue_pixels * run.samples; }

// Radiance of one sample [W m^-2 sr^-1]. If OPEN, the fourth components are its estimate of the
// view ray's transmittance (red, green, blue).
struct Result {
    vec4 order1;  // scattered once, by a medium
    vec4 higher;  // scattered by a medium first, then further
    vec4 surface; // reflected by a surface first, without direct sunlight and before the view's
                  // transmittance; if OPEN, all light with no medium as the first event
};

layout(std430, binding = 6) buffer Results {
    Result results[];
};

// Per queue: the next free item. There is room for one queue per pixel of the chunk, because the
// number of queues changes from round to round.
layout(std430, binding = 7) buffer Queues {
    uint next_items[];
};

// Per pixel of a part of the frame: the deterministic light, and compensated sums over all samples
// (numbers.glsl).
struct TracerPixel {
    vec4 behind;        // background, or sunlight reflected by the surface; black if OPEN; w: eye
                        // depth [m]
    vec4 transmittance; // w: length of the view ray [m]; FAR_M: it meets no solid
    vec4 sums[4];       // order1, higher, surface; and squared differences of pairs, w: their
                        // sum over the channels, squared
    vec4 excess[4];     // rounding errors of the sums
};

layout(std430, binding = 8) buffer Pixels {
    TracerPixel pixels[];
};

// Length of the view ray of a pixel of the chunk, which tracer_view.comp has found.
float view_length_m(uint pixel)
{
    return pixels[run.first_pixel + pixel - run.part_pixel].transmittance.w;
}

// Cost and progress of all rounds. Counters only grow.
layout(std430, binding = 9) buffer Progress {
    uint items_done;
    uint collisions;
    uint lookups;
    uint closed_forms;
} progress;

// A sample's forced first collision on the view ray.
struct First {
    vec3 weight; // f / p per channel, if OPEN without transmittance; 0: no collision
    float t_m;
    vec3 channels; // p per channel, relative to the hero
    uint medium;   // MEDIA_MAX: the path finds the collision
    float view_depth, sun_depth; // if OPEN: guessed optical depths to camera and sun
};

First no_first() { return First(vec3(0.0), 0.0, vec3(1.0), 0, 0.0, 0.0); }

layout(std430, binding = 10) buffer Firsts {
    First firsts[];
};

// Optical depth of the view ray, scalar, per pixel and layer of a medium (media without layers have
// one).
const uint PARTS = MEDIA_MAX * LAYERS_MAX;
layout(std430, binding = 11) buffer Depths {
    float depths[];
};

uvec4 sample_key(uint pixel, uint sample_index)
{
    return pcg4d(uvec4(pixel, sample_index, run.seed_low, run.seed_high));
}

// Decisions of a sample that take a low-discrepancy pair each.
const uint PAIR_PLACE = 0;      // place of the first collision, and its medium where it is guessed
const uint PAIR_SCATTERED = 1;  // direction from there
const uint PAIR_REFLECTED = 2;  // direction from a first surface
const uint PAIR_FREE_PATH = 3;  // free path after the first event; one number

// If SOBOL. The two samples of a pair are from independent sequences, so the means over both are
// independent (tracer_sum.comp).
uvec2 low_discrepancy(uint pixel, uint sample_index, uint decision)
{
    uvec2 own = pcg4d(uvec4(pixel, 2u * decision + (sample_index & 1u), run.seed_low,
                            ~run.seed_high)).xy;
    return sobol_pair(sample_index >> 1, uvec4(own, run.seed_low, run.seed_high));
}

// Hero channel, by which distances are drawn; from a sample's first random numbers.
uint choose_hero(uvec3 bits)
{
    return COLOURED ? min(uint(3.0 * uniform_from(bits).z), 2u) : 0u;
}

// Balance heuristic over channels: one path stands for all three, with the mean of their densities
// (single-sample multiple importance sampling; B. Miller, I. Georgiev, W. Jarosz 2019).
vec3 channel_weights(vec3 channels)
{
    return COLOURED ? channels * (3.0 / (channels.r + channels.g + channels.b)) : vec3(1.0);
}

// Grey scenes need one exponential, not three.
vec3 colour_transmittance(vec3 optical_depth)
{
    return COLOURED ? transmittance(optical_depth) : vec3(transmittance(optical_depth.r));
}

vec3 colour_absorbed_fraction(vec3 optical_depth)
{
    return COLOURED ? absorbed_fraction(optical_depth) : vec3(absorbed_fraction(optical_depth.r));
}

float max_channel(vec3 channels) { return max(channels.r, max(channels.g, channels.b)); }

float average_channels(vec3 channels) { return dot(channels, vec3(1.0 / 3.0)); }

// Approximate light of a collision [W m^-2 sr^-1] (scenes/sources.h). Used for sampling only.
struct Source {
    vec3 sun;     // before attenuation
    vec3 ambient; // emitted, or scattered from other light than the sun's
};

// Light from other sources than direct sun; lamps count as one metre away.
vec3 incident_light()
{
    vec3 light = ENVIRONMENT ? frame.background : vec3(0.0);
    if (MULTIPLE)
        light += frame.sun_irradiance / (4.0 * PI);
    for (uint m = 0; MULTIPLE && m < media_count(); m++)
        light += frame.media[m].glow;
    for (uint i = 0; MULTIPLE && LAMPS && i < make_nonuniform(frame.lamp_count); i++)
        light += frame.lamps[i].intensity / (4.0 * PI);
    return light;
}

Source make_source(uint m)
{
    vec3 scattered = frame.media[m].albedo * sign(frame.media[m].extinction_color);
    return Source(scattered * frame.sun_irradiance / (4.0 * PI),
                  frame.media[m].glow + scattered * incident_light());
}

bool is_bright(uint m)
{
    Source source = make_source(m);
    return source.sun + source.ambient != vec3(0.0);
}

// Optical depth on the view ray of all media except one medium or fog layer.
vec3 other_media_depth(uint but_medium, uint but_layer, ViewRay ray, float length_m)
{
    vec3 sum = vec3(0.0);
    if (media_count() == 1 && medium_layer_count(0) == 1)
        return sum;
    for (uint m = 0; m < media_count(); m++) {
        float depth = 0.0;
        for (uint l = 0; l < medium_layer_count(m); l++)
            if (m != but_medium || l != but_layer)
                depth += layer_optical_depth(m, l, ray.origin_m, ray.direction, length_m);
        sum += frame.media[m].extinction_color * depth;
    }
    return sum;
}

// View rays of the caller, in place of the camera's.
const bool OWN_RAYS = (TRAITS & NEPH_GPU_OWN_RAYS) != 0u;

struct OwnRay {
    vec3 origin_m; // from the camera's position
    float padding0;
    vec3 direction; // unit
    float padding1;
};

layout(std430, binding = 18) readonly buffer OwnRays {
    OwnRay own_rays[];
};

ViewRay pixel_ray(Camera camera, uint pixel)
{
    if (OWN_RAYS)
        return ViewRay(own_rays[pixel].origin_m, own_rays[pixel].direction);
    return camera_ray(camera, pixel % camera.width_px, pixel / camera.width_px);
}

ViewRay pixel_ray(uint pixel) { return pixel_ray(frame_camera(), pixel); }

#endif
