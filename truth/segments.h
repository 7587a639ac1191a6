/* SPDX-License-Identifier: MIT
 *
 * The stretches of a ray on each of which one number bounds the extinction of a medium: the cells
 * of a majorant grid, or scale heights of a shell.
 */
#ifndef NEPH_TRUTH_SEGMENTS_H
#define NEPH_TRUTH_SEGMENTS_H

#include "scenes/majorant.h"
#include "scenes/scene.h"

struct neph_segments {
    double t0_m, t1_m;     /* of the present stretch */
    double majorant_per_m; /* on it; of extinction_color 1 */
    double end_m;          /* of the last */
    struct neph_vec3 origin_m, direction;
    const struct neph_medium *medium;
    /* Grids. */
    const struct neph_majorants *majorants;
    int cell[3];
    double side_m[3], next_m[3];
    /* Shells: where the ray is lowest, and the radius there. */
    double nearest_m, low_m;
};

/* The first stretch of [0, end_m]; false when the ray misses the medium. `majorants` is NULL for
 * shells, which need none. */
bool neph_segments_start(struct neph_segments *segments, const struct neph_medium *medium,
                         const struct neph_majorants *majorants, struct neph_vec3 origin_m,
                         struct neph_vec3 direction, double end_m);

/* The next stretch; false after the last. */
bool neph_segments_next(struct neph_segments *segments);

#endif
