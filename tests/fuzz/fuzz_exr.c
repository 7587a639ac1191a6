/* SPDX-License-Identifier: MIT
 *
 * An image that is read as an OpenEXR file must be bit-exact after this project's writer and
 * reader.
 */
#include "tests/fuzz/fuzz.h"

#include "base/exr.h"

static void require_same(const struct neph_image *a, const struct neph_image *b)
{
    fuzz_require(a->width_px == b->width_px && a->height_px == b->height_px, "same size");
    fuzz_require(a->channel_count == b->channel_count, "same count of channels");
    for (int c = 0; c < a->channel_count; c++) {
        const float *samples = neph_image_channel(b, a->channels[c].name);
        fuzz_require(samples && memcmp(samples, a->channels[c].samples,
                                       neph_image_pixel_count(a) * sizeof(float)) == 0,
                     "same channels");
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const struct fuzz_file file = fuzz_file_make("fuzz.exr", data, size);
    struct neph_image *image = NULL, *again = NULL;
    struct neph_diag diag = {0};
    setenv("NEPH_IMAGE", "/nowhere", 1); /* no process for files with DWA compression */
    const enum neph_status status = neph_exr_read(file.path, &image, &diag);
    fuzz_require_outcome(status, &diag, image);
    if (image && neph_image_pixel_count(image) <= 1 << 16 &&
        neph_exr_write(file.path, image, &diag) == NEPH_OK) {
        fuzz_require(neph_exr_read(file.path, &again, &diag) == NEPH_OK, "what we write we read");
        require_same(image, again);
    }
    neph_image_destroy(image);
    neph_image_destroy(again);
    fuzz_file_remove(&file);
    return 0;
}
