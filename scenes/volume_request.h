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

/* The density between nodes. */
enum neph_volume_interpolation {
    NEPH_INTERPOLATION_OF_FILE, /* constant cells, if the file has the ends of cells; else linear */
    NEPH_INTERPOLATION_TRILINEAR,
    NEPH_INTERPOLATION_CONSTANT,
    NEPH_INTERPOLATION_COUNT,
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
    const char *value_unit;         /* in place of that of the file; also of a text file */
    bool has_length_unit;           /* coordinates without a known unit of length are lengths */
    enum neph_density_unit density; /* for which the values must have a unit */
    const int *table_size;          /* the file is a table of numbers along x, y, z; NULL: not */
    enum neph_volume_interpolation interpolation;
    bool is_endless[3]; /* along x, y, z of the world */
    size_t memory_limit_bytes;
    bool is_z_up;                            /* (x, y, z) of the file becomes (x, z, -y) */
    const struct neph_volume_box *index_box; /* the voxels to read; NULL: the file's block */
    bool counts_zeros; /* active voxels of 0 are part of the block of a .vdb */
    bool is_fitted;    /* the block will be scaled to a size: refuse stray voxels that decide it */
};

#endif
