/* SPDX-License-Identifier: MIT
 *
 * A separate folder for each test that writes to the disk, and functions to inspect it.
 */
#ifndef NEPH_TESTS_BASE_SCRATCH_H
#define NEPH_TESTS_BASE_SCRATCH_H

#include "tests/neph_test.h"

#include "base/files.h"

#include <unistd.h>

#define SCRATCH_PATH_MAX 512

struct scratch {
    char folder[SCRATCH_PATH_MAX / 2];
};

static inline int scratch_setup(void **state)
{
    struct scratch *scratch = calloc(1, sizeof(*scratch));
    const char *parent = getenv("TMPDIR");
    snprintf(scratch->folder, sizeof(scratch->folder), "%s/neph-test-XXXXXX",
             parent && *parent ? parent : "/tmp");
    if (!mkdtemp(scratch->folder))
        return -1;
    *state = scratch;
    return 0;
}

static inline int scratch_teardown(void **state)
{
    struct scratch *scratch = *state;
    enum neph_status status = neph_dir_remove(scratch->folder, NULL);
    free(scratch);
    return status == NEPH_OK ? 0 : -1;
}

/* The path of a name in the test's folder. */
static inline const char *scratch_path(void **state, char path[SCRATCH_PATH_MAX], const char *name)
{
    const struct scratch *scratch = *state;
    snprintf(path, SCRATCH_PATH_MAX, "%s/%.200s", scratch->folder, name);
    return path;
}

/* Writes a file as another program would. Unlike in neph_file_write() it is not flushed to the
 * disk, as a loop over damaged files would spend most of its time waiting for it; and it is a new
 * file each time, as ext4 flushes a file that is overwritten. */
static inline void scratch_write(const char *path, const void *data, size_t size)
{
    unlink(path);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_true(fwrite(data, 1, size, file) == size);
    assert_int_equal(fclose(file), 0);
}

/* The number of entries in a folder of the test ("": its own), including hidden ones: leftover
 * temporary files are counted. */
static inline int scratch_count_in(void **state, const char *name)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_arena arena = {NULL};
    struct neph_names names;
    neph_assert_ok(neph_dir_list(scratch_path(state, path, name), &arena, &names, NULL), NULL);
    neph_arena_finish(&arena);
    return names.count;
}

static inline int scratch_count(void **state)
{
    return scratch_count_in(state, "");
}

/* Writes a text as a file into a folder, flushed to the disk. */
static inline void scratch_put(const char *folder, const char *name, const char *text)
{
    char *path = neph_path_join(folder, name);
    neph_assert_ok(neph_file_write(path, text, strlen(text), NULL), NULL);
    free(path);
}

#define scratch_test(function)                                                                     \
    cmocka_unit_test_setup_teardown(function, scratch_setup, scratch_teardown)

#endif
