/* SPDX-License-Identifier: MIT
 *
 * Children of all kinds. `test_child eat-memory MIB SECONDS` and `test_child burn-cpu SECONDS` are
 * programs with a known use of resources.
 */
#include "tests/base/scratch.h"

#include "base/child.h"
#include "base/clock.h"
#include "base/confine.h"

#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static const char self[] = "/proc/self/exe";

static void pause_s(double duration_s)
{
    struct timespec pause = {(time_t)duration_s,
                             (long)(1e9 * (duration_s - (double)(time_t)duration_s))};
    nanosleep(&pause, NULL);
}

static int eat_memory(const char *mib, const char *duration)
{
    size_t size = (size_t)atoi(mib) << 20;
    volatile char *memory = malloc(size);
    for (size_t i = 0; i < size; i += 4096)
        memory[i] = 1;
    pause_s(atof(duration));
    free((void *)memory);
    return 0;
}

static int burn_cpu(const char *duration)
{
    while (neph_cpu_s() < atof(duration))
        ;
    return 0;
}

/* Runs a shell script. `log_path` and `result` may be NULL. */
static enum neph_status run_shell(const char *script, const char *log_path, double time_limit_s,
                                  struct neph_child_result *result, struct neph_diag *diag)
{
    const char *const argv[] = {"sh", "-c", script, NULL};
    struct neph_child_params params = {
        .argv = argv, .log_path = log_path, .time_limit_s = time_limit_s};
    struct neph_child_result ignored;
    return neph_child_run(&params, result ? result : &ignored, diag);
}

static void assert_log(const char *path, const char *expected)
{
    char *text = NULL;
    size_t size = 0;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_file_read(path, 1 << 20, &text, &size, &diag), &diag);
    assert_string_equal(text, expected);
    free(text);
}

/* A process that has ended, or is a zombie that init has not reaped. */
static bool is_dead(pid_t pid)
{
    char path[64], text[512] = "";
    snprintf(path, sizeof(path), "/proc/%d/stat", (int)pid);
    int fd = open(path, O_RDONLY);
    if (fd < 0)
        return true;
    ssize_t got = read(fd, text, sizeof(text) - 1);
    close(fd);
    const char *name_end = strrchr(text, ')');
    return got <= 0 || !name_end || name_end[2] == 'Z' || name_end[2] == 'X';
}

static void assert_dies(pid_t pid)
{
    for (int i = 0; i < 500 && !is_dead(pid); i++)
        pause_s(0.01);
    assert_true(is_dead(pid));
}

/* Waits for the number that a script writes into a file. */
static pid_t read_pid(const char *path)
{
    for (int i = 0; i < 1000; i++) {
        FILE *file = fopen(path, "r");
        int pid = 0;
        char end = '\0'; /* the newline marks the number as complete */
        int found = file ? fscanf(file, "%d%c", &pid, &end) : 0;
        if (file)
            fclose(file);
        if (found == 2)
            return pid;
        pause_s(0.01);
    }
    fail_msg("no process number in '%s'", path);
    return -1;
}

/* ---- how it ends ----------------------------------------------------------------------------- */

static void test_success_and_log(void **state)
{
    char log[SCRATCH_PATH_MAX];
    scratch_path(state, log, "log");
    neph_assert_ok(neph_file_write(log, "of an earlier run", 17, NULL), NULL);
    struct neph_child_result result = {.exit_code = 99};
    struct neph_diag diag = {0};
    neph_assert_ok(run_shell("echo out; echo err >&2; echo out again", log, 0.0, &result, &diag),
                   &diag);
    assert_int_equal(result.exit_code, 0);
    assert_int_equal(result.signal, 0);
    assert_log(log, "out\nerr\nout again\n");
}

static void test_exit_codes(void **state)
{
    static const int codes[] = {1, 2, 42, 126, 127, 255};
    for (size_t i = 0; i < sizeof(codes) / sizeof(codes[0]); i++) {
        char script[32], words[32];
        snprintf(script, sizeof(script), "exit %d", codes[i]);
        snprintf(words, sizeof(words), "exit code %d", codes[i]);
        struct neph_child_result result = {0};
        struct neph_diag diag = {0};
        assert_int_equal(run_shell(script, NULL, 0.0, &result, &diag), NEPH_ERR_ENGINE);
        assert_int_equal(result.exit_code, codes[i]);
        assert_int_equal(result.signal, 0);
        assert_non_null(strstr(diag.message, words));
    }
}

