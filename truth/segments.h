/* SPDX-License-Identifier: MIT
 *
 * Divides a ray into segments with one bound of a medium's extinction each: the cells of a majorant
 * grid, or scale heights of a shell.
 */
#ifndef NEPH_TRUTH_SEGMENTS_H
#define NEPH_TRUTH_SEGMENTS_H

#include "scenes/majorant.h"
#include "scenes/scene.h"

struct neph_segments {
    double t0_m, t1_m;     /* of the current segment */
    double majorant_per_m; /* bound for extinction_color 1 */
    double end_m;          /* end of the last segment */
    struct neph_vec3 origin_m, direction;
    const struct neph_medium *medium;
    /* For grids. */
    const struct neph_majorants *majorants;
    int cell[3];
    double side_m[3], next_m[3];
    /* For shells: position and radius of the ray's lowest point. */
    double nearest_m, low_m;
};

/* Start with the first segment of [0, end_m]; false: the ray misses the medium. `majorants` is NULL
 * for shells, which need none. */
bool neph_segments_start(struct neph_segments *segments, const struct neph_medium *medium,
                         const struct neph_majorants *majorants, struct neph_vec3 origin_m,
                         struct neph_vec3 direction, double end_m);

/* Advance to the next segment; false after the last one. */
bool neph_segments_next(struct neph_segments *segments);

#endif
