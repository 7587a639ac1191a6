/* SPDX-License-Identifier: MIT
 *
 * What a march is told, whoever marches: every pixel (march.h) or a ray for each tile (realtime/).
 */
#ifndef NEPH_RENDERER_MARCH_PARAMS_H
#define NEPH_RENDERER_MARCH_PARAMS_H

#include <stdbool.h>

/* Where an optical depth comes from. */
enum neph_march_mode {
    NEPH_MARCH_EXACT, /* closed forms; Horizon clouds, which have none, are marched all the same */
    NEPH_MARCH_MARCHED, /* the sum over steps of extinction at the middle of the step */
};

/* How light gets to a point of a medium; the formulas are in shaders/march_light.glsl. */
enum neph_march_lighting {
    NEPH_MARCH_SINGLE,         /* sunlight scattered once */
    NEPH_MARCH_OCTAVES,        /* multiple scattering as scaled single scatterings: a look */
    NEPH_MARCH_HORIZON,        /* the light of Horizon's clouds, for their layers alone: a look */
    NEPH_MARCH_OCTAVES_FITTED, /* octaves by g and albedo of each medium (octaves_fitted.h): a look
                                */
};

#define NEPH_MARCH_SIDE_MAX_PX 4096
#define NEPH_MARCH_STEPS_MAX 65536

/* Shortcuts through media, for speed. Zero: none, and the march keeps its bits. */
struct neph_shortcuts {
    /* Optical depth of shapes (all media but fogs) towards the sun from a lattice over their
     * bounds, in place of a ray for each sample; of solids, and of fogs, it stays as it is. */
    bool sun_cache;
    int sun_cache_voxels; /* its nodes along the longest side, NEPH_SUN_CACHE_VOXELS_* */
    /* No density is evaluated in cells whose majorant is 0; same bits, fewer evaluations. */
    bool skip;
    /* A view ray ends where its transmittance is below this, 0..1; 0: never. What lies behind is
     * at most this times the brightest of it. A transmittance in closed form stays whole. */
    double early_out;
    /* Each view step is so many times as long as the one before; 0 and 1: all are equal. Else at
     * least NEPH_STEP_GROWTH_LEAST: nearer to 1 the shader's geometric sums cancel. */
    double step_growth;
};

#define NEPH_SUN_CACHE_VOXELS_MIN 8
#define NEPH_SUN_CACHE_VOXELS_MAX 512
#define NEPH_STEP_GROWTH_LEAST 1.001
#define NEPH_STEP_GROWTH_MAX 2.0

/* The last step is at most so many times as long as the first. */
#define NEPH_STEP_GROWTH_WHOLE_MAX 1e6

struct neph_march_params {
    int width_px, height_px;            /* 1..NEPH_MARCH_SIDE_MAX_PX */
    double frame;                       /* of the scene; may be fractional */
    int steps;                          /* per view ray, 1..NEPH_MARCH_STEPS_MAX */
    enum neph_march_mode transmittance; /* along the view ray: layer and in-scattering alike */
    enum neph_march_mode sun;           /* towards the sun */
    enum neph_march_lighting lighting;
    int sun_steps; /* per sun ray, 1..NEPH_MARCH_STEPS_MAX; not used where none is marched */
    struct neph_shortcuts shortcuts;
};

#endif