static void test_end_by_signal(void **state)
{
    struct neph_child_result result = {.exit_code = 99};
    struct neph_diag diag = {0};
    assert_int_equal(run_shell("kill -SEGV $$", NULL, 0.0, &result, &diag), NEPH_ERR_ENGINE);
    assert_int_equal(result.signal, SIGSEGV);
    assert_int_equal(result.exit_code, 0);
    assert_non_null(strstr(diag.message, "signal 11 (Segmentation fault)"));
    assert_int_equal(run_shell("exit 3", NULL, 0.0, &result, NULL), NEPH_ERR_ENGINE); /* no diag */
}

static void test_failure_quotes_the_end_of_the_log(void **state)
{
    char log[SCRATCH_PATH_MAX];
    scratch_path(state, log, "log");
    struct neph_diag diag = {0};
    assert_int_equal(run_shell("for i in $(seq 1000); do echo line $i of the log; done;"
                               "printf 'render 10%%\\rrender 20%%\\r\\033[31mout of cheese\\n\\n';"
                               "exit 1",
                               log, 0.0, NULL, &diag),
                     NEPH_ERR_ENGINE);
    assert_non_null(strstr(diag.message, "line 1000 of the log\nrender 10%\nrender 20%\n"));
    assert_non_null(strstr(diag.message, "?[31mout of cheese"));
    assert_non_null(strstr(diag.message, "line 996 of"));
    assert_null(strstr(diag.message, "line 995 of")); /* eight lines */
    assert_non_null(strstr(diag.hint, log));
}

/* One endless line, truncated in the middle of a two-byte character. */
static void test_quote_fits_and_stays_utf8(void **state)
{
    char log[SCRATCH_PATH_MAX];
    scratch_path(state, log, "log");
    for (int shift = 0; shift < 2; shift++) {
        char script[128];
        snprintf(script, sizeof(script),
                 "printf '%%s' %s; i=0; while [ $i -lt 900 ]; do printf '\303\274'; i=$((i+1));"
                 "done; exit 1",
                 shift ? "x" : "''");
        struct neph_diag diag = {0};
        assert_int_equal(run_shell(script, log, 0.0, NULL, &diag), NEPH_ERR_ENGINE);
        const char *quote = strstr(diag.message, ":\n");
        assert_non_null(quote);
        assert_int_equal((unsigned char)quote[2], 0xc3);
        assert_int_equal((unsigned char)diag.message[strlen(diag.message) - 1], 0xbc);
    }
}

/* ---- its environment ------------------------------------------------------------------------- */

static void test_missing_programs(void **state)
{
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "program");
    const char *names[] = {"neph-no-such-program", "/no/such/program", "", path, "/tmp"};
    neph_assert_ok(neph_file_write(path, "#!/bin/sh\n", 10, NULL), NULL); /* not executable */
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
        const char *const argv[] = {names[i], NULL};
        struct neph_child_params params = {.argv = argv};
        struct neph_child_result result = {.exit_code = 99};
        struct neph_diag diag = {0};
        assert_false(neph_child_program_exists(names[i]));
        assert_int_equal(neph_child_run(&params, &result, &diag), NEPH_ERR_UNAVAILABLE);
        assert_non_null(strstr(diag.message, names[i]));
        assert_int_equal(result.exit_code, 99);
    }
    assert_true(neph_child_program_exists("sh"));
    assert_true(neph_child_program_exists("/bin/sh"));
}

/* They exist and are executable, but execve() fails, which only the child can detect. */
static void test_programs_that_cannot_start(void **state)
{
    static const char *const contents[] = {"#!/no/such/interpreter\n", "neither script nor ELF"};
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "program");
    for (size_t i = 0; i < sizeof(contents) / sizeof(contents[0]); i++) {
        neph_assert_ok(neph_file_write(path, contents[i], strlen(contents[i]), NULL), NULL);
        assert_int_equal(chmod(path, 0755), 0);
        const char *const argv[] = {path, NULL};
        struct neph_child_params params = {.argv = argv};
        struct neph_child_result result = {.exit_code = 99};
        struct neph_diag diag = {0};
        assert_true(neph_child_program_exists(path));
        assert_int_equal(neph_child_run(&params, &result, &diag), NEPH_ERR_UNAVAILABLE);
        assert_int_equal(result.exit_code, 99);
    }
}

static void test_working_directory(void **state)
{
    const struct scratch *scratch = *state;
    char log[SCRATCH_PATH_MAX];
    const char *const argv[] = {"pwd", NULL};
    struct neph_child_params params = {.argv = argv,
                                       .working_directory = scratch->folder,
                                       .log_path = scratch_path(state, log, "log")};
    struct neph_child_result result;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_child_run(&params, &result, &diag), &diag);
    char *expected = neph_format("%s\n", scratch->folder);
    assert_log(log, expected);
    free(expected);

    params.working_directory = "/no/such/folder";
    assert_int_equal(neph_child_run(&params, &result, &diag), NEPH_ERR_IO);
    assert_non_null(strstr(diag.message, "/no/such/folder"));
}

