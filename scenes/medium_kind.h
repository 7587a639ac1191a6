/* SPDX-License-Identifier: MIT
 *
 * A kind of medium: one file and one line of the table in media.c. Private to scenes/; others ask
 * through scenes/media.h, which also cuts to the medium's bounds.
 */
#ifndef NEPH_SCENES_MEDIUM_KIND_H
#define NEPH_SCENES_MEDIUM_KIND_H

#include "scenes/cuts.h"
#include "scenes/fields.h"

/* Cells of a majorant grid where nothing else was measured: good for a 64^3 cloud. */
#define NEPH_MAJORANT_CELLS (16 * 16 * 16)

/* What a file says of a medium: where the fields of forms lead to. Some add what is made into
 * voxels or textures. */
struct neph_written_medium {
    struct neph_medium medium;
    int voxels; /* nodes along the longest side, for all engines; 0: the medium itself */
};

/* A way to write a medium in a scene file: its key in the list, and the keys below that. */
struct neph_medium_form {
    const char *key, *note;
    const struct neph_field *fields; /* without those that all media have */
    size_t size; /* of the struct to read into, which begins with a neph_written_medium; 0: that */
    /* Refuse what ranges do not cover, make what the medium owns. NULL: nothing to do. */
    enum neph_status (*finish)(struct neph_reader *reader, const yaml_node_t *node, void *written);
};

/* Ways to write one kind. */
#define NEPH_MEDIUM_FORMS 3

struct neph_medium_row {
    struct neph_medium_facts facts;
    struct neph_medium_form forms[NEPH_MEDIUM_FORMS]; /* without a key: none */
    /* At a point inside the bounds. */
    double (*extinction_per_m)(const struct neph_medium *medium, struct neph_vec3 point_m);
    /* Over [t0, t1], t0 < t1, both inside the bounds; t1 may be +inf. */
    double (*optical_depth)(const struct neph_medium *medium, struct neph_vec3 origin_m,
                            struct neph_vec3 direction, double t0_m, double t1_m);
    /* No smaller than the extinction anywhere in the box, of which all lies inside the bounds. The
     * caller adds a margin for rounding. */
    double (*bound_per_m)(const struct neph_medium *medium, const struct neph_bounds *box);
    /* Where the density is not negligible, the bounds not considered unless it is all there is. */
    struct neph_bounds (*support)(const struct neph_medium *medium);
    /* A finite box for engines without unbounded media, and the largest error in transmittance that
     * the box makes; it need not be cut to the bounds. NULL: the support, which loses nothing. */
    struct neph_bounds (*container)(const struct neph_scene *scene,
                                    const struct neph_medium *medium, double *cut_error);
    /* Cut a ray at the scale of the density, on the ray itself and in the shadow that the medium
     * throws on it. NULL: what is never exact needs none. */
    void (*cut_scales)(struct neph_cuts *cuts, const struct neph_medium *medium);
    /* Cut a ray where the density has kinks in great number: what does not fit is left to the
     * halving of the quadrature. NULL: none. */
    void (*cut_kinks)(struct neph_cuts *cuts, const struct neph_medium *medium);
    /* Carry it along with the wind, its bounds too where they are its own; what `medium` owns may
     * be written. NULL: it stays. */
    void (*drift)(struct neph_medium *medium, struct neph_vec3 by_m);
    /* What changes a rendered value, after what all media have. NULL: the fields of the form. */
    void (*hash)(const struct neph_medium *medium, FILE *text);
    /* Free what it owns. NULL: nothing, and then `borrow` is NULL, too. */
    void (*destroy)(struct neph_medium *medium);
    /* Use `room`, of `room_size` bytes, in place of what it owns, so that it can drift by itself;
     * large data are borrowed. */
    void (*borrow)(struct neph_medium *medium, void *room);
    size_t room_size;
};

extern const struct neph_medium_row neph_medium_homogeneous, neph_medium_height_fog,
    neph_medium_gaussian, neph_medium_shell, neph_medium_grid, neph_medium_horizon,
    neph_medium_plume, neph_medium_tent;

const struct neph_medium_row *neph_medium_row(enum neph_medium_kind kind);

/* `bounds`, within NEPH_FAR_M and within NEPH_PLANET_M. Unbounded when left out. */
extern const struct neph_record neph_bounds_record, neph_planet_bounds_record;

/* The container of fog: scenes/container.c. */
struct neph_bounds neph_fog_container(const struct neph_scene *scene,
                                      const struct neph_medium *medium, double *cut_error);

#endif
