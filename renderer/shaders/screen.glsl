// SPDX-License-Identifier: MIT
//
// Common part of the screen-space passes (renderer/screen/): targets, settings, and the conversion
// between pixels and positions. A pass has one thread per pixel, in groups of 8x8; row 0 is at the
// top. At half resolution it has one thread per cell of 2x2 pixels and works on one pixel of the
// cell:
//
//    +---+---+    own_px: the pixel of each cell that is used in this frame
//    | x |   |
//    +---+---+
//    |   |   |
//    +---+---+
//
// Positions are in camera axes (right, up, forward), relative to the camera [m], so z is the eye
// depth.
#ifndef NEPH_SCREEN_GLSL
#define NEPH_SCREEN_GLSL

#include "random.glsl"
#include "screen_names.h"

layout(local_size_x = 64) in;

layout(push_constant) uniform ScreenRun {
    uint first_group;
    uint turn;     // index of the repetition, in passes that run several times
    uint from, to; // targets, in passes that work on several
    uint before;   // history of `to`: its content in the frame before
    uint cell_px;  // side of a cell: 1 or 2
    // Pixel of each cell that is used, in this frame and the one before.
    uint own_px[2], before_px[2];
} run;

layout(std430, binding = 5) readonly buffer ScreenView {
    // In the order of the table of options; choices as whole numbers.
    float settings[SCREEN_SETTING_COUNT];
    uint size_px[2];
    // Half the size of the image plane: tangents (perspective camera) or metres (orthographic).
    float half_size[2];
    uint is_orthographic;
    uint frame; // for the noise
    float sky_light[3]; // radiance of the background, where it illuminates solids
    uint has_before; // 0: no frame before
    uint has_bounces; // 0: no light between surfaces
    uint open_at, gi_at, ssr_at; // targets with the final results; SCREEN_NONE: none
    uint gi_cell_px, ssr_cell_px;
} view;

// Material of a solid (scenes/surface.h), indexed by the solid's number.
struct ScreenSurface {
    vec3 other; // second colour of the pattern
    float roughness;
    float metalness;
    float cell_m; // side of a pattern cell; 0: no pattern
    uint is_noise;
    uint seed;
    // Motion of the solid: the matrix, by rows of four, that maps its points from this frame's
    // camera axes to the axes of the camera of the frame before.
    float to_before[12];
};

layout(std430, binding = 6) readonly buffer ScreenSurfaces {
    ScreenSurface surfaces[];
};

layout(std430, binding = 7) buffer ScreenTargets {
    uint words[];
} targets[SCREEN_TARGET_COUNT];

// Views of the same targets for loads and stores of whole texels.
layout(std430, binding = 7) buffer ScreenTexels32 {
    uvec4 texels[];
} texels_32[SCREEN_TARGET_COUNT];
layout(std430, binding = 7) buffer ScreenTexels16 {
    uvec2 texels[];
} texels_16[SCREEN_TARGET_COUNT];

const int TILE = 8; // side of a thread group [px]

float setting(int index) { return view.settings[index]; }
int choice(int index) { return int(view.settings[index]); }
ivec2 size_px() { return ivec2(view.size_px[0], view.size_px[1]); }
vec2 half_size() { return vec2(view.half_size[0], view.half_size[1]); }
bool is_orthographic() { return view.is_orthographic != 0u; }
vec3 sky_light() { return vec3(view.sky_light[0], view.sky_light[1], view.sky_light[2]); }
bool is_sky(float depth_m) { return depth_m >= FAR_M; }

// The element of this thread in a grid of `size`; false when there is none.
bool get_thread_place(ivec2 size, out ivec2 place)
{
    int columns = (size.x + TILE - 1) / TILE;
    int group = int(run.first_group + gl_WorkGroupID.x), thread = int(gl_LocalInvocationIndex);
    place = TILE * ivec2(group % columns, group / columns) + ivec2(thread % TILE, thread / TILE);
    return place.x < size.x && place.y < size.y;
}

