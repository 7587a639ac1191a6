/* SPDX-License-Identifier: MIT */
#include "harness/experiment/pool.h"

#include "base/interrupt.h"
#include "harness/progress.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

/* Time limit of one wait for messages; the receiver checks for interrupts this often. */
enum { HEAR_EVERY_MS = 1000 };

/* In memory that all processes share. */
struct neph_pool_queue {
    atomic_int next;
};

/* The worker processes, seen from the process that started them. */
struct crew {
    struct neph_pool_queue *queue;
    int tell_fd, hear_fd; /* ends of a SOCK_SEQPACKET socket, which keeps messages apart */
    pid_t *pids;
    int count;
    char *text; /* NEPH_POOL_TEXT_MAX bytes */
};

/* The work of every worker. */
struct duty {
    int workers;
    struct neph_shared_device *device;
    neph_pool_work *work;
    void *context;
};

int neph_worker_next(struct neph_worker *worker)
{
    return worker->queue ? atomic_fetch_add(&worker->queue->next, 1) : worker->next++;
}

void neph_worker_tell(const struct neph_worker *worker, const char *text)
{
    const size_t length = strlen(text);
    if (!worker->queue || length >= NEPH_POOL_TEXT_MAX)
        return;
    while (send(worker->told_fd, text, length, MSG_NOSIGNAL) < 0 && errno == EINTR)
        continue;
}

/* ---- worker processes ------------------------------------------------------------------------ */

static enum neph_status open_crew(int jobs, struct crew *crew, struct neph_diag *diag)
{
    int ends[2];
    *crew = (struct crew){.tell_fd = -1, .hear_fd = -1};
    void *memory = mmap(NULL, sizeof(struct neph_pool_queue), PROT_READ | PROT_WRITE,
                        MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    crew->queue = memory == MAP_FAILED ? NULL : memory;
    crew->pids = calloc((size_t)jobs, sizeof(*crew->pids));
    crew->text = malloc(NEPH_POOL_TEXT_MAX);
    if (!crew->queue || !crew->pids || !crew->text)
        return neph_fail_memory(diag);
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends))
        return neph_fail(diag, NEPH_ERR_IO, "processes cannot be heard: %s", strerror(errno));
    crew->tell_fd = ends[0];
    crew->hear_fd = ends[1];
    return NEPH_OK;
}

static void close_end(int *fd)
{
    if (*fd >= 0)
        close(*fd);
    *fd = -1;
}

/* Free the memory of a crew, after its processes have ended. */
static void close_crew(struct crew *crew)
{
    if (crew->queue)
        munmap(crew->queue, sizeof(*crew->queue));
    free(crew->pids);
    free(crew->text);
}

/* The life of a worker process. It ends with _exit(): the parent writes the buffered output. */
static void live(struct neph_worker *worker, pid_t parent, const struct duty *duty)
{
    struct neph_diag diag = {.line = 0};
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() == parent)
        duty->work(worker, duty->context, &diag);
    neph_shared_device_close(duty->device);
    _exit(EXIT_SUCCESS);
}

static enum neph_status start(struct crew *crew, int index, const struct duty *duty,
                              struct neph_diag *diag)
{
    struct neph_worker worker = {
        .index = index, .count = duty->workers, .queue = crew->queue, .told_fd = crew->tell_fd};
    const pid_t parent = getpid();
    fflush(NULL);
    const pid_t pid = fork();
    if (pid < 0)
        return neph_fail(diag, NEPH_ERR_IO, "no process could be started: %s", strerror(errno));
    if (pid == 0) {
        close(crew->hear_fd);
        live(&worker, parent, duty);
    }
    crew->pids[crew->count++] = pid;
    return NEPH_OK;
}

static void stop_all(const struct crew *crew)
{
    for (int i = 0; i < crew->count; i++)
        kill(crew->pids[i], SIGTERM);
}

/* Wait for all workers. A crashed worker is reported; its job is done once more in this process,
 * where it may crash again. */
static void wait_for_all(const struct crew *crew, bool are_stopped)
{
    for (int i = 0; i < crew->count; i++) {
        int how = 0;
        while (waitpid(crew->pids[i], &how, 0) < 0 && errno == EINTR)
            continue;
        if (!are_stopped && WIFSIGNALED(how))
            neph_progress_warn("worker %d was ended by signal %d (%s)", i + 1, WTERMSIG(how),
                               strsignal(WTERMSIG(how)));
    }
}

/* ---- receiving messages ---------------------------------------------------------------------- */

/* The next message; NULL: none within HEAR_EVERY_MS, or, with `*is_over`, no worker can send any
 * more. */
static const char *next_text(const struct crew *crew, bool *is_over)
{
    struct pollfd told = {.fd = crew->hear_fd, .events = POLLIN};
    *is_over = false;
    if (poll(&told, 1, HEAR_EVERY_MS) <= 0) /* a signal ends the wait as well */
        return NULL;
    const ssize_t length = recv(crew->hear_fd, crew->text, NEPH_POOL_TEXT_MAX - 1, 0);
    *is_over = length == 0 || (length < 0 && errno != EINTR);
    if (length <= 0)
        return NULL;
    crew->text[length] = '\0';
    return crew->text;
}

/* Receive messages until all workers have closed their ends of the socket. */
static enum neph_status hear_all(const struct crew *crew, neph_pool_hear *hear, void *context,
                                 struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    bool is_over = false;
    while (!status && !is_over) {
        if (neph_interrupted())
            return neph_fail(diag, NEPH_ERR_INTERRUPTED, "interrupted");
        const char *text = next_text(crew, &is_over);
        if (hear)
            status = hear(text, context, diag);
    }
    return status;
}

static enum neph_status run_parts(const struct duty *duty, neph_pool_hear *hear,
                                  struct neph_diag *diag)
{
    struct crew crew;
    neph_shared_device_close(duty->device);
    enum neph_status status = open_crew(duty->workers, &crew, diag);
    for (int i = 0; i < duty->workers && !status; i++)
        status = start(&crew, i + 1, duty, diag);
    if (!status) {
        close_end(&crew.tell_fd); /* only the workers send */
        status = hear_all(&crew, hear, duty->context, diag);
    }
    if (status)
        stop_all(&crew);
    close_end(&crew.tell_fd);
    close_end(&crew.hear_fd); /* unblocks workers that wait to send */
    wait_for_all(&crew, status != NEPH_OK);
    close_crew(&crew);
    return status;
}

enum neph_status neph_pool_run(int workers, struct neph_shared_device *device, neph_pool_work *work,
                               neph_pool_hear *hear, void *context, struct neph_diag *diag)
{
    struct neph_worker whole = {.count = workers};
    const struct duty duty = {workers, device, work, context};
    const enum neph_status status = workers > 1 ? run_parts(&duty, hear, diag) : NEPH_OK;
    return status ? status : work(&whole, context, diag);
}
