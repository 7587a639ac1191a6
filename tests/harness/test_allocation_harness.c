/* SPDX-License-Identifier: MIT
 *
 * Out of memory between the words of a command line and the frames: see tests/allocation.h.
 */
#include "tests/allocation.h"
#include "tests/base/scratch.h"

#include "harness/compare/frame.h"
#include "harness/compare/sequence.h"
#include "harness/physics/i3rc.h"
#include "harness/physics/i3rc_files.h"

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

static const struct neph_i3rc_file six_values = {"six", "a flux", 6, -1.0, 1.0};

static enum neph_status read_values(void *context, struct neph_diag *diag)
{
    double *values = NULL;
    const enum neph_status status = neph_i3rc_file_read(context, &six_values, &values, diag);
    assert_int_equal(values != NULL, status == NEPH_OK);
    free(values);
    return status;
}

static enum neph_status read_consensus(void *context, struct neph_diag *diag)
{
    double *values = NULL;
    const enum neph_status status = neph_i3rc_consensus_read(context, 1, 1, "R", 32, &values, diag);
    assert_int_equal(values != NULL, status == NEPH_OK);
    free(values);
    return status;
}

static enum neph_status run_suite(void *context, struct neph_diag *diag)
{
    static const char *const only = "case1_exp1";
    struct neph_i3rc suite = {.rows = NULL};
    const struct neph_i3rc_params params = {.folder = context,
                                            .engine = "oracle",
                                            .only = &only,
                                            .only_count = 1,
                                            .paths = 16,
                                            .quiet = true};
    const enum neph_status status = neph_i3rc_run(&params, &suite, diag);
    if (!status)
        assert_int_equal(suite.compared, 1);
    neph_i3rc_finish(&suite);
    return status;
}

/* Files of I3RC, and an experiment with its consensus. */
static void test_i3rc(void **state)
{
    static const char six[] = "0.1 0.2\n-1 1e-3 .5 1.E0\n";
    char path[SCRATCH_PATH_MAX], consensus[32 * 4 + 1] = "";
    for (int i = 0; i < 32; i++)
        strcat(consensus, "0.5\n");
    neph_assert_ok(neph_file_write(scratch_path(state, path, "six"), six, strlen(six), NULL), NULL);
    neph_assert_ok(neph_file_write(scratch_path(state, path, "case1_exp1_R.txt"), consensus,
                                   strlen(consensus), NULL),
                   NULL);
    scratch_path(state, path, "");
    assert_every_failure_is_reported("values of I3RC", read_values, path);
    assert_every_failure_is_reported("a consensus of I3RC", read_consensus, path);
    assert_every_failure_is_reported("an experiment of I3RC", run_suite, path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        scratch_test(test_sequences),
        cmocka_unit_test(test_frames),
        scratch_test(test_i3rc),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
