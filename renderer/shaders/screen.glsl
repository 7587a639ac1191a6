// SPDX-License-Identifier: MIT
//
// What the passes of the screen share: its targets, its settings, and where a pixel lies in the
// world. A pass is one thread a pixel, 64 of them in a square of 8x8; row 0 is on top.
//
// Places are in the camera's own axes, (right, up, forward) from the camera [m], so that z is the
// eye depth.
#ifndef NEPH_SCREEN_GLSL
#define NEPH_SCREEN_GLSL

#include "random.glsl"
#include "screen_names.h"

layout(local_size_x = 64) in;

layout(push_constant) uniform ScreenRun {
    uint first_group;
    uint turn;     // of a pass that runs several times
    uint from, to; // targets, of passes that work on several
    uint before;   // what `to` was in the frame before
} run;

layout(std430, binding = 5) readonly buffer ScreenView {
    float settings[SCREEN_SETTING_COUNT]; // as in the table of options; choices as whole numbers
    uint size_px[2];
    float half_size[2]; // of the picture: tangents of a perspective camera's angles, else metres
    uint is_orthographic;
    uint frame; // of the noise
    float sky_light[3]; // radiance of the background, where it lights solids
    uint has_before; // 0: there was no frame before
    // A place in the axes of the frame before: rows times it, and the last column added.
    float to_before[12];
    uint has_bounces; // 0: surfaces do not light each other
    uint open_at, gi_at, ssr_at; // targets in which these end up; SCREEN_NONE: there is none
} view;

// What a solid is made of (scenes/surface.h), by its number.
struct ScreenSurface {
    vec3 other; // second colour of its pattern
    float roughness;
    float metalness;
    float cell_m; // of the pattern; 0: there is none
    uint is_noise;
    uint seed;
};

layout(std430, binding = 6) readonly buffer ScreenSurfaces {
    ScreenSurface surfaces[];
};

layout(std430, binding = 7) buffer ScreenTargets {
    uint words[];
} targets[SCREEN_TARGET_COUNT];

const int TILE = 8; // pixels along a side of a group

float setting(int index) { return view.settings[index]; }
int choice(int index) { return int(view.settings[index]); }
ivec2 size_px() { return ivec2(view.size_px[0], view.size_px[1]); }
vec2 half_size() { return vec2(view.half_size[0], view.half_size[1]); }
bool is_orthographic() { return view.is_orthographic != 0u; }
vec3 sky_light() { return vec3(view.sky_light[0], view.sky_light[1], view.sky_light[2]); }
bool is_sky(float depth_m) { return depth_m >= FAR_M; }

// The pixel of this thread; false when there is none.
bool own_pixel(out ivec2 pixel)
{
    int columns = (size_px().x + TILE - 1) / TILE;
    int group = int(run.first_group + gl_WorkGroupID.x), thread = int(gl_LocalInvocationIndex);
    pixel = TILE * ivec2(group % columns, group / columns) + ivec2(thread % TILE, thread / TILE);
    return pixel.x < size_px().x && pixel.y < size_px().y;
}

bool is_inside(ivec2 pixel)
{
    return pixel.x >= 0 && pixel.y >= 0 && pixel.x < size_px().x && pixel.y < size_px().y;
}

// --- targets ----------------------------------------------------------------------------------

int texel_of(ivec2 pixel) { return pixel.y * size_px().x + pixel.x; }
bool is_half() { return choice(SCREEN_TARGETS) == SCREEN_FLOAT16; }

vec4 load(int target, ivec2 pixel)
{
    int at = texel_of(pixel);
    if (is_half())
        return vec4(unpackHalf2x16(targets[target].words[SCREEN_WORDS_16 * at]),
                    unpackHalf2x16(targets[target].words[SCREEN_WORDS_16 * at + 1]));
    int word = SCREEN_WORDS_32 * at;
    return uintBitsToFloat(uvec4(targets[target].words[word], targets[target].words[word + 1],
                                 targets[target].words[word + 2], targets[target].words[word + 3]));
}

void store(int target, ivec2 pixel, vec4 texel)
{
    int at = texel_of(pixel);
    if (is_half()) {
        const float HALF_MAX = 65504.0;
        vec4 held = clamp(texel, -HALF_MAX, HALF_MAX);
        targets[target].words[SCREEN_WORDS_16 * at] = packHalf2x16(held.xy);
        targets[target].words[SCREEN_WORDS_16 * at + 1] = packHalf2x16(held.zw);
        return;
    }
    int word = SCREEN_WORDS_32 * at;
    targets[target].words[word] = floatBitsToUint(texel.x);
    targets[target].words[word + 1] = floatBitsToUint(texel.y);
    targets[target].words[word + 2] = floatBitsToUint(texel.z);
    targets[target].words[word + 3] = floatBitsToUint(texel.w);
}

float load_one(int target, ivec2 pixel)
{
    return uintBitsToFloat(targets[target].words[texel_of(pixel)]);
}

