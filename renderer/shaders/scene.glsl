// SPDX-License-Identifier: MIT
//
// The scene as the device sees it (renderer/gpu_scene.h is its mirror) and the questions a
// renderer asks of it. The origin is the camera: differences were taken in double on the CPU, so
// that float32 spends its digits near the viewer.
#ifndef NEPH_SCENE_GLSL
#define NEPH_SCENE_GLSL

// What the scene is made of, known before the shader is compiled: code for what is not there costs
// nothing, not even the loop turns (renderer/compute.h) of loops that no thread takes.
layout(constant_id = 0) const uint KINDS = 0xffffffffu; // bit k: a medium of kind k
layout(constant_id = 1) const bool COLOURED = true;     // extinction depends on the channel

// What is the same in all channels of a scene without colour is computed once: the compiler drops
// what nobody reads.
vec3 grey(vec3 channels)
{
    return COLOURED ? channels : channels.xxx;
}

layout(std430, binding = 2) readonly buffer GridValues {
    float grid_values[]; // of all voxel grids, one after the other
};

layout(std430, binding = 4) readonly buffer HorizonTexels {
    vec4 horizon_texels[]; // of all Horizon clouds, one after the other
};

#include "fog.glsl"
#include "gaussian.glsl"
#include "grid.glsl"
#include "horizon.glsl"
#include "phase.glsl"
#include "shell.glsl"
#include "solids.glsl"

const uint MEDIA_MAX = 8;
const uint LAYERS_MAX = 2;
const uint NO_SOLID = 0xffffffffu;

// enum neph_medium_kind
const uint MEDIUM_HOMOGENEOUS = 0;
const uint MEDIUM_HEIGHT_FOG = 1;
const uint MEDIUM_GAUSSIAN = 2;
const uint MEDIUM_SHELL = 3;
const uint MEDIUM_GRID = 4;
const uint MEDIUM_HORIZON = 5;

bool has_kind(uint kind) { return (KINDS & (1u << kind)) != 0u; }

// Kinds whose optical depth has no closed form.
const uint OPEN_KINDS = 1u << MEDIUM_HORIZON;

// Fog has `layers`; every other kind is `extinction_per_m` times a density.
struct Medium {
    vec3 low_m; // where it may be: bounds and support; open sides lie at -FAR_M and FAR_M
    uint kind;
    vec3 high_m;
    uint phase_kind;
    vec3 albedo;
    float g;
    vec3 extinction_color;
    float extinction_per_m;
    FogLayer layers[LAYERS_MAX];
    Gaussian gaussian;
    Shell shell;
    Grid grid;
    Horizon horizon;
    uvec3 majorant_size; // cells of the majorant grid over low_m..high_m; 0 when there is none
    uint majorant_first; // their place in majorants[]
    uint layer_count;
    uint padding[3];
};

layout(std430, binding = 0) readonly buffer Frame {
    vec3 camera_right;
    float tan_half_width;
    vec3 camera_up;
    float tan_half_height;
    vec3 camera_forward;
    uint width_px;
    vec3 sun_direction; // unit, towards the sun
    uint height_px;
    vec3 sun_irradiance; // W/m^2 on a plane across the direction; 0 when there is no sun
    uint medium_count;
    vec3 background; // W m^-2 sr^-1
    uint solid_count;
    uint steps;
    uint sun_steps;
    uint scatters; // 0 or 1: some medium scatters sunlight that the scene wants to see
    uint octave_count;
    vec3 octave_factors; // contribution, attenuation, eccentricity (struct neph_octaves)
    float padding;
    vec2 jitter_px; // of this frame's view rays, for renderers of sequences
    vec2 padding_2;
    Medium media[MEDIA_MAX];
} frame;

// Upper bounds of the extinction (of extinction_color 1) per cell, x fastest [1/m].
layout(std430, binding = 3) readonly buffer Majorants {
    float majorants[];
};

layout(std430, binding = 1) readonly buffer Solids {
    Solid solids[];
};

