/* SPDX-License-Identifier: MIT */
#include "tests/base/scratch.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

static void assert_content(const char *path, const char *data, size_t size)
{
    char *found = NULL;
    size_t found_size = 0;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_file_read(path, SIZE_MAX, &found, &found_size, &diag), &diag);
    assert_int_equal(found_size, size);
    assert_memory_equal(found, data, size);
    assert_int_equal(found[size], '\0');
    free(found);
}

static void test_round_trip_at_many_sizes(void **state)
{
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "file");
    char *data = malloc(70000);
    uint64_t random = 1;
    for (int i = 0; i < 70000; i++)
        data[i] = (char)neph_test_random(&random); /* including NULs */
    static const size_t sizes[] = {0, 1, 2, 4095, 4096, 16383, 16384, 16385, 70000};
    for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++) {
        struct neph_diag diag = {0};
        neph_assert_ok(neph_file_write(path, data, sizes[i], &diag), &diag);
        assert_content(path, data, sizes[i]);
    }
    assert_int_equal(scratch_count(state), 1); /* no temporary file remains */
    free(data);
}

static void test_limit_is_inclusive(void **state)
{
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "file");
    neph_assert_ok(neph_file_write(path, "12345", 5, NULL), NULL);
    char *data = NULL;
    size_t size = 99;
    struct neph_diag diag = {0};
    assert_int_equal(neph_file_read(path, 4, &data, &size, &diag), NEPH_ERR_INPUT);
    assert_non_null(strstr(diag.message, "larger than 4 bytes"));
    assert_null(data);
    assert_int_equal(size, 99);
    neph_assert_ok(neph_file_read(path, 5, &data, &size, &diag), &diag);
    assert_int_equal(size, 5);
    free(data);
}

static void test_limit_applies_to_unsized_files(void **state)
{
    char *data = NULL;
    size_t size = 0;
    assert_int_equal(neph_file_read("/proc/self/status", 100, &data, &size, NULL), NEPH_ERR_INPUT);
    neph_assert_ok(neph_file_read("/proc/self/status", 100000, &data, &size, NULL), NULL);
    assert_true(size > 0);
    assert_non_null(strstr(data, "VmHWM"));
    free(data);
}

static void test_missing_and_unreadable(void **state)
{
    char path[SCRATCH_PATH_MAX];
    char *data = NULL;
    size_t size = 0;
    struct neph_diag diag = {0};
    assert_int_equal(neph_file_read(scratch_path(state, path, "none"), 10, &data, &size, &diag),
                     NEPH_ERR_NOT_FOUND);
    assert_non_null(strstr(diag.message, path));
    assert_int_equal(neph_file_read(scratch_path(state, path, ""), 10, &data, &size, &diag),
                     NEPH_ERR_IO);
}

/* A reader that has the old file open still gets the old bytes: a new file took its name. */
static void test_replacing_is_atomic(void **state)
{
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "file");
    neph_assert_ok(neph_file_write(path, "old", 3, NULL), NULL);
    int fd = open(path, O_RDONLY);
    assert_true(fd >= 0);
    neph_assert_ok(neph_file_write(path, "new!", 4, NULL), NULL);
    char old[8] = {0};
    assert_int_equal(read(fd, old, sizeof(old)), 3);
    assert_memory_equal(old, "old", 3);
    close(fd);
    assert_content(path, "new!", 4);
    assert_int_equal(scratch_count(state), 1);
}

static void test_failed_write_leaves_nothing(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_diag diag = {0};
    assert_int_equal(neph_file_write(scratch_path(state, path, "no/such/file"), "x", 1, &diag),
                     NEPH_ERR_IO);
    assert_non_null(strstr(diag.message, path));
    /* The rename fails here, after the temporary file was written. */
    neph_assert_ok(neph_dir_create(scratch_path(state, path, "folder/inside"), NULL), NULL);
    scratch_path(state, path, "folder");
    assert_int_equal(neph_file_write(path, "x", 1, &diag), NEPH_ERR_IO);
    assert_true(neph_path_is_dir(path));
    assert_int_equal(scratch_count(state), 1);
}

/* In a folder of many files: only new ones, complete, and on the disk after one wait. */
static void test_unsynced_files_are_new_ones(void **state)
{
    char path[SCRATCH_PATH_MAX], folder[SCRATCH_PATH_MAX];
    struct neph_diag diag = {0};
    scratch_path(state, path, "file");
    neph_assert_ok(neph_file_write_unsynced(path, "12345", 5, &diag), &diag);
    neph_assert_ok(neph_file_system_sync(scratch_path(state, folder, "."), &diag), &diag);
    assert_content(path, "12345", 5);
    assert_int_equal(neph_file_write_unsynced(path, "x", 1, &diag), NEPH_ERR_IO);
    assert_non_null(strstr(diag.message, path));
    assert_content(path, "12345", 5);
    assert_int_equal(neph_file_system_sync(scratch_path(state, folder, "nobody"), &diag),
                     NEPH_ERR_IO);
}

