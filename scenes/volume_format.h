/* SPDX-License-Identifier: MIT
 *
 * Declarations that the readers of the file formats share. Private to scenes/volume_*.c.
 */
#ifndef NEPH_SCENES_VOLUME_FORMAT_H
#define NEPH_SCENES_VOLUME_FORMAT_H

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

#endif
