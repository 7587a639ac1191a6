/* SPDX-License-Identifier: MIT
 *
 * Declarations that the readers of the file formats share. Private to scenes/volume_*.c.
 */
#ifndef NEPH_SCENES_VOLUME_FORMAT_H
#define NEPH_SCENES_VOLUME_FORMAT_H

#include "scenes/even_levels.h"
#include "scenes/grid.h"
#include "scenes/volume_request.h"
#include "scenes/volume_turn.h"

#include <stdio.h>

/* An open regular file. */
struct neph_volume_source {
    FILE *file;
    size_t size_bytes;
};

/* Reads one format into an unsealed grid. The dispatcher seals it, and adds the file's name to the
 * message of any error. */
typedef enum neph_status neph_volume_reader(const struct neph_volume_request *request,
                                            const struct neph_volume_source *source,
                                            struct neph_grid **grid, struct neph_diag *diag);

neph_volume_reader neph_volume_read_vdb;
neph_volume_reader neph_volume_read_df3;
neph_volume_reader neph_volume_read_netcdf;
neph_volume_reader neph_volume_read_text;

/* The grid of what neph-netcdf wrote (volume_netcdf.h), whatever it contains. */
enum neph_status neph_volume_take_netcdf(const struct neph_volume_request *request,
                                         const void *bytes, size_t size, struct neph_grid **grid,
                                         struct neph_diag *diag);

/* NEPH_ERR_INPUT, in words, when these nodes exceed the memory limit of the request. */
enum neph_status neph_volume_check_size(const struct neph_volume_request *request,
                                        const int size[3], struct neph_diag *diag);

/* A grid of zeros for a block in the order of the file. The transform of the file turns its axes by
 * `turn` and puts its first node at `origin`; `is_z_up` of the request is applied after that.
 * `turned` receives the indices of the values. Errors: neph_volume_check_size(),
 * neph_grid_create(). */
enum neph_status neph_volume_create_grid(const struct neph_volume_request *request,
                                         const struct neph_axis_turn *turn,
                                         const struct neph_block *block,
                                         struct neph_turned_block *turned, struct neph_grid **grid,
                                         struct neph_diag *diag);

/* The block of the request, or all of a file of this size. NEPH_ERR_INPUT: it reaches beyond. */
enum neph_status neph_volume_find_box(const struct neph_volume_request *request, const int size[3],
                                      struct neph_volume_box *box, struct neph_diag *diag);

/* The factor from a file's unit of values to that of the density of the request; `value_unit` of
 * the request stands in place of it. NEPH_ERR_INPUT: it is not of that density. `name`: of the
 * values, for messages. */
enum neph_status neph_volume_find_unit(const struct neph_volume_request *request, const char *name,
                                       const char *unit, double *factor, struct neph_diag *diag);

/* An axis of a block of values, x fastest, and its cells [m]. */
struct neph_volume_levels {
    int axis;
    struct neph_levels levels;
    const char *name; /* for the note */
};

/* Makes the levels of an axis even: replaces `*values` and `size[axis]` where they are not, and
 * adds to the note. Errors: neph_volume_check_size(). */
enum neph_status neph_volume_make_even(const struct neph_volume_request *request,
                                       const struct neph_volume_levels *levels, int size[3],
                                       float **values, struct neph_even_levels *even,
                                       char note[NEPH_GRID_NOTE_SIZE], struct neph_diag *diag);

/* The grid of a block of values, x fastest: neph_volume_create_grid() and a copy. */
enum neph_status neph_volume_make_grid(const struct neph_volume_request *request, const int size[3],
                                       const double first[3], const double spacing[3],
                                       const float *values, const char note[NEPH_GRID_NOTE_SIZE],
                                       struct neph_grid **grid, struct neph_diag *diag);

#endif
