/* SPDX-License-Identifier: MIT
 *
 * The parameters of reading a volume file.
 */
#ifndef NEPH_SCENES_VOLUME_REQUEST_H
#define NEPH_SCENES_VOLUME_REQUEST_H

#include <stdbool.h>
#include <stddef.h>

/* Voxels by their indices in the file; `last` is inside. */
struct neph_volume_box {
    int first[3], last[3];
};

struct neph_volume_request {
    const char *path;
    /* Name of the file in messages: as the user wrote it, because `path` may contain the value of
     * an environment variable. NULL: the path. */
    const char *shown;
    const char *grid_name; /* of a .vdb; NULL: the only grid, or "density" */
    size_t memory_limit_bytes;
    bool is_z_up;                            /* (x, y, z) of the file becomes (x, z, -y) */
    const struct neph_volume_box *index_box; /* the voxels to read; NULL: the file's block */
    bool counts_zeros; /* active voxels of 0 are part of the block of a .vdb */
    bool is_fitted;    /* the block will be scaled to a size: refuse stray voxels that decide it */
};

#endif
