// SPDX-License-Identifier: MIT
//
// Shared by the passes of the real-time renderer: the view, the targets that they hand to each
// other, and the formats of the targets.
//
// Decisions (which slot, which ray, whether a value is in the clamp) are made in float32 with
// `precise` arithmetic and explicit comparisons, so that the CPU reference makes the same ones bit
// by bit: min, max and clamp are undefined for a NaN. Filters are written out, too, because the
// weights of a sampler have 8 bits.
#ifndef NEPH_REALTIME_GLSL
#define NEPH_REALTIME_GLSL

#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require

#include "renderer/shaders/halves.glsl"
#include "renderer/shaders/lamp.glsl"
#include "renderer/shaders/numbers.glsl"
#include "choices.glsl"
#include "names.h"

#ifndef REALTIME_BINDING
#define REALTIME_BINDING 0
#define VIEW_BLOCK uniform
#define KNOWN_TARGETS RT_TARGET_COUNT
#define SEES_TEXELS
#else // passes with rays: after the buffers of the scene
#define VIEW_BLOCK readonly buffer
#define KNOWN_TARGETS RT_RAY_TARGET_COUNT
#endif

// The camera of one frame; positions are relative to this frame's camera.
struct ViewCamera {
    vec3 right;
    float half_width; // of the image plane; tangents of a perspective camera's angles, else metres
    vec3 up;
    float half_height;
    vec3 forward;
    uint is_parallel; // 1: an orthographic camera
    vec3 position_m; // 0 for this frame's camera; for the last frame's camera its place
    float padding_2;
};

// Solids that move together: since the frame before they have turned about a pivot, and the pivot
// has moved. Places are relative to this frame's camera.
struct Mover {
    vec3 pivot_m;
    uint first; // of the scene's solids that are no meshes; `end` is past the last
    vec3 pivot_before_m;
    uint end;
    uint axis; // 0 x, 1 y, 2 z
    float cosine, sine; // of the angle back to the frame before
    uint instances_first; // of meshes; `instances_end` is past the last
    uint instances_end;
    uint padding_1, padding_2, padding_3;
};

// Elements row by row, row 0 on top.
struct Target {
    uint format; // RT_R16F, ..
    uint width, height;
    uint padding;
};

// A view is a rectangle of its targets: pixel (0, 0) of the view is texel `origin` of the
// full-resolution targets, origin / 2 of the half, origin / 4 of the quarter (`origin` is a
// multiple of 4).
layout(std430, binding = REALTIME_BINDING) VIEW_BLOCK View {
    ViewCamera now, before;
    Target targets[RT_TARGET_COUNT];
    // As in the table of options, choices as whole numbers; then those that the pipeline selects.
    float settings[RT_NUMBER_COUNT];
    uint seed;
    uint frame;       // frames that this pipeline has rendered before: phase and dither
    uint has_history; // 0 in the first frame, after a resize, and after a cut if cut_reset
    uint is_cut;      // the camera jumped since the frame before
    uint origin_px[2];
    uint size_px[2];      // of the view, full resolution
    uint half_size_px[2]; // rounded up
    uint tile_count[2];   // quarter resolution, rounded up
    float jitter_px[2]; // of this frame's rays, added to the pixel's centre; x right, y down
    float wind_m[3];    // displacement of the medium since the frame before
    uint resting;       // no override in this frame (override_rest)
    float jitter_before_px[2]; // jitter_px of the frame before
    uint mover_count;
    Mover movers[RT_MOVERS_MAX];
    uint picture_px[2]; // size of the output: size_px, or more with screen_percent
    float rendered_per_px[2]; // size_px over picture_px
    float exposure; // factor on colours before they are stored
    float exposure_before;
    // 1: the gradient samples of the medium, or those behind it, cannot find that the light has
    // changed (set_light_flags() of renderer/realtime/pipeline.c): the change is complete.
    uint strobes_medium;
    uint strobes_behind;
    // For the history of froxels (renderer/realtime/lamp_changes.h). Bit i: lamp i of this frame
    // differs from the frame before, where it was lamps_before[i], relative to this frame's camera.
    uint lamps_changed;
    uint sun_jumped; // 1: the sun differs from the frame before by more than its history follows
    Lamp lamps_before[NEPH_GPU_LAMPS_MAX];
} view;

