/* SPDX-License-Identifier: MIT
 *
 * Parameters of the ray marcher, for full resolution (march.h) and for one ray per tile
 * (realtime/).
 */
#ifndef NEPH_RENDERER_MARCH_PARAMS_H
#define NEPH_RENDERER_MARCH_PARAMS_H

#include "base/vec3.h"
#include "renderer/shaders/constants.h"
#include "renderer/sky/sky.h"
#include "scenes/fog_look.h"

#include <stdbool.h>
#include <stdint.h>

/* How an optical depth is computed. */
enum neph_march_mode {
    NEPH_MARCH_EXACT,   /* closed form; Horizon clouds have none and are always marched */
    NEPH_MARCH_MARCHED, /* sum over steps of the extinction at the middle of the step */
    NEPH_MARCH_MODE_COUNT,
};

/* In-scattered light at a point of a medium; formulas in shaders/march_light.glsl. */
enum neph_march_lighting {
    NEPH_MARCH_SINGLE,         /* sunlight scattered once */
    NEPH_MARCH_OCTAVES,        /* multiple scattering as octaves of single scattering: a
                                  non-physical model */
    NEPH_MARCH_HORIZON,        /* the lighting of Horizon clouds, only for these: a non-physical
                                  model */
    NEPH_MARCH_OCTAVES_FITTED, /* octaves fitted to g and albedo (octaves_fitted.h): non-physical */
    NEPH_MARCH_TRACED,         /* single, plus higher orders by paths (traced_light.h) */
    NEPH_MARCH_DIFFUSED,       /* single, plus higher orders by diffusion (diffused_light.h) */
    NEPH_MARCH_SIMILARITY,     /* single, plus octaves of the similar isotropic medium: non-physical
                                */
    NEPH_MARCH_SLAB,           /* single, plus higher orders of a slab (slab_light.h): non-physical
                                */
    NEPH_MARCH_LIGHTING_COUNT,
};

#define NEPH_MARCH_SIDE_MAX_PX 4096
#define NEPH_MARCH_STEPS_MAX 65536

/* Format of a texel of a voxel grid's texture: density divided by the grid's maximum. */
enum neph_texel_format {
    NEPH_TEXEL_R32F,
    NEPH_TEXEL_R16F, /* 11 significant bits */
    NEPH_TEXEL_R8,   /* in steps of 1/255 */
    NEPH_TEXEL_FORMAT_COUNT,
};

/* The plane of a shadow map of clouds (renderer/cloud_shadow.h). */
enum neph_shadow_plane {
    NEPH_SHADOW_LEVEL, /* horizontal, through the middle of the clouds; fixed to the clouds */
    NEPH_SHADOW_SUN,   /* perpendicular to the sunlight; turns with the sun */
    NEPH_SHADOW_PLANE_COUNT,
};

#include "settings/march_shortcuts.h" /* struct neph_shortcuts */

/* Below this growth the shader's geometric sums suffer cancellation. */
#define NEPH_STEP_GROWTH_LEAST 1.001
/* Largest ratio of the last step's length to the first's. */
#define NEPH_STEP_GROWTH_WHOLE_MAX 1e6

/* Paths of traced light, only for NEPH_MARCH_TRACED. */
struct neph_light_paths {
    int texel_px;       /* side of a texel [pixels]: 1..NEPH_LIGHT_TEXEL_PX_MAX */
    int paths;          /* concurrent paths of a texel: 1..NEPH_LIGHT_PATHS_MAX */
    int rounds;         /* rounds of all paths in a frame: 1..NEPH_LIGHT_ROUNDS_MAX */
    int memory;         /* frames over which sums decay; 1: no history */
    double blur_texels; /* standard deviation of the blur; 0: none */
    double similar;     /* 0..1: degree of the similarity transform after two events */
    bool looks_ahead;   /* the remainder of unfinished paths is estimated by diffused light of the
                           resolution .diffusion, and corrected when they end (traced_light.h) */
    bool ends_ahead;    /* paths end with the frame: that estimate and its bias stay */
    uint32_t seed;
};