/* Changes by a confined program, or by a program that it starts, to files outside of its folder
 * have no effect; in its folder it is free. */
static void test_confined(void **state)
{
    char log[SCRATCH_PATH_MAX], own[SCRATCH_PATH_MAX], kept[SCRATCH_PATH_MAX],
        made[SCRATCH_PATH_MAX], inside[SCRATCH_PATH_MAX];
    neph_assert_ok(neph_dir_create(scratch_path(state, own, "own"), NULL), NULL);
    if (neph_confine_probe(own) > NEPH_CONFINE_WRITES)
        skip();
    neph_assert_ok(neph_file_write(scratch_path(state, kept, "kept"), "kept\n", 5, NULL), NULL);
    const char *const argv[] = {
        "sh", "-c",
        "sh -c 'echo gone > ../kept; rm ../kept; mv ../kept .; touch "
        "../made; mkdir ../folder; ln ../kept linked' 2> /dev/null; mkdir a "
        "&& echo in > a/file && mv a/file inside && cat ../kept inside",
        NULL};
    struct neph_child_params params = {.argv = argv,
                                       .working_directory = own,
                                       .log_path = scratch_path(state, log, "log"),
                                       .is_confined = true};
    struct neph_child_result result;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_child_run(&params, &result, &diag), &diag);
    assert_log(log, "kept\nin\n");
    assert_false(neph_path_exists(scratch_path(state, made, "made")));
    assert_false(neph_path_exists(scratch_path(state, made, "folder")));
    assert_true(neph_path_exists(scratch_path(state, inside, "own/inside")));
    params.is_confined = false; /* which prevents this */
    assert_int_equal(neph_child_run(&params, &result, &diag), NEPH_ERR_ENGINE); /* a exists */
    assert_true(neph_path_exists(scratch_path(state, made, "made")));
}

/* Ways to change a file's mode, times and attributes without writing into it, tried on ../kept; the
 * script ends with 0 if it may change a file of its own folder. */
static const char changes[] =
    "chmod 0777 ../kept; touch -d 2001-02-03 ../kept; chown 1:1 ../kept;"
    "python3 -c 'import os; os.setxattr(\"../kept\", \"user.a\", b\"b\")';"
    "exec 3< ../kept; chmod 0777 /proc/self/fd/3; exec 3<&-;"
    "(cd .. && chmod 0777 kept);"
    "touch own-file && chmod 0640 own-file && test $(stat -c %a own-file) = 640";

/* Runs `changes` confined in the folder "own" and compares the file next to it with its state
 * before. Returns the program's status. */
static enum neph_status try_changes(void **state)
{
    char log[SCRATCH_PATH_MAX], own[SCRATCH_PATH_MAX], kept[SCRATCH_PATH_MAX];
    scratch_path(state, own, "own");
    scratch_path(state, kept, "kept");
    const char *const argv[] = {"sh", "-c", changes, NULL};
    const struct neph_child_params params = {.argv = argv,
                                             .working_directory = own,
                                             .log_path = scratch_path(state, log, "own/log"),
                                             .is_confined = true};
    struct neph_child_result result;
    struct stat before, after;
    assert_int_equal(stat(kept, &before), 0);
    const enum neph_status status = neph_child_run(&params, &result, NULL);
    assert_int_equal(stat(kept, &after), 0);
    assert_int_equal(after.st_mode, before.st_mode);
    assert_int_equal(after.st_uid, before.st_uid);
    assert_int_equal(after.st_mtime, before.st_mtime);
    assert_int_equal(after.st_ctim.tv_sec, before.st_ctim.tv_sec);
    assert_int_equal(after.st_ctim.tv_nsec, before.st_ctim.tv_nsec);
    return status;
}

static void make_kept(void **state, uid_t owner)
{
    char own[SCRATCH_PATH_MAX], kept[SCRATCH_PATH_MAX];
    neph_assert_ok(neph_dir_create(scratch_path(state, own, "own"), NULL), NULL);
    neph_assert_ok(neph_file_write(scratch_path(state, kept, "kept"), "kept\n", 5, NULL), NULL);
    assert_int_equal(chmod(((const struct scratch *)*state)->folder, 0755), 0);
    if (owner != geteuid())
        assert_int_equal(chown(own, owner, owner) | chown(kept, owner, owner), 0);
}

static void test_confined_changes_no_modes(void **state)
{
    char own[SCRATCH_PATH_MAX];
    make_kept(state, geteuid());
    const enum neph_confinement reached = neph_confine_probe(scratch_path(state, own, "own"));
    if (reached > NEPH_CONFINE_NO_CHANGES)
        skip();
    assert_int_equal(try_changes(state) == NEPH_OK, reached == NEPH_CONFINE_TO_FOLDER);
}

