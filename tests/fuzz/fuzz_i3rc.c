/* SPDX-License-Identifier: MIT
 *
 * The reader of the files of I3RC: every refusal has a position in the file, and values that are
 * read are within their range.
 */
#include "tests/fuzz/fuzz.h"

#include "harness/physics/i3rc_files.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const struct fuzz_file file = fuzz_file_make("fuzz.txt", data, size);
    const struct neph_i3rc_file expected = {"fuzz.txt", "a flux", 4, -2.0, 100.0};
    double *values = NULL;
    struct neph_diag diag = {0};
    const enum neph_status status = neph_i3rc_file_read(file.folder, &expected, &values, &diag);
    fuzz_require_outcome(status, &diag, values);
    fuzz_require(status == NEPH_OK || status == NEPH_ERR_INPUT, "the file is at fault");
    fuzz_require(status == NEPH_OK || (diag.line >= 1 && diag.column >= 1), "a position is named");
    for (int i = 0; values && i < expected.values; i++)
        fuzz_require(values[i] >= expected.minimum && values[i] <= expected.maximum,
                     "a value is in its range");
    free(values);
    fuzz_file_remove(&file);
    return 0;
}
