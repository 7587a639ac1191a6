/* SPDX-License-Identifier: MIT
 *
 * Which folders neph recognises as its own; a check does not modify other folders.
 */
#include "tests/base/scratch.h"

#include "base/owned.h"

#include <sys/stat.h>
#include <unistd.h>

static bool has_old_file(const char *folder)
{
    char *path = neph_path_join(folder, "old");
    const bool there = path && neph_path_exists(path);
    free(path);
    return there;
}

static const struct neph_owned_kind shelf = {.name = "shelf", .version = 2, .is_old = has_old_file};
static const struct neph_owned_kind drawer = {.name = "drawer", .version = 1};

static void put(void **state, const char *name, const char *text)
{
    char path[SCRATCH_PATH_MAX];
    neph_assert_ok(neph_file_write(scratch_path(state, path, name), text, strlen(text), NULL),
                   NULL);
}

static void assert_refused(void **state, const struct neph_owned_kind *kind, const char *because)
{
    const struct scratch *scratch = *state;
    const int count = scratch_count(state);
    enum neph_status (*const ways[])(const char *, const struct neph_owned_kind *,
                                     struct neph_diag *) = {neph_owned_check, neph_owned_claim};
    for (size_t i = 0; i < 2; i++) {
        struct neph_diag diag = {0};
        assert_int_equal(ways[i](scratch->folder, kind, &diag), NEPH_ERR_USAGE);
        assert_non_null(strstr(diag.message, scratch->folder));
        assert_non_null(strstr(diag.message, because));
        assert_non_null(strstr(diag.hint, "-o"));
        assert_int_equal(scratch_count(state), count);
    }
}

static void test_new_and_empty_folders_are_taken(void **state)
{
    const struct scratch *scratch = *state;
    char path[SCRATCH_PATH_MAX];
    struct neph_diag diag = {0};
    neph_assert_ok(neph_owned_check(scratch_path(state, path, "a/b"), &shelf, &diag), &diag);
    assert_false(neph_path_exists(path)); /* a check creates nothing */
    neph_assert_ok(neph_owned_claim(path, &shelf, &diag), &diag);
    neph_assert_ok(neph_owned_claim(path, &shelf, &diag), &diag);
    assert_int_equal(scratch_count(state), 1);
    rmdir(path);
    put(state, "a/b/file", "now it holds something");
    neph_assert_ok(neph_owned_claim(path, &shelf, &diag), &diag);
    assert_int_equal(neph_owned_claim(scratch->folder, &shelf, &diag), NEPH_ERR_USAGE);
}

static void test_what_holds_files_is_refused(void **state)
{
    put(state, "thesis.tex", "years");
    assert_refused(state, &shelf, "was not made by neph");
    assert_refused(state, &drawer, "was not made by neph");
}

static void test_hidden_files_count(void **state)
{
    put(state, ".git", "");
    assert_refused(state, &shelf, "was not made by neph");
}

static void test_a_file_of_that_name_is_refused(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_diag diag = {0};
    put(state, "file", "text");
    assert_int_equal(neph_owned_check(scratch_path(state, path, "file"), &shelf, &diag),
                     NEPH_ERR_USAGE);
    assert_non_null(strstr(diag.message, "is not a folder"));
}

static void test_markers_of_others_are_refused(void **state)
{
    put(state, ".neph-owned", "neph drawer 1\n");
    assert_refused(state, &shelf, "is neph's drawer");
    put(state, ".neph-owned", "neph shelf 3\n");
    assert_refused(state, &shelf, "another version");
    put(state, ".neph-owned", "");
    assert_refused(state, &shelf, "damaged marker file");
    put(state, ".neph-owned", "neph shelf 1\n");
    const struct scratch *scratch = *state;
    neph_assert_ok(neph_owned_claim(scratch->folder, &shelf, NULL), NULL);
}

static void test_old_folders_are_recognised_where_that_can_be(void **state)
{
    const struct scratch *scratch = *state;
    struct neph_diag diag = {0};
    put(state, "old", "");
    assert_refused(state, &drawer, "was not made by neph");
    neph_assert_ok(neph_owned_claim(scratch->folder, &shelf, &diag), &diag);
    char path[SCRATCH_PATH_MAX];
    unlink(scratch_path(state, path, "old"));
    neph_assert_ok(neph_owned_check(scratch->folder, &shelf, &diag), &diag); /* marked now */
}

/* A marker that another run is writing at this moment is not foreign. */
static void test_a_marker_on_its_way_is_nothing(void **state)
{
    const struct scratch *scratch = *state;
    put(state, ".neph-0123456789abcdef.tmp", "neph shelf 2\n");
    neph_assert_ok(neph_owned_claim(scratch->folder, &shelf, NULL), NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        scratch_test(test_new_and_empty_folders_are_taken),
        scratch_test(test_what_holds_files_is_refused),
        scratch_test(test_hidden_files_count),
        scratch_test(test_a_file_of_that_name_is_refused),
        scratch_test(test_markers_of_others_are_refused),
        scratch_test(test_old_folders_are_recognised_where_that_can_be),
        scratch_test(test_a_marker_on_its_way_is_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
