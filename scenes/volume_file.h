/* SPDX-License-Identifier: MIT
 *
 * Volumes from and to files: OpenVDB (.vdb; float or half grids whose transform is a scale and a
 * translation) and POV-Ray density files (.df3; 8, 16 or 32 bits). Axes in files are the world's:
 * x, y, z of the file are x, y, z here, in the file's own unit of length.
 */
#ifndef NEPH_SCENES_VOLUME_FILE_H
#define NEPH_SCENES_VOLUME_FILE_H

#include "scenes/grid.h"

/* Read a volume into a grid in the file's own coordinates (index space scaled and moved by the
 * file's transform; a .df3 fills the unit cube: node i at (i + 0.5) / size). The grid covers the
 * active voxels of a .vdb. `grid_name` is for .vdb alone; NULL: the only grid, or "density".
 *
 * `shown` is what messages call the file: as the user wrote it, since `path` may hold more than
 * that (the value of an environment variable). Every error names the file so, and what is wrong
 * with it: not readable, truncated, says it is larger than it is, no such grid (lists those there
 * are), not a float or half grid, rotated or sheared, NaN, infinite or negative values, larger than
 * `memory_limit_bytes` of float nodes (NEPH_ERR_INPUT). Memory stays below the limit plus the tree
 * of the file. */
enum neph_status neph_volume_read(const char *path, const char *shown, const char *grid_name,
                                  size_t memory_limit_bytes, struct neph_grid **grid,
                                  struct neph_diag *diag);

/* The names of the extensions that neph_volume_read() knows: ".vdb", ".df3". */
bool neph_volume_has_known_extension(const char *path);

/* The path of the program that reads and writes .vdb for us, for the caller to free: what the
 * variable NEPH_VDB names, or neph-vdb beside the running program, or where it was built.
 * NEPH_ERR_UNAVAILABLE: it is not there. */
enum neph_status neph_volume_find_openvdb(char **program, struct neph_diag *diag);

/* Where a .vdb puts the nodes. */
enum neph_vdb_layout {
    /* OpenVDB's own convention: axes of the world, the transform takes the index of a node to its
     * position, and exactly the nodes are active. Reads back as the same grid, to the bit. */
    NEPH_VDB_WORLD,
    /* What Blender 3.4 (Cycles) renders as the same density in its coordinates (x, -z, y): it takes
     * the value of index i to be at transform(i + 0.5), so the transform takes 0 to the lower
     * corner of the voxel; and it cuts the volume to active voxels, so that the ramp from the
     * outermost nodes down to 0 is kept alive by one more layer of active voxels of 1e-9 on every
     * side. */
    NEPH_VDB_BLENDER,
    NEPH_VDB_LAYOUT_COUNT,
};

/* Write a sealed grid as .vdb (float, zip, a fog volume named "density"). The same grid gives the
 * same bytes. Whole or not at all. */
enum neph_status neph_volume_write_vdb(const char *path, const struct neph_grid *grid,
                                       enum neph_vdb_layout layout, struct neph_diag *diag);

/* Write the values of a sealed grid / its maximum as a 32-bit .df3, with one layer of zeros on
 * every side (size + 2): POV-Ray puts node i of N, trilinear, at i / N of the unit cube and wraps
 * from the last to the first. So `scale (size + 2) * spacing translate origin - spacing` puts it in
 * place, and the maximum belongs into the scattering colour. Whole or not at all. */
enum neph_status neph_volume_write_df3(const char *path, const struct neph_grid *grid,
                                       struct neph_diag *diag);

/* One of the two above, by the extension; a .vdb as NEPH_VDB_WORLD. NEPH_ERR_INPUT: neither. */
enum neph_status neph_volume_write(const char *path, const struct neph_grid *grid,
                                   struct neph_diag *diag);

#endif
