/* SPDX-License-Identifier: MIT
 *
 * The readers of PNG: images have only values in 0..1, and a file of codes gives the same image in
 * both. The input is tested unchanged, and again with valid checksums, which a fuzzer cannot find.
 */
#include "tests/base/png_chunks.h"
#include "tests/fuzz/fuzz.h"

#include "base/apng.h"
#include "base/png.h"

static void require_display_values(const struct neph_image *image)
{
    fuzz_require(image->channel_count == 3, "three channels");
    for (int c = 0; c < 3; c++)
        for (size_t i = 0; i < neph_image_pixel_count(image); i++) {
            const float value = image->channels[c].samples[i];
            fuzz_require(value >= 0.0f && value <= 1.0f, "a value in 0..1");
        }
}

/* Large images take seconds, legitimately; images above the maximum size are refused, which is
 * tested. */
static bool is_expensive(const uint8_t *data, size_t size)
{
    const uint64_t most = 1 << 16, refused = NEPH_IMAGE_SIDE_MAX_PX;
    uint64_t side[2] = {0, 0};
    for (size_t i = 0; i < 8 && size >= 24; i++)
        side[i / 4] = side[i / 4] << 8 | data[16 + i];
    return side[0] * side[1] > most && side[0] <= refused && side[1] <= refused;
}

/* The frames of an animation, at most four. */
static void try_animation(const char *path)
{
    struct neph_apng *apng = NULL;
    struct neph_diag diag = {0};
    enum neph_status status = neph_apng_open(path, &apng, &diag);
    fuzz_require_outcome(status, &diag, apng);
    for (int frame = 0; apng && frame < neph_apng_frame_count(apng) && frame < 4; frame++) {
        struct neph_image *image = NULL;
        status = neph_apng_read(apng, frame, path, &image, &diag);
        fuzz_require_outcome(status, &diag, image);
        if (image)
            require_display_values(image);
        neph_image_destroy(image);
    }
    neph_apng_close(apng);
}

static void try(const uint8_t *data, size_t size)
{
    const struct fuzz_file file = fuzz_file_make("fuzz.png", data, size);
    struct neph_image *image = NULL;
    uint16_t *rgb = NULL;
    int width_px = 0, height_px = 0;
    struct neph_diag diag = {0};
    enum neph_status status = neph_png_read_image(file.path, &image, &diag);
    fuzz_require_outcome(status, &diag, image);
    if (image)
        require_display_values(image);
    status = neph_png_read_rgb16(file.path, &width_px, &height_px, &rgb, &diag);
    fuzz_require_outcome(status, &diag, rgb);
    if (image && rgb)
        fuzz_require(width_px == image->width_px && height_px == image->height_px, "same size");
    free(rgb);
    float *rgba = NULL;
    bool has_alpha = false;
    status = neph_png_read_rgba(file.path, 1 << 24, &width_px, &height_px, &rgba, &has_alpha,
                                &diag);
    fuzz_require_outcome(status, &diag, rgba);
    for (size_t i = 0; rgba && i < 4 * (size_t)width_px * (size_t)height_px; i++)
        fuzz_require(rgba[i] >= 0.0f && rgba[i] <= 1.0f, "a value in 0..1");
    if (image && rgba)
        fuzz_require(!has_alpha && rgba[0] == image->channels[0].samples[0], "the same image");
    free(rgba);
    neph_image_destroy(image);
    if (neph_apng_count(file.path) > 0)
        try_animation(file.path);
    fuzz_file_remove(&file);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (fuzz_is_searching() && is_expensive(data, size))
        return 0;
    try(data, size);
    uint8_t *mended = malloc(size + 1);
    memcpy(mended, data, size);
    png_mend_checksums(mended, size);
    if (memcmp(mended, data, size) != 0)
        try(mended, size);
    free(mended);
    return 0;
}
