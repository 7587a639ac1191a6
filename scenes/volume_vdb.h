/* SPDX-License-Identifier: MIT
 *
 * Between neph and the program neph-vdb, the only one that knows OpenVDB.
 *
 * OpenVDB trusts its files: damaged ones make it crash, allocate without bound, or loop. So it runs
 * in a process of its own, with limits on memory and time, and neph believes nothing that it says:
 *
 *     neph-vdb read  VOXELS FILE MEMORY_LIMIT_BYTES CPU_LIMIT_S [GRID]
 *     neph-vdb write VOXELS FILE UUID
 *
 * VOXELS is a path to memory of neph (memfd_create(2), seen through /proc), in this machine's byte
 * order. read fills it with a placement and then blocks that do not overlap; what no block covers
 * is 0. write takes from it a placement and then all nodes, x fastest; all become active.
 *
 * Exit codes: sysexits(3); EX_DATAERR is the file's fault. The last line of stderr says why.
 */
#ifndef NEPH_SCENES_VOLUME_VDB_H
#define NEPH_SCENES_VOLUME_VDB_H

#include <stdint.h>

struct neph_vdb_placement {
    double origin[3]; /* of node (0, 0, 0), in the unit of the file */
    double spacing[3];
    int64_t size[3];
};

struct neph_vdb_block {
    int32_t first[3], last[3]; /* nodes, counted from the corner of the placement; last is inside */
    int32_t is_uniform;        /* `value` everywhere; else the values follow, x fastest */
    float value;
};

#endif
