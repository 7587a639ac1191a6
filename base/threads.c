/* SPDX-License-Identifier: MIT */
#include "base/threads.h"

#include "base/interrupt.h"

#include <math.h>
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

enum { THREADS_MAX = 1024 };

struct row_work {
    int row_count;
    neph_row_body *body;
    void *context;
    int helper_limit; /* threads beside the calling thread */
    atomic_int next_row, helper_count;
    atomic_bool stopped_early;
};

int neph_processor_count(void)
{
    /* The affinity mask, not the machine's count: Slurm and taskset assign a part of the machine.
     */
    cpu_set_t allowed;
    if (sched_getaffinity(0, sizeof(allowed), &allowed) == 0 && CPU_COUNT(&allowed) > 0)
        return CPU_COUNT(&allowed);
    long online = sysconf(_SC_NPROCESSORS_ONLN); /* more than CPU_SETSIZE processors */
    return online > 0 ? (int)online : 1;
}

static const char thread_variable[] = "NEPH_THREADS";

int neph_thread_count(void)
{
    const char *text = getenv(thread_variable);
    const long count = text ? strtol(text, NULL, 10) : 0;
    return count >= 1 && count <= THREADS_MAX ? (int)count : neph_processor_count();
}

void neph_set_thread_count(int count)
{
    char text[16];
    snprintf(text, sizeof(text), "%d", count);
    setenv(thread_variable, text, 1); /* a failure leaves more threads */
}

static void process_rows(struct row_work *work)
{
    for (;;) {
        /* Rows are assigned one by one, because rows with clouds cost much more than others. */
        int row = atomic_fetch_add(&work->next_row, 1);
        if (row >= work->row_count)
            return;
        if (neph_interrupted()) {
            atomic_store(&work->stopped_early, true);
            return;
        }
        work->body(row, work->context);
    }
}

static void *run_row_thread(void *argument);

static bool start_helper(struct row_work *work, pthread_t *helper)
{
    const int left = work->row_count - atomic_load(&work->next_row);
    if (left < 2 || atomic_fetch_add(&work->helper_count, 1) >= work->helper_limit)
        return false;
    return pthread_create(helper, NULL, run_row_thread, work) == 0;
}

/* Each thread starts the next one while rows are left. A short loop ends before it has created many
 * threads, which would cost more than its rows. */
static void *run_row_thread(void *argument)
{
    pthread_t helper;
    const bool has_helper = start_helper(argument, &helper);
    process_rows(argument);
    if (has_helper)
        pthread_join(helper, NULL);
    return NULL;
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

bool neph_call_with_timeout(double limit_s, void (*work)(void *context), void *context)
{
    pthread_t thread;
    struct call *call = malloc(sizeof(*call));
    if (call)
        *call = (struct call){work, context};
    if (!call || pthread_create(&thread, NULL, make_call, call) != 0) {
        free(call);
        work(context); /* no thread could be created: call without a time limit */
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
    struct row_work work = {.row_count = row_count,
                            .body = body,
                            .context = context,
                            .helper_limit = neph_thread_count() - 1};
    /* The calling thread works too, so that the loop also runs when no thread can be created. */
    run_row_thread(&work);
    if (atomic_load(&work.stopped_early))
        return neph_fail(diag, NEPH_ERR_INTERRUPTED, "interrupted");
    return NEPH_OK;
}
