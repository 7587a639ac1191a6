/* SPDX-License-Identifier: MIT
 *
 * What every kind of medium can do: one file and one row of the table in media.c each. Private to
 * scenes/; others ask through scenes/media.h, which also cuts to the medium's bounds.
 */
#ifndef NEPH_SCENES_MEDIUM_KIND_H
#define NEPH_SCENES_MEDIUM_KIND_H

#include "scenes/media.h"

struct neph_medium_kind_ops {
    const char *name; /* for people */
    bool closed_form; /* see neph_medium_has_closed_form */
    /* At a point inside the bounds. */
    double (*extinction_per_m)(const struct neph_medium *medium, struct neph_vec3 point_m);
    /* Over [t0, t1], t0 < t1, both inside the bounds; t1 may be +inf. */
    double (*optical_depth)(const struct neph_medium *medium, struct neph_vec3 origin_m,
                            struct neph_vec3 direction, double t0_m, double t1_m);
    /* No smaller than the extinction anywhere in the box, of which all lies inside the bounds. */
    double (*bound_per_m)(const struct neph_medium *medium, const struct neph_bounds *box);
    /* Where the density is not negligible, the bounds not considered unless it is all there is. */
    struct neph_bounds (*support)(const struct neph_medium *medium);
};

extern const struct neph_medium_kind_ops neph_medium_fog, neph_medium_gaussian, neph_medium_shell,
    neph_medium_grid;

#endif
