/* SPDX-License-Identifier: MIT
 *
 * Levels at uneven distances, such as the stretched heights of a simulation, as even ones. A level,
 * unless its ends are given, is a cell from half-way to the level before to half-way to the level
 * after it; the outermost cells are as thick above their level as below it. An even cell has the
 * mean of the cells that it overlaps, weighted by the overlap: the sum of value times thickness
 * stays the same up to the rounding of float. Private to scenes/.
 */
#ifndef NEPH_SCENES_EVEN_LEVELS_H
#define NEPH_SCENES_EVEN_LEVELS_H

#include <stdbool.h>
#include <stddef.h>

/* Levels that are this part of their distance from even ones are even: coordinates in float. */
#define NEPH_EVEN_LEVELS_TOLERANCE 1e-3

struct neph_even_levels {
    int count;
    double first, spacing; /* of the centres of cells */
};

/* Cells along an axis, which ascend. */
struct neph_levels {
    const double *at;
    int count;     /* of cells; 2 or more levels, or 1 or more cells */
    bool are_ends; /* `at` has the count + 1 ends of the cells in place of their levels */
};

/* Whether levels are even. `*even` receives them, or the even cells for them: as thick as the
 * thinnest, if no more than `most` cells are needed. */
bool neph_are_levels_even(struct neph_levels levels, int most, struct neph_even_levels *even);

/* Resamples one axis of `values`, an array of `outer` times `levels.count` times `inner` numbers,
 * the last fastest, into `to`, with `even->count` in place of `levels.count`. Returns the relative
 * change of the sum of value times thickness; 0 without values. */
double neph_even_levels_resample(struct neph_levels levels, const struct neph_even_levels *even,
                                 size_t outer, size_t inner, const float *values, float *to);

#endif