bool get_thread_pixel(out ivec2 pixel) { return get_thread_place(size_px(), pixel); }

bool is_inside(ivec2 pixel)
{
    return pixel.x >= 0 && pixel.y >= 0 && pixel.x < size_px().x && pixel.y < size_px().y;
}

// --- cells ------------------------------------------------------------------------------------

int cell_shift() { return int(run.cell_px) - 1; } // log2 of the cell's side, 1 or 2
ivec2 cells() { return (size_px() + cell_shift()) >> cell_shift(); }
bool get_thread_cell(out ivec2 cell) { return get_thread_place(cells(), cell); }

bool is_cell(ivec2 cell)
{
    return cell.x >= 0 && cell.y >= 0 && cell.x < cells().x && cell.y < cells().y;
}

ivec2 used_px() { return ivec2(run.own_px[0], run.own_px[1]); }
ivec2 before_px() { return ivec2(run.before_px[0], run.before_px[1]); }

// The pixel of a cell that is used, in this frame and in the one before.
ivec2 pixel_in(ivec2 cell) { return min((cell << cell_shift()) + used_px(), size_px() - 1); }
ivec2 pixel_before_in(ivec2 cell)
{
    return min((cell << cell_shift()) + before_px(), size_px() - 1);
}

// --- targets ----------------------------------------------------------------------------------

// Index of a texel. Cells are stored in the upper left part of their target, at the same row stride
// as pixels.
int texel_index(ivec2 pixel) { return pixel.y * size_px().x + pixel.x; }
bool is_half() { return choice(SCREEN_TARGETS) == SCREEN_FLOAT16; }

vec4 load(int target, ivec2 pixel)
{
    int at = texel_index(pixel);
    if (is_half()) {
        uvec2 halves = texels_16[target].texels[at];
        return vec4(unpackHalf2x16(halves.x), unpackHalf2x16(halves.y));
    }
    return uintBitsToFloat(texels_32[target].texels[at]);
}

void store(int target, ivec2 pixel, vec4 texel)
{
    int at = texel_index(pixel);
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
    return uintBitsToFloat(targets[target].words[texel_index(pixel)]);
}

void store_one(int target, ivec2 pixel, float value)
{
    targets[target].words[texel_index(pixel)] = floatBitsToUint(value);
}

float depth_at_m(ivec2 pixel) { return load_one(SCREEN_DEPTH, pixel); }
float depth_before_m(ivec2 pixel) { return load_one(SCREEN_DEPTH_BEFORE, pixel); }
vec3 normal_at(ivec2 pixel) { return normalize(load(SCREEN_NORMAL, pixel).xyz); }

// Whether a pixel has metallic reflections (`of_metal`) or diffuse light. Pure metal has no diffuse
// part; other materials reflect nothing.
bool has_light(ivec2 pixel, bool of_metal)
{
    float metalness = load(SCREEN_BASE, pixel).w;
    return !is_sky(depth_at_m(pixel)) && (of_metal ? metalness > 0.0 : metalness < 1.0);
}

// At half resolution, cells without this light are skipped; no pixel reads them.
bool is_left_out(ivec2 pixel, bool of_metal)
{
    return run.cell_px > 1u && !has_light(pixel, of_metal);
}

// --- places -----------------------------------------------------------------------------------

vec2 pixel_centre_px(ivec2 pixel) { return vec2(pixel) + 0.5; }

// The point seen at an image position, in pixels from the upper left corner, for an eye depth.
vec3 place_m(vec2 place_px, float depth_m)
{
    vec2 way = (2.0 * place_px / vec2(size_px()) - 1.0) * vec2(1.0, -1.0) * half_size();
    return vec3(is_orthographic() ? way : way * depth_m, depth_m);
}

vec3 surface_m(ivec2 pixel) { return place_m(pixel_centre_px(pixel), depth_at_m(pixel)); }