/* Runs a test in a process of its own: returns its exit code. */
static int run_apart(void (*test)(void **state), void **state)
{
    int wait_status = -1;
    const pid_t pid = fork();
    if (pid == 0) {
        test(state);
        _exit(0);
    }
    assert_int_equal(waitpid(pid, &wait_status, 0), pid);
    return WIFEXITED(wait_status) ? WEXITSTATUS(wait_status) : -1;
}

enum { OTHER_USER = 12345, NOT_POSSIBLE = 77 };

/* A folder that its owner cannot read cannot be measured, but is removed anyway. */
static bool hide_a_folder(const char *own)
{
    const char *const argv[] = {"sh", "-c", "mkdir a; touch a/b; chmod 0 a", NULL};
    const struct neph_child_params params = {
        .argv = argv, .working_directory = own, .limits = {.folder_bytes = 1 << 20}};
    struct neph_child_result result;
    struct neph_diag diag = {0};
    char *hidden = neph_path_join(own, "a");
    const bool is_stopped = neph_child_run(&params, &result, &diag) == NEPH_ERR_ENGINE &&
                            strstr(diag.message, "cannot be read");
    const bool is_removed = neph_dir_remove(hidden, NULL) == NEPH_OK && !neph_path_exists(hidden);
    free(hidden);
    return is_stopped && is_removed;
}

static void as_another_user(void **state)
{
    char own[SCRATCH_PATH_MAX];
    if (setgid(OTHER_USER) != 0 || setuid(OTHER_USER) != 0)
        _exit(NOT_POSSIBLE);
    const enum neph_confinement reached = neph_confine_probe(scratch_path(state, own, "own"));
    if (reached > NEPH_CONFINE_NO_CHANGES)
        _exit(NOT_POSSIBLE);
    if ((try_changes(state) == NEPH_OK) != (reached == NEPH_CONFINE_TO_FOLDER))
        _exit(1);
    _exit(hide_a_folder(own) ? 0 : 2);
}

/* Without root privileges the mounts need a user namespace. */
static void test_confined_as_another_user(void **state)
{
    if (geteuid() != 0)
        skip();
    make_kept(state, OTHER_USER);
    const int code = run_apart(as_another_user, state);
    if (code == NOT_POSSIBLE)
        skip();
    assert_int_equal(code, 0);
}

static bool write_number(const char *path, const char *number)
{
    const int fd = open(path, O_WRONLY | O_CLOEXEC);
    const bool is_written = fd >= 0 && write(fd, number, strlen(number)) == (ssize_t)strlen(number);
    if (fd >= 0)
        close(fd);
    return is_written;
}

/* As on systems that do not allow users to create namespaces. */
static void without_namespaces(void **state)
{
    char own[SCRATCH_PATH_MAX];
    if (unshare(CLONE_NEWUSER) != 0 || !write_number("/proc/self/setgroups", "deny") ||
        !write_number("/proc/self/uid_map", "0 0 1") ||
        !write_number("/proc/self/gid_map", "0 0 1") ||
        !write_number("/proc/sys/user/max_mnt_namespaces", "0"))
        _exit(NOT_POSSIBLE);
    const enum neph_confinement reached = neph_confine_probe(scratch_path(state, own, "own"));
    if (reached != NEPH_CONFINE_NO_CHANGES) /* Landlock or seccomp is missing */
        _exit(reached == NEPH_CONFINE_TO_FOLDER ? 1 : NOT_POSSIBLE);
    _exit(try_changes(state) == NEPH_ERR_ENGINE ? 0 : 2);
}

static void test_confined_without_namespaces(void **state)
{
    if (geteuid() != 0)
        skip();
    make_kept(state, geteuid());
    const int code = run_apart(without_namespaces, state);
    if (code == NOT_POSSIBLE)
        skip();
    assert_int_equal(code, 0);
}

/* ---- how much it writes ---------------------------------------------------------------------- */

static const struct neph_child_limits tight = {
    .folder_bytes = 1 << 20, .folder_entries = 20, .log_bytes = 1 << 16};

static void assert_stopped(void **state, const char *script, const char *words)
{
    char own[SCRATCH_PATH_MAX], log[SCRATCH_PATH_MAX];
    neph_assert_ok(neph_dir_create(scratch_path(state, own, "own"), NULL), NULL);
    const char *const argv[] = {"sh", "-c", script, NULL};
    const struct neph_child_params params = {.argv = argv,
                                             .working_directory = own,
                                             .log_path = scratch_path(state, log, "own/log"),
                                             .limits = tight};
    struct neph_child_result result = {0};
    struct neph_diag diag = {0};
    assert_int_equal(neph_child_run(&params, &result, &diag), NEPH_ERR_ENGINE);
    if (!strstr(diag.message, words))
        fail_msg("'%s' is not in: %s", words, diag.message);
    struct stat info;
    assert_int_equal(stat(log, &info), 0);
    assert_true(info.st_size <= tight.log_bytes);
    neph_assert_ok(neph_dir_remove(own, NULL), NULL);
}

