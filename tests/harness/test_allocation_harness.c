/* SPDX-License-Identifier: MIT
 *
 * Out of memory between the words of a command line and the frames: see tests/allocation.h.
 */
#include "tests/allocation.h"
#include "tests/base/scratch.h"

#include "harness/compare/frame.h"
#include "harness/compare/sequence.h"

#define CORPUS NEPH_SOURCE_DIR "/tests/fuzz/corpus/"

static enum neph_status find(void *context, struct neph_diag *diag)
{
    const char *words[] = {context};
    struct neph_sequence sequence = {0};
    const enum neph_status status = neph_sequence_find(1, words, false, &sequence, diag);
    assert_int_equal(sequence.count > 0, status == NEPH_OK);
    neph_sequence_finish(&sequence);
    return status;
}

static enum neph_status read_frame(void *context, struct neph_diag *diag)
{
    struct neph_image *image = NULL;
    const enum neph_status status = neph_frame_read(context, NULL, SIZE_MAX, &image, diag);
    assert_int_equal(image != NULL, status == NEPH_OK);
    neph_image_destroy(image);
    return status;
}

/* A file with a data window of 21x18 pixels in a display window of 23x20. */
static enum neph_status read_placed(void *context, struct neph_diag *diag)
{
    const struct neph_frame_choice choice = {
        .window = {.size_px = {23, 19}, .display_px = {23, 20}}};
    struct neph_image *image = NULL;
    const enum neph_status status = neph_frame_read(context, &choice, SIZE_MAX, &image, diag);
    assert_int_equal(image != NULL, status == NEPH_OK);
    neph_image_destroy(image);
    return status;
}

static void test_sequences(void **state)
{
    char path[SCRATCH_PATH_MAX];
    for (int i = 8; i < 12; i++) {
        char name[16];
        snprintf(name, sizeof(name), "f%d.exr", i);
        neph_assert_ok(neph_file_write(scratch_path(state, path, name), "", 0, NULL), NULL);
    }
    assert_every_failure_is_reported("a file", find, path);
    scratch_path(state, path, "f%d.exr");
    assert_every_failure_is_reported("a pattern", find, path);
    scratch_path(state, path, "f*.exr");
    assert_every_failure_is_reported("a glob", find, path);
    scratch_path(state, path, "");
    assert_every_failure_is_reported("a folder", find, path);
}

static void test_frames(void **state)
{
    assert_every_failure_is_reported("an EXR", read_frame, CORPUS "exr/smooth_zip.exr");
    assert_every_failure_is_reported("an EXR in another window", read_placed,
                                     CORPUS "exr/smooth_zip.exr");
    assert_every_failure_is_reported("a PNG", read_frame, CORPUS "png/rgb_8.png");
    assert_every_failure_is_reported("an animated PNG", read_frame,
                                     CORPUS "png/animation.png/0002.png");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        scratch_test(test_sequences),
        cmocka_unit_test(test_frames),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
