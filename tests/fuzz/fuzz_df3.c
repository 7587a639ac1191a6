/* SPDX-License-Identifier: MIT
 *
 * The reader of .df3 volumes. (.vdb is read by a program of its own, which may crash.)
 */
#include "tests/fuzz/fuzz.h"

#include "scenes/volume_file.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const struct fuzz_file file = fuzz_file_make("fuzz.df3", data, size);
    struct neph_grid *grid = NULL;
    struct neph_diag diag = {0};
    const enum neph_status status = neph_volume_read(file.path, file.path, NULL, (size_t)1 << 24,
                                                     &grid, &diag);
    fuzz_require_outcome(status, &diag, grid);
    neph_grid_destroy(grid);
    fuzz_file_remove(&file);
    return 0;
}
