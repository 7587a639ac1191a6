// SPDX-License-Identifier: MIT
//
// The uniform block of a frame, written by renderer/gpu_scene.c: camera, sun, media, lights,
// solids; and the rays of the camera.
//
// The origin of all positions is the camera. Differences to it are taken in double precision on the
// CPU, so float32 has its full resolution near the viewer. media.glsl, which defines Medium,
// includes this file.
#ifndef NEPH_FRAME_GLSL
#define NEPH_FRAME_GLSL

#include "fog_look.glsl"
#include "lamp.glsl"

const uint MEDIA_MAX = NEPH_GPU_MEDIA_MAX;
const uint NO_SOLID = 0xffffffffu;

// A regular grid: its nodes, or the cells between neighbouring nodes.
struct Lattice {
    vec3 origin_m; // position of node (0, 0, 0), relative to the camera
    vec3 per_m;    // nodes or cells per metre
    uvec3 size;
};

// A level of the shadow map: position of texel (0, 0), and texels per metre along both sides.
struct ShadowLevel {
    vec2 low_m;
    vec2 per_m;
};

// The shadow map of clouds (cloud_shadow.glsl). Its coordinates of a point are the place where the
// point's sun ray meets the plane of the texels, and the distance from there towards the sun.
struct ShadowMap {
    vec3 across_u; // coordinate along the first side: dot(point, across_u) + across_u_m
    float across_u_m;
    vec3 across_v;
    float across_v_m;
    vec3 along; // distance from the plane: dot(point, along) + along_m
    float along_m;
    vec3 side_u; // unit vectors of the plane
    uint texels; // along each side
    vec3 side_v;
    uint first;       // first word of the map, behind the sun cache
    vec3 plane_m; // position with coordinates (0, 0)
    float start_m;    // start of the texels' rays: no cloud is farther from the sun
    ShadowLevel levels[NEPH_GPU_SHADOW_LEVELS_MAX]; // nested, the finest first
    uint level_count;
    uint layers; // optical depths per texel
};

// Triangle meshes (meshes.glsl).
struct Meshes {
    vec3 origin_m; // of the places of instances, relative to the camera
    float reach_m; // their largest coordinate
    vec3 origin_low_m; // what origin_m has lost by rounding
    uint instances; // index of the first instance
    uint padding;
    uint frame_number;  // of the sequence, for alpha as coverage
    uint searched;      // number of instances among which that of a hit is searched; 0: not needed
    uint triangle_bits; // of the number of a hit, where it is not searched
};

// The grid across the sun (sun_grid.glsl). A point has its place in the grid, in cells, by
// across_u and across_v, and its height towards the sun.
struct SunGrid {
    vec3 across_u; // cells per metre
    float height_m; // of the camera
    vec3 across_v;
    float reach_m; // points that are farther from the camera along an axis do not use it
    vec2 corner_cells; // the camera's place
    uvec2 size; // in cells
    uint first; // index of cell (0, 0)
    uint apart_nodes; // nodes of the trees of solids that are not in the grid
    uint first_listed; // index of the list of cell (0, 0)
    uint padding;
};

struct Hit {
    float t_m;  // FAR_M when nothing is hit
    uint solid; // NO_SOLID when nothing is hit
};

layout(std140, binding = 0) uniform Frame {
    vec3 camera_right;
    float half_width; // of the image plane: tangent (perspective camera) or metres (orthographic)
    vec3 camera_up;
    float half_height;
    vec3 camera_forward;
    uint width_px;
    vec3 sun_direction; // unit, towards the sun
    uint height_px;
    vec3 sun_irradiance; // W/m^2 on a plane across the direction; 0: no sun
    uint medium_count;
    vec3 background; // W m^-2 sr^-1
    uint solid_count;
    uint steps;
    uint sun_steps;
    uint scatters; // 0 or 1: a medium scatters sunlight, and the scene shows it
    uint octave_count;
    vec3 octave_factors; // contribution, attenuation, eccentricity (struct neph_octaves)
    uint emits; // 0 or 1: a medium emits light
    vec2 jitter_px; // sub-pixel jitter of this frame's view rays, for sequences
    float sun_first_part; // length of a sun ray's first step, over the whole
    uint light_texel_px; // pixels along a side of a texel of traced light (traced_light.glsl)
    Lattice sun_lattice;  // nodes of the sun cache, at least 2 along each axis (sun_cache.glsl)
    Lattice skip_lattice; // cells for empty-space skipping (shortcuts.glsl)
    Lattice light_lattice; // cells of diffused light (diffusion.glsl)
    ShadowMap shadow;
    Medium media[MEDIA_MAX];
    uint lamp_count;
    uint solids_shade; // 0 or 1: a solid may shadow a medium
    uint scatters_lamps; // 0 or 1: a medium scatters light of lamps, and the scene shows it
#include "settings/march_frame.glsl" // settings of approximations
    Lamp lamps[NEPH_GPU_LAMPS_MAX];
    Meshes meshes;
    SunGrid sun_grid;
    FogLook fog_look; // of a march that leaves the height fog to a closed form (march_veil.glsl)
} frame;

// Upper bounds of the extinction (for extinction_color 1) per cell, x fastest [1/m].
layout(std430, binding = 3) readonly buffer Majorants {
    float majorants[];
};

layout(std140, binding = 1) uniform Solids {
    SolidNode solid_nodes[NEPH_GPU_SOLID_NODES_MAX];
    uvec4 solid_order[NEPH_GPU_SOLIDS_MAX / 4];
    Solid solids[NEPH_GPU_SOLIDS_MAX];
};

vec3 kept_sun_direction = make_nonuniform(frame.sun_direction);

// The direction of the sun; on a CPU device from a copy per thread (READS_FRAME_ONCE).
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

// The ray of an image position. A perspective camera's rays start at the constant 0, which the
// compiler can fold; an orthographic camera's start on the plane through the camera.
struct ViewRay {
    vec3 origin_m;
    vec3 direction; // unit
};

// The ray through an image position, in pixels from the upper left corner.
ViewRay camera_ray_at(Camera camera, vec2 place_px)
{
    float x = (2.0 * place_px.x / float(camera.width_px) - 1.0) * camera.half_width;
    float y = (1.0 - 2.0 * place_px.y / float(camera.height_px)) * camera.half_height;
    vec3 origin_m = ORTHOGRAPHIC ? x * camera.right + y * camera.up : vec3(0.0);
    vec3 direction = ORTHOGRAPHIC ? make_nonuniform(camera.forward)
                              : normalize(camera.forward + x * camera.right + y * camera.up);
    return ViewRay(origin_m, direction);
}

// The ray through the centre of a pixel; row 0 is at the top.
ViewRay camera_ray(Camera camera, uint i, uint j)
{
    return camera_ray_at(camera, vec2(i, j) + 0.5);
}

ViewRay camera_ray(uint i, uint j) { return camera_ray(frame_camera(), i, j); }

// The point at a distance on a ray.
vec3 view_point_m(ViewRay ray, float t_m)
{
    return ORTHOGRAPHIC ? ray.origin_m + t_m * ray.direction : t_m * ray.direction;
}

#endif
