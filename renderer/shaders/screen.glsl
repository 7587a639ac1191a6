// SPDX-License-Identifier: MIT
//
// What the passes of the screen share: its targets, its settings, and where a pixel lies in the
// world. A pass is one thread a pixel, 64 of them in a square of 8x8; row 0 is on top. At half
// resolution it has a thread for each cell of 2x2 pixels, of which it looks at one.
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
    uint cell_px;  // side of a cell
    uint own_px[2], before_px[2]; // which pixel of its cells the pass looks at, now and before
} run;

layout(std430, binding = 5) readonly buffer ScreenView {
    float settings[SCREEN_SETTING_COUNT]; // as in the table of options; choices as whole numbers
    uint size_px[2];
    float half_size[2]; // of the picture: tangents of a perspective camera's angles, else metres
    uint is_orthographic;
    uint frame; // of the noise
    float sky_light[3]; // radiance of the background, where it lights solids
    uint has_before; // 0: there was no frame before
    uint has_bounces; // 0: surfaces do not light each other
    uint open_at, gi_at, ssr_at; // targets in which these end up; SCREEN_NONE: there is none
    uint gi_cell_px, ssr_cell_px;
} view;

// What a solid is made of (scenes/surface.h), by its number.
struct ScreenSurface {
    vec3 other; // second colour of its pattern
    float roughness;
    float metalness;
    float cell_m; // of the pattern; 0: there is none
    uint is_noise;
    uint seed;
    // A place of it in the axes of the camera of the frame before, from where it is now: rows times
    // it, and the last column added.
    float to_before[12];
};

layout(std430, binding = 6) readonly buffer ScreenSurfaces {
    ScreenSurface surfaces[];
};

layout(std430, binding = 7) buffer ScreenTargets {
    uint words[];
} targets[SCREEN_TARGET_COUNT];

// The same targets by the texel, in one piece.
layout(std430, binding = 7) buffer ScreenTexels32 {
    uvec4 texels[];
} texels_32[SCREEN_TARGET_COUNT];
layout(std430, binding = 7) buffer ScreenTexels16 {
    uvec2 texels[];
} texels_16[SCREEN_TARGET_COUNT];

const int TILE = 8; // pixels along a side of a group

float setting(int index) { return view.settings[index]; }
int choice(int index) { return int(view.settings[index]); }
ivec2 size_px() { return ivec2(view.size_px[0], view.size_px[1]); }
vec2 half_size() { return vec2(view.half_size[0], view.half_size[1]); }
bool is_orthographic() { return view.is_orthographic != 0u; }
vec3 sky_light() { return vec3(view.sky_light[0], view.sky_light[1], view.sky_light[2]); }
bool is_sky(float depth_m) { return depth_m >= FAR_M; }

// The place of this thread among so many columns and rows; false when there is none.
bool own_place(ivec2 size, out ivec2 place)
{
    int columns = (size.x + TILE - 1) / TILE;
    int group = int(run.first_group + gl_WorkGroupID.x), thread = int(gl_LocalInvocationIndex);
    place = TILE * ivec2(group % columns, group / columns) + ivec2(thread % TILE, thread / TILE);
    return place.x < size.x && place.y < size.y;
}

bool own_pixel(out ivec2 pixel) { return own_place(size_px(), pixel); }

bool is_inside(ivec2 pixel)
{
    return pixel.x >= 0 && pixel.y >= 0 && pixel.x < size_px().x && pixel.y < size_px().y;
}

// --- cells ------------------------------------------------------------------------------------

int halvings() { return int(run.cell_px) - 1; } // of a side of 1 or 2
ivec2 cells() { return (size_px() + halvings()) >> halvings(); }
bool own_cell(out ivec2 cell) { return own_place(cells(), cell); }

bool is_cell(ivec2 cell)
{
    return cell.x >= 0 && cell.y >= 0 && cell.x < cells().x && cell.y < cells().y;
}