// Ranks of the blue noise masks: 64x64, then 64x64x32 (renderer/blue_noise.h).
layout(std430, binding = REALTIME_BINDING + 1) readonly buffer NoiseRanks {
    uint noise_ranks[];
};

layout(std430, binding = REALTIME_BINDING + 2) buffer Targets {
    uint words[];
} targets[KNOWN_TARGETS];

// The same words in pairs and in fours, for elements of that size: one access each. lavapipe splits
// vectors into one access per word and thread, so it reads a pair as one 64-bit number. Each target
// is accessed through only one of the four.
layout(std430, binding = REALTIME_BINDING + 2) buffer TargetPairs {
    uvec2 words[];
} target_pairs[KNOWN_TARGETS];

layout(std430, binding = REALTIME_BINDING + 2) buffer TargetLongs {
    uint64_t words[];
} target_longs[KNOWN_TARGETS];

layout(std430, binding = REALTIME_BINDING + 2) buffer TargetFours {
    uvec4 words[];
} target_fours[KNOWN_TARGETS];

#ifdef SEES_TEXELS
// The targets as texels, for reads on a CPU (neph_buffer_create_texel_views()).
layout(binding = NEPH_GPU_TEXELS_BINDING, r32ui)
uniform readonly uimageBuffer target_texels[RT_WORD_TARGET_COUNT];
layout(binding = NEPH_GPU_TEXEL_PAIRS_BINDING, rg32ui)
uniform readonly uimageBuffer target_texel_pairs[RT_PAIR_TARGET_COUNT];
layout(binding = NEPH_GPU_TEXEL_FOURS_BINDING, rgba32ui)
uniform readonly uimageBuffer target_texel_fours[RT_TARGET_COUNT];
#endif

#include "device.glsl"

ViewCamera force_nonuniform(ViewCamera camera)
{
    camera.is_parallel = force_nonuniform(camera.is_parallel);
    camera.position_m = force_nonuniform(camera.position_m);
    return camera;
}

// A copy of the view, read at the start of main(). There lavapipe knows that all threads are active
// and reads once for all; after a return or a branch it reads for one thread after the other.
ViewCamera view_now = force_nonuniform(view.now), view_before = force_nonuniform(view.before);
float settings[RT_NUMBER_COUNT] = view.settings;
ivec2 origin_px = ivec2(view.origin_px[0], view.origin_px[1]);
ivec2 size_px = ivec2(view.size_px[0], view.size_px[1]);
ivec2 picture_px = ivec2(view.picture_px[0], view.picture_px[1]);
vec2 rendered_per_px = vec2(view.rendered_per_px[0], view.rendered_per_px[1]);
float exposure = view.exposure, exposure_before = view.exposure_before;
ivec2 half_size_px = ivec2(view.half_size_px[0], view.half_size_px[1]);
ivec2 tiles = ivec2(view.tile_count[0], view.tile_count[1]);
vec2 jitter_px = vec2(view.jitter_px[0], view.jitter_px[1]);
vec2 jitter_before_px = vec2(view.jitter_before_px[0], view.jitter_before_px[1]);
vec3 moved_by_wind_m = force_nonuniform(vec3(view.wind_m[0], view.wind_m[1], view.wind_m[2]));
uint view_seed = view.seed, view_frame = force_nonuniform(view.frame);
bool has_past = force_nonuniform(view.has_history) != 0u;
bool is_cut = force_nonuniform(view.is_cut) != 0u;
// Texels in a row of the targets of each resolution.
int full_row = int(view.targets[RT_DEPTH].width);
int picture_row = int(view.targets[RT_TAA_OUT].width);
int half_row = int(view.targets[RT_HALF_DEPTH].width);
int quarter_row = int(view.targets[RT_TILE].width);
int froxel_row = int(view.targets[RT_FROXELS].width);

#define choice(index) (SPECIALISED ? known_choice(index) : int(settings[index]))
float setting(int index) { return force_nonuniform(settings[index]); } // of a number
// Whether a number is other than 0, where that is "never" or "off".
#define is_set(index) (SPECIALISED ? known_choice(index) != 0 : setting(index) != 0.0)

ivec2 view_origin() { return origin_px; }
ivec2 view_size() { return size_px; }
ivec2 get_output_size() { return picture_px; }
ivec2 half_size() { return half_size_px; }
ivec2 tile_count() { return tiles; }
vec3 wind_m() { return moved_by_wind_m; }

