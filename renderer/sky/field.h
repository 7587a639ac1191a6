/* SPDX-License-Identifier: MIT
 *
 * The radiance field of the atmosphere: light scattered by the air or reflected by the ground at
 * least once, at every altitude and for every elevation of the sun, as moments over directions. The
 * Rayleigh phase function uses only moments of degree 0 and 2, so these are sufficient for air;
 * haze needs more. One small table with two axes is therefore the input of all higher orders. For
 * comparison: E. Bruneton and F. Neyret ("Precomputed Atmospheric Scattering", EGSR 2008) use
 * tables with four axes for each order; S. Hillaire ("A scalable and production ready sky and
 * atmosphere rendering technique", EGSR 2020) uses the moment of degree 0 of two orders, and a
 * geometric series for higher ones. solve.h fills the table.
 */
#ifndef NEPH_RENDERER_SKY_FIELD_H
#define NEPH_RENDERER_SKY_FIELD_H

#include "renderer/sky/harmonics.h"

struct neph_sky_field {
    int altitudes, suns;  /* nodes, 2 or more */
    int degree;           /* of the moments */
    double (*moments)[3]; /* owned; [altitude][sun][moment], for a solar irradiance of 1 */
    double (*ground)[3];  /* owned; [sun]: irradiance of the ground without direct sunlight */
};

/* Zero-filled. Free with _destroy, also after an error. */
enum neph_status neph_sky_field_create(int altitudes, int suns, int degree,
                                       struct neph_sky_field *field, struct neph_diag *diag);

/* A zero-initialised field is fine. */
void neph_sky_field_destroy(struct neph_sky_field *field);

/* Start of the sun axis: the signed square root of the elevation divided by 90 degrees. */
double neph_sky_deepest_root(void);

/* Coordinates of a node. */
double neph_sky_node_altitude_m(const struct neph_sky_air *air, const struct neph_sky_field *field,
                                int node);
double neph_sky_node_sun_cosine(const struct neph_sky_field *field, int node);

/* Moments at a point: linear interpolation between nodes. */
void neph_sky_field_at(const struct neph_sky_air *air, const struct neph_sky_field *field,
                       double altitude_m, double sun_cosine,
                       double moments[NEPH_SKY_MOMENTS_MAX][3]);

/* Irradiance of the ground without direct sunlight. */
void neph_sky_field_ground(const struct neph_sky_field *field, double sun_cosine,
                           double irradiance[3]);

#endif