#define NEPH_LIGHT_TEXEL_PX_MAX 64
#define NEPH_LIGHT_PATHS_MAX 64
#define NEPH_LIGHT_ROUNDS_MAX 65536
#define NEPH_LIGHT_MEMORY_MAX 65536
#define NEPH_LIGHT_BLUR_MAX 2.0

/* The grid of diffused light, for NEPH_MARCH_DIFFUSED and for traced light with .looks_ahead. */
struct neph_light_diffusion {
    int cells;  /* along the longest side of the bounds: NEPH_DIFFUSION_CELLS_MIN.._MAX */
    int cycles; /* multigrid cycles a frame: 1..NEPH_DIFFUSION_CYCLES_MAX */
};

#define NEPH_DIFFUSION_CELLS_MIN 4
#define NEPH_DIFFUSION_CELLS_MAX 192
#define NEPH_DIFFUSION_CYCLES_MAX 1024

/* The sky of a planet from tables, instead of marching through its air (renderer/sky/split.h).
 * Zero: all media are marched. */
struct neph_march_sky {
    bool is_on;
    bool has_shadows;              /* shadows of media and solids on the air in front of the camera
                                    */
    struct neph_sky_params tables; /* with the tables for views and for the air in front of the
                                      camera */
};

/* The user's settings of the sky. */
struct neph_march_sky_choices {
    bool is_on, has_shadows;
    int columns, rows, slices; /* as struct neph_sky_aerial_params */
    double far_m;
    int refill; /* enum neph_sky_refill */
};

/* All tables except the one in front of the camera have the defaults of engine `sky`. */
struct neph_march_sky neph_sky_for_march(struct neph_march_sky_choices choices);

/* The height fog as a game engine renders it, by the scene's `fog_look`: in front of, between and
 * behind all other media (shaders/march_veil.glsl). Zero: the fog is a medium like all others. */
struct neph_march_fog {
    bool is_look;
    enum neph_fog_model model;
    bool is_handed_over; /* up to the depth volumetric_fog_distance_m of the scene the fog is a
                            medium of froxels; beyond, the model */
};

/* The fog model for the index of the option's choice. */
struct neph_march_fog neph_fog_for_march(int choice);

/* The veils of a scene: media that are not marched but rendered over the marched media, the air of
 * a planet from tables and the height fog by a model. */
struct neph_march_veils {
    bool sky; /* the air of a planet */
    struct neph_march_fog fog;
};

struct neph_march_params {
    int width_px, height_px;            /* 1..NEPH_MARCH_SIDE_MAX_PX */
    int picture_px[2];                  /* sides of the image with the aspect ratio of the frame; 0:
                                           square pixels */
    double frame;                       /* of the scene; may be fractional */
    int steps;                          /* per view ray, 1..NEPH_MARCH_STEPS_MAX */
    enum neph_march_mode transmittance; /* along the view ray, for transmittance and in-scattering
                                         */
    enum neph_march_mode sun;           /* towards the sun */
    enum neph_march_lighting lighting;
    int sun_steps; /* per sun ray, 1..NEPH_MARCH_STEPS_MAX; ignored without marched sun rays */
    struct neph_shortcuts shortcuts;
    struct neph_light_paths light;
    struct neph_light_diffusion diffusion;
    struct neph_march_sky sky;
    struct neph_march_fog fog;
};

/* A frame of a sequence. Zero: rays through the centres of pixels, no previous frame. */
struct neph_march_moment {
    float jitter_px[2];       /* offset of all rays [pixels], x to the right, y down */
    bool continues;           /* the previous frame was of the same sequence, without a cut */
    struct neph_vec3 drift_m; /* displacement of the media by the wind, since any fixed time */
};

#endif
