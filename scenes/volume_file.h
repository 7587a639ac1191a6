/* SPDX-License-Identifier: MIT
 *
 * Volumes from and to files: OpenVDB (.vdb; float or half grids, placed by scale, translation,
 * turns by 90 degrees and mirrors) and POV-Ray density files (.df3; 8, 16 or 32 bits).
 */
#ifndef NEPH_SCENES_VOLUME_FILE_H
#define NEPH_SCENES_VOLUME_FILE_H

#include "scenes/grid.h"
#include "scenes/volume_request.h"

/* Read a volume into a grid in the file's own unit of length, along the axes of the world.
 *
 * The block of voxels is `index_box` where it is given. Else the block of a .vdb is the smallest
 * box around the active voxels that are not 0, or around all active voxels (with `counts_zeros`, or
 * if all of them are 0); the transform of the file places it. The block of a .df3 is all of its
 * nodes, zeros included: 1 apart, the first at the origin, because the format has no transform.
 *
 * Every error names the file, and what is wrong with it: not readable, truncated, says it is larger
 * than it is, no such grid or several of that name (lists those there are), not a float or half
 * grid, turned by other angles than 90 degrees or sheared, NaN, infinite or negative values, a side
 * of more than NEPH_GRID_SIDE_MAX, more nodes than `memory_limit_bytes` holds, and, for a fitted
 * block, stray voxels that decide its size (NEPH_ERR_INPUT). Memory stays below the limit plus the
 * tree of the file. */
enum neph_status neph_volume_read(const struct neph_volume_request *request,
                                  struct neph_grid **grid, struct neph_diag *diag);

/* Whether the format of the file, by its extension, says how large a voxel is and where. */
bool neph_volume_has_transform(const char *path);

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
 * place, and the maximum belongs into the scattering colour. In a scene file a volume with `size_m`
 * (size + 2) * spacing, and `center_m` in the middle of the nodes, puts it in place. Whole or not
 * at all. */
enum neph_status neph_volume_write_df3(const char *path, const struct neph_grid *grid,
                                       struct neph_diag *diag);

/* One of the two above, by the extension; a .vdb as NEPH_VDB_WORLD. NEPH_ERR_INPUT: neither. */
enum neph_status neph_volume_write(const char *path, const struct neph_grid *grid,
                                   struct neph_diag *diag);

#endif
