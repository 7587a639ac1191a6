/* SPDX-License-Identifier: MIT
 *
 * The installed build of a program, which is part of a job's key. Shell scripts replace the
 * program.
 */
#include "harness/engines/program.h"

#include "base/files.h"
#include "harness/engines/engines.h"
#include "harness/run/job.h"
#include "tests/neph_test.h"

#include <dirent.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

/* A folder that is both TMPDIR and first in PATH. */
struct place {
    char folder[64];
    char *path, *program; /* PATH before the test; the script's file */
};

static int set_up(void **state)
{
    struct place *place = calloc(1, sizeof(*place));
    strcpy(place->folder, "/tmp/neph-program-XXXXXX");
    assert_non_null(mkdtemp(place->folder));
    place->path = strdup(getenv("PATH"));
    place->program = neph_path_join(place->folder, "witness");
    char *longer = neph_format("%s:%s", place->folder, place->path);
    setenv("PATH", longer, 1);
    setenv("TMPDIR", place->folder, 1);
    free(longer);
    *state = place;
    return 0;
}

static int tear_down(void **state)
{
    struct place *place = *state;
    setenv("PATH", place->path, 1);
    unsetenv("TMPDIR");
    neph_dir_remove(place->folder, NULL);
    free(place->program);
    free(place->path);
    free(place);
    return 0;
}

static void install(const struct place *place, const char *script)
{
    neph_assert_ok(neph_file_write(place->program, script, strlen(script), NULL), NULL);
    assert_int_equal(chmod(place->program, 0755), 0);
}

static void ask(const char *expected_text, char build[NEPH_BUILD_SIZE])
{
    char *text = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_program_query_version("witness", "Witness ", 10.0, &text, build, &diag),
                   &diag);
    assert_string_equal(text, expected_text);
    assert_int_equal(strspn(build, "0123456789abcdef"), NEPH_BUILD_SIZE - 1);
    free(text);
}

/* The build depends on the program's file and output; its working folder is a new one at every call
 * and is removed from the output. */
static void test_a_build_is_its_file_and_its_words(void **state)
{
    const struct place *place = *state;
    char first[NEPH_BUILD_SIZE], build[NEPH_BUILD_SIZE];
    install(place, "#!/bin/sh\necho \"no $HOME/.witness\"\necho 'Witness 1.0'\n");
    ask("Witness 1.0\n", first);
    ask("Witness 1.0\n", build);
    assert_string_equal(build, first);
    install(place, "#!/bin/sh\necho \"no $HOME/.witness\"\necho 'Witness 1.0' # patched\n");
    ask("Witness 1.0\n", build);
    assert_string_not_equal(build, first);
}

static int count_entries(const char *path)
{
    DIR *folder = opendir(path);
    int count = 0;
    while (readdir(folder))
        count++;
    closedir(folder);
    return count - 2;
}

/* After a process is killed, the process that watches its children, and shares its lock, still runs
 * for a moment. */
static void wait_for_locks(const char *path)
{
    DIR *folder = opendir(path);
    for (const struct dirent *entry; (entry = readdir(folder));) {
        const size_t length = strlen(entry->d_name);
        if (length < 5 || strcmp(entry->d_name + length - 5, ".lock") != 0)
            continue;
        const int fd = openat(dirfd(folder), entry->d_name, O_RDONLY | O_CLOEXEC);
        assert_true(fd >= 0 && flock(fd, LOCK_EX) == 0);
        close(fd);
    }
    closedir(folder);
}

/* A probe killed with SIGKILL leaves a folder, which the next probe removes. */
static void test_a_killed_probe_is_swept(void **state)
{
    const struct place *place = *state;
    char build[NEPH_BUILD_SIZE];
    install(place, "#!/bin/sh\n: >\"$HOME/started\"; exec sleep 60\n");
    const pid_t neph = fork();
    if (neph == 0) {
        char *text = NULL;
        neph_program_query_version("witness", "Witness ", 60.0, &text, build, NULL);
        _exit(0);
    }
    while (count_entries(place->folder) < 3) /* the program, the folder, its lock */
        usleep(1000);
    kill(neph, SIGKILL);
    waitpid(neph, NULL, 0);
    assert_int_equal(count_entries(place->folder), 3);
    wait_for_locks(place->folder);
    install(place, "#!/bin/sh\necho 'Witness 1.0'\n");
    ask("Witness 1.0\n", build);
    assert_int_equal(count_entries(place->folder), 1);
}

static void test_failures(void **state)
{
    const struct place *place = *state;
    char *text = NULL, build[NEPH_BUILD_SIZE] = "";
    struct neph_diag diag = {0};
    install(place, "#!/bin/sh\necho broken; exit 3\n");
    assert_int_equal(neph_program_query_version("witness", "Witness ", 10.0, &text, build, &diag),
                     NEPH_ERR_ENGINE);
    assert_non_null(strstr(diag.message, "broken"));
    setenv("TMPDIR", "/nonexistent", 1);
    assert_int_equal(neph_program_query_version("witness", "Witness ", 10.0, &text, build, &diag),
                     NEPH_ERR_IO);
    assert_non_null(strstr(diag.message, "TMPDIR"));
    assert_null(text);
    assert_string_equal(build, "");
}

static void test_the_key_of_a_job_knows_the_build(void **state)
{
    struct neph_scene scene = {.name = "a"};
    struct neph_engine_info info = {.available = true, .version = "Witness 1.0", .build = "0a"};
    const struct neph_engine *engine = neph_engine_find("povray");
    const struct neph_job job = {
        .engine = engine,
        .info = &info,
        .shot = {.scene = &scene, .settings = neph_settings_default(engine)},
    };
    char one[NEPH_HASH_HEX_SIZE], other[NEPH_HASH_HEX_SIZE];
    neph_assert_ok(neph_job_key(&job, one, NULL), NULL);
    strcpy(info.build, "0b");
    neph_assert_ok(neph_job_key(&job, other, NULL), NULL);
    assert_string_not_equal(one, other);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_a_build_is_its_file_and_its_words, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_a_killed_probe_is_swept, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_failures, set_up, tear_down),
        cmocka_unit_test(test_the_key_of_a_job_knows_the_build),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
