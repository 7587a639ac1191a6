/* SPDX-License-Identifier: MIT
 *
 * The reader of text files of radiation codes. The bits of the first byte, a part of the file,
 * decide how it is read: with radii, as extinction, or as a table.
 */
#include "tests/fuzz/fuzz.h"

#include "scenes/volume_file.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const int table_size[3] = {3, 2, 1};
    static const struct neph_volume_box box = {{0, 0, 0}, {1, 0, 1}};
    const unsigned bits = size > 0 ? data[0] : 0;
    const struct fuzz_file file = fuzz_file_make("fuzz.dat", data, size);
    const bool has_radii = bits & 1;
    const struct neph_volume_request request = {
        .path = file.path,
        .radius_name = has_radii ? "reff" : NULL,
        .density = has_radii || bits & 2 ? NEPH_DENSITY_WATER : NEPH_DENSITY_EXTINCTION,
        .droplets = {.unit = NEPH_DENSITY_WATER},
        .table_size = (bits & 12) == 12 ? table_size : NULL,
        .index_box = (bits & 12) == 8 ? &box : NULL,
        .memory_limit_bytes = (size_t)1 << 20,
        .is_z_up = true,
    };
    struct neph_grid *grid = NULL;
    struct neph_diag diag = {0};
    const enum neph_status status = neph_volume_read(&request, &grid, &diag);
    fuzz_require_outcome(status, &diag, grid);
    fuzz_require(status == NEPH_OK || status == NEPH_ERR_INPUT, "the file is at fault");
    neph_grid_destroy(grid);
    fuzz_file_remove(&file);
    return 0;
}
