// SPDX-License-Identifier: MIT
//
// The media of a scene: one interface to all kinds. Each kind has its own file; only this file
// tells kinds apart. A new kind needs a file, a number, a member of struct Shape, and a line in
// each function below that treats it in a special way. The CPU side is renderer/media/.
//
//   medium_extinction_per_m()   extinction at a point
//   medium_optical_depth()      exact optical depth along a ray
//   layer_free_path_m()         distance to a given optical depth
//   medium_include()            the part of a ray that is worth marching
#ifndef NEPH_MEDIA_GLSL
#define NEPH_MEDIA_GLSL

#extension GL_EXT_control_flow_attributes : require

layout(std430, binding = 2) readonly buffer GridValues {
    float grid_values[]; // phase functions as tables, and then the values of all voxel grids
};

#include "solids.glsl" // has TRAITS, which all files need
#include "device_forms.glsl"

#ifdef SEES_GRID_TEXELS
// Each value together with the next one, as a texel buffer for a CPU device
// (neph_buffer_create_texel_views()).
layout(binding = NEPH_GPU_TEXEL_PAIRS_BINDING, rg32ui) uniform readonly uimageBuffer grid_pairs[1];

vec2 grid_pair(uint at)
{
    if ((TRAITS & NEPH_GPU_PAIRS) != 0u)
        return uintBitsToFloat(imageLoad(grid_pairs[0], int(at)).xy);
    return vec2(grid_values[at], grid_values[at + 1]);
}
#endif

layout(std430, binding = 4) readonly buffer HorizonTexels {
    vec4 horizon_texels[]; // textures of all Horizon clouds, one after the other
};

#include "fog.glsl"
#include "gaussian.glsl"
#include "grid.glsl"
#include "horizon.glsl"
#include "plume.glsl"
#include "shell.glsl"
#include "tent.glsl"

// Properties of the scene as specialization constants. Code for absent features is removed before
// compilation and costs nothing, not even the loop iterations (renderer/compute.h) of loops that no
// thread would enter.
layout(constant_id = 0) const uint SCENE_KINDS = NEPH_GPU_KINDS_MASK; // and NEPH_GPU_MESHES
const uint KINDS = SCENE_KINDS & NEPH_GPU_KINDS_MASK; // bit k: the scene has a medium of kind k
// A medium's extinction or phase function depends on the channel.
const bool COLOURED = (TRAITS & NEPH_GPU_COLOURED) != 0u;
const bool HAS_PHASE_TABLES = (TRAITS & NEPH_GPU_PHASE_TABLES) != 0u;
const bool PHASES_COLOURED = COLOURED && HAS_PHASE_TABLES; // the channels of one may differ
const bool ORTHOGRAPHIC = (TRAITS & NEPH_GPU_ORTHOGRAPHIC) != 0u; // the camera is orthographic

// enum neph_medium_kind
const uint MEDIUM_HOMOGENEOUS = 0;
const uint MEDIUM_HEIGHT_FOG = 1;
const uint MEDIUM_GAUSSIAN = 2;
const uint MEDIUM_SHELL = 3;
const uint MEDIUM_GRID = 4;
const uint MEDIUM_HORIZON = 5;
const uint MEDIUM_PLUME = 6;
const uint MEDIUM_TENT = 7;

// Fogs consist of layers with closed-form free paths. All other kinds are shapes: a density times
// the medium's extinction, tracked through majorants.
const uint FOG_KINDS = 1u << MEDIUM_HOMOGENEOUS | 1u << MEDIUM_HEIGHT_FOG;
const uint SHAPE_KINDS = KINDS & ~FOG_KINDS;
const uint OPEN_KINDS = 1u << MEDIUM_HORIZON; // optical depth without a closed form

