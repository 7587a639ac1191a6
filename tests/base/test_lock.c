/* SPDX-License-Identifier: MIT
 *
 * Locks, folders for work in progress and temporary files: files of a running process stay,
 * leftovers of a killed process are removed, independent of process numbers.
 */
#include "tests/base/scratch.h"

#include "base/lock.h"
#include "base/scratch.h"

#include <errno.h>
#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static void test_a_lock_is_held_until_it_is_closed(void **state)
{
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "lock");
    assert_int_equal(neph_lock_take_over(path), -1);
    const int fd = neph_lock_create(path);
    assert_true(fd >= 0);
    assert_int_equal(neph_lock_create(path), -1);
    assert_int_equal(neph_lock_take_over(path), -1);
    assert_int_equal(fcntl(fd, F_GETFD) & FD_CLOEXEC, FD_CLOEXEC);
    close(fd);
    const int taken = neph_lock_take_over(path);
    assert_true(taken >= 0);
    assert_int_equal(fcntl(taken, F_GETFD) & FD_CLOEXEC, FD_CLOEXEC);
    close(taken);
}

static void test_only_plain_files_are_taken_over(void **state)
{
    char path[SCRATCH_PATH_MAX], link_path[SCRATCH_PATH_MAX];
    neph_assert_ok(neph_dir_create(scratch_path(state, path, "folder"), NULL), NULL);
    assert_int_equal(neph_lock_take_over(path), -1);
    neph_assert_ok(neph_file_write(scratch_path(state, path, "file"), "", 0, NULL), NULL);
    assert_int_equal(symlink(path, scratch_path(state, link_path, "link")), 0);
    assert_int_equal(neph_lock_take_over(link_path), -1);
    assert_int_equal(mkfifo(scratch_path(state, path, "fifo"), 0600), 0);
    assert_int_equal(neph_lock_take_over(path), -1);
}

static void test_scratch_is_empty_and_goes(void **state)
{
    const struct scratch *scratch = *state;
    struct neph_scratch *a = NULL, *b = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_scratch_create(scratch->folder, "work-", &a, &diag), &diag);
    neph_assert_ok(neph_scratch_create(scratch->folder, "work-", &b, &diag), &diag);
    assert_string_not_equal(neph_scratch_path(a), neph_scratch_path(b));
    assert_true(neph_path_is_dir(neph_scratch_path(a)));
    assert_int_equal(scratch_count(state), 4); /* two folders, two locks */
    neph_scratch_sweep(scratch->folder, "work-");
    assert_int_equal(scratch_count(state), 4); /* both are in use */
    neph_scratch_destroy(a);
    neph_scratch_destroy(b);
    assert_int_equal(scratch_count(state), 0);
}

static void test_scratch_that_was_renamed_stays(void **state)
{
    const struct scratch *scratch = *state;
    struct neph_scratch *work = NULL;
    char kept[SCRATCH_PATH_MAX];
    neph_assert_ok(neph_scratch_create(scratch->folder, "work-", &work, NULL), NULL);
    assert_int_equal(rename(neph_scratch_path(work), scratch_path(state, kept, "kept")), 0);
    neph_scratch_destroy(work);
    assert_true(neph_path_is_dir(kept));
    assert_int_equal(scratch_count(state), 1);
}

static void test_scratch_that_was_kept_is_not_swept(void **state)
{
    const struct scratch *scratch = *state;
    struct neph_scratch *empty = NULL, *full = NULL;
    neph_assert_ok(neph_scratch_create(scratch->folder, "work-", &empty, NULL), NULL);
    neph_assert_ok(neph_scratch_create(scratch->folder, "work-", &full, NULL), NULL);
    char *log = neph_path_join(neph_scratch_path(full), "engine.log");
    neph_assert_ok(neph_file_write(log, "why", 3, NULL), NULL);
    assert_false(neph_scratch_keep(empty));
    assert_true(neph_scratch_keep(full));
    neph_scratch_sweep(scratch->folder, "work-");
    assert_true(neph_path_exists(log));
    assert_int_equal(scratch_count(state), 1);
    free(log);
}

/* A process that works in `folder` and then pauses; returns its number. */
static pid_t start_worker(const char *folder)
{
    int fds[2];
    char byte = 0;
    assert_int_equal(pipe(fds), 0);
    const pid_t pid = fork();
    if (pid == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        struct neph_scratch *work = NULL;
        char *file = NULL;
        if (neph_scratch_create(folder, "work-", &work, NULL) == NEPH_OK)
            file = neph_path_join(neph_scratch_path(work), "half.exr");
        if (file && neph_file_write(file, "half", 4, NULL) == NEPH_OK)
            byte = 1;
        if (write(fds[1], &byte, 1) != 1)
            _exit(1);
        for (;;)
            pause();
    }
    assert_int_equal(read(fds[0], &byte, 1), 1);
    assert_int_equal(byte, 1);
    close(fds[0]);
    close(fds[1]);
    return pid;
}