// --- targets --------------------------------------------------------------------------------

// The largest half. Values are clamped to it before they are stored as halves.
const float HALF_MAX = 65504.0;

struct TargetRow {
    int resolution, half_format, float_format;
};

const TargetRow TARGETS[RT_TARGET_COUNT] = {RT_TARGETS};

int get_format(int target)
{
    TargetRow row = TARGETS[target];
    bool is_half = choice(RT_TARGET_FORMAT) == RT_FORMAT_HALF;
    return is_half ? row.half_format : row.float_format;
}

layout(constant_id = RT_HALVES_CONSTANT) const uint NATIVE_HALVES = 0;
// Static frames skip most of the reprojection. A constant removes that code from the kernel;
// lavapipe would execute it under a branch.
layout(constant_id = RT_STATIC_CONSTANT) const uint STATIC_PARTS = 0;
const bool IS_VIEW_STATIC = (STATIC_PARTS & RT_STATIC_VIEW) != 0u;
const bool IS_MEDIUM_STATIC = (STATIC_PARTS & RT_STATIC_MEDIUM) != 0u;

// By the driver's conversions where they are known to be correct (renderer/halves.h).
vec4 unpack(uvec2 words)
{
    if ((NATIVE_HALVES & NEPH_HALVES_READ) != 0u)
        return vec4(unpackHalf2x16(words.x), unpackHalf2x16(words.y));
    return from_words(words);
}

uint pack(vec2 value)
{
    return (NATIVE_HALVES & NEPH_HALVES_WRITTEN) != 0u
               ? packHalf2x16(value)
               : to_word(value);
}

int get_width(int target)
{
    int resolution = TARGETS[target].resolution;
    if (resolution == RT_FROXEL)
        return froxel_row;
    if (resolution == RT_OUTPUT)
        return picture_row;
    return resolution == RT_FULL ? full_row : resolution == RT_HALF ? half_row : quarter_row;
}

// The words of an element in a half format: one or two.
uvec2 half_words(int target, uint index, int format)
{
    if (format == RT_RGBA16F)
        return load_word_pair(target, index);
    uint word = load_word(target, index);
    return uvec2(format == RT_R16F ? word & 0xffffu : word, 0u);
}

// Element (x, y) of a target, in texels of the whole target. The caller ensures 0 <= (x, y) < size.
vec4 fetch(int target, ivec2 texel)
{
    uint index = uint(texel.y * get_width(target) + texel.x);
    int format = get_format(target);
    switch (format) {
    case RT_R32F:
        return vec4(uintBitsToFloat(load_word(target, index)), 0.0, 0.0, 0.0);
    case RT_RG32F:
        return vec4(uintBitsToFloat(load_word_pair(target, index)), 0.0, 0.0);
    case RT_RGBA32F:
        return uintBitsToFloat(load_word_four(target, index));
    default:
        return unpack(half_words(target, index, format));
    }
}

void put(int target, ivec2 texel, vec4 value)
{
    uint index = uint(texel.y * get_width(target) + texel.x);
    switch (get_format(target)) {
    case RT_R16F:
        targets[target].words[index] = pack(vec2(value.x, 0.0));
        break;
    case RT_R32F:
        targets[target].words[index] = floatBitsToUint(value.x);
        break;
    case RT_RG16F:
        targets[target].words[index] = pack(value.xy);
        break;
    case RT_RG32F:
        store_word_pair(target, index, floatBitsToUint(value.xy));
        break;
    case RT_RGBA16F:
        store_word_pair(target, index, uvec2(pack(value.xy), pack(value.zw)));
        break;
    default:
        target_fours[target].words[index] = floatBitsToUint(value);
    }
}

// Elements by their place in the view: pixels (fetch_full), pixels of the output (fetch_output),
// half-resolution texels (fetch_half) or tiles (fetch_tile), clamped to its sides. A tile:
//
//     +-------+-------+
//     | p   p | p   p |     4x4 pixels p, 2x2 half-resolution texels,
//     | p   p | p   p |     one element at quarter resolution
//     +-------+-------+
//     | p   p | p   p |
//     | p   p | p   p |
//     +-------+-------+
vec4 fetch_full(int target, ivec2 pixel)
{
    return fetch(target, view_origin() + clamp(pixel, ivec2(0), view_size() - 1));
}

