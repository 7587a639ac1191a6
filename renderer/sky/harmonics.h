/* SPDX-License-Identifier: MIT
 *
 * Real spherical harmonics of light that is the same to the left and to the right of the sun: Y_lm
 * of m >= 0 alone, orthonormal over the sphere, in the frame of a place: z up, x towards the sun
 * over the ground. As polynomials of x and z they have no pole.
 */
#ifndef NEPH_RENDERER_SKY_HARMONICS_H
#define NEPH_RENDERER_SKY_HARMONICS_H

#include "renderer/sky/air.h"

enum { NEPH_SKY_MOMENTS_MAX = (NEPH_SKY_DEGREE_MAX + 1) * (NEPH_SKY_DEGREE_MAX + 2) / 2 };

/* How many there are up to a degree; that of degree l and order m has the index l (l + 1) / 2 + m.
 */
static inline int neph_sky_moments(int degree)
{
    return (degree + 1) * (degree + 2) / 2;
}

/* What makes that of degree l and order m orthonormal: a factor of the Legendre function. */
double neph_sky_norm(int l, int m);

/* Values in the direction (x, y, z), unit, y^2 following from x and z. */
void neph_sky_harmonics(int degree, double x, double z, double values[NEPH_SKY_MOMENTS_MAX]);

#endif