static void test_limits(void **state)
{
    assert_stopped(state, "head -c 2M /dev/zero > a; sleep 60", "more than 1 MiB");
    assert_stopped(state, "mkdir b; head -c 2M /dev/zero > b/a", "more than 1 MiB");
    assert_stopped(state, "for i in $(seq 30); do echo > $i; done; sleep 60", "more than 20 files");
    assert_stopped(state, "for i in $(seq 30); do mkdir a; cd a; done", "more than 20 files");
    assert_stopped(state, "yes", "printed more than");
    assert_stopped(state, "head -c 100K /dev/zero; exit 3", "printed more than");
}

/* A sparse file uses no space but has a large size: a confined program cannot create it. */
static void test_a_file_of_a_confined_program(void **state)
{
    char own[SCRATCH_PATH_MAX];
    neph_assert_ok(neph_dir_create(scratch_path(state, own, "own"), NULL), NULL);
    const char *const argv[] = {"truncate", "-s", "2M", "a", NULL};
    const struct neph_child_params params = {
        .argv = argv, .working_directory = own, .is_confined = true, .limits = tight};
    struct neph_child_result result = {0};
    struct neph_diag diag = {0};
    assert_int_equal(neph_child_run(&params, &result, &diag), NEPH_ERR_ENGINE);
    assert_int_equal(result.signal, SIGXFSZ);
}

/* A relative path refers to the current folder, even if the child works elsewhere. */
static void test_relative_program(void **state)
{
    const struct scratch *scratch = *state;
    char path[SCRATCH_PATH_MAX];
    static const char script[] = "#!/bin/sh\nexit 5\n";
    neph_assert_ok(
        neph_file_write(scratch_path(state, path, "program"), script, sizeof(script) - 1, NULL),
        NULL);
    assert_int_equal(chmod(path, 0755), 0);
    char *before = getcwd(NULL, 0);
    assert_int_equal(chdir(scratch->folder), 0);
    const char *const argv[] = {"./program", NULL};
    struct neph_child_params params = {.argv = argv, .working_directory = "/"};
    struct neph_child_result result = {0};
    enum neph_status status = neph_child_run(&params, &result, NULL);
    assert_int_equal(chdir(before), 0);
    free(before);
    assert_int_equal(status, NEPH_ERR_ENGINE);
    assert_int_equal(result.exit_code, 5);
}

/* PATH and the caller's variables, and no other variables of the user, whose settings do not apply
 * to the child. */
static void test_environment(void **state)
{
    const struct scratch *scratch = *state;
    char log[SCRATCH_PATH_MAX];
    const char *const argv[] = {"env", NULL};
    const char *const more[] = {"NEPH_ONLY=this", NULL};
    struct neph_child_params params = {.argv = argv, .log_path = scratch_path(state, log, "log")};
    struct neph_child_result result;
    struct neph_diag diag = {0};
    setenv("NEPH_TEST_INHERITED", "yes", 1);
    setenv("LD_LIBRARY_PATH", "/nonexistent", 1);
    neph_assert_ok(neph_child_run(&params, &result, &diag), &diag);
    char *expected = neph_format("PATH=%s\nLANG=C.UTF-8\nHOME=/nonexistent\n", getenv("PATH"));
    assert_log(log, expected);
    free(expected);

    params.home = scratch->folder;
    params.environment = more;
    neph_assert_ok(neph_child_run(&params, &result, &diag), &diag);
    unsetenv("NEPH_TEST_INHERITED");
    unsetenv("LD_LIBRARY_PATH");
    expected = neph_format("PATH=%s\nLANG=C.UTF-8\nHOME=%s\nTMPDIR=%s\nNEPH_ONLY=this\n",
                           getenv("PATH"), scratch->folder, scratch->folder);
    assert_log(log, expected);
    free(expected);
}

/* A relative home refers to the current folder, whichever folder the child works in. */
static void test_relative_home(void **state)
{
    const struct scratch *scratch = *state;
    char log[SCRATCH_PATH_MAX];
    const char *const argv[] = {"sh", "-c", "cd \"$HOME\" && pwd", NULL};
    struct neph_child_params params = {.argv = argv,
                                       .working_directory = "/",
                                       .home = ".",
                                       .log_path = scratch_path(state, log, "log")};
    struct neph_child_result result;
    struct neph_diag diag = {0};
    char *before = getcwd(NULL, 0);
    assert_int_equal(chdir(scratch->folder), 0);
    const enum neph_status status = neph_child_run(&params, &result, &diag);
    assert_int_equal(chdir(before), 0);
    free(before);
    neph_assert_ok(status, &diag);
    char *expected = neph_format("%s\n", scratch->folder);
    assert_log(log, expected);
    free(expected);
}