// The surface point at an image position: the pixel's surface is extended in its tangent plane,
// which is exact for flat surfaces and of second order for others. False where the plane is seen
// edge-on, or where the extended point is much nearer or farther than the pixel.
bool plane_at(vec2 place_px, ivec2 pixel, out vec3 point_m)
{
    // A cosine; the others relative to the depth.
    const float EDGE = 1e-4, NEARER = 0.5, FARTHER = 10.0;
    vec3 own_m = surface_m(pixel), normal = normal_at(pixel);
    vec3 near_m = place_m(place_px, own_m.z);
    vec3 sight = is_orthographic() ? vec3(0.0, 0.0, 1.0) : near_m / near_m.z;
    float facing = -dot(normal, sight);
    float along = dot(normal, near_m - own_m) / max(facing, EDGE);
    point_m = near_m + along * sight;
    return facing > EDGE && along > -NEARER * own_m.z && along < FARTHER * own_m.z;
}

// How well a point lies in a surface's plane: 1 in the plane, falling to 0 at a slope of 1:10.
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

// Image position of a point in front of the camera.
vec2 project_to_pixel(vec3 point_m)
{
    vec2 way = is_orthographic() ? point_m.xy : point_m.xy / point_m.z;
    return (0.5 + 0.5 * vec2(1.0, -1.0) * way / half_size()) * vec2(size_px());
}

// Number of the solid that a pixel shows.
uint solid_at(ivec2 pixel)
{
    return targets[SCREEN_MARKS].words[texel_index(pixel)] >> SCREEN_LIGHT_BITS;
}

// A direction and a point of a solid in the axes of the camera of the frame before.
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

// Direction from a point to the camera, unit.
vec3 to_camera(vec3 point_m)
{
    return is_orthographic() ? vec3(0.0, 0.0, -1.0) : -normalize(point_m);
}

// Two unit vectors perpendicular to a unit vector and to each other (T. Duff et al., "Building an
// Orthonormal Basis, Revisited", JCGT 6(1), 2017).
void basis_across(vec3 axis, out vec3 first, out vec3 second)
{
    float side = axis.z >= 0.0 ? 1.0 : -1.0;
    float a = -1.0 / (side + axis.z), b = axis.x * axis.y * a;
    first = vec3(1.0 + side * axis.x * axis.x * a, side * b, -side * axis.x);
    second = vec3(b, side + axis.y * axis.y * a, -axis.y);
}

// --- noise ------------------------------------------------------------------------------------

// Noise of a 4x4 tile: 16 rotations, each once, and 4 offsets, each four times (J. Jimenez et al.,
// "Practical Real-Time Strategies for Accurate Indirect Occlusion", 2016). Both are in [0, 1) and
// advance by the R2 sequence from frame to frame.
//
//   rotation [1/16]     0  5 10 15      offset [1/4]     0 3 2 1
//                       4  9 14  3                       1 0 3 2
//                       8 13  2  7                       2 1 0 3
//                      12  1  6 11                       3 2 1 0
vec2 tiled_noise(ivec2 pixel)
{
    // R2, the two-dimensional golden ratio (M. Roberts, 2018).
    const vec2 GOLDEN = vec2(0.754877666, 0.569840291);
    float turn = float((((pixel.x + pixel.y) & 3) << 2) + (pixel.x & 3)) / 16.0;
    float offset = float((pixel.y - pixel.x) & 3) / 4.0;
    return fract(vec2(turn, offset) + float(view.frame & 0xffffu) * GOLDEN);
}

// Pair `index` of a pixel: the R2 sequence, which covers the square evenly, from a random start per
// pixel.
vec2 ray_noise(ivec2 pixel, uint salt, uint index)
{
    const vec2 GOLDEN = vec2(0.754877666, 0.569840291);
    vec2 first = uniform_from(pcg3d(uvec3(pixel, salt))).xy;
    return fract(first + float(index & 0xffffu) * GOLDEN);
}

#endif
