/* SPDX-License-Identifier: MIT
 *
 * Volumes from and to files: OpenVDB (.vdb; float or half grids; scale, translation, rotations by
 * multiples of 90 degrees, and mirrors) and POV-Ray density files (.df3; 8, 16 or 32 bits); from
 * NetCDF files of simulations (.nc; scenes/volume_netcdf.h), and from text files of radiation codes
 * (.dat, .lwc, .txt, and any with `table_size`; scenes/volume_text.c).
 */
#ifndef NEPH_SCENES_VOLUME_FILE_H
#define NEPH_SCENES_VOLUME_FILE_H

#include "scenes/grid.h"
#include "scenes/volume_request.h"

/* Reads a volume into a grid in the file's own unit of length, along the axes of the world.
 *
 * The block of voxels is `index_box` where it is given. Else the block of a .vdb is the smallest
 * box around the active voxels that are not 0, or around all active voxels (with `counts_zeros`, or
 * if all of them are 0); the transform of the file places it. The block of a .df3 is all of its
 * nodes, zeros included: 1 apart, the first at the origin, because the format has no transform. The
 * block of a .nc or a text is all of its nodes, in metres at their coordinates; uneven levels
 * become even ones (scenes/even_levels.h). A table has the block of a .df3. With `radius_name` each
 * value becomes its extinction.
 *
 * NEPH_ERR_INPUT; each message names the file and the fault:
 * - it is not readable, truncated, or declares a larger size than it has,
 * - it has no such grid, or several of that name (the message lists the grids), or not a float or
 *   half grid,
 * - it is rotated by angles other than multiples of 90 degrees, or sheared,
 * - it has NaN, infinite, negative or missing values,
 * - of a text: a line, whose number is named, is not as its format has it, or a voxel has two,
 * - of a .nc: the unit of values or coordinates is unknown, coordinates do not ascend or descend,
 * - a side is longer than NEPH_GRID_SIDE_MAX, or the nodes need more than `memory_limit_bytes`,
 * - for a fitted block: stray voxels decide its size.
 * Memory stays below the limit plus the tree of the file. */
enum neph_status neph_volume_read(const struct neph_volume_request *request,
                                  struct neph_grid **grid, struct neph_diag *diag);

/* Whether the file's format, by its extension, defines size and place of a voxel. */
bool neph_volume_has_transform(const char *path);

/* Whether the file is NetCDF, by its extension. */
bool neph_volume_is_netcdf(const char *path);

/* Whether the file is a text with a header, by its extension. */
bool neph_volume_is_text(const char *path);

/* Whether neph_volume_read() knows the extension: ".vdb", ".df3", ".nc", ".dat", ".lwc", ".txt". */
bool neph_volume_has_known_extension(const char *path);

/* The path of the program that reads and writes .vdb files; the caller frees it. It is the value of
 * the variable NEPH_VDB, else neph-vdb beside the running program, else the place where it was
 * built. NEPH_ERR_UNAVAILABLE: no such program. */
enum neph_status neph_volume_find_openvdb(char **program, struct neph_diag *diag);

/* The path of the program that reads .nc files, from NEPH_NETCDF or beside the running program, as
 * neph_volume_find_openvdb() finds the other. NEPH_ERR_UNAVAILABLE: no such program. */
enum neph_status neph_volume_find_netcdf(char **program, struct neph_diag *diag);

/* Conventions for the nodes in a .vdb. */
enum neph_vdb_layout {
    /* OpenVDB's own convention: axes of the world, the transform maps the index of a node to its
     * position, and exactly the nodes are active. Read back, the grid is equal bit by bit. */
    NEPH_VDB_WORLD,
    /* Blender 3.4 (Cycles) renders this as the same density in its coordinates (x, -z, y). Blender
     * assumes the value of index i at transform(i + 0.5), so the transform maps 0 to the lower
     * corner of the voxel. It clips the volume to active voxels, so one more layer of active voxels
     * of 1e-9 on every side keeps the ramp from the outermost nodes to 0. */
    NEPH_VDB_BLENDER,
    NEPH_VDB_LAYOUT_COUNT,
};

/* Writes a sealed grid as .vdb (float, zip, a fog volume named "density"). The same grid gives the
 * same bytes. The file is complete or absent. */
enum neph_status neph_volume_write_vdb(const char *path, const struct neph_grid *grid,
                                       enum neph_vdb_layout layout, struct neph_diag *diag);

/* Writes the values of a sealed grid / its maximum as a 32-bit .df3, with one layer of zeros on
 * every side (size + 2): POV-Ray puts node i of N, trilinear, at i / N of the unit cube and wraps
 * from the last to the first. The placement in POV-Ray is `scale (size + 2) * spacing translate
 * origin - spacing`, and the maximum is a factor of the scattering colour. In a scene file it is a
 * volume with `size_m` (size + 2) * spacing, and `center_m` at the centre of the nodes. The file is
 * complete or absent. */
enum neph_status neph_volume_write_df3(const char *path, const struct neph_grid *grid,
                                       struct neph_diag *diag);

/* Writes either format, by the extension; a .vdb as NEPH_VDB_WORLD. NEPH_ERR_INPUT: another one. */
enum neph_status neph_volume_write(const char *path, const struct neph_grid *grid,
                                   struct neph_diag *diag);

#endif
