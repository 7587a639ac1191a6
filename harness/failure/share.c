/* SPDX-License-Identifier: MIT */
#include "harness/failure/share.h"

#include "base/interrupt.h"
#include "harness/progress.h"

#include <errno.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

/* In memory that all processes see. */
struct neph_share_board {
    atomic_int next;
    struct {
        atomic_int steps;
        atomic_llong time_us;
    } told[NEPH_PROGRESS_KINDS];
};

static struct neph_share_board *make_board(void)
{
    void *board = mmap(NULL, sizeof(struct neph_share_board), PROT_READ | PROT_WRITE,
                       MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    return board == MAP_FAILED ? NULL : board;
}

int neph_share_next(struct neph_share *share)
{
    return share->board ? atomic_fetch_add(&share->board->next, 1) : share->next++;
}

void neph_share_tell(const struct neph_share *share, int kind, int steps, double seconds)
{
    if (!share->board)
        return;
    atomic_fetch_add(&share->board->told[kind].steps, steps);
    atomic_fetch_add(&share->board->told[kind].time_us, (long long)(seconds * 1e6));
}

void neph_share_hear(const struct neph_share *share, int kind, int *steps, double *seconds)
{
    *steps = share->board ? atomic_exchange(&share->board->told[kind].steps, 0) : 0;
    *seconds = share->board ? 1e-6 * (double)atomic_exchange(&share->board->told[kind].time_us, 0)
                            : 0.0;
}

/* In the new process: what is on the way to a file is its parent's to write. */
static void live(struct neph_share *share, pid_t parent, neph_share_work *work, void *context)
{
    struct neph_diag diag = {.line = 0};
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() == parent)
        work(share, context, &diag);
    _exit(EXIT_SUCCESS);
}

static pid_t start(struct neph_share *share, neph_share_work *work, void *context)
{
    const pid_t parent = getpid();
    fflush(NULL);
    const pid_t pid = fork();
    if (pid == 0)
        live(share, parent, work, context);
    return pid;
}

static void end(const pid_t *pids, int count)
{
    for (int i = 0; i < count; i++) {
        if (neph_interrupted())
            kill(pids[i], SIGTERM);
        while (waitpid(pids[i], NULL, 0) < 0 && errno == EINTR)
            if (neph_interrupted())
                kill(pids[i], SIGTERM);
    }
}

/* The shares beside this process's own. */
static enum neph_status run_shares(int jobs, pid_t *pids, struct neph_share_board *board,
                                   neph_share_work *work, void *context, struct neph_diag *diag)
{
    struct neph_share own = {.index = 0, .count = jobs, .board = board};
    enum neph_status status = NEPH_OK;
    int count = 0;
    for (int i = 1; i < jobs && !status; i++) {
        struct neph_share share = {.index = i, .count = jobs, .board = board};
        const pid_t pid = start(&share, work, context);
        if (pid < 0)
            status = neph_fail(diag, NEPH_ERR_IO, "no process could be started: %s",
                               strerror(errno));
        else
            pids[count++] = pid;
    }
    if (!status)
        status = work(&own, context, diag);
    end(pids, count);
    return status;
}

enum neph_status neph_shares_run(int jobs, neph_share_work *work, void *context,
                                 struct neph_diag *diag)
{
    struct neph_share whole = {.count = 1, .again = jobs > 1};
    enum neph_status status = NEPH_OK;
    if (jobs > 1) {
        pid_t *pids = calloc((size_t)jobs, sizeof(*pids));
        struct neph_share_board *board = make_board();
        status = pids && board ? run_shares(jobs, pids, board, work, context, diag)
                               : neph_fail_memory(diag);
        if (board)
            munmap(board, sizeof(*board));
        free(pids);
    }
    return status ? status : work(&whole, context, diag);
}