static void test_what_a_killed_process_left_is_swept(void **state)
{
    const struct scratch *scratch = *state;
    const pid_t worker = start_worker(scratch->folder);
    neph_scratch_sweep(scratch->folder, "work-");
    assert_int_equal(scratch_count(state), 2); /* it is alive */
    kill(worker, SIGKILL);
    waitpid(worker, NULL, 0);
    neph_scratch_sweep(scratch->folder, "other-");
    assert_int_equal(scratch_count(state), 2);
    neph_scratch_sweep(scratch->folder, "work-");
    assert_int_equal(scratch_count(state), 0);
}

static void test_strangers_are_not_swept(void **state)
{
    static const char *const names[] = {"work-0123456789abcdef", "work-.lock", "work-12.lock",
                                        "x-work-0123456789abcdef.lock",
                                        "work-0123456789abcdef.lock.txt"};
    const struct scratch *scratch = *state;
    char path[SCRATCH_PATH_MAX];
    for (int i = 0; i < 5; i++)
        neph_assert_ok(neph_file_write(scratch_path(state, path, names[i]), "", 0, NULL), NULL);
    neph_scratch_sweep(scratch->folder, "work-");
    assert_int_equal(scratch_count(state), 5);
}

/* Takes over and removes the file `path`, repeatedly. */
static pid_t start_sweeper(const char *path)
{
    const pid_t pid = fork();
    if (pid == 0)
        prctl(PR_SET_PDEATHSIG, SIGKILL); /* also when the test fails */
    while (pid == 0) {
        const int fd = neph_lock_take_over(path);
        if (fd >= 0) {
            unlink(path);
            close(fd);
        }
    }
    return pid;
}

/* Between open and flock a new file looks abandoned: if it is removed, it must not be used. */
static void test_sweeping_does_not_race_with_making(void **state)
{
    char path[SCRATCH_PATH_MAX];
    const pid_t sweeper = start_sweeper(scratch_path(state, path, "lock"));
    int made = 0, lost = 0;
    for (int i = 0; i < neph_test_by_day(500, 2000); i++) {
        const int fd = neph_lock_create(path);
        if (fd < 0) {
            assert_int_equal(errno, EEXIST);
            continue;
        }
        made++;
        sched_yield();
        lost += !neph_path_exists(path);
        unlink(path);
        close(fd);
    }
    kill(sweeper, SIGKILL);
    waitpid(sweeper, NULL, 0);
    assert_int_equal(lost, 0);
    assert_true(made > 0);
}

static void test_temporary_files_of_the_dead_are_swept(void **state)
{
    const struct scratch *scratch = *state;
    char path[SCRATCH_PATH_MAX];
    const int fd = neph_lock_create(scratch_path(state, path, ".neph-0123456789abcdef.tmp"));
    assert_true(fd >= 0); /* as neph_file_write() has it while writing */
    neph_assert_ok(neph_file_write(scratch_path(state, path, "mine.tmp"), "", 0, NULL), NULL);
    neph_assert_ok(neph_file_write(scratch_path(state, path, ".neph-owned"), "", 0, NULL), NULL);
    neph_file_sweep(scratch->folder);
    assert_int_equal(scratch_count(state), 3);
    close(fd);
    neph_file_sweep(scratch->folder);
    assert_int_equal(scratch_count(state), 2);
}

static void test_waiting_for_a_lock(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_diag diag = {0};
    int fd = -1, second = -1;
    neph_assert_ok(neph_lock_wait(scratch_path(state, path, "lock"), &fd, &diag), &diag);
    assert_int_equal(neph_lock_take_over(path), -1);
    close(fd);
    neph_assert_ok(neph_lock_wait(path, &second, &diag), &diag);
    close(second);
    assert_int_equal(neph_lock_wait(scratch_path(state, path, "no/lock"), &fd, &diag), NEPH_ERR_IO);
    assert_non_null(strstr(diag.message, path));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        scratch_test(test_a_lock_is_held_until_it_is_closed),
        scratch_test(test_only_plain_files_are_taken_over),
        scratch_test(test_scratch_is_empty_and_goes),
        scratch_test(test_scratch_that_was_renamed_stays),
        scratch_test(test_scratch_that_was_kept_is_not_swept),
        scratch_test(test_what_a_killed_process_left_is_swept),
        scratch_test(test_strangers_are_not_swept),
        scratch_test(test_sweeping_does_not_race_with_making),
        scratch_test(test_temporary_files_of_the_dead_are_swept),
        scratch_test(test_waiting_for_a_lock),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
