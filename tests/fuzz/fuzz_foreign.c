/* SPDX-License-Identifier: MIT
 *
 * The output of neph-image: whatever it contains, an image or an error.
 */
#include "tests/fuzz/fuzz.h"

#include "base/oiio.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct neph_image *image = NULL;
    struct neph_diag diag = {0};
    const enum neph_status status = neph_oiio_image("fuzz.tif", data, size, &image, &diag);
    fuzz_require_outcome(status, &diag, image);
    neph_image_destroy(image);
    return 0;
}