const bool LAMPS = (TRAITS & NEPH_GPU_LAMPS) != 0u; // the scene has point or spot lights
const uint KNOWN_MEDIA = TRAITS >> NEPH_GPU_MEDIA_SHIFT & 15u; // number of media; 0: not known
const uint KNOWN_KINDS = TRAITS >> NEPH_GPU_KINDS_SHIFT;

// A macro, so that its condition is constant before anything is inlined. (In constant expressions
// keep the right side of && and || to one comparison: glslang makes a branch of more.)
#define has_kind(kind) ((KINDS & (1u << (kind))) != 0u)

const bool HAS_FOG = (KINDS & FOG_KINDS) != 0u;

// Layers of a medium, at most; a shape counts as one layer.
const uint LAYERS_MAX = NEPH_GPU_LAYERS_MAX;
const uint LAYERS = (KINDS & 1u << MEDIUM_HEIGHT_FOG) != 0u ? LAYERS_MAX : 1u;

struct Shape {
    Gaussian gaussian;
    Shell shell;
    Grid grid;
    Horizon horizon;
    Plume plume;
    Tent tent;
};

struct Medium {
    vec3 low_m; // its bounding box: bounds and support; open sides are at -FAR_M and FAR_M
    uint kind;
    vec3 high_m;
    uint phase_kind;
    vec3 albedo;
    float g; // asymmetry; of a phase function as a table, the table's index in grid_values[]
    vec3 extinction_color;
    float extinction_per_m; // of a shape, at density 1
    uvec3 majorant_size;    // cells of the majorant grid over low_m..high_m; 0: none
    uint majorant_first;    // index of the first cell in majorants[]
    vec3 glow; // emitted per optical depth of this medium [W m^-2 sr^-1]
    float octave_eccentricity;  // this and the next two are fitted (renderer/octaves_fitted.h)
    vec3 octave_contribution;
    float octave_attenuation;
    FogLayer layers[LAYERS_MAX];
    uint layer_count;
    Shape shape;
    // Rotated bounds, before the rotation about their middle; low_m..high_m is the box around them.
    vec3 bounds_low_m;
    uint turn_axis; // 0 x, 1 y, 2 z
    vec3 bounds_high_m;
    float turn_cosine; // and sine: 0 where the bounds are not rotated
    float turn_sine;
};

#include "frame.glsl"

// --- shapes: passed by value, so that a caller in a loop reads them once ------------------------

// Whether a shape is of a kind; constant where the scene has no other kind. For a fog the answer is
// meaningless: it is true for the only kind of shape.
#define is_a(kind, shape_kind) \
    (has_kind(kind) && (SHAPE_KINDS == 1u << (kind) || (shape_kind) == (kind)))

float shape_density(uint kind, Shape shape, vec3 point_m)
{
    float density = 0.0;
    if (is_a(MEDIUM_GAUSSIAN, kind))
        density = gaussian_density(shape.gaussian, point_m);
    else if (is_a(MEDIUM_SHELL, kind))
        density = shell_density(shape.shell, point_m);
    else if (is_a(MEDIUM_GRID, kind))
        density = grid_density(shape.grid, point_m);
    else if (is_a(MEDIUM_HORIZON, kind))
        density = horizon_density(shape.horizon, point_m);
    else if (is_a(MEDIUM_PLUME, kind))
        density = plume_density(shape.plume, point_m);
    else if (is_a(MEDIUM_TENT, kind))
        density = tent_density(shape.tent, point_m);
    return density;
}

// A random number with the density as its expectation.
float shape_random_density(uint kind, Shape shape, vec3 point_m, uvec2 bits)
{
    return is_a(MEDIUM_GRID, kind) ? grid_random_node(shape.grid, point_m, bits)
                                   : shape_density(kind, shape, point_m);
}

