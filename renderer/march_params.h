/* SPDX-License-Identifier: MIT
 *
 * What a march is told, whoever marches: every pixel (march.h) or a ray for each tile (realtime/).
 */
#ifndef NEPH_RENDERER_MARCH_PARAMS_H
#define NEPH_RENDERER_MARCH_PARAMS_H

#include "base/vec3.h"
#include "renderer/shaders/constants.h"
#include "renderer/sky/sky.h"
#include "scenes/fog_look.h"

#include <stdbool.h>
#include <stdint.h>

/* Where an optical depth comes from. */
enum neph_march_mode {
    NEPH_MARCH_EXACT, /* closed forms; Horizon clouds, which have none, are marched all the same */
    NEPH_MARCH_MARCHED, /* the sum over steps of extinction at the middle of the step */
    NEPH_MARCH_MODE_COUNT,
};

/* How light gets to a point of a medium; the formulas are in shaders/march_light.glsl. */
enum neph_march_lighting {
    NEPH_MARCH_SINGLE,         /* sunlight scattered once */
    NEPH_MARCH_OCTAVES,        /* multiple scattering as scaled single scatterings: a look */
    NEPH_MARCH_HORIZON,        /* the light of Horizon's clouds, for their layers alone: a look */
    NEPH_MARCH_OCTAVES_FITTED, /* octaves by g and albedo of each medium (octaves_fitted.h): a look
                                */
    NEPH_MARCH_TRACED,         /* single, and higher orders by paths (traced_light.h) */
    NEPH_MARCH_DIFFUSED,       /* single, and higher orders by diffusion (diffused_light.h) */
    NEPH_MARCH_SIMILARITY,     /* single, and octaves of the similar isotropic medium: a look */
    NEPH_MARCH_SLAB,           /* single, and higher orders as in a slab (slab_light.h): a look */
    NEPH_MARCH_LIGHTING_COUNT,
};

#define NEPH_MARCH_SIDE_MAX_PX 4096
#define NEPH_MARCH_STEPS_MAX 65536

/* What a texel of a voxel grid's texture holds: the density over the grid's largest. */
enum neph_texel_format {
    NEPH_TEXEL_R32F,
    NEPH_TEXEL_R16F, /* eleven bits of it */
    NEPH_TEXEL_R8,   /* in steps of 1/255 */
    NEPH_TEXEL_FORMAT_COUNT,
};

/* What the texels of a shadow map of clouds lie on (renderer/cloud_shadow.h). */
enum neph_shadow_plane {
    NEPH_SHADOW_LEVEL, /* a level plane through the middle of the clouds; they stay with these */
    NEPH_SHADOW_SUN,   /* the plane across the sunlight, with which they turn */
    NEPH_SHADOW_PLANE_COUNT,
};

#include "settings/march_shortcuts.h" /* struct neph_shortcuts */

/* Nearer to 1 than this the shader's geometric sums cancel. */
#define NEPH_STEP_GROWTH_LEAST 1.001
/* The last step is at most so many times as long as the first. */
#define NEPH_STEP_GROWTH_WHOLE_MAX 1e6

/* Paths of traced light, for NEPH_MARCH_TRACED alone. */
struct neph_light_paths {
    int texel_px;       /* pixels along the side of a texel: 1..NEPH_LIGHT_TEXEL_PX_MAX */
    int paths;          /* of a texel, under way at a time: 1..NEPH_LIGHT_PATHS_MAX */
    int rounds;         /* of all paths in a picture: 1..NEPH_LIGHT_ROUNDS_MAX */
    int memory;         /* pictures over which sums fade; 1: each picture is by itself */
    double blur_texels; /* standard deviation of the blur; 0: none */
    double similar;     /* 0..1: how far media are changed for similar ones after two events */
    bool looks_ahead;   /* by diffused light, of which .diffusion says how fine (traced_light.h) */
    bool ends_ahead;    /* and paths end with the round, in what they look ahead to */
    uint32_t seed;
};

#define NEPH_LIGHT_TEXEL_PX_MAX 64
#define NEPH_LIGHT_PATHS_MAX 64
#define NEPH_LIGHT_ROUNDS_MAX 65536
#define NEPH_LIGHT_MEMORY_MAX 65536
#define NEPH_LIGHT_BLUR_MAX 2.0

/* Cells of diffused light, for NEPH_MARCH_DIFFUSED and for traced light that looks ahead. */
struct neph_light_diffusion {
    int cells;  /* along the longest side of all shapes: NEPH_DIFFUSION_CELLS_MIN.._MAX */
    int cycles; /* multigrid cycles in a picture: 1..NEPH_DIFFUSION_CYCLES_MAX */
};

#define NEPH_DIFFUSION_CELLS_MIN 4
#define NEPH_DIFFUSION_CELLS_MAX 192
#define NEPH_DIFFUSION_CYCLES_MAX 1024

/* The sky of a planet from tables, in place of a march through its air (renderer/sky/split.h).
 * Zero: all media are marched. */
struct neph_march_sky {
    bool is_on;
    bool has_shadows;              /* of media and solids on the air before the camera */
    struct neph_sky_params tables; /* with views and the air before the camera */
};

/* What a user says of it. */
struct neph_march_sky_choices {
    bool is_on, has_shadows;
    int columns, rows, slices; /* as struct neph_sky_aerial_params */
    double far_m;
    int refill; /* enum neph_sky_refill */
};

/* All tables but that before the camera are as engine `sky` has them by default. */
struct neph_march_sky neph_sky_for_march(struct neph_march_sky_choices choices);

/* The height fog as a game engine draws it by the scene's `fog_look`, before, between and behind
 * all else (shaders/march_veil.glsl). Zero: it is a medium like all others. */
struct neph_march_fog {
    bool is_look;
    enum neph_fog_model model;
    bool is_handed_over; /* nearer than the scene's volumetric_fog_distance_m, of depth, it is a
                            medium of froxels, and its look begins where they end */
};

/* By the index of the option's word. */
struct neph_march_fog neph_fog_for_march(int choice);

/* Which of a scene's media are none of the march's. */
struct neph_march_veils {
    bool sky; /* the air of a planet */
    struct neph_march_fog fog;
};

struct neph_march_params {
    int width_px, height_px;            /* 1..NEPH_MARCH_SIDE_MAX_PX */
    int picture_px[2];                  /* whose shape the frame has; 0: square pixels */
    double frame;                       /* of the scene; may be fractional */
    int steps;                          /* per view ray, 1..NEPH_MARCH_STEPS_MAX */
    enum neph_march_mode transmittance; /* along the view ray: layer and in-scattering alike */
    enum neph_march_mode sun;           /* towards the sun */
    enum neph_march_lighting lighting;
    int sun_steps; /* per sun ray, 1..NEPH_MARCH_STEPS_MAX; not used where none is marched */
    struct neph_shortcuts shortcuts;
    struct neph_light_paths light;
    struct neph_light_diffusion diffusion;
    struct neph_march_sky sky;
    struct neph_march_fog fog;
};

/* A picture among others. Zero: through the centres of pixels, a picture by itself. */
struct neph_march_moment {
    float jitter_px[2];       /* added to the place of each ray, x to the right, y down */
    bool continues;           /* the picture before was of the same sequence, without a cut */
    struct neph_vec3 drift_m; /* how far the wind has carried the media, since whenever */
};

#endif