// --- camera ---------------------------------------------------------------------------------

struct Camera {
    vec3 right;
    float tan_half_width;
    vec3 up;
    float tan_half_height;
    vec3 forward;
    uint width_px;
    uint height_px;
};

Camera frame_camera()
{
    return Camera(frame.camera_right, frame.tan_half_width, frame.camera_up, frame.tan_half_height,
                  frame.camera_forward, frame.width_px, frame.height_px);
}

// Unit direction through a place in the picture, in pixels from its upper left corner.
vec3 camera_ray_at(Camera camera, vec2 place_px)
{
    float x = (2.0 * place_px.x / float(camera.width_px) - 1.0) * camera.tan_half_width;
    float y = (1.0 - 2.0 * place_px.y / float(camera.height_px)) * camera.tan_half_height;
    return normalize(camera.forward + x * camera.right + y * camera.up);
}

// The same through the centre of a pixel; row 0 is on top.
vec3 camera_ray(Camera camera, uint i, uint j)
{
    return camera_ray_at(camera, vec2(i, j) + 0.5);
}

vec3 camera_ray(uint i, uint j) { return camera_ray(frame_camera(), i, j); }

// --- solids ---------------------------------------------------------------------------------

struct Hit {
    float t_m;  // FAR_M when nothing is hit
    uint solid; // NO_SOLID when nothing is hit
};

// Nearest surface with t > 0; from inside a solid that is its far side.
Hit scene_hit(vec3 origin_m, vec3 direction)
{
    Hit hit = Hit(FAR_M, NO_SOLID);
    for (uint s = 0; s < frame.solid_count; s++) {
        float t0_m, t1_m;
        if (!solid_interval(solids[s], origin_m, direction, t0_m, t1_m))
            continue;
        float t_m = t0_m > 0.0 ? t0_m : t1_m;
        if (t_m > 0.0 && t_m < hit.t_m)
            hit = Hit(t_m, s);
    }
    return hit;
}

// A point found at a distance t is off by some 1e-7 t: a solid that a sun ray leaves within this
// fraction of t only touches the point and does not hide the sun.
const float SHADOW_START = 1e-6;

// `except`: the solid that the point lies on. It is convex, so where its surface faces the sun it
// cannot hide it; leaving it out spares us the choice of an offset.
bool sees_sun(vec3 point_m, uint except)
{
    float start_m = SHADOW_START * length(point_m);
    for (uint s = 0; s < frame.solid_count; s++) {
        float t0_m, t1_m;
        if (s != except && solid_interval(solids[s], point_m, frame.sun_direction, t0_m, t1_m) &&
            t1_m > start_m)
            return false;
    }
    return true;
}

// --- media ----------------------------------------------------------------------------------

bool medium_contains(uint m, vec3 point_m)
{
    return all(greaterThanEqual(point_m, frame.media[m].low_m)) &&
           all(lessThanEqual(point_m, frame.media[m].high_m));
}

float fog_medium_extinction_per_m(uint m, vec3 point_m)
{
    float extinction_per_m = 0.0;
    for (uint l = 0; l < frame.media[m].layer_count; l++)
        extinction_per_m += fog_extinction_per_m(frame.media[m].layers[l], point_m.y);
    return extinction_per_m;
}

// Of extinction_color 1.
float medium_extinction_per_m(uint m, vec3 point_m)
{
    float extinction_per_m = 0.0;
    if (medium_contains(m, point_m)) {
        uint kind = frame.media[m].kind;
        float scale_per_m = frame.media[m].extinction_per_m;
        if (kind <= MEDIUM_HEIGHT_FOG)
            extinction_per_m = fog_medium_extinction_per_m(m, point_m);
        else if (has_kind(MEDIUM_GAUSSIAN) && kind == MEDIUM_GAUSSIAN)
            extinction_per_m = scale_per_m * gaussian_density(frame.media[m].gaussian, point_m);
        else if (has_kind(MEDIUM_SHELL) && kind == MEDIUM_SHELL)
            extinction_per_m = scale_per_m * shell_density(frame.media[m].shell, point_m);
        else if (has_kind(MEDIUM_GRID) && kind == MEDIUM_GRID)
            extinction_per_m = scale_per_m * grid_density(frame.media[m].grid, point_m);
        else if (has_kind(MEDIUM_HORIZON) && kind == MEDIUM_HORIZON)
            extinction_per_m = scale_per_m * horizon_density(frame.media[m].horizon, point_m);
    }
    return extinction_per_m;
}

