/* SPDX-License-Identifier: MIT
 *
 * The parameters of reading a volume file.
 */
#ifndef NEPH_SCENES_VOLUME_REQUEST_H
#define NEPH_SCENES_VOLUME_REQUEST_H

#include "scenes/droplet_voxels.h"

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
    const char *grid_name;               /* of a .vdb; NULL: the only grid, or "density" */
    const char *radius_name;             /* a second grid, of effective radii; NULL: none */
    struct neph_droplet_voxels droplets; /* with it: the values become extinctions */
    /* Only of NetCDF files; NULL: not given. */
    const char *axes;               /* names of the dimensions along x, y, z, separated by commas */
    const int *time_index;          /* the place along another dimension */
    const char *value_unit;         /* in place of the attribute `units` */
    bool has_length_unit;           /* coordinates without a known unit of length are lengths */
    enum neph_density_unit density; /* for which the values must have a unit */
    size_t memory_limit_bytes;
    bool is_z_up;                            /* (x, y, z) of the file becomes (x, z, -y) */
    const struct neph_volume_box *index_box; /* the voxels to read; NULL: the file's block */
    bool counts_zeros; /* active voxels of 0 are part of the block of a .vdb */
    bool is_fitted;    /* the block will be scaled to a size: refuse stray voxels that decide it */
};

#endif
