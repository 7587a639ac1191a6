/* SPDX-License-Identifier: MIT
 *
 * The process that reads the files of a sequence: a file that ends its process, a process that
 * something ends, and what they inherit. A pipe without a writer is a file that is never read.
 */
#include "tests/base/scratch.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/oiio.h"

static const char pixel[] = "P6\n1 1\n255\nabc";

/* ---- processes ------------------------------------------------------------------------------- */

/* The parent of a process, and the letter of its state; 0: there is no such process. */
static pid_t read_parent(pid_t pid, char *state)
{
    char path[64], text[512] = "", *end;
    int parent = 0;
    snprintf(path, sizeof(path), "/proc/%d/stat", pid);
    FILE *file = fopen(path, "r");
    const size_t got = file ? fread(text, 1, sizeof(text) - 1, file) : 0;
    if (file)
        fclose(file);
    text[got] = '\0';
    end = strrchr(text, ')');
    return end && sscanf(end + 1, " %c %d", state, &parent) == 2 ? parent : 0;
}

static bool is_running(pid_t pid)
{
    char state = 'Z';
    return read_parent(pid, &state) != 0 && state != 'Z';
}

/* The only child of a process; waits for it. */
static pid_t await_child(pid_t parent)
{
    for (;;) {
        DIR *folder = opendir("/proc");
        assert_non_null(folder);
        pid_t found = 0;
        for (const struct dirent *entry; !found && (entry = readdir(folder)) != NULL;) {
            char state;
            const pid_t pid = (pid_t)strtol(entry->d_name, NULL, 10);
            if (pid > 0 && read_parent(pid, &state) == parent && state != 'Z')
                found = pid;
        }
        closedir(folder);
        if (found)
            return found;
        usleep(1000);
    }
}

static void await_end(pid_t pid)
{
    while (is_running(pid))
        usleep(1000);
}

/* A file of /proc of a process, with a space for each zero byte. */
static void read_proc(pid_t pid, const char *name, char *text, size_t size)
{
    char path[64];
    snprintf(path, sizeof(path), "/proc/%d/%s", pid, name);
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    const size_t got = fread(text, 1, size - 1, file);
    fclose(file);
    text[got] = '\0';
    for (size_t i = 0; i < got; i++)
        text[i] = text[i] ? text[i] : ' ';
}

static int count_descriptors(pid_t pid)
{
    char path[64];
    int count = -2; /* . and .. */
    snprintf(path, sizeof(path), "/proc/%d/fd", pid);
    DIR *folder = opendir(path);
    assert_non_null(folder);
    while (readdir(folder))
        count++;
    closedir(folder);
    return count;
}

/* ---- readings -------------------------------------------------------------------------------- */

/* A reading on a thread of its own. */
struct reading {
    struct neph_oiio_server *server;
    char path[SCRATCH_PATH_MAX];
    enum neph_status status;
    struct neph_diag diag;
    pthread_t thread;
};

static void *read_path(void *context)
{
    struct reading *reading = context;
    struct neph_oiio_request request = {.part = -1,
                                        .side_max_px = 100,
                                        .cpu_limit_s = 10,
                                        .wall_limit_s = 100,
                                        .memory_limit_bytes = 1 << 20};
    struct neph_shared stream;
    snprintf(request.path, sizeof(request.path), "%s", reading->path);
    neph_assert_ok(neph_shared_create("test", &stream, NULL), NULL);
    reading->status = neph_oiio_server_read(reading->server, &request, &stream, &reading->diag);
    neph_shared_destroy(&stream);
    return NULL;
}

static void start_stuck(void **state, struct neph_oiio_server *server, struct reading *reading)
{
    *reading = (struct reading){.server = server};
    scratch_path(state, reading->path, "stuck.tif");
    assert_true(mkfifo(reading->path, 0600) == 0 || errno == EEXIST);
    assert_int_equal(pthread_create(&reading->thread, NULL, read_path, reading), 0);
}

static struct neph_oiio_server *create_server(void)
{
    struct neph_oiio_server *server = NULL;
    if (!neph_oiio_is_available()) {
        print_message("skipped: neph was built without OpenImageIO (libopenimageio-dev)\n");
        skip();
    }
    neph_assert_ok(neph_oiio_server_create(&server, NULL), NULL);
    return server;
}

static void read_pixel(void **state, struct neph_oiio_server *server)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_image *image = NULL;
    struct neph_diag diag = {0};
    scratch_path(state, path, "pixel.ppm");
    scratch_write(path, pixel, sizeof(pixel) - 1);
    neph_assert_ok(neph_oiio_read_part(path, NULL, server, &image, &diag), &diag);
    assert_int_equal(image->width_px, 1);
    neph_image_destroy(image);
}

/* ---- cases ----------------------------------------------------------------------------------- */

/* A file that ends its process by a signal is an error; files beside it and after it are read by
 * the same program. */
