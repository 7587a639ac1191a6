/* SPDX-License-Identifier: MIT */
#include "base/interrupt.h"

#include <errno.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdint.h>
#include <sys/eventfd.h>
#include <unistd.h>

/* Lock-free, so the signal handler and all threads may access them. */
static atomic_int signal_count, acknowledged_count;
static atomic_int event_fd = -1;

static void on_signal(int number)
{
    int saved_errno = errno;
    int earlier = atomic_fetch_add(&signal_count, 1);
    if (earlier > 0 && number == SIGINT) {
        /* Only a second SIGINT ends the program: timeout(1) and supervisors send SIGTERM twice. */
        signal(number, SIG_DFL);
        raise(number); /* delivered when this handler returns */
    }
    /* The event is never read, so the descriptor stays readable for every later poll(). */
    uint64_t one = 1;
    ssize_t written = write(atomic_load(&event_fd), &one, sizeof(one));
    (void)written;
    errno = saved_errno;
}

static void install(int number)
{
    struct sigaction action = {.sa_handler = on_signal, .sa_flags = SA_RESTART};
    sigemptyset(&action.sa_mask);
    sigaction(number, &action, NULL);
}

void neph_interrupt_install(void)
{
    if (atomic_load(&event_fd) < 0)
        atomic_store(&event_fd, eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
    install(SIGTERM);
    /* A shell starts `neph &` in a script with SIGINT ignored; it must stay ignored. */
    struct sigaction inherited;
    if (sigaction(SIGINT, NULL, &inherited) == 0 && inherited.sa_handler != SIG_IGN)
        install(SIGINT);
    /* With an ignored SIGCHLD, which exec inherits, the exit codes of children would be lost. */
    signal(SIGCHLD, SIG_DFL);
    /* A file that reaches `ulimit -f` becomes an error of write() and not a sudden end. */
    signal(SIGXFSZ, SIG_IGN);
}

bool neph_interrupted(void)
{
    return atomic_load(&signal_count) > atomic_load(&acknowledged_count);
}

void neph_interrupt_acknowledge(void)
{
    atomic_store(&acknowledged_count, atomic_load(&signal_count));
}

int neph_interrupt_fd(void)
{
    return atomic_load(&event_fd);
}
