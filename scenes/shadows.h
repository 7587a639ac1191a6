/* SPDX-License-Identifier: MIT
 *
 * The parts of a ray from which a light is hidden.
 */
#ifndef NEPH_SCENES_SHADOWS_H
#define NEPH_SCENES_SHADOWS_H

#include "scenes/quadrature.h"

#include <stdbool.h>

#define NEPH_SHADOWS_MAX 3072 /* their ends are three quarters of NEPH_CUTS_MAX */

/* A union of intervals of t: disjoint and ascending. Where it would need more than
 * NEPH_SHADOWS_MAX, the two with the smallest gap between them become one: with them on a ray of
 * 1 km, this gap is below 0.4 m. */
struct neph_shadows {
    int count;
    struct neph_interval at_m[NEPH_SHADOWS_MAX];
};

/* Adds an interval, low < high; those that it touches become one with it. */
void neph_shadows_add(struct neph_shadows *shadows, double low_m, double high_m);

/* Whether one shadow has the whole interval. */
bool neph_shadows_cover(const struct neph_shadows *shadows, double low_m, double high_m);

#endif
