/* SPDX-License-Identifier: MIT
 *
 * The sky of a scene: its tables, and the radiance along a ray. The tables depend only on the
 * atmosphere and are valid for every position and sun.
 */
#ifndef NEPH_RENDERER_SKY_SKY_H
#define NEPH_RENDERER_SKY_SKY_H

#include "renderer/sky/solve.h"
#include "renderer/sky/view_table.h"

/* The table of air between the camera and the scene, by columns, rows and distances; only on a
 * device (shaders/sky_aerial.glsl). */
struct neph_sky_aerial_params {
    int columns, rows; /* nodes from edge to edge of the frame, 2 or more */
    int slices;        /* nodes after the camera; 0: no table */
    double far_m;      /* distance of the last one */
};

/* Which tables are filled for a frame on a device: stale ones; or, to measure the cost, also those
 * that depend on camera and sun, or all. */
enum neph_sky_refill {
    NEPH_SKY_REFILL_STALE,
    NEPH_SKY_REFILL_VIEWS,
    NEPH_SKY_REFILL_ALL,
    NEPH_SKY_REFILL_COUNT
};

struct neph_sky_params {
    int steps;                      /* along a view ray */
    int sun_altitudes, sun_cosines; /* nodes of the table of transmittance towards the sun */
    struct neph_sky_solve_params field;
    struct neph_sky_view_params view;
    struct neph_sky_aerial_params aerial;
    enum neph_sky_refill refill;
};

struct neph_sky;

/* The scene must outlive the sky. Free with _destroy. NEPH_ERR_UNSUPPORTED: neph_sky_read_air() is
 * false. */
enum neph_status neph_sky_create(const struct neph_scene *scene,
                                 const struct neph_sky_params *params, struct neph_sky **sky,
                                 struct neph_diag *diag);

/* NULL is fine. */
void neph_sky_destroy(struct neph_sky *sky);

/* Fill the table of views for a position; neph_sky_trace() then uses it for rays from there. Does
 * nothing when the parameters have no such table. */
enum neph_status neph_sky_fill_view_table(struct neph_sky *sky, struct neph_vec3 eye_m,
                                          struct neph_diag *diag);

/* Radiance along a ray of the scene, with its orders of scattering and its sun; the direction is
 * unit. Solids other than the ground occlude what is behind them, cast shadows on each other and on
 * the ground, and are lit by the sky. Not included: their shadows on the air, and their occlusion
 * of the sky for each other. */
struct neph_sky_light neph_sky_trace(const struct neph_sky *sky, struct neph_vec3 origin_m,
                                     struct neph_vec3 direction);

#endif
