/* SPDX-License-Identifier: MIT
 *
 * The light of the sky that has been scattered, or reflected by the ground, at least once: at every
 * altitude, under a sun at every elevation, as moments over directions. Air scatters light by
 * moments of degree 0 and 2 alone, which makes these all that it has to be told; a haze wants more
 * of them. So one small table of two axes holds what all further orders start from, where E.
 * Bruneton and F. Neyret ("Precomputed Atmospheric Scattering", EGSR 2008) have tables of four axes
 * for each order, and S. Hillaire ("A scalable and production ready sky and atmosphere rendering
 * technique", EGSR 2020) the moment of degree 0 of two orders, and a geometric series for the rest.
 * solve.h fills it.
 */
#ifndef NEPH_RENDERER_SKY_FIELD_H
#define NEPH_RENDERER_SKY_FIELD_H

#include "renderer/sky/harmonics.h"

struct neph_sky_field {
    int altitudes, suns;  /* nodes, 2 or more */
    int degree;           /* of the moments */
    double (*moments)[3]; /* owned; [altitude][sun][moment], for a sun of irradiance 1 */
    double (*ground)[3];  /* owned; [sun]: irradiance of the ground by all but the sun itself */
};

/* Made of zeros. Free with _destroy, also after an error. */
enum neph_status neph_sky_field_create(int altitudes, int suns, int degree,
                                       struct neph_sky_field *field, struct neph_diag *diag);

/* A zero one is fine. */
void neph_sky_field_destroy(struct neph_sky_field *field);

/* Where the axis of suns begins: the root of the elevation over a right angle, with its sign. */
double neph_sky_deepest_root(void);

/* Where a node is. */
double neph_sky_node_altitude_m(const struct neph_sky_air *air, const struct neph_sky_field *field,
                                int node);
double neph_sky_node_sun_cosine(const struct neph_sky_field *field, int node);

/* Moments at a place: linear between nodes. */
void neph_sky_field_at(const struct neph_sky_air *air, const struct neph_sky_field *field,
                       double altitude_m, double sun_cosine,
                       double moments[NEPH_SKY_MOMENTS_MAX][3]);

/* Irradiance of the ground by all but the sun itself. */
void neph_sky_field_ground(const struct neph_sky_field *field, double sun_cosine,
                           double irradiance[3]);

#endif
