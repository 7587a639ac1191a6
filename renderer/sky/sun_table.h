/* SPDX-License-Identifier: MIT
 *
 * Transmittance from a place of the atmosphere to the sun, as a table over altitude and the sun's
 * cosine. Its axes are lengths: to the horizon at the place's altitude, and along the ray to the
 * top of the atmosphere between the shortest and the longest that there is from there (E. Bruneton,
 * F. Neyret, "Precomputed Atmospheric Scattering", EGSR 2008, section 4, for rays that miss the
 * ground).
 */
#ifndef NEPH_RENDERER_SKY_SUN_TABLE_H
#define NEPH_RENDERER_SKY_SUN_TABLE_H

#include "renderer/sky/air.h"

struct neph_sky_sun_table {
    int altitudes, cosines; /* nodes, 2 or more */
    float (*nodes)[3];      /* owned; the cosine runs fastest */
};

/* Free with _destroy, also after an error. */
enum neph_status neph_sky_sun_table_create(const struct neph_sky_air *air, int altitudes,
                                           int cosines, struct neph_sky_sun_table *table,
                                           struct neph_diag *diag);

/* A zero one is fine. */
void neph_sky_sun_table_destroy(struct neph_sky_sun_table *table);

/* Linear between nodes; 0 where the ground hides the sun. */
void neph_sky_sun_transmittance(const struct neph_sky_air *air,
                                const struct neph_sky_sun_table *table, double altitude_m,
                                double sun_cosine, double transmittance[3]);

#endif
