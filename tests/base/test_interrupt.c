/* SPDX-License-Identifier: MIT
 *
 * The flag of an interrupt cannot be reset, so each test runs in a process of its own: it returns 0
 * or the line that failed.
 */
#include "tests/base/scratch.h"

#include "base/child.h"
#include "base/clock.h"
#include "base/interrupt.h"
#include "base/threads.h"

#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define CHECK(condition)                                                                           \
    do {                                                                                           \
        if (!(condition))                                                                          \
            return __LINE__;                                                                       \
    } while (0)

/* The exit code has 8 bits, a line number needs more: it is sent through the pipe. */
static int run_alone(int (*body)(void), int *signal_number)
{
    int fds[2], line = -1, wait_status = 0;
    assert_int_equal(pipe(fds), 0);
    pid_t pid = fork();
    if (pid == 0) {
        line = body();
        ssize_t written = write(fds[1], &line, sizeof(line));
        (void)written;
        _exit(0);
    }
    assert_true(pid > 0);
    close(fds[1]);
    ssize_t got = read(fds[0], &line, sizeof(line));
    close(fds[0]);
    assert_int_equal(waitpid(pid, &wait_status, 0), pid);
    *signal_number = WIFSIGNALED(wait_status) ? WTERMSIG(wait_status) : 0;
    return got == (ssize_t)sizeof(line) ? line : -1;
}

static void assert_alone(int (*body)(void))
{
    int signal_number = 0;
    int line = run_alone(body, &signal_number);
    if (line != 0 || signal_number != 0)
        print_error("failed in line %d, signal %d\n", line, signal_number);
    assert_int_equal(line, 0);
    assert_int_equal(signal_number, 0);
}

static bool is_readable(int fd)
{
    struct pollfd poll_fd = {.fd = fd, .events = POLLIN};
    return poll(&poll_fd, 1, 0) == 1 && (poll_fd.revents & POLLIN);
}

static int flag_and_descriptor(void)
{
    CHECK(neph_interrupt_fd() == -1);
    CHECK(!neph_interrupted());
    neph_interrupt_install();
    CHECK(neph_interrupt_fd() >= 0);
    CHECK(!neph_interrupted());
    CHECK(!is_readable(neph_interrupt_fd()));
    raise(SIGTERM);
    CHECK(neph_interrupted());
    CHECK(is_readable(neph_interrupt_fd()));
    CHECK(is_readable(neph_interrupt_fd())); /* and stays so */
    raise(SIGTERM);                          /* timeout(1) sends two; the clean-up continues */
    CHECK(neph_interrupted());
    return 0;
}

static int first_ctrl_c(void)
{
    neph_interrupt_install();
    raise(SIGINT);
    CHECK(neph_interrupted());
    CHECK(is_readable(neph_interrupt_fd()));
    return 0;
}

static int second_ctrl_c(void)
{
    neph_interrupt_install();
    raise(SIGINT);
    raise(SIGINT);
    return __LINE__; /* not reached */
}

static int ignored_ctrl_c(void)
{
    signal(SIGINT, SIG_IGN); /* as a shell does for `neph &` in a script */
    neph_interrupt_install();
    raise(SIGINT);
    CHECK(!neph_interrupted());
    return 0;
}

static void interrupt_in_row_10(int row, void *context)
{
    atomic_int *visits = context;
    atomic_fetch_add(visits, 1);
    if (row == 10)
        raise(SIGTERM);
}

static int rows_stop_early(void)
{
    neph_interrupt_install();
    atomic_int visits = 0;
    struct neph_diag diag = {0};
    CHECK(neph_parallel_rows(1000000, interrupt_in_row_10, &visits, &diag) == NEPH_ERR_INTERRUPTED);
    CHECK(visits >= 1 && visits < 1000000);
    CHECK(diag.message[0] != '\0');
    return 0;
}

/* All rows are done although the signal arrived: nothing was stopped, so nothing is reported. */
static int last_row_is_not_early(void)
{
    neph_interrupt_install();
    atomic_int visits = 0;
    CHECK(neph_parallel_rows(11, interrupt_in_row_10, &visits, NULL) == NEPH_OK || visits < 11);
    return 0;
}

static void *interrupt_soon(void *process)
{
    nanosleep(&(struct timespec){.tv_nsec = 200 * 1000 * 1000}, NULL);
    kill(*(pid_t *)process, SIGINT);
    return NULL;
}

static int child_is_stopped(void)
{
    neph_interrupt_install();
    pid_t self = getpid();
    pthread_t thread;
    CHECK(pthread_create(&thread, NULL, interrupt_soon, &self) == 0);
    const char *const argv[] = {"sleep", "60", NULL};
    struct neph_child_params params = {.argv = argv};
    struct neph_child_result result = {0};
    double start_s = neph_wall_s();
    CHECK(neph_child_run(&params, &result, NULL) == NEPH_ERR_INTERRUPTED);
    pthread_join(thread, NULL);
    CHECK(neph_wall_s() - start_s < 30.0);
    CHECK(result.signal == SIGTERM);
    CHECK(result.wall_s > 0.1);
    return 0;
}

/* The clean-up after Ctrl-C may start children, too: they run, and neph sleeps meanwhile. */
static int child_after_acknowledgement(void)
{
    neph_interrupt_install();
    raise(SIGINT);
    CHECK(neph_interrupted());
    neph_interrupt_acknowledge();
    const char *const argv[] = {"sleep", "0.5", NULL};
    struct neph_child_params params = {.argv = argv};
    struct neph_child_result result = {0};
    const double before_s = neph_cpu_s();
    CHECK(neph_child_run(&params, &result, NULL) == NEPH_OK);
    CHECK(neph_cpu_s() - before_s < 0.1);
    return 0;
}

/* A shell that ignores SIGCHLD must not hide exit codes from neph. */
static int inherited_sigchld(void)
{
    signal(SIGCHLD, SIG_IGN);
    neph_interrupt_install();
    const char *const argv[] = {"sh", "-c", "exit 7", NULL};
    struct neph_child_params params = {.argv = argv};
    struct neph_child_result result = {0};
    CHECK(neph_child_run(&params, &result, NULL) == NEPH_ERR_ENGINE);
    CHECK(result.exit_code == 7);
    return 0;
}

static void test_flag_and_descriptor(void **state)
{
    assert_alone(flag_and_descriptor);
    assert_alone(first_ctrl_c);
    assert_alone(ignored_ctrl_c);
}

static void test_second_ctrl_c_ends_the_program(void **state)
{
    int signal_number = 0;
    assert_int_equal(run_alone(second_ctrl_c, &signal_number), -1);
    assert_int_equal(signal_number, SIGINT);
}

static void test_parallel_rows_stop(void **state)
{
    assert_alone(rows_stop_early);
    assert_alone(last_row_is_not_early);
}

static void test_children_are_stopped(void **state)
{
    assert_alone(child_is_stopped);
    assert_alone(child_after_acknowledgement);
}

static void test_inherited_sigchld(void **state)
{
    assert_alone(inherited_sigchld);
}

#include "tests/main.h"
