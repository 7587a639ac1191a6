// SPDX-License-Identifier: MIT
//
// One frame as the device sees it (written by renderer/gpu_scene.c): camera, sun, media, solids.
// The origin is the camera: differences were taken in double on the CPU, so that float32 spends its
// digits near the viewer. Included by media.glsl, which says what a Medium is.
#ifndef NEPH_FRAME_GLSL
#define NEPH_FRAME_GLSL

#include "fog_look.glsl"

const uint MEDIA_MAX = NEPH_GPU_MEDIA_MAX;
const uint NO_SOLID = 0xffffffffu;

// A lattice of nodes, or of cells from one node to the next.
struct Lattice {
    vec3 origin_m; // of node (0, 0, 0)
    vec3 per_m;    // nodes or cells
    uvec3 size;
};

// A light of scenes/lights.h. One that is no spot has cosines below all others.
struct Lamp {
    vec3 position_m;
    float inner_cosine;
    vec3 axis; // unit, from the light
    float outer_cosine;
    vec3 intensity; // W/sr
    float padding;
};

// One of the maps: its texel (0, 0), and how many texels there are to a metre, along both sides.
struct ShadowLevel {
    vec2 low_m;
    vec2 per_m;
};

// Light space (cloud_shadow.glsl): where a point's sun ray meets the plane of the texels, and how
// far it has gone from there towards the sun.
struct ShadowMap {
    vec3 across_u; // a point's place along the first side is dot(point, across_u) + across_u_m
    float across_u_m;
    vec3 across_v;
    float across_v_m;
    vec3 along; // and how far it is
    float along_m;
    vec3 side_u; // unit vectors of the plane
    uint texels; // along each side
    vec3 side_v;
    uint first;       // of the map's numbers, behind those of the sun cache
    vec3 plane_m; // where both places are 0
    float start_m;    // no cloud is farther from the sun
    ShadowLevel levels[NEPH_GPU_SHADOW_LEVELS_MAX]; // each within the next
    uint level_count;
    uint layers; // of a texel
};

layout(std140, binding = 0) uniform Frame {
    vec3 camera_right;
    float half_width; // of the picture; tangents of a perspective camera's angles, else metres
    vec3 camera_up;
    float half_height;
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
    uint emits; // 0 or 1: some medium does
    vec2 jitter_px; // of this frame's view rays, for renderers of sequences
    float sun_first_part; // of a sun ray that its first step is long
    uint light_texel_px; // pixels along a side of a texel of traced light (traced_light.glsl)
    Lattice sun_lattice;  // nodes of the sun cache, at least 2 along each axis (sun_cache.glsl)
    Lattice skip_lattice; // cells that may be empty (shortcuts.glsl)
    Lattice light_lattice; // cells of diffused light (diffusion.glsl)
    ShadowMap shadow;
    Medium media[MEDIA_MAX];
    uint lamp_count;
    uint solids_shade; // 0 or 1: some solid may stand between a medium and the sun
    uint scatters_lamps; // 0 or 1: some medium scatters light of lamps that the scene wants to see
#include "settings/march_frame.glsl" // the numbers of shortcuts
    Lamp lamps[NEPH_GPU_LAMPS_MAX];
    FogLook fog_look; // of a march that leaves the height fog to it (march_veil.glsl)
} frame;

// Upper bounds of the extinction (of extinction_color 1) per cell, x fastest [1/m].
layout(std430, binding = 3) readonly buffer Majorants {
    float majorants[];
};

layout(std140, binding = 1) uniform Solids {
    SolidBlock blocks[NEPH_GPU_BLOCKS_MAX];
    Solid solids[NEPH_GPU_SOLIDS_MAX];
};

vec3 kept_sun_direction = own(frame.sun_direction);

vec3 to_sun()
{
    if (READS_FRAME_ONCE)
        return kept_sun_direction;
    return frame.sun_direction;
}

struct Camera {
    vec3 right;
    float half_width;
    vec3 up;
    float half_height;
    vec3 forward;
    uint width_px;
    uint height_px;
};

Camera frame_camera()
{
    return Camera(frame.camera_right, frame.half_width, frame.camera_up, frame.half_height,
                  frame.camera_forward, frame.width_px, frame.height_px);
}

// What a place of the picture sees. The rays of a perspective camera begin at 0, which the compiler
// knows; those of an orthographic one on the plane through it.
struct ViewRay {
    vec3 origin_m;
    vec3 direction; // unit
};

// Through a place in the picture, in pixels from its upper left corner.
ViewRay camera_ray_at(Camera camera, vec2 place_px)
{
    float x = (2.0 * place_px.x / float(camera.width_px) - 1.0) * camera.half_width;
    float y = (1.0 - 2.0 * place_px.y / float(camera.height_px)) * camera.half_height;
    vec3 origin_m = ORTHOGRAPHIC ? x * camera.right + y * camera.up : vec3(0.0);
    vec3 direction = ORTHOGRAPHIC ? own(camera.forward)
                              : normalize(camera.forward + x * camera.right + y * camera.up);
    return ViewRay(origin_m, direction);
}

// Through the centre of a pixel; row 0 is on top.
ViewRay camera_ray(Camera camera, uint i, uint j)
{
    return camera_ray_at(camera, vec2(i, j) + 0.5);
}

ViewRay camera_ray(uint i, uint j) { return camera_ray(frame_camera(), i, j); }

// The place at a distance on a ray.
vec3 view_point_m(ViewRay ray, float t_m)
{
    return ORTHOGRAPHIC ? ray.origin_m + t_m * ray.direction : t_m * ray.direction;
}

#endif