ivec2 own_px() { return ivec2(run.own_px[0], run.own_px[1]); }
ivec2 before_px() { return ivec2(run.before_px[0], run.before_px[1]); }

// The pixel that a cell stands for, now and in the frame before.
ivec2 pixel_in(ivec2 cell) { return min((cell << halvings()) + own_px(), size_px() - 1); }
ivec2 pixel_before_in(ivec2 cell)
{
    return min((cell << halvings()) + before_px(), size_px() - 1);
}

// --- targets ----------------------------------------------------------------------------------

// Cells lie in the upper left of their target, row by row as pixels do.
int texel_of(ivec2 pixel) { return pixel.y * size_px().x + pixel.x; }
bool is_half() { return choice(SCREEN_TARGETS) == SCREEN_FLOAT16; }

vec4 load(int target, ivec2 pixel)
{
    int at = texel_of(pixel);
    if (is_half()) {
        uvec2 halves = texels_16[target].texels[at];
        return vec4(unpackHalf2x16(halves.x), unpackHalf2x16(halves.y));
    }
    return uintBitsToFloat(texels_32[target].texels[at]);
}

void store(int target, ivec2 pixel, vec4 texel)
{
    int at = texel_of(pixel);
    if (is_half()) {
        const float HALF_MAX = 65504.0;
        vec4 held = clamp(texel, -HALF_MAX, HALF_MAX);
        texels_16[target].texels[at] = uvec2(packHalf2x16(held.xy), packHalf2x16(held.zw));
        return;
    }
    texels_32[target].texels[at] = floatBitsToUint(texel);
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

// Metal has no diffuse part, and other things reflect nothing.
bool has_light(ivec2 pixel, bool of_metal)
{
    float metalness = load(SCREEN_BASE, pixel).w;
    return !is_sky(depth_at_m(pixel)) && (of_metal ? metalness > 0.0 : metalness < 1.0);
}

// At half resolution cells without the light are left out: no pixel looks at them.
bool is_left_out(ivec2 pixel, bool of_metal)
{
    return run.cell_px > 1u && !has_light(pixel, of_metal);
}

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

// By how much a place is off the plane of a surface, over its distance: 0 at a slope of 1:10.
float in_plane(vec3 point_m, vec3 normal, vec3 place_m)
{
    const float STEEPEST = 0.1;
    vec3 offset_m = place_m - point_m;
    float distance_m = length(offset_m);
    if (!(distance_m > 0.0))
        return 1.0;
    return clamp(1.0 - abs(dot(offset_m, normal)) / (STEEPEST * distance_m), 0.0, 1.0);
}

float same_surface(vec3 point_m, vec3 normal, ivec2 neighbour)
{
    return in_plane(point_m, normal, surface_m(neighbour));
}

// Where a place before the camera is seen.
vec2 pixel_of(vec3 point_m)
{
    vec2 way = is_orthographic() ? point_m.xy : point_m.xy / point_m.z;
    return (0.5 + 0.5 * vec2(1.0, -1.0) * way / half_size()) * vec2(size_px());
}

// The number of the solid that a pixel shows.
uint solid_at(ivec2 pixel)
{
    return targets[SCREEN_MARKS].words[texel_of(pixel)] >> SCREEN_LIGHT_BITS;
}

// A direction and a place of a solid as the camera of the frame before has them.
vec3 direction_before(uint solid, vec3 v)
{
    float rows[12] = surfaces[solid].to_before;
    return vec3(dot(v, vec3(rows[0], rows[1], rows[2])), dot(v, vec3(rows[4], rows[5], rows[6])),
                dot(v, vec3(rows[8], rows[9], rows[10])));
}

vec3 place_before_m(uint solid, vec3 point_m)
{
    float rows[12] = surfaces[solid].to_before;
    return direction_before(solid, point_m) + vec3(rows[3], rows[7], rows[11]);
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
