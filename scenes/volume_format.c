/* SPDX-License-Identifier: MIT */
#include "scenes/volume_format.h"

enum neph_status neph_volume_check_size(const struct neph_volume_request *request,
                                        const int size[3], struct neph_diag *diag)
{
    const double nodes = (double)size[0] * size[1] * size[2];
    if (nodes * sizeof(float) <= (double)request->memory_limit_bytes)
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_INPUT,
              "%d x %d x %d nodes need %.0f MiB of memory, and the limit is %.0f MiB", size[0],
              size[1], size[2], nodes * sizeof(float) / 0x1p20,
              (double)request->memory_limit_bytes / 0x1p20);
    neph_hint(diag, "resample the volume to fewer nodes, or read a part of it: index_box");
    return NEPH_ERR_INPUT;
}

enum neph_status neph_volume_create_grid(const struct neph_volume_request *request,
                                         const struct neph_axis_turn *turn,
                                         const struct neph_block *block,
                                         struct neph_turned_block *turned, struct neph_grid **grid,
                                         struct neph_diag *diag)
{
    enum neph_status status = neph_volume_check_size(request, block->size, diag);
    if (status)
        return status;
    const struct neph_axis_turn *up = request->is_z_up ? &neph_axis_turn_z_up
                                                       : &neph_axis_turn_none;
    const struct neph_axis_turn whole = neph_axis_turn_join(turn, up);
    struct neph_block placed = *block;
    placed.origin = neph_axis_turn_point(up, block->origin);
    *turned = neph_axis_turn_block(&whole, &placed);
    return neph_grid_create(turned->block.size, turned->block.origin, turned->block.spacing, grid,
                            diag);
}