// The exact integral of the density over [t0, t1]; 0 for OPEN_KINDS.
float shape_integral_m(uint kind, Shape shape, vec3 origin_m, vec3 direction, float t0_m,
                       float t1_m)
{
    float integral_m = 0.0;
    if (is_a(MEDIUM_GAUSSIAN, kind))
        integral_m = gaussian_integral_m(shape.gaussian, origin_m, direction, t0_m, t1_m);
    else if (is_a(MEDIUM_SHELL, kind))
        integral_m = shell_integral_m(shape.shell, origin_m, direction, t0_m, t1_m);
    else if (is_a(MEDIUM_GRID, kind))
        integral_m = grid_integral_m(shape.grid, origin_m, direction, t0_m, t1_m);
    else if (is_a(MEDIUM_PLUME, kind))
        integral_m = plume_integral_m(shape.plume, origin_m, direction, t0_m, t1_m);
    else if (is_a(MEDIUM_TENT, kind))
        integral_m = tent_integral_m(shape.tent, origin_m, direction, t0_m, t1_m);
    return integral_m;
}

// Clips a stretch to the part with at least THIN optical depth.
void shape_narrow(uint kind, Shape shape, vec3 origin_m, vec3 direction, inout Stretch inside)
{
    if (is_a(MEDIUM_GAUSSIAN, kind))
        gaussian_narrow(shape.gaussian, origin_m, direction, inside);
    else if (is_a(MEDIUM_SHELL, kind))
        shell_narrow(shape.shell, origin_m, direction, inside);
    else if (is_a(MEDIUM_HORIZON, kind))
        horizon_narrow(shape.horizon, origin_m, direction, inside);
    else if (is_a(MEDIUM_PLUME, kind))
        plume_narrow(shape.plume, origin_m, direction, inside);
    else if (is_a(MEDIUM_TENT, kind))
        tent_narrow(shape.tent, origin_m, direction, inside);
}

// --- media: passed by number, because reading a whole medium costs more than most functions -----

// Loops over media are unrolled where their number is known. Uniforms then have addresses that are
// known at compile time, and lavapipe reads each once for all threads.
uint media_count() { return KNOWN_MEDIA > 0u ? KNOWN_MEDIA : make_nonuniform(frame.medium_count); }

uint get_medium_kind(uint m)
{
    return KNOWN_MEDIA > 0u ? KNOWN_KINDS >> 4u * m & 7u : make_nonuniform(frame.media[m].kind);
}

// Number of layers of a fog.
uint fog_layer_count(uint m)
{
    return KNOWN_MEDIA > 0u ? 1u + (KNOWN_KINDS >> 4u * m + 3u & 1u)
                            : make_nonuniform(frame.media[m].layer_count);
}

// Properties of the only medium that every step reads: copied once per thread, as in to_sun().
const bool IS_KEPT = READS_FRAME_ONCE && KNOWN_MEDIA == 1u;

struct KeptMedium {
    vec3 low_m, high_m, albedo, extinction_color;
    float extinction_per_m;
    Shape shape;
} kept = KeptMedium(frame.media[0].low_m, frame.media[0].high_m, frame.media[0].albedo,
                    frame.media[0].extinction_color, frame.media[0].extinction_per_m,
                    frame.media[0].shape);

vec3 medium_low_m(uint m)
{
    if (IS_KEPT)
        return kept.low_m;
    return frame.media[m].low_m;
}

vec3 medium_high_m(uint m)
{
    if (IS_KEPT)
        return kept.high_m;
    return frame.media[m].high_m;
}

vec3 medium_albedo(uint m)
{
    if (IS_KEPT)
        return kept.albedo;
    return frame.media[m].albedo;
}

vec3 medium_color(uint m)
{
    if (IS_KEPT)
        return kept.extinction_color;
    return frame.media[m].extinction_color;
}

float medium_full_per_m(uint m)
{
    if (IS_KEPT)
        return kept.extinction_per_m;
    return frame.media[m].extinction_per_m;
}

Shape medium_shape(uint m)
{
    if (IS_KEPT)
        return kept.shape;
    return frame.media[m].shape;
}