// Of the media whose kind is among `kinds`.
vec3 scene_extinction_per_m(uint kinds, vec3 point_m)
{
    vec3 extinction_per_m = vec3(0.0);
    for (uint m = 0; m < frame.medium_count; m++)
        if ((kinds & (1u << frame.media[m].kind)) != 0u)
            extinction_per_m +=
                frame.media[m].extinction_color * medium_extinction_per_m(m, point_m);
    return grey(extinction_per_m);
}

float fog_medium_optical_depth(uint m, vec3 origin_m, vec3 direction, float t0_m, float t1_m)
{
    float y_m = origin_m.y + t0_m * direction.y;
    float optical_depth = 0.0;
    for (uint l = 0; l < frame.media[m].layer_count; l++)
        optical_depth += fog_optical_depth(frame.media[m].layers[l], y_m, direction.y, t1_m - t0_m);
    return optical_depth;
}

// Exact optical depth of a medium (of extinction_color 1) along origin + t direction, t in
// [0, length]; 0 for OPEN_KINDS.
float medium_optical_depth(uint m, vec3 origin_m, vec3 direction, float length_m)
{
    float t0_m = 0.0, t1_m = length_m;
    float optical_depth = 0.0;
    if (clip_box(frame.media[m].low_m, frame.media[m].high_m, origin_m, direction, t0_m, t1_m)) {
        uint kind = frame.media[m].kind;
        float scale_per_m = frame.media[m].extinction_per_m;
        if (kind <= MEDIUM_HEIGHT_FOG)
            optical_depth = fog_medium_optical_depth(m, origin_m, direction, t0_m, t1_m);
        else if (has_kind(MEDIUM_GAUSSIAN) && kind == MEDIUM_GAUSSIAN)
            optical_depth = scale_per_m * gaussian_integral_m(frame.media[m].gaussian, origin_m,
                                                              direction, t0_m, t1_m);
        else if (has_kind(MEDIUM_SHELL) && kind == MEDIUM_SHELL)
            optical_depth = scale_per_m * shell_integral_m(frame.media[m].shell, origin_m,
                                                           direction, t0_m, t1_m);
        else if (has_kind(MEDIUM_GRID) && kind == MEDIUM_GRID)
            optical_depth = scale_per_m * grid_integral_m(frame.media[m].grid, origin_m,
                                                          direction, t0_m, t1_m);
    }
    return optical_depth;
}

// Of everything that has a closed form, per channel.
vec3 scene_optical_depth(vec3 origin_m, vec3 direction, float length_m)
{
    vec3 optical_depth = vec3(0.0);
    for (uint m = 0; m < frame.medium_count; m++)
        optical_depth += frame.media[m].extinction_color *
                         medium_optical_depth(m, origin_m, direction, length_m);
    return grey(optical_depth);
}

struct Stretch {
    float t0_m, t1_m; // empty when t1 <= t0
};

void include(inout Stretch hull, float start_m, float end_m)
{
    if (start_m < end_m) {
        hull.t0_m = min(hull.t0_m, start_m);
        hull.t1_m = max(hull.t1_m, end_m);
    }
}

float least_positive(vec3 color)
{
    vec3 seen = mix(vec3(FAR_M), color, greaterThan(color, vec3(0.0)));
    return min(seen.r, min(seen.g, seen.b));
}

