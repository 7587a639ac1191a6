/* SPDX-License-Identifier: MIT
 *
 * The sky of a scene: its tables, and what is seen along a ray. The tables are of the atmosphere
 * alone; they serve every place and every sun.
 */
#ifndef NEPH_RENDERER_SKY_SKY_H
#define NEPH_RENDERER_SKY_SKY_H

#include "renderer/sky/solve.h"
#include "renderer/sky/view_table.h"

/* The air before a camera, by columns, rows and distances, on a device alone
 * (shaders/sky_aerial.glsl). */
struct neph_sky_aerial_params {
    int columns, rows; /* nodes from edge to edge of the picture, 2 or more */
    int slices;        /* nodes beyond the camera; 0: there is none */
    double far_m;      /* where the last one is */
};

/* Which tables are filled for a picture, on a device: what is stale, or, to know what that costs,
 * also what is of a camera and a sun, or all. */
enum neph_sky_refill {
    NEPH_SKY_REFILL_STALE,
    NEPH_SKY_REFILL_VIEWS,
    NEPH_SKY_REFILL_ALL,
    NEPH_SKY_REFILL_COUNT
};

struct neph_sky_params {
    int steps;                      /* along a view ray */
    int sun_altitudes, sun_cosines; /* nodes of the table of transmittance to the sun */
    struct neph_sky_solve_params field;
    struct neph_sky_view_params view;
    struct neph_sky_aerial_params aerial;
    enum neph_sky_refill refill;
};

struct neph_sky;

/* The scene must outlive it. Free with _destroy. NEPH_ERR_UNSUPPORTED: neph_sky_air_of() says no.
 */
enum neph_status neph_sky_create(const struct neph_scene *scene,
                                 const struct neph_sky_params *params, struct neph_sky **sky,
                                 struct neph_diag *diag);

/* NULL is fine. */
void neph_sky_destroy(struct neph_sky *sky);

/* Make the table of views of a place, from which neph_sky_see() then takes what rays from there
 * see; nothing where the parameters have none. */
enum neph_status neph_sky_stand(struct neph_sky *sky, struct neph_vec3 eye_m,
                                struct neph_diag *diag);

/* Along a ray of the scene, in its orders of scattering and under its sun; the direction is unit.
 * Solids beside the ground hide what is behind them and the sun from each other and from the
 * ground, and are lit by the sky around; that they shadow the air and hide the sky from each other
 * is left out. */
struct neph_sky_light neph_sky_see(const struct neph_sky *sky, struct neph_vec3 origin_m,
                                   struct neph_vec3 direction);

#endif
