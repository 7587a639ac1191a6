/* SPDX-License-Identifier: MIT
 *
 * A scene in the layout of shaders/scene.glsl (std430), as seen by the camera of one frame.
 *
 * All positions are relative to the camera, subtracted in double: a float32 at 1000 km from the
 * world's origin moves in steps of 6 cm, at 1 km from the camera in steps of 0.06 mm.
 * Not for other folders.
 */
#ifndef NEPH_RENDERER_GPU_SCENE_H
#define NEPH_RENDERER_GPU_SCENE_H

#include "renderer/compute.h"
#include "scenes/scene.h"

#include <stddef.h>
#include <stdint.h>

/* FAR_M of shaders/numbers.glsl: the finite stand-in for infinity [m]. */
#define NEPH_GPU_FAR_M 1e15f

/* struct FogLayer of shaders/fog.glsl */
struct neph_gpu_fog_layer {
    float extinction_per_m;
    float falloff_per_m;
    float height_m;
    float exponent_max;
};

/* struct Gaussian of shaders/gaussian.glsl */
struct neph_gpu_gaussian {
    float center_m[3];
    float width_m;
    float reach_m;
    float padding[3];
};

/* struct Globe of shaders/globe.glsl */
struct neph_gpu_globe {
    float up[3];
    float camera_radius_m;
    float camera_altitude_m;
    float radius_m;
    float padding[2];
};

/* struct Shell of shaders/shell.glsl */
struct neph_gpu_shell {
    struct neph_gpu_globe globe;
    float scale_height_m;
    float reach_m;
    float padding[2];
};

/* struct Grid of shaders/grid.glsl */
struct neph_gpu_grid {
    float origin_m[3];
    uint32_t first;
    float nodes_per_m[3];
    uint32_t padding;
    uint32_t size[3];
    uint32_t padding_2;
};

/* struct Horizon of shaders/horizon.glsl */
struct neph_gpu_horizon {
    struct neph_gpu_globe globe;
    float base_at[3];
    float base_per_m;
    float detail_at[3];
    float detail_per_m;
    float weather_at[2];
    float weather_per_m;
    float thickness_m;
    float coverage;
    float density;
    float erosion;
    uint32_t first;
};

/* struct Medium of shaders/scene.glsl */
struct neph_gpu_medium {
    float low_m[3];
    uint32_t kind;
    float high_m[3];
    uint32_t phase_kind;
    float albedo[3];
    float g;
    float extinction_color[3];
    float extinction_per_m;
    struct neph_gpu_fog_layer layers[NEPH_FOG_LAYERS_MAX];
    struct neph_gpu_gaussian gaussian;
    struct neph_gpu_shell shell;
    struct neph_gpu_grid grid;
    struct neph_gpu_horizon horizon;
    uint32_t majorant_size[3];
    uint32_t majorant_first;
    uint32_t layer_count;
    uint32_t padding[3];
};

/* struct Solid of shaders/solids.glsl */
struct neph_gpu_solid {
    float low_m[3];
    uint32_t kind;
    float high_m[3];
    float radius_m;
    float albedo[4];
};

/* buffer Frame of shaders/scene.glsl */
struct neph_gpu_frame {
    float camera_right[3];
    float tan_half_width;
    float camera_up[3];
    float tan_half_height;
    float camera_forward[3];
    uint32_t width_px;
    float sun_direction[3];
    uint32_t height_px;
    float sun_irradiance[3];
    uint32_t medium_count;
    float background[3];
    uint32_t solid_count;
    uint32_t steps;
    uint32_t sun_steps;
    uint32_t scatters;
    uint32_t octave_count;
    float octave_factors[3];
    float padding;
    float jitter_px[2]; /* 0; a sequence's renderer sets it */
    float padding_2[2];
    struct neph_gpu_medium media[NEPH_SCENE_MEDIA_MAX];
};

