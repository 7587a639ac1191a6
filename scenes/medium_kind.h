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
    /* No smaller than the extinction anywhere in the box, of which all lies inside the bounds. The
     * caller adds a margin for rounding. */
    double (*bound_per_m)(const struct neph_medium *medium, const struct neph_bounds *box);
    /* Carry it along with the wind, its bounds too where they are its own; what `medium` owns may
     * be written. NULL: it stays. */
    void (*drift)(struct neph_medium *medium, struct neph_vec3 by_m);
    /* Where the density is not negligible, the bounds not considered unless it is all there is. */
    struct neph_bounds (*support)(const struct neph_medium *medium);
    /* A finite box for engines without unbounded media, and the largest error in transmittance that
     * the box makes; it need not be cut to the bounds. NULL: the support, which loses nothing. */
    struct neph_bounds (*container)(const struct neph_scene *scene,
                                    const struct neph_medium *medium, double *cut_error);
};

extern const struct neph_medium_kind_ops neph_medium_fog, neph_medium_gaussian, neph_medium_shell,
    neph_medium_grid, neph_medium_horizon;

/* The part of `a` that lies in `b`; where nothing does, a minimum is above its maximum. */
struct neph_bounds neph_bounds_intersect(struct neph_bounds a, struct neph_bounds b);

/* The place of a box that is nearest to a point. */
struct neph_vec3 neph_bounds_nearest(const struct neph_bounds *box, struct neph_vec3 point_m);

/* Both corners moved; infinite sides stay. */
struct neph_bounds neph_bounds_moved(struct neph_bounds bounds, struct neph_vec3 by_m);

/* The box around a ball. */
struct neph_bounds neph_bounds_around(struct neph_vec3 center_m, double radius_m);

/* The container of fog: scenes/container.c. */
struct neph_bounds neph_fog_container(const struct neph_scene *scene,
                                      const struct neph_medium *medium, double *cut_error);

#endif
