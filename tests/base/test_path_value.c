/* SPDX-License-Identifier: MIT
 *
 * Paths as values: equal to paths on the heap, and refused if too long.
 */
#include "tests/base/scratch.h"

#include "base/path.h"

#include <errno.h>
#include <limits.h>
#include <sys/stat.h>

static void test_a_path_is_as_one_in_memory(void **state)
{
    static const char *const folders[] = {"", "/", "a", "a/", "/a/b"};
    for (size_t i = 0; i < COUNT(folders); i++) {
        char *joined = neph_path_join(folders[i], "c.d");
        assert_string_equal(neph_path_in(folders[i], "c.d").text, joined);
        free(joined);
    }
    assert_string_equal(neph_path_format("%s-%06d", "a", 7).text, "a-000007");
}

/* Truncated, it might be another path; the system accepts neither. */
static void test_a_path_that_is_too_long_is_refused(void **state)
{
    static const size_t lengths[] = {PATH_MAX, NEPH_PATH_SIZE, 3 * PATH_MAX};
    for (size_t i = 0; i < COUNT(lengths); i++) {
        char *folder = calloc(lengths[i] + 1, 1);
        struct stat info;
        for (size_t k = 0; k < lengths[i]; k++)
            folder[k] = k % 2 ? '/' : '.';
        errno = 0;
        assert_int_equal(stat(neph_path_in(folder, "..").text, &info), -1);
        assert_int_equal(errno, ENAMETOOLONG);
        assert_int_equal(neph_dir_create(neph_path_in(folder, "a").text, NULL), NEPH_ERR_IO);
        free(folder);
    }
}

#include "tests/main.h"
