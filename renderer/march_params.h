/* SPDX-License-Identifier: MIT
 *
 * What a march is told, whoever marches: every pixel (march.h) or a ray for each tile (realtime/).
 */
#ifndef NEPH_RENDERER_MARCH_PARAMS_H
#define NEPH_RENDERER_MARCH_PARAMS_H

/* Where an optical depth comes from. */
enum neph_march_mode {
    NEPH_MARCH_EXACT, /* closed forms; Horizon clouds, which have none, are marched all the same */
    NEPH_MARCH_MARCHED, /* the sum over steps of extinction at the middle of the step */
};

/* How light gets to a point of a medium; the formulas are in shaders/march_light.glsl. */
enum neph_march_lighting {
    NEPH_MARCH_SINGLE,  /* sunlight scattered once */
    NEPH_MARCH_OCTAVES, /* multiple scattering as scaled single scatterings: a look */
    NEPH_MARCH_HORIZON, /* the light of Horizon's clouds, for their layers alone: a look */
};

#define NEPH_MARCH_SIDE_MAX_PX 4096
#define NEPH_MARCH_STEPS_MAX 65536

struct neph_march_params {
    int width_px, height_px;            /* 1..NEPH_MARCH_SIDE_MAX_PX */
    double frame;                       /* of the scene; may be fractional */
    int steps;                          /* per view ray, 1..NEPH_MARCH_STEPS_MAX */
    enum neph_march_mode transmittance; /* along the view ray: layer and in-scattering alike */
    enum neph_march_mode sun;           /* towards the sun */
    enum neph_march_lighting lighting;
    int sun_steps; /* per sun ray, 1..NEPH_MARCH_STEPS_MAX; not used where none is marched */
};

#endif