static void test_mode_follows_umask(void **state)
{
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "file");
    mode_t before = umask(027);
    enum neph_status status = neph_file_write(path, "x", 1, NULL);
    umask(before);
    neph_assert_ok(status, NULL);
    struct stat info;
    assert_int_equal(stat(path, &info), 0);
    assert_int_equal(info.st_mode & 0777, 0640);
}

static void test_longest_name(void **state)
{
    const struct scratch *scratch = *state;
    char name[256];
    memset(name, 'n', 255);
    name[255] = '\0';
    char *path = neph_path_join(scratch->folder, name);
    struct neph_diag diag = {0};
    neph_assert_ok(neph_file_write(path, "x", 1, &diag), &diag);
    assert_content(path, "x", 1);
    free(path);
}

static void test_relative_path_without_folder(void **state)
{
    const struct scratch *scratch = *state;
    char *before = getcwd(NULL, 0);
    assert_int_equal(chdir(scratch->folder), 0);
    enum neph_status status = neph_file_write("here", "x", 1, NULL);
    assert_int_equal(chdir(before), 0);
    free(before);
    neph_assert_ok(status, NULL);
    char path[SCRATCH_PATH_MAX];
    assert_content(scratch_path(state, path, "here"), "x", 1);
}

static void test_copy(void **state)
{
    char from[SCRATCH_PATH_MAX], to[SCRATCH_PATH_MAX];
    scratch_path(state, from, "from");
    scratch_path(state, to, "to");
    size_t size = 600001; /* more than two buffers */
    char *data = malloc(size);
    for (size_t i = 0; i < size; i++)
        data[i] = (char)(i * 31);
    struct neph_diag diag = {0};
    neph_assert_ok(neph_file_write(from, data, size, &diag), &diag);
    neph_assert_ok(neph_file_copy(from, to, &diag), &diag);
    assert_content(to, data, size);
    neph_assert_ok(neph_file_copy(to, to, &diag), &diag); /* onto itself: unchanged */
    assert_content(to, data, size);
    free(data);

    assert_int_equal(neph_file_copy(scratch_path(state, from, "none"), to, &diag),
                     NEPH_ERR_NOT_FOUND);
    assert_int_equal(neph_file_copy(scratch_path(state, from, ""), to, &diag), NEPH_ERR_IO);
    assert_int_equal(scratch_count(state), 2);
}

static void test_dir_create(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_diag diag = {0};
    for (int i = 0; i < 2; i++) /* the second time all of it exists */
        neph_assert_ok(neph_dir_create(scratch_path(state, path, "a//b/c/"), &diag), &diag);
    assert_true(neph_path_is_dir(scratch_path(state, path, "a/b/c")));
    neph_assert_ok(neph_dir_create("/", &diag), &diag);
    neph_assert_ok(neph_dir_create(".", &diag), &diag);

    neph_assert_ok(neph_file_write(scratch_path(state, path, "a/file"), "x", 1, &diag), &diag);
    assert_int_equal(neph_dir_create(path, &diag), NEPH_ERR_IO);
    assert_int_equal(neph_dir_create(scratch_path(state, path, "a/file/b"), &diag), NEPH_ERR_IO);
    assert_int_equal(neph_dir_create("", &diag), NEPH_ERR_IO);
}

static void test_dir_list(void **state)
{
    static const char *const made[] = {"list/b", "list/.hidden", "list/a", "list/B"};
    static const char *const sorted[] = {".hidden", "B", "a", "b"};
    char path[SCRATCH_PATH_MAX];
    struct neph_arena arena = {NULL};
    struct neph_names names;
    neph_assert_ok(neph_dir_create(scratch_path(state, path, "list"), NULL), NULL);
    for (size_t i = 0; i < COUNT(made); i++)
        neph_assert_ok(neph_file_write(scratch_path(state, path, made[i]), "x", 1, NULL), NULL);
    neph_assert_ok(neph_dir_list(scratch_path(state, path, "list"), &arena, &names, NULL), NULL);
    assert_int_equal(names.count, COUNT(sorted));
    for (size_t i = 0; i < COUNT(sorted); i++)
        assert_string_equal(names.list[i], sorted[i]);
    assert_int_equal(neph_dir_list(scratch_path(state, path, "no"), &arena, &names, NULL),
                     NEPH_ERR_IO);
    assert_int_equal(names.count, 0);
    neph_arena_finish(&arena);
}

