/* SPDX-License-Identifier: MIT
 *
 * The reader of .df3 volumes. (A separate program reads .vdb files and may crash.)
 */
#include "tests/fuzz/fuzz.h"

#include "scenes/volume_file.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const struct fuzz_file file = fuzz_file_make("fuzz.df3", data, size);
    struct neph_grid *grid = NULL;
    struct neph_diag diag = {0};
    const struct neph_volume_box box = {{0, 0, 0}, {1, 2, 0}};
    const bool is_part = size % 2 == 1;
    const struct neph_volume_request request = {.path = file.path,
                                                .memory_limit_bytes = (size_t)1 << 24,
                                                .is_z_up = is_part,
                                                .index_box = is_part ? &box : NULL};
    const enum neph_status status = neph_volume_read(&request, &grid, &diag);
    fuzz_require_outcome(status, &diag, grid);
    neph_grid_destroy(grid);
    fuzz_file_remove(&file);
    return 0;
}
