/* SPDX-License-Identifier: MIT
 *
 * What a reader of volume files is asked for.
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
    /* What messages call the file: as the user wrote it, since `path` may hold more than that (the
     * value of an environment variable). NULL: the path. */
    const char *shown;
    const char *grid_name; /* of a .vdb; NULL: the only grid, or "density" */
    size_t memory_limit_bytes;
    bool is_z_up;                            /* (x, y, z) of the file becomes (x, z, -y) */
    const struct neph_volume_box *index_box; /* which voxels to read; NULL: the file's block */
    bool counts_zeros; /* active voxels of 0 are part of the block of a .vdb */
    bool is_fitted;    /* the block will be scaled to a size: stray voxels must not decide it */
};

#endif