static void test_log_that_cannot_be_written(void **state)
{
    char log[SCRATCH_PATH_MAX];
    struct neph_diag diag = {0};
    assert_int_equal(run_shell("true", scratch_path(state, log, "no/log"), 0.0, NULL, &diag),
                     NEPH_ERR_IO);
    assert_non_null(strstr(diag.message, log));
}

/* No terminal, no signals blocked or ignored, no open files except the three. */
static void test_child_starts_clean(void **state)
{
    char log[SCRATCH_PATH_MAX];
    scratch_path(state, log, "log");
    int leaked_fd = dup2(open("/dev/null", O_RDONLY), 77); /* without O_CLOEXEC */
    assert_int_equal(leaked_fd, 77);
    sigset_t blocked, before;
    sigemptyset(&blocked);
    sigaddset(&blocked, SIGUSR1);
    sigprocmask(SIG_BLOCK, &blocked, &before);
    void (*sigpipe)(int) = signal(SIGPIPE, SIG_IGN);
    void (*sigxfsz)(int) = signal(SIGXFSZ, SIG_IGN);
    struct neph_diag diag = {0};
    enum neph_status status = run_shell("test ! -e /proc/self/fd/77 || echo file;"
                                        "grep SigBlk /proc/self/status | tr -d '\\t';"
                                        "grep SigIgn /proc/self/status | tr -d '\\t';"
                                        "readlink /proc/self/fd/0",
                                        log, 0.0, NULL, &diag);
    signal(SIGXFSZ, sigxfsz);
    signal(SIGPIPE, sigpipe);
    sigprocmask(SIG_SETMASK, &before, NULL);
    close(leaked_fd);
    neph_assert_ok(status, &diag);
    assert_log(log, "SigBlk:0000000000000000\nSigIgn:0000000000000000\n/dev/null\n");
}

/* ---- how it is stopped ----------------------------------------------------------------------- */

static void test_timeout(void **state)
{
    char log[SCRATCH_PATH_MAX];
    struct neph_child_result result = {0};
    struct neph_diag diag = {0};
    double start_s = neph_wall_s();
    assert_int_equal(run_shell("echo started; exec sleep 60", scratch_path(state, log, "log"), 0.3,
                               &result, &diag),
                     NEPH_ERR_TIMEOUT);
    assert_true(neph_wall_s() - start_s < 30.0);
    assert_int_equal(result.signal, SIGTERM);
    assert_true(result.wall_s >= 0.3);
    assert_non_null(strstr(diag.message, "time limit of 0.3 s"));
    assert_non_null(strstr(diag.message, "started"));
    assert_log(log, "started\n");
}

static void test_no_timeout_when_in_time(void **state)
{
    struct neph_child_result result = {0};
    struct neph_diag diag = {0};
    neph_assert_ok(run_shell("sleep 0.1", NULL, 60.0, &result, &diag), &diag);
    assert_true(result.wall_s >= 0.1);
    assert_true(result.wall_s < 30.0);
}

/* A child that ends cleanly on SIGTERM has still exceeded its time. */
static void test_exit_0_on_sigterm_is_still_a_timeout(void **state)
{
    struct neph_child_result result = {.exit_code = 99};
    assert_int_equal(
        run_shell("trap 'exit 0' TERM; while :; do sleep 0.05; done", NULL, 0.3, &result, NULL),
        NEPH_ERR_TIMEOUT);
    assert_int_equal(result.exit_code, 0);
    assert_int_equal(result.signal, 0);
}

static void test_sigkill_after_two_seconds(void **state)
{
    struct neph_child_result result = {0};
    assert_int_equal(
        run_shell("trap '' TERM; while :; do sleep 0.05; done", NULL, 0.2, &result, NULL),
        NEPH_ERR_TIMEOUT);
    assert_int_equal(result.signal, SIGKILL);
    assert_true(result.wall_s >= 2.2);
    assert_true(result.wall_s < 30.0);
}

static void test_timeout_kills_grandchildren(void **state)
{
    char path[SCRATCH_PATH_MAX], script[SCRATCH_PATH_MAX + 128];
    scratch_path(state, path, "pid");
    snprintf(script, sizeof(script), "(trap '' TERM; exec sleep 61) & echo $! > %s; wait", path);
    assert_int_equal(run_shell(script, NULL, 0.5, NULL, NULL), NEPH_ERR_TIMEOUT);
    assert_dies(read_pid(path));
}