vec4 fetch_output(int target, ivec2 pixel)
{
    return fetch(target, view_origin() + clamp(pixel, ivec2(0), get_output_size() - 1));
}

vec4 fetch_half(int target, ivec2 pixel)
{
    return fetch(target, view_origin() / 2 + clamp(pixel, ivec2(0), half_size() - 1));
}

vec4 fetch_tile(int target, ivec2 tile)
{
    return fetch(target, view_origin() / 4 + clamp(tile, ivec2(0), tile_count() - 1));
}

void put_full(int target, ivec2 pixel, vec4 value) { put(target, view_origin() + pixel, value); }

void put_output(int target, ivec2 pixel, vec4 value) { put(target, view_origin() + pixel, value); }

void put_half(int target, ivec2 pixel, vec4 value)
{
    put(target, view_origin() / 2 + pixel, value);
}

void put_tile(int target, ivec2 tile, vec4 value) { put(target, view_origin() / 4 + tile, value); }

// --- numbers that may be bad -------------------------------------------------------------------

// Tests the bits, because a compiler may assume that there is no NaN.
bool is_finite(float value) { return (floatBitsToUint(value) & 0x7f800000u) != 0x7f800000u; }

// Whether in-scattered radiance and transmittance are valid: finite and not negative. Without early
// returns, because a GPU would then wait for one value after the other.
bool is_sound(vec4 value)
{
    uvec4 magnitudes = floatBitsToUint(value) & 0x7fffffffu;
    bool are_finite = all(lessThan(magnitudes, uvec4(0x7f800000u)));
    bool are_positive = all(greaterThanEqual(value, vec4(0.0)));
    return are_finite && are_positive;
}

// A volume composed with the radiance behind it. `precise`, because a fused multiply-add would
// round once where march.comp rounds twice.
vec3 over(vec4 volume, vec3 behind)
{
    precise vec3 transmitted = volume.w * behind;
    precise vec3 radiance = volume.xyz + transmitted;
    return radiance;
}

// --- rays -----------------------------------------------------------------------------------

struct ViewLine {
    vec3 origin_m; // 0 of a perspective camera
    vec3 direction; // unit
};

// The line of sight of this frame's camera through a place of the view in pixels, (0, 0) its upper
// left corner. Without jitter.
ViewLine view_line_at(ViewCamera camera, vec2 place_px)
{
    float x = (2.0 * place_px.x / float(size_px.x) - 1.0) * camera.half_width;
    float y = (1.0 - 2.0 * place_px.y / float(size_px.y)) * camera.half_height;
    if (camera.is_parallel != 0u)
        return ViewLine(x * camera.right + y * camera.up, camera.forward);
    return ViewLine(vec3(0.0), normalize(camera.forward + x * camera.right + y * camera.up));
}

// Whether the camera has the same place, direction and field of view as in the frame before.
bool is_camera_static()
{
    if (IS_VIEW_STATIC)
        return true;
    return view_before.position_m == vec3(0.0) && view_now.forward == view_before.forward &&
           view_now.right == view_before.right && view_now.up == view_before.up &&
           view_now.half_width == view_before.half_width &&
           view_now.half_height == view_before.half_height;
}

bool is_medium_static()
{
    return IS_MEDIUM_STATIC || choice(RT_WIND) == 0 || wind_m() == vec3(0.0);
}

// The factor by which the image plane widens: the depth, or 1 for an orthographic camera.
float view_spread(ViewCamera camera, float depth) { return camera.is_parallel != 0u ? 1.0 : depth; }

// Projects a point (relative to this frame's camera) into a camera's image: xy in pixels, z its eye
// depth [m], which is not above 0 when the point is not in front of the camera.
vec3 project(ViewCamera camera, vec3 point_m)
{
    vec3 from_m = point_m - camera.position_m;
    float depth_m = dot(from_m, camera.forward);
    float spread_m = view_spread(camera, depth_m);
    float x = dot(from_m, camera.right) / (spread_m * camera.half_width);
    float y = dot(from_m, camera.up) / (spread_m * camera.half_height);
    return vec3((0.5 + 0.5 * x) * float(size_px.x), (0.5 - 0.5 * y) * float(size_px.y),
                depth_m);
}

#endif
