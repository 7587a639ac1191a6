/* SPDX-License-Identifier: MIT
 *
 * The protocol between neph and the program neph-vdb, which alone links OpenVDB.
 *
 * OpenVDB trusts its files: damaged ones make it crash, allocate without bound, or loop. So it runs
 * in a separate process with limits on memory and time, and neph checks all of its output:
 *     neph-vdb read  VOXELS FILE MEMORY_LIMIT_BYTES CPU_LIMIT_S SIDE_MAX USE INDEX_BOX [GRID]
 *     neph-vdb write VOXELS FILE UUID
 *
 * USE is "fit" when the size of the block of values that are not 0 decides the scale, "active" when
 * the block includes all active voxels, else "file". INDEX_BOX is "all", or the first and the last
 * voxel as "i,j,k,i,j,k".
 *
 * VOXELS is a path to memory of neph (memfd_create(2), through /proc), in this machine's byte
 * order. `read` fills it with a placement and then blocks that do not overlap; nodes outside all
 * blocks are
 * 0. `write` reads from it a placement and then all nodes, x fastest; all become active.
 *
 * Exit codes: sysexits(3); EX_DATAERR is the file's fault. The last line of stderr is the reason,
 * followed after a tab by the way out, if there is one.
 */
#ifndef NEPH_SCENES_VOLUME_VDB_H
#define NEPH_SCENES_VOLUME_VDB_H

#include <stdint.h>

struct neph_vdb_placement {
    double origin[3];  /* of node (0, 0, 0), in the unit of the file */
    double spacing[3]; /* along the axes of the index, > 0 */
    int64_t size[3];
    int32_t first[3];       /* index of node (0, 0, 0) in the file */
    int32_t axis[3];        /* axis i of the index lies along this axis of the file's world */
    int32_t is_reversed[3]; /* against that axis; write reads none of these */
};

struct neph_vdb_block {
    int32_t first[3], last[3]; /* nodes from the corner of the placement; last is included */
    int32_t is_uniform;        /* `value` everywhere; else the values follow, x fastest */
    float value;
};

#endif
