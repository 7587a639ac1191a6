/* SPDX-License-Identifier: MIT
 *
 * What the readers of the file formats share. Private to scenes/volume_*.c.
 */
#ifndef NEPH_SCENES_VOLUME_FORMAT_H
#define NEPH_SCENES_VOLUME_FORMAT_H

#include "scenes/grid.h"

#include <stdio.h>

/* What a reader is asked for: the parameters of neph_volume_read(). */
struct neph_volume_request {
    const char *path;
    const char *grid_name; /* NULL: the only one, or "density" */
    size_t memory_limit_bytes;
    size_t file_bytes; /* of the file, which is a regular one */
};

/* Read one format into an unsealed grid. The dispatcher seals it, and names the file in the message
 * of any error. */
typedef enum neph_status neph_volume_reader(const struct neph_volume_request *request, FILE *file,
                                            struct neph_grid **grid, struct neph_diag *diag);

neph_volume_reader neph_volume_read_vdb;
neph_volume_reader neph_volume_read_df3;

/* NEPH_ERR_INPUT, in words, when so many nodes do not fit into the limit of the request. */
enum neph_status neph_volume_check_size(const struct neph_volume_request *request,
                                        const int size[3], struct neph_diag *diag);

#endif
