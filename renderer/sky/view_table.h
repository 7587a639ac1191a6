/* SPDX-License-Identifier: MIT
 *
 * A table over directions of all light visible from one position under one sun, so that a pixel
 * needs a few samples instead of a walk along its ray. One half is above and one below the horizon,
 * without interpolation between them; nodes are dense near the horizon and towards the sun.
 *
 * The angle between a ray and the sun is constant along the ray. Singly scattered light of a layer
 * is therefore a phase function times a smooth function, and only the latter is stored. (After S.
 * Hillaire 2020, whose table stores the light itself, and E. Bruneton, F. Neyret 2008, who separate
 * the phase function of haze.)
 */
#ifndef NEPH_RENDERER_SKY_VIEW_TABLE_H
#define NEPH_RENDERER_SKY_VIEW_TABLE_H

#include "renderer/sky/walk.h"

struct neph_sky_view_params {
    bool is_table;            /* false: rays are walked */
    int elevations, azimuths; /* nodes: of each half; over half a turn from the sun */
};

struct neph_sky_view_table {
    int elevations, azimuths;
    int slices; /* values of a node: one per layer, then enum neph_sky_slice */
    double altitude_m, sun_cosine;
    double (*nodes)[3]; /* owned; [half][elevation][azimuth][slice] */
};

/* Values after the slices of the layers (singly scattered light of a layer divided by its phase
 * function). Below the horizon these and the higher orders are per metre of the distance to the
 * ground. */
enum neph_sky_slice { NEPH_SKY_HIGHER, NEPH_SKY_GROUND, NEPH_SKY_THROUGH, NEPH_SKY_SLICES };

/* Free with _destroy, also after an error. */
enum neph_status neph_sky_view_table_create(const struct neph_sky_air *air,
                                            const struct neph_sky_sources *sources,
                                            const struct neph_sky_view_params *params, int steps,
                                            double altitude_m, double sun_cosine,
                                            struct neph_sky_view_table *table,
                                            struct neph_diag *diag);

/* A zero-initialised table is fine. */
void neph_sky_view_table_destroy(struct neph_sky_view_table *table);

/* Light along a ray from the table's position, with the ray's phase values. */
struct neph_sky_light neph_sky_view(const struct neph_sky_air *air,
                                    const struct neph_sky_view_table *table,
                                    const struct neph_sky_ray *ray);

#endif
