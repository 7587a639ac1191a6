/* SPDX-License-Identifier: MIT */
#include "harness/failure/share.h"

#include "base/interrupt.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

bool neph_share_has(const struct neph_share *share, int number)
{
    return number % share->count == share->index;
}

/* In the new process: what is on the way to a file is its parent's to write. */
static void live(const struct neph_share *share, pid_t parent, neph_share_work *work, void *context)
{
    struct neph_diag diag = {.line = 0};
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() == parent)
        work(share, context, &diag);
    _exit(EXIT_SUCCESS);
}

static pid_t start(const struct neph_share *share, neph_share_work *work, void *context)
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
static enum neph_status run_shares(int jobs, pid_t *pids, neph_share_work *work, void *context,
                                   struct neph_diag *diag)
{
    const struct neph_share own = {0, jobs};
    enum neph_status status = NEPH_OK;
    int count = 0;
    for (int i = 1; i < jobs && !status; i++) {
        const struct neph_share share = {i, jobs};
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
    const struct neph_share whole = {0, 1};
    enum neph_status status = NEPH_OK;
    if (jobs > 1) {
        pid_t *pids = calloc((size_t)jobs, sizeof(*pids));
        status = pids ? run_shares(jobs, pids, work, context, diag) : neph_fail_memory(diag);
        free(pids);
    }
    return status ? status : work(&whole, context, diag);
}