_Static_assert(sizeof(struct neph_gpu_fog_layer) == 16, "std430 FogLayer");
_Static_assert(offsetof(struct neph_gpu_medium, high_m) == 16, "std430 Medium.high_m");
_Static_assert(offsetof(struct neph_gpu_medium, albedo) == 32, "std430 Medium.albedo");
_Static_assert(offsetof(struct neph_gpu_medium, layers) == 64, "std430 Medium.layers");
_Static_assert(offsetof(struct neph_gpu_medium, gaussian) == 96, "std430 Medium.gaussian");
_Static_assert(sizeof(struct neph_gpu_globe) == 32, "std430 Globe");
_Static_assert(offsetof(struct neph_gpu_medium, shell) == 128, "std430 Medium.shell");
_Static_assert(offsetof(struct neph_gpu_medium, grid) == 176, "std430 Medium.grid");
_Static_assert(offsetof(struct neph_gpu_medium, horizon) == 224, "std430 Medium.horizon");
_Static_assert(sizeof(struct neph_gpu_horizon) == 96, "std430 Horizon");
_Static_assert(offsetof(struct neph_gpu_medium, majorant_size) == 320, "std430 Medium.majorants");
_Static_assert(sizeof(struct neph_gpu_medium) == 352, "std430 Medium");
_Static_assert(offsetof(struct neph_gpu_solid, high_m) == 16, "std430 Solid.high_m");
_Static_assert(offsetof(struct neph_gpu_solid, albedo) == 32, "std430 Solid.albedo");
_Static_assert(sizeof(struct neph_gpu_solid) == 48, "std430 Solid");
_Static_assert(offsetof(struct neph_gpu_frame, camera_up) == 16, "std430 Frame.camera_up");
_Static_assert(offsetof(struct neph_gpu_frame, camera_forward) == 32, "std430 Frame.forward");
_Static_assert(offsetof(struct neph_gpu_frame, sun_direction) == 48, "std430 Frame.sun_direction");
_Static_assert(offsetof(struct neph_gpu_frame, sun_irradiance) == 64, "std430 Frame.irradiance");
_Static_assert(offsetof(struct neph_gpu_frame, background) == 80, "std430 Frame.background");
_Static_assert(offsetof(struct neph_gpu_frame, steps) == 96, "std430 Frame.steps");
_Static_assert(offsetof(struct neph_gpu_frame, octave_factors) == 112, "std430 Frame.octaves");
_Static_assert(offsetof(struct neph_gpu_frame, jitter_px) == 128, "std430 Frame.jitter");
_Static_assert(offsetof(struct neph_gpu_frame, media) == 144, "std430 Frame.media");
_Static_assert(sizeof(struct neph_gpu_frame) == 144 + 352 * NEPH_SCENE_MEDIA_MAX, "std430 Frame");
_Static_assert(NEPH_SCENE_MEDIA_MAX == 8 && NEPH_FOG_LAYERS_MAX == 2, "scene.glsl's counts");
_Static_assert(NEPH_PHASE_ISOTROPIC == 0 && NEPH_PHASE_HENYEY_GREENSTEIN == 1 &&
                   NEPH_PHASE_RAYLEIGH == 2,
               "phase.glsl's kinds");
_Static_assert(NEPH_SOLID_BOX == 0 && NEPH_SOLID_SPHERE == 1, "solids.glsl's kinds");

/* The layer as seen from a height; its extinction must be above 0. */
struct neph_gpu_fog_layer neph_gpu_fog_layer_from(const struct neph_fog_layer *layer,
                                                  double camera_y_m);

/* A sphere as large as a planet, as seen from the camera. */
struct neph_gpu_globe neph_gpu_globe_from(struct neph_vec3 center_m, double radius_m,
                                          struct neph_vec3 camera_position_m);

/* One medium; the places of its grid, textures and majorants are left 0. */
struct neph_gpu_medium neph_gpu_medium_from(const struct neph_medium *medium,
                                            struct neph_vec3 camera_position_m);

struct neph_gpu_solid neph_gpu_solid_from(const struct neph_solid *solid,
                                          struct neph_vec3 camera_position_m);

/* A scene on the device, for one frame: the buffers at bindings 0 to 4 of every kernel that
 * includes shaders/scene.glsl. */
enum { NEPH_GPU_SCENE_BUFFERS = 5, NEPH_GPU_SCENE_CONSTANTS = 2 };

struct neph_gpu_scene {
    struct neph_gpu_frame *frame; /* in the mapped memory of buffers[0]; may be changed between
                                     dispatches. `steps` and `sun_steps` are left 0 */
    /* Frame, solids, grid values, majorants, textures of Horizon clouds. */
    struct neph_buffer buffers[NEPH_GPU_SCENE_BUFFERS];
    /* Specialization constants 0 and 1 of every such kernel: the kinds of media that are there, and
     * whether some medium's extinction differs between the channels. */
    uint32_t constants[NEPH_GPU_SCENE_CONSTANTS];
    /* Loop turns (compute.h) of one exact optical depth through all media, at most. */
    uint64_t optical_depth_turns;
};

/* Zero-initialise `gpu`; free with _destroy, also after an error. `with_majorants`: build majorant
 * grids for the media that have no free path in closed form. NEPH_ERR_UNSUPPORTED: a grid is larger
 * than the device lets a kernel see; a medium needs majorants and has no end. */
enum neph_status neph_gpu_scene_create(const struct neph_vulkan *vulkan,
                                       const struct neph_scene *scene, double frame, int width_px,
                                       int height_px, bool with_majorants,
                                       struct neph_gpu_scene *gpu, struct neph_diag *diag);

/* The same scene at another frame, with another sun or its media moved (neph_scene_at()): grids and
 * textures stay where they are on the device. Not for a scene with majorants. */
void neph_gpu_scene_move(struct neph_gpu_scene *gpu, const struct neph_scene *scene, double frame,
                         int width_px, int height_px);

void neph_gpu_scene_destroy(const struct neph_vulkan *vulkan, struct neph_gpu_scene *gpu);

/* Fill in the first buffers of a dispatch. */
void neph_gpu_scene_bind(const struct neph_gpu_scene *gpu, struct neph_dispatch *dispatch);

#endif
