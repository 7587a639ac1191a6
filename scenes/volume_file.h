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
 * Every error names the file and what is wrong with it: not readable, truncated, says it is larger
 * than it is, no such grid (lists those there are), not a float or half grid, rotated or sheared,
 * NaN, infinite or negative values, larger than `memory_limit_bytes` of float nodes
 * (NEPH_ERR_INPUT). Memory stays below the limit plus the tree of the file. */
enum neph_status neph_volume_read(const char *path, const char *grid_name,
                                  size_t memory_limit_bytes, struct neph_grid **grid,
                                  struct neph_diag *diag);

/* The names of the extensions that neph_volume_read() knows: ".vdb", ".df3". */
bool neph_volume_has_known_extension(const char *path);

/* Write .vdb (float, zip) with a grid named "density" whose transform puts node (0,0,0) at origin.
 * The outermost layer of zeros that the density falls to beyond the nodes is written as active
 * voxels of 1e-9, so that engines that clip to active voxels do not cut the ramp. */
enum neph_status neph_volume_write_vdb(const char *path, const struct neph_grid *grid,
                                       struct neph_diag *diag);

/* Write a 32-bit .df3 of values / maximum, with one layer of zeros on every side. */
enum neph_status neph_volume_write_df3(const char *path, const struct neph_grid *grid,
                                       struct neph_diag *diag);

#endif
