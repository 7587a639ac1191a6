/* SPDX-License-Identifier: MIT */
#include "base/threads.h"

#include "base/interrupt.h"

#include <math.h>
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

struct row_work {
    int row_count;
    neph_row_body *body;
    void *context;
    atomic_int next_row;
    atomic_bool stopped_early;
};

int neph_processor_count(void)
{
    /* Affinity, not the machine: Slurm and taskset give us a share of it. */
    cpu_set_t allowed;
    if (sched_getaffinity(0, sizeof(allowed), &allowed) == 0 && CPU_COUNT(&allowed) > 0)
        return CPU_COUNT(&allowed);
    long online = sysconf(_SC_NPROCESSORS_ONLN); /* more than CPU_SETSIZE processors */
    return online > 0 ? (int)online : 1;
}

static void *work_on_rows(void *argument)
{
    struct row_work *work = argument;
    for (;;) {
        /* Rows are handed out one by one, because rows of a cloud differ much in cost. */
        int row = atomic_fetch_add(&work->next_row, 1);
        if (row >= work->row_count)
            return NULL;
        if (neph_interrupted()) {
            atomic_store(&work->stopped_early, true);
            return NULL;
        }
        work->body(row, work->context);
    }
}

struct call {
    void (*work)(void *context);
    void *context;
};

static void *make_call(void *argument)
{
    const struct call call = *(struct call *)argument;
    free(argument);
    call.work(call.context);
    return NULL;
}

bool neph_finishes_within(double limit_s, void (*work)(void *context), void *context)
{
    pthread_t thread;
    struct call *call = malloc(sizeof(*call));
    if (call)
        *call = (struct call){work, context};
    if (!call || pthread_create(&thread, NULL, make_call, call) != 0) {
        free(call);
        work(context); /* for want of a thread: better late than not at all */
        return true;
    }
    struct timespec deadline;
    clock_gettime(CLOCK_MONOTONIC, &deadline);
    const double end_s = (double)deadline.tv_sec + 1e-9 * (double)deadline.tv_nsec + limit_s;
    deadline.tv_sec = (time_t)end_s;
    deadline.tv_nsec = (long)(1e9 * (end_s - floor(end_s)));
    if (pthread_clockjoin_np(thread, NULL, CLOCK_MONOTONIC, &deadline) == 0)
        return true;
    pthread_detach(thread);
    return false;
}

enum neph_status neph_parallel_rows(int row_count, neph_row_body *body, void *context,
                                    struct neph_diag *diag)
{
    struct row_work work = {.row_count = row_count, .body = body, .context = context};
    int processor_count = neph_processor_count();
    int helper_count = (row_count < processor_count ? row_count : processor_count) - 1;

    /* The calling thread works too, so that nothing here can fail for want of a thread. */
    pthread_t *helpers = helper_count > 0 ? calloc((size_t)helper_count, sizeof(*helpers)) : NULL;
    int started_count = 0;
    while (helpers && started_count < helper_count &&
           pthread_create(&helpers[started_count], NULL, work_on_rows, &work) == 0)
        started_count++;
    work_on_rows(&work);
    for (int i = 0; i < started_count; i++)
        pthread_join(helpers[i], NULL);
    free(helpers);

    if (atomic_load(&work.stopped_early))
        return neph_fail(diag, NEPH_ERR_INTERRUPTED, "interrupted");
    return NEPH_OK;
}
