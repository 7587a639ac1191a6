/* SPDX-License-Identifier: MIT
 *
 * The protocol between neph and the program neph-netcdf, which alone links NetCDF; it is built
 * where that library is. As OpenVDB (volume_vdb.h), NetCDF and HDF5 trust their files, so the
 * program runs with limits on memory and time, and neph checks all of its output:
 *     neph-netcdf read VOXELS FILE MEMORY_LIMIT_BYTES CPU_LIMIT_S SIDE_MAX TIME AXES INDEX_BOX
 *                 VARIABLE [RADIUS]
 *
 * TIME is an index from 0 on, or -1: not given. AXES are the dimensions along x, y, z, separated by
 * commas; "-": the last three of the variable, which are z, y, x by the CF conventions. INDEX_BOX
 * is "all", or the first and the last index along x, y, z as "i,j,k,i,j,k". VARIABLE "-": the only
 * one with three dimensions.
 *
 * VOXELS is memory of neph, as for neph-vdb. It receives a header, the coordinates along x, y, z in
 * double, and the values of VARIABLE and RADIUS in float, x fastest. Packed values are unpacked
 * (scale_factor, add_offset); a variable with missing values is refused.
 *
 * Exit codes and the reason of a failure: as those of neph-vdb.
 */
#ifndef NEPH_SCENES_VOLUME_NETCDF_H
#define NEPH_SCENES_VOLUME_NETCDF_H

#include <stdint.h>

enum { NEPH_NETCDF_TEXT_SIZE = 64 };

/* A unit is the attribute `units`, "" where there is none; texts end in a 0 and may be cut. */
struct neph_netcdf_axis {
    char name[NEPH_NETCDF_TEXT_SIZE], unit[NEPH_NETCDF_TEXT_SIZE];
    int64_t size;
    int64_t has_coordinates; /* else they are indices */
};

struct neph_netcdf_header {
    struct neph_netcdf_axis axes[3];
    char names[2][NEPH_NETCDF_TEXT_SIZE], units[2][NEPH_NETCDF_TEXT_SIZE];
    int64_t variable_count; /* 1, or 2 with the radii */
};

#endif
