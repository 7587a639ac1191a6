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
    neph_hint(diag, "resample the volume to fewer nodes");
    return NEPH_ERR_INPUT;
}
