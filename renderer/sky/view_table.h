/* SPDX-License-Identifier: MIT
 *
 * All that is seen from one place under one sun, as a table over directions, so that a picture is a
 * few look-ups a pixel in place of a walk. One half is above the horizon and one below it, and
 * nothing is interpolated across it; nodes are close together at the horizon and towards the sun.
 *
 * The angle between a ray and the sun is the same all along the ray. So light that is scattered
 * once by a layer is a phase function times what is smooth, and the table has the latter alone.
 * (After S. Hillaire 2020, whose table has the light itself, and E. Bruneton, F. Neyret 2008, who
 * keep the phase function of haze apart.)
 */
#ifndef NEPH_RENDERER_SKY_VIEW_TABLE_H
#define NEPH_RENDERER_SKY_VIEW_TABLE_H

#include "renderer/sky/walk.h"

struct neph_sky_view_params {
    bool is_table;            /* else a ray is walked */
    int elevations, azimuths; /* nodes: of each half; from the sun over half a turn */
};

struct neph_sky_view_table {
    int elevations, azimuths;
    int slices; /* of a node: of each layer; then as below */
    double altitude_m, sun_cosine;
    double (*nodes)[3]; /* owned; [half][elevation][azimuth][slice] */
};

/* Behind a slice for each layer, light that it scatters once over its phase function. Below the
 * horizon that and what is of higher orders are per metre of the way to the ground. */
enum neph_sky_slice { NEPH_SKY_HIGHER, NEPH_SKY_GROUND, NEPH_SKY_THROUGH, NEPH_SKY_SLICES };

/* Free with _destroy, also after an error. */
enum neph_status neph_sky_view_table_create(const struct neph_sky_air *air,
                                            const struct neph_sky_sources *sources,
                                            const struct neph_sky_view_params *params, int steps,
                                            double altitude_m, double sun_cosine,
                                            struct neph_sky_view_table *table,
                                            struct neph_diag *diag);

/* A zero one is fine. */
void neph_sky_view_table_destroy(struct neph_sky_view_table *table);

/* Along a ray from the table's place, with its phases. */
struct neph_sky_light neph_sky_view(const struct neph_sky_air *air,
                                    const struct neph_sky_view_table *table,
                                    const struct neph_sky_ray *ray);

#endif