static void test_dir_remove(void **state)
{
    char path[SCRATCH_PATH_MAX], target[SCRATCH_PATH_MAX], link[SCRATCH_PATH_MAX];
    neph_assert_ok(neph_dir_create(scratch_path(state, path, "kept"), NULL), NULL);
    neph_assert_ok(neph_file_write(scratch_path(state, target, "kept/file"), "x", 1, NULL), NULL);

    neph_assert_ok(neph_dir_create(scratch_path(state, path, "gone/deep/deeper"), NULL), NULL);
    for (int i = 0; i < 300; i++) {
        char name[64];
        snprintf(name, sizeof(name), "gone/deep/file-%d", i);
        neph_assert_ok(neph_file_write(scratch_path(state, path, name), "x", 1, NULL), NULL);
    }
    /* Links to a folder and to nothing are removed; their targets stay. */
    assert_int_equal(symlink("../kept", scratch_path(state, link, "gone/folder-link")), 0);
    assert_int_equal(symlink("/no/such", scratch_path(state, link, "gone/dead-link")), 0);
    struct neph_diag diag = {0};
    neph_assert_ok(neph_dir_remove(scratch_path(state, path, "gone"), &diag), &diag);
    assert_false(neph_path_exists(path));
    assert_content(target, "x", 1);

    assert_int_equal(symlink("kept", scratch_path(state, link, "link")), 0);
    neph_assert_ok(neph_dir_remove(link, &diag), &diag);
    assert_false(neph_path_exists(link));
    assert_content(target, "x", 1);

    neph_assert_ok(neph_dir_remove(path, &diag), &diag); /* does not exist */
    neph_assert_ok(neph_dir_remove(target, &diag), &diag);
    assert_false(neph_path_exists(target));
}

static void test_dir_remove_refuses_disasters(void **state)
{
    static const char *const paths[] = {"", ".", "..", "/", "//", "./", "../..", "/."};
    for (size_t i = 0; i < sizeof(paths) / sizeof(paths[0]); i++)
        assert_int_equal(neph_dir_remove(paths[i], NULL), NEPH_ERR_INTERNAL);
}

static void test_paths(void **state)
{
    char path[SCRATCH_PATH_MAX];
    assert_true(neph_path_exists(scratch_path(state, path, "")));
    assert_true(neph_path_is_dir(path));
    neph_assert_ok(neph_file_write(scratch_path(state, path, "file"), "", 0, NULL), NULL);
    assert_true(neph_path_exists(path));
    assert_false(neph_path_is_dir(path));
    assert_false(neph_path_exists(scratch_path(state, path, "none")));
    assert_false(neph_path_is_dir(path));

    static const char *const joins[][3] = {
        {"a", "b", "a/b"}, {"a/", "b", "a/b"}, {"/", "b", "/b"}, {"", "b", "b"}};
    for (size_t i = 0; i < sizeof(joins) / sizeof(joins[0]); i++) {
        char *joined = neph_path_join(joins[i][0], joins[i][1]);
        assert_string_equal(joined, joins[i][2]);
        free(joined);
    }
    char *text = neph_format("%d-%s", 7, "x");
    assert_string_equal(text, "7-x");
    free(text);
}

/* There are machines whose /dev/null was replaced by a regular file, and machines without a
 * terminal. */
static bool is_device_here(const char *path)
{
    struct stat info;
    const int fd = open(path, O_RDONLY | O_NONBLOCK);
    const bool is_device = fd >= 0 && fstat(fd, &info) == 0 && S_ISCHR(info.st_mode);
    if (fd >= 0)
        close(fd);
    if (!is_device)
        print_message("%s is no device of this machine\n", path);
    return is_device;
}

static void assert_refused(const char *path, const char *reason, const char *copy)
{
    char *data = NULL;
    size_t size = 0;
    int fd = -1;
    struct neph_diag diag = {0};
    assert_int_equal(neph_file_open(path, &fd, NULL, &diag), NEPH_ERR_INPUT);
    assert_int_equal(fd, -1);
    assert_non_null(strstr(diag.message, reason));
    assert_int_equal(neph_file_read(path, 10, &data, &size, NULL), NEPH_ERR_INPUT);
    assert_int_equal(neph_file_copy(path, copy, NULL), NEPH_ERR_INPUT);
}

/* Reading must not wait for any of them; ctest ends a test that hangs. */
static void test_special_files_are_refused_at_once(void **state)
{
    static const char *const devices[] = {"/dev/zero", "/dev/null", "/dev/random", "/dev/tty"};
    char fifo[SCRATCH_PATH_MAX], copy[SCRATCH_PATH_MAX];
    int tried = 0;
    assert_int_equal(mkfifo(scratch_path(state, fifo, "fifo"), 0600), 0);
    scratch_path(state, copy, "copy");
    assert_refused(fifo, "a pipe is not a regular file", copy);
    for (size_t i = 0; i < COUNT(devices); i++) {
        if (!is_device_here(devices[i]))
            continue;
        assert_refused(devices[i], "a device is not a regular file", copy);
        tried++;
    }
    assert_true(tried >= 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        scratch_test(test_round_trip_at_many_sizes),
        scratch_test(test_limit_is_inclusive),
        cmocka_unit_test(test_limit_applies_to_unsized_files),
        scratch_test(test_missing_and_unreadable),
        scratch_test(test_special_files_are_refused_at_once),
        scratch_test(test_replacing_is_atomic),
        scratch_test(test_failed_write_leaves_nothing),
        scratch_test(test_unsynced_files_are_new_ones),
        scratch_test(test_mode_follows_umask),
        scratch_test(test_longest_name),
        scratch_test(test_relative_path_without_folder),
        scratch_test(test_copy),
        scratch_test(test_dir_create),
        scratch_test(test_dir_list),
        scratch_test(test_dir_remove),
        cmocka_unit_test(test_dir_remove_refuses_disasters),
        scratch_test(test_paths),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
