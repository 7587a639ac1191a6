/* SPDX-License-Identifier: MIT
 *
 * Real spherical harmonics of light that is symmetric about the vertical plane through the sun:
 * only Y_lm with m >= 0, orthonormal over the sphere, in a local frame: z up, x the horizontal
 * direction towards the sun. As polynomials of x and z they have no pole.
 */
#ifndef NEPH_RENDERER_SKY_HARMONICS_H
#define NEPH_RENDERER_SKY_HARMONICS_H

#include "renderer/sky/air.h"

enum { NEPH_SKY_MOMENTS_MAX = (NEPH_SKY_DEGREE_MAX + 1) * (NEPH_SKY_DEGREE_MAX + 2) / 2 };

/* Number of harmonics up to a degree; degree l and order m have the index l (l + 1) / 2 + m. */
static inline int neph_sky_moments(int degree)
{
    return (degree + 1) * (degree + 2) / 2;
}

/* The normalisation factor of degree l and order m, applied to the Legendre function. */
double neph_sky_norm(int l, int m);

/* Values in the unit direction (x, y, z); y^2 follows from x and z. */
void neph_sky_harmonics(int degree, double x, double z, double values[NEPH_SKY_MOMENTS_MAX]);

#endif
