/* SPDX-License-Identifier: MIT
 *
 * The time limit of `--partner`; all else of it: e2e_partner.py.
 */
#include "tests/base/scratch.h"

#include "base/exr.h"
#include "harness/compare/partner.h"

#include <sys/stat.h>

/* Put a program that never ends into PATH. */
static void install(void **state)
{
    static const char script[] = "#!/bin/sh\nsleep 600\n";
    const char *folder = ((struct scratch *)*state)->folder;
    char path[SCRATCH_PATH_MAX], search[1024];
    scratch_write(scratch_path(state, path, "cvvdp"), script, strlen(script));
    assert_int_equal(chmod(path, 0755), 0);
    snprintf(search, sizeof(search), "%s:%s", folder, getenv("PATH"));
    assert_int_equal(setenv("PATH", search, 1), 0);
    assert_int_equal(setenv("TMPDIR", folder, 1), 0);
}

static void write_grey(const char *path)
{
    struct neph_image *image;
    float *rgb[3];
    assert_int_equal(neph_image_create(4, 4, &image, NULL), NEPH_OK);
    assert_int_equal(neph_image_add_rgb(image, NULL, rgb, NULL), NEPH_OK);
    assert_int_equal(neph_exr_write(path, image, NULL), NEPH_OK);
    neph_image_destroy(image);
}

static void test_a_program_that_never_ends(void **state)
{
    char path[SCRATCH_PATH_MAX], *paths[] = {path};
    const struct neph_sequence frame = {.count = 1, .paths = paths}, none = {.count = 0};
    struct neph_partner_job job = {.reference = &frame,
                                   .test = &frame,
                                   .other = &none,
                                   .viewing = NEPH_VIEWING_DEFAULTS,
                                   .time_limit_s = 0.05};
    struct neph_partner_numbers numbers = {.display = NULL};
    struct neph_diag diag = {.line = 0};
    install(state);
    write_grey(scratch_path(state, path, "frame.exr"));
    assert_int_equal(neph_partner_find("cvvdp", &job.display, NULL), NEPH_OK);
    assert_int_equal(neph_partner_run(&job, &numbers, &diag), NEPH_ERR_TIMEOUT);
    assert_non_null(strstr(diag.message, "cvvdp_jod was not measured: "));
    assert_non_null(strstr(numbers.not_measured, "0.05 s"));
    assert_int_equal(numbers.count, 0);
    neph_partner_finish(&numbers);
}

int main(void)
{
    const struct CMUnitTest tests[] = {scratch_test(test_a_program_that_never_ends)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
