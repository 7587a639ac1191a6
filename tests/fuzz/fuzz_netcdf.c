/* SPDX-License-Identifier: MIT
 *
 * The output of neph-netcdf, whatever it contains. (A separate program reads .nc files and may
 * crash.) The parity of the size decides whether there are effective radii.
 */
#include "tests/fuzz/fuzz.h"

#include "scenes/volume_format.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct neph_grid *grid = NULL;
    struct neph_diag diag = {0};
    const struct neph_volume_request request = {
        .path = "fuzz.nc",
        .radius_name = size % 2 == 1 ? "re" : NULL,
        .density = size % 2 == 1 ? NEPH_DENSITY_WATER : NEPH_DENSITY_EXTINCTION,
        .droplets = {.unit = NEPH_DENSITY_WATER},
        .memory_limit_bytes = (size_t)1 << 22,
    };
    const enum neph_status status = neph_volume_take_netcdf(&request, data, size, &grid, &diag);
    fuzz_require_outcome(status, &diag, grid);
    fuzz_require(status == NEPH_OK || status == NEPH_ERR_INPUT, "the output is at fault");
    if (grid) {
        const enum neph_status sealed = neph_grid_seal(grid, &diag);
        fuzz_require(sealed == NEPH_OK || diag.message[0], "a failure says why");
    }
    neph_grid_destroy(grid);
    return 0;
}