/* A daemon that the program leaves would use the processors of the next job. */
static void test_leftovers_are_killed(void **state)
{
    char path[SCRATCH_PATH_MAX], script[SCRATCH_PATH_MAX + 128];
    struct neph_diag diag = {0};
    scratch_path(state, path, "pid");
    snprintf(script, sizeof(script), "sleep 62 & echo $! > %s", path);
    double start_s = neph_wall_s();
    neph_assert_ok(run_shell(script, NULL, 0.0, NULL, &diag), &diag);
    assert_true(neph_wall_s() - start_s < 30.0);
    assert_dies(read_pid(path));
}

/* An engine behind a script: the script continues while the engine does, in its own session. */
static void write_wrapper(char script[2 * SCRATCH_PATH_MAX], const char *pid_path, const char *then)
{
    snprintf(script, 2 * SCRATCH_PATH_MAX,
             "(setsid sh -c 'echo $$ > %s; trap \"\" TERM HUP; while :; do sleep 0.1; done' &); "
             "while ! test -s %s; do sleep 0.01; done; %s",
             pid_path, pid_path, then);
}

static void test_nothing_escapes_into_another_session(void **state)
{
    char path[SCRATCH_PATH_MAX], script[2 * SCRATCH_PATH_MAX];
    struct neph_diag diag = {0};
    write_wrapper(script, scratch_path(state, path, "left"), "true");
    neph_assert_ok(run_shell(script, NULL, 0.0, NULL, &diag), &diag);
    assert_true(is_dead(read_pid(path)));

    write_wrapper(script, scratch_path(state, path, "late"), "exec sleep 60");
    assert_int_equal(run_shell(script, NULL, 0.5, NULL, NULL), NEPH_ERR_TIMEOUT);
    assert_true(is_dead(read_pid(path)));
}

/* Runs the script in a process in place of neph, and kills this process with its group. */
static void kill_neph_in(const char *script, const char *pid_path)
{
    const pid_t neph = fork();
    if (neph == 0) {
        setpgid(0, 0);
        run_shell(script, NULL, 0.0, NULL, NULL);
        _exit(0);
    }
    const pid_t child = read_pid(pid_path);
    assert_false(is_dead(child));
    assert_int_equal(kill(-neph, SIGKILL), 0);
    assert_int_equal(waitpid(neph, NULL, 0), neph);
    assert_dies(child);
}

/* SIGKILL of neph: the child dies, and an engine behind a wrapper as well. */
static void test_child_dies_with_us(void **state)
{
    char path[SCRATCH_PATH_MAX], script[2 * SCRATCH_PATH_MAX];
    scratch_path(state, path, "pid");
    snprintf(script, sizeof(script), "echo $$ > %s; exec sleep 63", path);
    kill_neph_in(script, path);
    write_wrapper(script, scratch_path(state, path, "wrapped"), "exec sleep 64");
    kill_neph_in(script, path);
}

/* Killing the process between neph and the child ends the child, and is reported. */
static void test_child_dies_with_its_keeper(void **state)
{
    char path[SCRATCH_PATH_MAX], script[SCRATCH_PATH_MAX + 64];
    struct neph_diag diag = {0};
    scratch_path(state, path, "pid");
    snprintf(script, sizeof(script), "echo $$ > %s; kill -9 $PPID; exec sleep 65", path);
    const double start_s = neph_wall_s();
    assert_int_equal(run_shell(script, NULL, 0.0, NULL, &diag), NEPH_ERR_ENGINE);
    assert_true(neph_wall_s() - start_s < 30.0);
    assert_non_null(strstr(diag.message, "supervisor process of 'sh'"));
    assert_dies(read_pid(path));
}

/* ---- its use of resources -------------------------------------------------------------------- */

static void run_self(const char *const *argv, struct neph_child_result *result)
{
    struct neph_child_params params = {.argv = argv, .time_limit_s = 60.0};
    struct neph_diag diag = {0};
    neph_assert_ok(neph_child_run(&params, result, &diag), &diag);
}

static void test_cpu_time(void **state)
{
    struct neph_child_result result;
    const char *const burn[] = {self, "burn-cpu", "0.3", NULL};
    run_self(burn, &result);
    assert_true(result.cpu_s >= 0.28); /* the two clocks of the kernel differ by a tick */
    assert_true(result.cpu_s < 3.0);
    assert_true(result.wall_s >= 0.28);
    const char *const idle[] = {"sleep", "0.3", NULL};
    run_self(idle, &result);
    assert_true(result.cpu_s < 0.1);
    assert_true(result.wall_s >= 0.3);
}

