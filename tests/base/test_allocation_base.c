/* SPDX-License-Identifier: MIT
 *
 * Out of memory in images, EXR, PNG, files and checkpoints: see tests/allocation.h.
 */
#include "tests/allocation.h"
#include "tests/base/scratch.h"

#include "base/checkpoint.h"
#include "base/exr.h"
#include "base/hash.h"
#include "base/packed.h"
#include "base/png.h"

/* Paths in the test's folder. */
struct place {
    char exr[SCRATCH_PATH_MAX], png[SCRATCH_PATH_MAX], text[SCRATCH_PATH_MAX];
    char copy[SCRATCH_PATH_MAX], checkpoint[SCRATCH_PATH_MAX], folder[SCRATCH_PATH_MAX];
};

static struct place make_paths(void **state)
{
    struct place place;
    scratch_path(state, place.exr, "frame.exr");
    scratch_path(state, place.png, "frame.png");
    scratch_path(state, place.text, "text");
    scratch_path(state, place.copy, "copy");
    scratch_path(state, place.checkpoint, "checkpoint");
    scratch_path(state, place.folder, "a/b/c");
    return place;
}

static enum neph_status make_image(struct neph_image **image, struct neph_diag *diag)
{
    float *planes[3];
    enum neph_status status = neph_image_create(9, 40, image, diag);
    if (status)
        return status;
    status = neph_image_add_rgb(*image, "volume", planes, diag);
    if (!status)
        status = neph_image_add_channel(*image, "Z", NULL, diag);
    for (int i = 0; i < 3 && !status; i++) /* the third replaces the second */
        status = neph_image_set_attribute(*image, i == 0 ? "a" : "b", diag, "%d", i);
    for (int i = 0; i < 40 && !status; i++)
        planes[1][9 * i] = (float)i;
    return status;
}

static enum neph_status use_image(void *context, struct neph_diag *diag)
{
    (void)context;
    struct neph_image *image = NULL;
    const enum neph_status status = make_image(&image, diag);
    neph_image_destroy(image);
    return status;
}

static enum neph_status write_exr(void *context, struct neph_diag *diag)
{
    const struct place *place = context;
    struct neph_image *image = NULL;
    enum neph_status status = make_image(&image, diag);
    if (!status)
        status = neph_exr_write(place->exr, image, diag);
    neph_image_destroy(image);
    return status;
}

static enum neph_status read_exr(void *context, struct neph_diag *diag)
{
    const struct place *place = context;
    struct neph_image *image = NULL;
    const enum neph_status status = neph_exr_read(place->exr, &image, diag);
    assert_int_equal(image != NULL, status == NEPH_OK);
    if (image)
        assert_true(neph_image_channel(image, "volume.G")[9 * 7] == 7.0f);
    neph_image_destroy(image);
    return status;
}

static enum neph_status write_png(void *context, struct neph_diag *diag)
{
    const struct place *place = context;
    static const uint8_t rgb[2 * 3 * 3] = {1, 2, 3};
    return neph_png_write_rgb8(place->png, 2, 3, rgb, diag);
}

static enum neph_status write_deep_png(void *context, struct neph_diag *diag)
{
    const struct place *place = context;
    static const uint16_t rgb[2 * 3 * 3] = {1, 2, 3};
    return neph_png_write_rgb16(place->png, 2, 3, 10, NEPH_PNG_BT2020_PQ, rgb, diag);
}

static enum neph_status read_png(void *context, struct neph_diag *diag)
{
    const struct place *place = context;
    struct neph_image *image = NULL;
    const enum neph_status status = neph_png_read_image(place->png, &image, diag);
    assert_int_equal(image != NULL, status == NEPH_OK);
    neph_image_destroy(image);
    return status;
}

static enum neph_status read_png_codes(void *context, struct neph_diag *diag)
{
    (void)context;
    int width_px, height_px;
    uint16_t *rgb = NULL;
    const enum neph_status status = neph_png_read_rgb16(
        NEPH_SOURCE_DIR "/tests/fuzz/corpus/png/rgb_16.png", &width_px, &height_px, &rgb, diag);
    assert_int_equal(rgb != NULL, status == NEPH_OK);
    free(rgb);
    return status;
}

static enum neph_status use_files(void *context, struct neph_diag *diag)
{
    const struct place *place = context;
    char *data = NULL;
    size_t size = 0;
    enum neph_status status = neph_file_write(place->text, "hello", 5, diag);
    if (!status)
        status = neph_file_copy(place->text, place->copy, diag);
    if (!status)
        status = neph_file_read(place->copy, 100, &data, &size, diag);
    free(data);
    return status ? status : neph_dir_create(place->folder, diag);
}

static enum neph_status use_checkpoint(void *context, struct neph_diag *diag)
{
    const struct place *place = context;
    double values[2] = {1.0, 2.0};
    char hash[NEPH_HASH_HEX_SIZE];
    enum neph_status status = neph_checkpoint_write(place->checkpoint, "me", values, 2, diag);
    if (!status)
        status = neph_checkpoint_read(place->checkpoint, "me", values, 2, diag);
    return status ? status : neph_hash("x", 1, hash, diag);
}

static enum neph_status pack(void *context, struct neph_diag *diag)
{
    (void)context;
    static const float plane[6] = {1.0f, 2.0f};
    const float *const planes[2] = {plane, plane};
    char *text = NULL;
    size_t length = 0;
    const enum neph_status status = neph_packed_floats(planes, 2, 6, &text, &length, diag);
    assert_int_equal(text != NULL, status == NEPH_OK);
    free(text);
    return status;
}

static void test_images(void **state)
{
    struct place place = make_paths(state);
    assert_every_failure_is_reported("an image", use_image, &place);
    assert_every_failure_is_reported("packed floats", pack, &place);
}

static void test_exr(void **state)
{
    struct place place = make_paths(state);
    assert_every_failure_is_reported("writing EXR", write_exr, &place);
    assert_every_failure_is_reported("reading EXR", read_exr, &place);
    assert_int_equal(scratch_count(state), 1); /* no temporary files remain */
}

static enum neph_status read_png_rgba(void *context, struct neph_diag *diag)
{
    float *rgba = NULL;
    int width_px, height_px;
    bool has_alpha;
    const enum neph_status status = neph_png_read_rgba(
        NEPH_SOURCE_DIR "/tests/fuzz/corpus/png/rgba_16.png", 1 << 20, &width_px, &height_px, &rgba,
        &has_alpha, diag);
    assert_int_equal(rgba != NULL, status == NEPH_OK);
    free(rgba);
    return status;
}

static void test_png(void **state)
{
    struct place place = make_paths(state);
    assert_every_failure_is_reported("writing deep PNG", write_deep_png, &place);
    assert_every_failure_is_reported("writing PNG", write_png, &place);
    assert_every_failure_is_reported("reading PNG", read_png, &place);
    assert_every_failure_is_reported("reading PNG with alpha", read_png_rgba, &place);
    assert_every_failure_is_reported("reading codes of PNG", read_png_codes, &place);
    assert_int_equal(scratch_count(state), 1);
}

static void test_files(void **state)
{
    struct place place = make_paths(state);
    assert_every_failure_is_reported("files", use_files, &place);
    assert_every_failure_is_reported("checkpoints", use_checkpoint, &place);
    assert_int_equal(scratch_count(state), 4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        scratch_test(test_images),
        scratch_test(test_exr),
        scratch_test(test_png),
        scratch_test(test_files),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
