/* SPDX-License-Identifier: MIT
 *
 * The density of a medium in a scene file: extinction_per_m, or one of the other units of
 * scenes/density_units.h in its place. Private to scenes/.
 */
#ifndef NEPH_SCENES_LOAD_DENSITY_H
#define NEPH_SCENES_LOAD_DENSITY_H

#include "scenes/density_units.h"
#include "scenes/fields.h"

/* Default of each row extinction_per_m: the reader accepts the other units beside such a row. */
#define NEPH_OR_ANOTHER_DENSITY "needed, or another density"

struct neph_written_density {
    double values[NEPH_DENSITY_UNIT_COUNT]; /* in the units of their keys, but the extinction */
    struct neph_droplet_radii radii;
    int along;                   /* index of a word */
    bool radius_in_voxels;       /* the grid has extinctions for a density of 1 */
    enum neph_density_unit unit; /* the one that is given; set by neph_choose_density() */
};

/* The keys of the other units, for the table of keys. */
extern const struct neph_record neph_density_record;

/* Copies the fields of a record, and after them the keys of the other units if it has a row
 * extinction_per_m; they are read into the neph_written_density at offset `at`. Returns the number
 * of rows in `fields`, without a last row without key. */
int neph_gather_fields(const struct neph_field *own, size_t at, struct neph_field *fields);

/* After the mapping was read: finds the unit that is given. Refuses none, two of them, and keys of
 * droplets or directions that belong to another unit. Does nothing if one of the keys has an
 * error. */
enum neph_status neph_choose_density(const struct neph_reader *reader, const yaml_node_t *node,
                                     struct neph_written_density *density);

/* The first unit that the mapping has; NEPH_DENSITY_UNIT_COUNT: none. */
enum neph_density_unit neph_find_density(const struct neph_reader *reader, const yaml_node_t *node);

/* The axis of optical_depth_along: 0 x, 1 y, 2 z. */
int neph_density_axis(const struct neph_written_density *density);

#endif
