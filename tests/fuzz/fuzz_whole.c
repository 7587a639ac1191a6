/* SPDX-License-Identifier: MIT
 *
 * The structure of TIFF and JPEG files: whole, or an error with a reason.
 */
#include "tests/fuzz/fuzz.h"

#include "base/whole.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const struct fuzz_file file = fuzz_file_make("fuzz.tif", data, size);
    struct neph_diag diag = {0};
    const int fd = open(file.path, O_RDONLY | O_CLOEXEC);
    fuzz_require(fd >= 0, "its file opens");
    const enum neph_status status = neph_whole_check(file.path, fd, size, &diag);
    fuzz_require(status == NEPH_OK || (status == NEPH_ERR_INPUT && diag.message[0]), "a reason");
    close(fd);
    fuzz_file_remove(&file);
    return 0;
}