static void test_a_file_that_ends_its_process(void **state)
{
    static const struct {
        int signal;
        enum neph_status status;
        const char *words;
    } ends[] = {
        {SIGSEGV, NEPH_ERR_INPUT, "damaged: OpenImageIO crashed on it (signal 11)"},
        {SIGXCPU, NEPH_ERR_INPUT, "damaged: OpenImageIO did not end within"},
        {SIGALRM, NEPH_ERR_TIMEOUT, "OpenImageIO did not end within 100 s"},
    };
    struct neph_oiio_server *server = create_server();
    read_pixel(state, server);
    const pid_t program = await_child(getpid());
    for (size_t i = 0; i < COUNT(ends); i++) {
        struct reading reading;
        start_stuck(state, server, &reading);
        const pid_t job = await_child(program);
        read_pixel(state, server);
        assert_int_equal(kill(job, ends[i].signal), 0);
        pthread_join(reading.thread, NULL);
        assert_int_equal(reading.status, ends[i].status);
        assert_non_null(strstr(reading.diag.message, ends[i].words));
        read_pixel(state, server);
        assert_int_equal(await_child(getpid()), program);
    }
    neph_oiio_server_destroy(server);
    assert_false(is_running(program));
}

static void test_a_program_that_is_killed_is_started_again(void **state)
{
    struct neph_oiio_server *server = create_server();
    struct reading reading;
    start_stuck(state, server, &reading);
    const pid_t program = await_child(getpid()), job = await_child(program);
    assert_int_equal(kill(program, SIGKILL), 0);
    pthread_join(reading.thread, NULL);
    assert_int_equal(reading.status, NEPH_ERR_UNAVAILABLE);
    assert_non_null(strstr(reading.diag.message, "neph-image was ended (signal 9)"));
    await_end(job);
    read_pixel(state, server);
    const pid_t second = await_child(getpid());
    assert_int_not_equal(second, program);
    assert_int_equal(kill(second, SIGKILL), 0); /* between two files */
    assert_int_equal(waitid(P_PID, (id_t)second, &(siginfo_t){0}, WEXITED | WNOWAIT), 0);
    read_pixel(state, server);
    neph_oiio_server_destroy(server);
}

/* The end of neph by SIGKILL, while a file is read. */
static void test_nothing_outlives_neph(void **state)
{
    struct neph_oiio_server *server = create_server();
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "stuck.tif");
    const pid_t neph = fork();
    if (neph == 0) {
        struct reading reading;
        start_stuck(state, server, &reading);
        pthread_join(reading.thread, NULL);
        _exit(0);
    }
    const pid_t program = await_child(neph), job = await_child(program);
    kill(neph, SIGKILL);
    assert_int_equal(waitpid(neph, NULL, 0), neph);
    await_end(program);
    await_end(job);
    neph_oiio_server_destroy(server);
}

static void test_what_the_processes_inherit(void **state)
{
    struct neph_oiio_server *server = create_server();
    struct reading reading;
    static char text[16384];
    const int passed = open("/dev/null", O_RDONLY); /* without O_CLOEXEC */
    assert_true(passed >= 0);
    setenv("NEPH_TEST_SECRET", "1", 1);
    start_stuck(state, server, &reading);
    const pid_t program = await_child(getpid()), job = await_child(program);
    do /* its limits come before the file, and its descriptors before the limits */
        read_proc(job, "status", text, sizeof(text));
    while (!strstr(text, "Seccomp:\t2"));
    assert_non_null(strstr(text, "NoNewPrivs:\t1"));
    assert_int_equal(count_descriptors(job), 4); /* the first three and the stream */
    while (count_descriptors(program) < 5) /* two more: the answer, and the process of the file */
        usleep(1000);
    assert_int_equal(count_descriptors(program), 5);
    read_proc(program, "environ", text, sizeof(text));
    assert_non_null(strstr(text, "HOME=/nonexistent"));
    assert_null(strstr(text, "NEPH_TEST_SECRET"));
    read_proc(job, "limits", text, sizeof(text));
    assert_non_null(strstr(text, "Max core file size        0 "));
    assert_non_null(strstr(text, "Max cpu time              10 "));
    kill(job, SIGKILL);
    pthread_join(reading.thread, NULL);
    unsetenv("NEPH_TEST_SECRET");
    close(passed);
    neph_oiio_server_destroy(server);
}

/* A program of that name that is something else. */
static void test_a_program_that_does_not_work(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_oiio_server *server = create_server();
    struct reading reading = {.server = server};
    scratch_path(state, path, "neph-image");
    scratch_write(path, "#!/bin/sh\necho no libraries >&2\nexit 127\n", 41);
    assert_int_equal(chmod(path, 0700), 0);
    setenv("NEPH_IMAGE", path, 1);
    read_path(&reading);
    unsetenv("NEPH_IMAGE");
    assert_int_equal(reading.status, NEPH_ERR_UNAVAILABLE);
    assert_non_null(strstr(reading.diag.message, "exit code 127, 'no libraries'"));
    neph_oiio_server_destroy(server);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
#include "cases/test_oiio_server.inc"
    };
    return cmocka_run_group_tests(tests, scratch_setup, scratch_teardown);
}