void store_one(int target, ivec2 pixel, float value)
{
    targets[target].words[texel_of(pixel)] = floatBitsToUint(value);
}

float depth_at_m(ivec2 pixel) { return load_one(SCREEN_DEPTH, pixel); }
float depth_before_m(ivec2 pixel) { return load_one(SCREEN_DEPTH_BEFORE, pixel); }
vec3 normal_at(ivec2 pixel) { return normalize(load(SCREEN_NORMAL, pixel).xyz); }

// --- places -----------------------------------------------------------------------------------

vec2 centre_of(ivec2 pixel) { return vec2(pixel) + 0.5; }

// What is seen at a place in the picture, in pixels from its upper left corner, at an eye depth.
vec3 place_m(vec2 place_px, float depth_m)
{
    vec2 way = (2.0 * place_px / vec2(size_px()) - 1.0) * vec2(1.0, -1.0) * half_size();
    return vec3(is_orthographic() ? way : way * depth_m, depth_m);
}

vec3 surface_m(ivec2 pixel) { return place_m(centre_of(pixel), depth_at_m(pixel)); }

// What is seen at a place of the picture: the surface of its pixel goes on in its plane, which is
// exact on flat ones and of second order on others. False where that plane is seen from its edge or
// ends before the place.
bool plane_at(vec2 place_px, ivec2 pixel, out vec3 point_m)
{
    const float EDGE = 1e-4, NEARER = 0.5, FARTHER = 10.0; // a cosine; of its depth
    vec3 own_m = surface_m(pixel), normal = normal_at(pixel);
    vec3 near_m = place_m(place_px, own_m.z);
    vec3 sight = is_orthographic() ? vec3(0.0, 0.0, 1.0) : near_m / near_m.z;
    float facing = -dot(normal, sight);
    float along = dot(normal, near_m - own_m) / max(facing, EDGE);
    point_m = near_m + along * sight;
    return facing > EDGE && along > -NEARER * own_m.z && along < FARTHER * own_m.z;
}

// Where a place before the camera is seen.
vec2 pixel_of(vec3 point_m)
{
    vec2 way = is_orthographic() ? point_m.xy : point_m.xy / point_m.z;
    return (0.5 + 0.5 * vec2(1.0, -1.0) * way / half_size()) * vec2(size_px());
}

// A place, and a direction, in the axes of the camera of the frame before.
vec3 direction_before(vec3 v)
{
    return vec3(dot(v, vec3(view.to_before[0], view.to_before[1], view.to_before[2])),
                dot(v, vec3(view.to_before[4], view.to_before[5], view.to_before[6])),
                dot(v, vec3(view.to_before[8], view.to_before[9], view.to_before[10])));
}

vec3 place_before_m(vec3 point_m)
{
    return direction_before(point_m) +
           vec3(view.to_before[3], view.to_before[7], view.to_before[11]);
}

// From a place to the camera, unit.
vec3 to_camera(vec3 point_m)
{
    return is_orthographic() ? vec3(0.0, 0.0, -1.0) : -normalize(point_m);
}

// Two unit vectors across a unit vector and each other (T. Duff et al., "Building an Orthonormal
// Basis, Revisited", JCGT 6(1), 2017).
void basis_across(vec3 axis, out vec3 first, out vec3 second)
{
    float side = axis.z >= 0.0 ? 1.0 : -1.0;
    float a = -1.0 / (side + axis.z), b = axis.x * axis.y * a;
    first = vec3(1.0 + side * axis.x * axis.x * a, side * b, -side * axis.x);
    second = vec3(b, side + axis.y * axis.y * a, -axis.y);
}

// --- noise ------------------------------------------------------------------------------------

// 4x4 pixels have 16 turns, each once, and 4 offsets, each four times (J. Jimenez et al.,
// "Practical Real-Time Strategies for Accurate Indirect Occlusion", 2016); both in [0, 1), with a
// step of the golden ratio from frame to frame.
vec2 tiled_noise(ivec2 pixel)
{
    const vec2 GOLDEN = vec2(0.754877666, 0.569840291); // R2 (M. Roberts, 2018)
    float turn = float((((pixel.x + pixel.y) & 3) << 2) + (pixel.x & 3)) / 16.0;
    float offset = float((pixel.y - pixel.x) & 3) / 4.0;
    return fract(vec2(turn, offset) + float(view.frame & 0xffffu) * GOLDEN);
}

// Pair `index` of a pixel: over the indices they fill the square evenly (R2), from a place of each
// pixel's own.
vec2 ray_noise(ivec2 pixel, uint salt, uint index)
{
    const vec2 GOLDEN = vec2(0.754877666, 0.569840291);
    vec2 first = uniform_from(pcg3d(uvec3(pixel, salt))).xy;
    return fract(first + float(index & 0xffffu) * GOLDEN);
}

#endif
