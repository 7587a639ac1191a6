/* SPDX-License-Identifier: MIT
 *
 * Transmittance from a point of the atmosphere to the sun, as a table over altitude and the sun's
 * cosine. Its coordinates are distances: to the horizon at the point's altitude, and along the ray
 * to the top of the atmosphere between the minimum and the maximum at that altitude (E. Bruneton,
 * F. Neyret, "Precomputed Atmospheric Scattering", EGSR 2008, section 4, for rays that miss the
 * ground).
 */
#ifndef NEPH_RENDERER_SKY_SUN_TABLE_H
#define NEPH_RENDERER_SKY_SUN_TABLE_H

#include "renderer/sky/air.h"

struct neph_sky_sun_table {
    int altitudes, cosines; /* nodes, 2 or more */
    float (*nodes)[3];      /* owned; cosine fastest */
};

/* Free with _destroy, also after an error. */
enum neph_status neph_sky_sun_table_create(const struct neph_sky_air *air, int altitudes,
                                           int cosines, struct neph_sky_sun_table *table,
                                           struct neph_diag *diag);

/* A zero-initialised table is fine. */
void neph_sky_sun_table_destroy(struct neph_sky_sun_table *table);

/* Linear interpolation between nodes; 0 where the ground occludes the sun. */
void neph_sky_sun_transmittance(const struct neph_sky_air *air,
                                const struct neph_sky_sun_table *table, double altitude_m,
                                double sun_cosine, double transmittance[3]);

#endif
