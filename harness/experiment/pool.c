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
enum { RECEIVE_TIMEOUT_MS = 1000 };

/* In memory that all processes share. */
struct neph_pool_queue {
    atomic_int next;
};

/* The worker processes, seen from the process that started them. */
struct worker_processes {
    struct neph_pool_queue *queue;
    int worker_fd, receiver_fd; /* ends of a SOCK_SEQPACKET socket, which keeps messages apart */
    pid_t *pids;
    int count;
    char *text; /* NEPH_POOL_TEXT_MAX bytes */
};

/* The work of every worker. */
struct worker_task {
    int workers;
    struct neph_shared_device *device;
    neph_pool_work *work;
    void *context;
};

int neph_worker_take_job(struct neph_worker *worker)
{
    return worker->queue ? atomic_fetch_add(&worker->queue->next, 1) : worker->next++;
}

void neph_worker_send_message(const struct neph_worker *worker, const char *text)
{
    const size_t length = strlen(text);
    if (!worker->queue || length >= NEPH_POOL_TEXT_MAX)
        return;
    while (send(worker->message_fd, text, length, MSG_NOSIGNAL) < 0 && errno == EINTR)
        continue;
}

/* ---- worker processes ------------------------------------------------------------------------ */

static enum neph_status open_worker_processes(int jobs, struct worker_processes *worker_processes,
                                              struct neph_diag *diag)
{
    int ends[2];
    *worker_processes = (struct worker_processes){.worker_fd = -1, .receiver_fd = -1};
    void *memory = mmap(NULL, sizeof(struct neph_pool_queue), PROT_READ | PROT_WRITE,
                        MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    worker_processes->queue = memory == MAP_FAILED ? NULL : memory;
    worker_processes->pids = calloc((size_t)jobs, sizeof(*worker_processes->pids));
    worker_processes->text = malloc(NEPH_POOL_TEXT_MAX);
    if (!worker_processes->queue || !worker_processes->pids || !worker_processes->text)
        return neph_fail_memory(diag);
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends))
        return neph_fail(diag, NEPH_ERR_IO, "processes cannot be heard: %s", strerror(errno));
    worker_processes->worker_fd = ends[0];
    worker_processes->receiver_fd = ends[1];
    return NEPH_OK;
}

static void close_end(int *fd)
{
    if (*fd >= 0)
        close(*fd);
    *fd = -1;
}

/* Free the memory of a crew, after its processes have ended. */
static void free_worker_processes(struct worker_processes *worker_processes)
{
    if (worker_processes->queue)
        munmap(worker_processes->queue, sizeof(*worker_processes->queue));
    free(worker_processes->pids);
    free(worker_processes->text);
}

/* The life of a worker process. It ends with _exit(): the parent writes the buffered output. */
static void run_worker_process(struct neph_worker *worker, pid_t parent,
                               const struct worker_task *worker_task)
{
    struct neph_diag diag = {.line = 0};
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() == parent)
        worker_task->work(worker, worker_task->context, &diag);
    neph_shared_device_close(worker_task->device);
    _exit(EXIT_SUCCESS);
}

static enum neph_status start(struct worker_processes *worker_processes, int index,
                              const struct worker_task *worker_task, struct neph_diag *diag)
{
    struct neph_worker worker = {.index = index,
                                 .count = worker_task->workers,
                                 .queue = worker_processes->queue,
                                 .message_fd = worker_processes->worker_fd};
    const pid_t parent = getpid();
    fflush(NULL);
    const pid_t pid = fork();
    if (pid < 0)
        return neph_fail(diag, NEPH_ERR_IO, "no process could be started: %s", strerror(errno));
    if (pid == 0) {
        close(worker_processes->receiver_fd);
        run_worker_process(&worker, parent, worker_task);
    }
    worker_processes->pids[worker_processes->count++] = pid;
    return NEPH_OK;
}

static void stop_all(const struct worker_processes *worker_processes)
{
    for (int i = 0; i < worker_processes->count; i++)
        kill(worker_processes->pids[i], SIGTERM);
}

/* Wait for all workers. A crashed worker is reported; its job is done once more in this process,
 * where it may crash again. */
static void wait_for_all(const struct worker_processes *worker_processes, bool are_stopped)
{
    for (int i = 0; i < worker_processes->count; i++) {
        int how = 0;
        while (waitpid(worker_processes->pids[i], &how, 0) < 0 && errno == EINTR)
            continue;
        if (!are_stopped && WIFSIGNALED(how))
            neph_progress_warn("worker %d was ended by signal %d (%s)", i + 1, WTERMSIG(how),
                               strsignal(WTERMSIG(how)));
    }
}

/* ---- receiving messages ---------------------------------------------------------------------- */

/* The next message; NULL: none within RECEIVE_TIMEOUT_MS, or, with `*is_over`, no worker can send
 * any more. */
static const char *next_text(const struct worker_processes *worker_processes, bool *is_over)
{
    struct pollfd told = {.fd = worker_processes->receiver_fd, .events = POLLIN};
    *is_over = false;
    if (poll(&told, 1, RECEIVE_TIMEOUT_MS) <= 0) /* a signal ends the wait as well */
        return NULL;
    const ssize_t length = recv(worker_processes->receiver_fd, worker_processes->text,
                                NEPH_POOL_TEXT_MAX - 1, 0);
    *is_over = length == 0 || (length < 0 && errno != EINTR);
    if (length <= 0)
        return NULL;
    worker_processes->text[length] = '\0';
    return worker_processes->text;
}

/* Receive messages until all workers have closed their ends of the socket. */
static enum neph_status receive_messages(const struct worker_processes *worker_processes,
                                         neph_pool_receive *hear, void *context,
                                         struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    bool is_over = false;
    while (!status && !is_over) {
        if (neph_interrupted())
            return neph_fail(diag, NEPH_ERR_INTERRUPTED, "interrupted");
        const char *text = next_text(worker_processes, &is_over);
        if (hear)
            status = hear(text, context, diag);
    }
    return status;
}

static enum neph_status run_parts(const struct worker_task *worker_task, neph_pool_receive *hear,
                                  struct neph_diag *diag)
{
    struct worker_processes worker_processes;
    neph_shared_device_close(worker_task->device);
    enum neph_status status = open_worker_processes(worker_task->workers, &worker_processes, diag);
    for (int i = 0; i < worker_task->workers && !status; i++)
        status = start(&worker_processes, i + 1, worker_task, diag);
    if (!status) {
        close_end(&worker_processes.worker_fd); /* only the workers send */
        status = receive_messages(&worker_processes, hear, worker_task->context, diag);
    }
    if (status)
        stop_all(&worker_processes);
    close_end(&worker_processes.worker_fd);
    close_end(&worker_processes.receiver_fd); /* unblocks workers that wait to send */
    wait_for_all(&worker_processes, status != NEPH_OK);
    free_worker_processes(&worker_processes);
    return status;
}

enum neph_status neph_pool_run(int workers, struct neph_shared_device *device, neph_pool_work *work,
                               neph_pool_receive *hear, void *context, struct neph_diag *diag)
{
    struct neph_worker whole = {.count = workers};
    const struct worker_task worker_task = {workers, device, work, context};
    const enum neph_status status = workers > 1 ? run_parts(&worker_task, hear, diag) : NEPH_OK;
    return status ? status : work(&whole, context, diag);
}