// What is thin must be so in the strongest channel, what is opaque in the weakest; a channel that
// does not see the fog at all does not make it longer, but sees what is behind.
void include_fog(uint m, vec3 origin_m, vec3 direction, Stretch inside, inout Stretch hull,
                 inout float opaque_m)
{
    vec3 color = frame.media[m].extinction_color;
    float most = max(color.r, max(color.g, color.b));
    bool all_see_it = all(greaterThan(color, vec3(0.0)));
    float y_m = origin_m.y + inside.t0_m * direction.y;
    for (uint l = 0; l < frame.media[m].layer_count; l++) {
        FogLayer layer = frame.media[m].layers[l];
        float start_m = inside.t0_m;
        if (layer.falloff_per_m * direction.y < 0.0)
            start_m += fog_distance_to(layer, y_m, direction.y, THIN / most);
        float thin_m = fog_distance_to_thin_end(layer, y_m, direction.y, THIN / most);
        float dark_m = inside.t0_m + fog_distance_to(layer, y_m, direction.y,
                                                     OPAQUE / least_positive(color));
        if (all_see_it)
            opaque_m = min(opaque_m, dark_m);
        include(hull, start_m, min(min(inside.t1_m, inside.t0_m + thin_m), dark_m));
    }
}

// Narrow the stretch inside the bounds to where the medium has THIN optical depth left.
void narrow(uint m, vec3 origin_m, vec3 direction, inout Stretch inside)
{
    uint kind = frame.media[m].kind;
    if (has_kind(MEDIUM_GAUSSIAN) && kind == MEDIUM_GAUSSIAN) {
        float near_m, far_m;
        bool met = sphere_interval(frame.media[m].gaussian.center_m,
                                   frame.media[m].gaussian.reach_m, origin_m, direction, near_m,
                                   far_m);
        inside.t0_m = max(inside.t0_m, near_m);
        inside.t1_m = met ? min(inside.t1_m, far_m) : inside.t0_m;
    }
    if (has_kind(MEDIUM_SHELL) && kind == MEDIUM_SHELL)
        globe_hull(frame.media[m].shell.globe, origin_m, direction, 0.0,
                   frame.media[m].shell.reach_m, inside.t0_m, inside.t1_m);
    if (has_kind(MEDIUM_HORIZON) && kind == MEDIUM_HORIZON)
        globe_hull(frame.media[m].horizon.globe, origin_m, direction, 0.0,
                   frame.media[m].horizon.thickness_m, inside.t0_m, inside.t1_m);
}

// The stretch of a ray on which fixed steps are well spent: the hull of all media, without the
// ends where no medium has THIN optical depth left and without what lies behind OPAQUE of one fog
// layer. For unbounded media this is what makes the march finite. What it leaves out changes the
// optical depth by less than 1e-7 per medium or layer, or lies where 1.1e-7 of the light comes
// through. `kinds` says which media count, as KINDS does.
Stretch scene_stretch(uint kinds, vec3 origin_m, vec3 direction, float length_m)
{
    Stretch hull = Stretch(length_m, 0.0);
    float opaque_m = length_m;
    for (uint m = 0; m < frame.medium_count; m++) {
        Stretch inside = Stretch(0.0, length_m);
        if ((kinds & (1u << frame.media[m].kind)) == 0u)
            continue;
        if (!clip_box(frame.media[m].low_m, frame.media[m].high_m, origin_m, direction,
                      inside.t0_m, inside.t1_m))
            continue;
        if (frame.media[m].kind <= MEDIUM_HEIGHT_FOG)
            include_fog(m, origin_m, direction, inside, hull, opaque_m);
        else {
            narrow(m, origin_m, direction, inside);
            include(hull, inside.t0_m, inside.t1_m);
        }
    }
    hull.t1_m = min(hull.t1_m, opaque_m);
    return hull;
}

Stretch scene_stretch(vec3 origin_m, vec3 direction, float length_m)
{
    return scene_stretch(KINDS, origin_m, direction, length_m);
}

#endif