Grid medium_grid(uint m)
{
    if (IS_KEPT)
        return kept.shape.grid;
    return frame.media[m].shape.grid;
}

bool is_among(uint kinds, uint m) { return (kinds & (1u << get_medium_kind(m))) != 0u; }

bool is_fog(uint m) { return HAS_FOG && is_among(FOG_KINDS, m); }

// The scene has rotated bounds.
const bool TURNED_MEDIA = (TRAITS & NEPH_GPU_TURNED_MEDIA) != 0u;

bool has_turned_bounds(uint m)
{
    return TURNED_MEDIA &&
           (frame.media[m].turn_cosine != 0.0 || frame.media[m].turn_sine != 0.0);
}

// A direction in the axes of rotated bounds.
vec3 to_bounds_axes(uint m, vec3 v)
{
    return turned_about(frame.media[m].turn_axis, v, frame.media[m].turn_cosine,
                        -frame.media[m].turn_sine);
}

vec3 bounds_middle_m(uint m)
{
    return 0.5 * (frame.media[m].bounds_low_m + frame.media[m].bounds_high_m);
}

// Narrows [t0, t1] to rotated bounds; false when it becomes empty.
bool clip_turned_bounds(uint m, vec3 origin_m, vec3 direction, inout float t0_m, inout float t1_m)
{
    if (!has_turned_bounds(m))
        return true;
    vec3 middle_m = bounds_middle_m(m);
    return clip_box(frame.media[m].bounds_low_m, frame.media[m].bounds_high_m,
                    middle_m + to_bounds_axes(m, origin_m - middle_m), to_bounds_axes(m, direction),
                    t0_m, t1_m);
}

bool turned_bounds_contain(uint m, vec3 point_m)
{
    if (!has_turned_bounds(m))
        return true;
    vec3 middle_m = bounds_middle_m(m);
    vec3 at_m = middle_m + to_bounds_axes(m, point_m - middle_m);
    return all(greaterThanEqual(at_m, frame.media[m].bounds_low_m)) &&
           all(lessThanEqual(at_m, frame.media[m].bounds_high_m));
}

bool clip_medium(uint m, vec3 origin_m, vec3 direction, inout float t0_m, inout float t1_m)
{
    bool meets = clip_box(medium_low_m(m), medium_high_m(m), origin_m, direction, t0_m, t1_m);
    if (TURNED_MEDIA)
        meets = meets && clip_turned_bounds(m, origin_m, direction, t0_m, t1_m);
    return meets;
}

bool medium_contains(uint m, vec3 point_m)
{
    bool is_above = all(greaterThanEqual(point_m, medium_low_m(m)));
    bool is_below = all(lessThanEqual(point_m, medium_high_m(m)));
    bool contains = is_above && is_below;
    if (TURNED_MEDIA)
        contains = contains && turned_bounds_contain(m, point_m);
    return contains;
}

float fog_medium_extinction_per_m(uint m, vec3 point_m)
{
    float extinction_per_m = 0.0;
    [[unroll]] for (uint l = 0; l < fog_layer_count(m); l++)
        extinction_per_m += fog_extinction_per_m(frame.media[m].layers[l], point_m.y);
    return extinction_per_m;
}

// For extinction_color 1, as in all functions below.
float medium_extinction_per_m(uint m, vec3 point_m)
{
    float extinction_per_m = 0.0;
    if (medium_contains(m, point_m)) {
        if (is_fog(m))
            extinction_per_m = fog_medium_extinction_per_m(m, point_m);
        else
            extinction_per_m = medium_full_per_m(m) *
                               shape_density(get_medium_kind(m), medium_shape(m), point_m);
    }
    return extinction_per_m;
}

// Layers of a fog; a shape counts as one layer.
uint medium_layer_count(uint m) { return is_fog(m) ? fog_layer_count(m) : 1u; }

