/* SPDX-License-Identifier: MIT
 *
 * A kind of medium: one file and one line of the table in media.c. Private to scenes/; other
 * folders use scenes/media.h, which also clips to the medium's bounds.
 */
#ifndef NEPH_SCENES_MEDIUM_KIND_H
#define NEPH_SCENES_MEDIUM_KIND_H

#include "scenes/cuts.h"
#include "scenes/fields.h"
#include "scenes/load_density.h"

/* Default number of cells of a majorant grid: good for a 64^3 cloud. */
#define NEPH_MAJORANT_CELLS (16 * 16 * 16)

/* A line parallel to an axis of the world, through this point. `begins_there`: it is a ray upwards
 * along the axis. `is_endless`: its optical depth is infinite. */
struct neph_column {
    struct neph_vec3 point_m;
    bool begins_there, is_endless;
};

/* A medium as written in a file: the target of the fields of forms. Some forms add members for the
 * voxels or textures that they create. */
struct neph_written_medium {
    struct neph_medium medium;
    struct neph_written_density density;
    int voxels; /* nodes along the longest side, for all engines; 0: the medium itself */
    const char *phase_table; /* a file */
    double bounds_turn_deg;
    int bounds_turn_axis; /* a word */
};

/* A form of a medium in a scene file: its key in the list, and the keys below that. */
struct neph_medium_form {
    const char *key, *note;
    const struct neph_field *fields; /* without the fields that all media have */
    size_t size; /* of the struct to read into, which begins with a neph_written_medium; 0: that */
    /* Refuses values that ranges do not exclude, creates owned memory. NULL: nothing to do. */
    enum neph_status (*finish)(struct neph_reader *reader, const yaml_node_t *node, void *written);
};

/* Number of forms of one kind. */
#define NEPH_MEDIUM_FORMS 3

struct neph_medium_row {
    struct neph_medium_facts facts;
    struct neph_medium_form forms[NEPH_MEDIUM_FORMS]; /* unused ones have no key */
    /* At a point inside the bounds. */
    double (*extinction_per_m)(const struct neph_medium *medium, struct neph_vec3 point_m);
    /* Over [t0, t1], t0 < t1, both inside the bounds; t1 may be +inf. */
    double (*optical_depth)(const struct neph_medium *medium, struct neph_vec3 origin_m,
                            struct neph_vec3 direction, double t0_m, double t1_m);
    /* An upper bound of the extinction in the box, which is inside the bounds. The caller adds a
     * margin for rounding. */
    double (*bound_per_m)(const struct neph_medium *medium, const struct neph_bounds *box);
    /* The region where the density is not negligible; ignores the bounds if it has a limit of its
     * own. */
    struct neph_bounds (*support)(const struct neph_medium *medium);
    /* A finite box for engines without unbounded media, and the largest error in transmittance that
     * it causes; the caller clips it to the bounds. NULL: the support, without error. */
    struct neph_bounds (*container)(const struct neph_scene *scene,
                                    const struct neph_medium *medium, double *cut_error);
    /* Splits a ray at the scale of the density, on the ray itself and in the shadow that the medium
     * casts on it. NULL: not needed by kinds that `exact` never renders. */
    void (*cut_scales)(struct neph_cuts *cuts, const struct neph_medium *medium);
    /* Splits a ray at the kinks of the density. There may be more than fit; bisection of the
     * quadrature covers those. NULL: none. */
    void (*cut_kinks)(struct neph_cuts *cuts, const struct neph_medium *medium);
    /* The densest column along an axis (scenes/column.h). NULL: not computed. */
    struct neph_column (*column)(const struct neph_medium *medium, int axis);
    /* Moves it with the wind, with the bounds where they move as well; may write to memory that
     * `medium` owns. NULL: it stays. */
    void (*drift)(struct neph_medium *medium, struct neph_vec3 by_m);
    /* Writes the values that change a rendered value, after those of all media. NULL: the fields of
     * the form. */
    void (*hash)(const struct neph_medium *medium, FILE *text);
    /* Frees owned memory. NULL: there is none, and `borrow` is NULL, too. */
    void (*destroy)(struct neph_medium *medium);
    /* Uses `room`, of `room_size` bytes, in place of owned memory, so that this copy can drift
     * independently; large data are borrowed. */
    void (*borrow)(struct neph_medium *medium, void *room);
    size_t room_size;
};

extern const struct neph_medium_row neph_medium_homogeneous, neph_medium_height_fog,
    neph_medium_gaussian, neph_medium_shell, neph_medium_grid, neph_medium_horizon,
    neph_medium_plume, neph_medium_tent;

const struct neph_medium_row *neph_medium_row(enum neph_medium_kind kind);

/* The key `bounds`, within NEPH_FAR_M or within NEPH_PLANET_M. Unbounded by default. */
extern const struct neph_record neph_bounds_record, neph_planet_bounds_record;

/* The container of fog: scenes/container.c. */
struct neph_bounds neph_fog_container(const struct neph_scene *scene,
                                      const struct neph_medium *medium, double *cut_error);

#endif