static void test_cpu_time_of_grandchildren(void **state)
{
    struct neph_child_result result;
    struct neph_diag diag = {0};
    char *script = NULL, *program = realpath(self, NULL);
    script = neph_format("'%s' burn-cpu 0.2; '%s' burn-cpu 0.2; true", program, program);
    neph_assert_ok(run_shell(script, NULL, 60.0, &result, &diag), &diag);
    assert_true(result.cpu_s >= 0.36);
    free(script);
    free(program);
}

/* neph does not wait for an engine that its wrapper has abandoned, but the engine's work counts. */
static void test_cpu_time_of_orphans(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_child_result result;
    struct neph_diag diag = {0};
    char *program = realpath(self, NULL);
    scratch_path(state, path, "done");
    char *script = neph_format("(setsid sh -c '\"%s\" burn-cpu 0.2; : > %s' &); "
                               "while ! test -e %s; do sleep 0.01; done",
                               program, path, path);
    neph_assert_ok(run_shell(script, NULL, 60.0, &result, &diag), &diag);
    assert_true(result.cpu_s >= 0.18);
    free(script);
    free(program);
}

static void test_peak_memory(void **state)
{
    static const int64_t mib = 1 << 20;
    struct neph_child_result small, large;
    const char *const small_argv[] = {self, "eat-memory", "1", "0", NULL};
    const char *const large_argv[] = {self, "eat-memory", "200", "0", NULL};
    run_self(small_argv, &small);
    run_self(large_argv, &large);
    assert_true(small.peak_memory_bytes > mib / 2);
    assert_true(large.peak_memory_bytes > 200 * mib);
    assert_true(large.peak_memory_bytes - small.peak_memory_bytes > 150 * mib);
#ifndef __SANITIZE_THREAD__ /* which needs several shadow bytes per byte */
    assert_true(large.peak_memory_bytes - small.peak_memory_bytes < 250 * mib);
#endif
}

/* The kernel counts the memory of the process that forked; a job must not include neph's memory. */
static void test_our_own_memory_is_not_the_childs(void **state)
{
    static const int64_t mib = 1 << 20;
    size_t size = (size_t)(300 * mib);
    volatile char *ours = malloc(size);
    for (size_t i = 0; i < size; i += 4096)
        ours[i] = 1;
    struct neph_child_result result;
    const char *const small[] = {"sleep", "0.4", NULL};
    run_self(small, &result);
    int64_t small_bytes = result.peak_memory_bytes;
    const char *const large[] = {self, "eat-memory", "450", "0.4", NULL};
    run_self(large, &result);
    int64_t large_bytes = result.peak_memory_bytes;
    free((void *)ours);
    assert_true(small_bytes > 0);
    assert_true(small_bytes < 100 * mib);
    assert_true(large_bytes > 450 * mib);
}

int main(int argc, char **argv)
{
    if (argc == 4 && strcmp(argv[1], "eat-memory") == 0)
        return eat_memory(argv[2], argv[3]);
    if (argc == 3 && strcmp(argv[1], "burn-cpu") == 0)
        return burn_cpu(argv[2]);
    const struct CMUnitTest tests[] = {
        scratch_test(test_success_and_log),
        cmocka_unit_test(test_exit_codes),
        cmocka_unit_test(test_end_by_signal),
        scratch_test(test_failure_quotes_the_end_of_the_log),
        scratch_test(test_quote_fits_and_stays_utf8),
        scratch_test(test_missing_programs),
        scratch_test(test_programs_that_cannot_start),
        scratch_test(test_working_directory),
        scratch_test(test_confined),
        scratch_test(test_confined_changes_no_modes),
        scratch_test(test_confined_as_another_user),
        scratch_test(test_confined_without_namespaces),
        scratch_test(test_limits),
        scratch_test(test_a_file_of_a_confined_program),
        scratch_test(test_relative_program),
        scratch_test(test_environment),
        scratch_test(test_relative_home),
        scratch_test(test_log_that_cannot_be_written),
        scratch_test(test_child_starts_clean),
        scratch_test(test_timeout),
        cmocka_unit_test(test_no_timeout_when_in_time),
        cmocka_unit_test(test_exit_0_on_sigterm_is_still_a_timeout),
        cmocka_unit_test(test_sigkill_after_two_seconds),
        scratch_test(test_timeout_kills_grandchildren),
        scratch_test(test_leftovers_are_killed),
        scratch_test(test_nothing_escapes_into_another_session),
        scratch_test(test_child_dies_with_us),
        scratch_test(test_child_dies_with_its_keeper),
        cmocka_unit_test(test_cpu_time),
        cmocka_unit_test(test_cpu_time_of_grandchildren),
        scratch_test(test_cpu_time_of_orphans),
        cmocka_unit_test(test_peak_memory),
        cmocka_unit_test(test_our_own_memory_is_not_the_childs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