float fog_medium_optical_depth(uint m, vec3 origin_m, vec3 direction, float t0_m, float t1_m)
{
    float optical_depth = 0.0;
    [[unroll]] for (uint l = 0; l < fog_layer_count(m); l++)
        optical_depth += fog_layer_optical_depth(frame.media[m].layers[l], origin_m, direction,
                                                 t0_m, t1_m);
    return optical_depth;
}

float shape_optical_depth(uint m, vec3 origin_m, vec3 direction, float t0_m, float t1_m)
{
    return frame.media[m].extinction_per_m * shape_integral_m(get_medium_kind(m),
                                                              frame.media[m].shape, origin_m,
                                                              direction, t0_m, t1_m);
}

// Exact optical depth along origin + t direction, t in [0, length]; 0 for OPEN_KINDS.
float medium_optical_depth(uint m, vec3 origin_m, vec3 direction, float length_m)
{
    float t0_m = 0.0, t1_m = length_m;
    float optical_depth = 0.0;
    if (clip_medium(m, origin_m, direction, t0_m, t1_m)) {
        if (is_fog(m))
            optical_depth = fog_medium_optical_depth(m, origin_m, direction, t0_m, t1_m);
        else
            optical_depth = shape_optical_depth(m, origin_m, direction, t0_m, t1_m);
    }
    return optical_depth;
}

float layer_optical_depth(uint m, uint l, vec3 origin_m, vec3 direction, float length_m)
{
    if (!is_fog(m))
        return medium_optical_depth(m, origin_m, direction, length_m);
    float t0_m = 0.0, t1_m = length_m;
    if (!clip_medium(m, origin_m, direction, t0_m, t1_m))
        return 0.0;
    return fog_layer_optical_depth(frame.media[m].layers[l], origin_m, direction, t0_m, t1_m);
}

// Free path in any medium with a closed-form optical depth, by bisection to the last bit of a
// float32.
float bisected_free_path_m(uint m, ViewRay ray, float t0_m, float t1_m, float depth)
{
    float low_m = t0_m, high_m = t1_m;
    for (int i = 0; i < 26; i++) {
        float middle_m = 0.5 * (low_m + high_m);
        if (medium_optical_depth(m, ray.origin_m, ray.direction, middle_m) < depth)
            low_m = middle_m;
        else
            high_m = middle_m;
    }
    return 0.5 * (low_m + high_m);
}

// The distance at which a camera ray has met the optical depth `depth` of one layer; [t0, t1] is
// the ray's part in the medium's box.
float layer_free_path_m(uint m, uint l, ViewRay ray, float t0_m, float t1_m, float depth)
{
    float t_m = t1_m;
    if (is_fog(m))
        t_m = fog_layer_free_path_m(frame.media[m].layers[l], ray.origin_m, ray.direction, t0_m,
                                    depth);
    else if (!ENDLESS && is_a(MEDIUM_GRID, get_medium_kind(m)))
        t_m = grid_free_path_m(frame.media[m].shape.grid, ray.origin_m, ray.direction, t0_m, t1_m,
                               depth / frame.media[m].extinction_per_m);
    else
        t_m = bisected_free_path_m(m, ray, t0_m, t1_m, depth);
    return clamp(t_m, t0_m, t1_m);
}

// Extends the hull of all media by this one: more than THIN optical depth left, and no layer
// OPAQUE.
void medium_include(uint m, vec3 origin_m, vec3 direction, Stretch inside, inout Stretch hull,
                    inout float opaque_m)
{
    if (is_fog(m)) {
        [[unroll]] for (uint l = 0; l < fog_layer_count(m); l++)
            fog_layer_include(frame.media[m].layers[l], frame.media[m].extinction_color, origin_m,
                              direction, inside, hull, opaque_m);
    } else {
        shape_narrow(get_medium_kind(m), frame.media[m].shape, origin_m, direction, inside);
        include(hull, inside.t0_m, inside.t1_m);
    }
}

#endif
