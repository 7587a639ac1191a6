/* SPDX-License-Identifier: MIT */
#include "base/workers.h"

#include <pthread.h>
#include <stdlib.h>

struct neph_workers {
    pthread_mutex_t lock;        /* guards all fields below, and the tasks */
    pthread_cond_t added, ended; /* signalled when a task was added; when a task has ended */
    struct neph_task *first, *last;
    int task_count;    /* tasks not done yet, including those in work */
    int waiting_count; /* tasks in the queue */
    int idle_count, thread_count, thread_limit;
    bool is_ending;
    pthread_t threads[];
};

enum neph_status neph_workers_create(int count, struct neph_workers **workers,
                                     struct neph_diag *diag)
{
    struct neph_workers *created = calloc(1, sizeof(*created) +
                                                 (size_t)count * sizeof(created->threads[0]));
    if (!created)
        return neph_fail_memory(diag);
    pthread_mutex_init(&created->lock, NULL);
    pthread_cond_init(&created->added, NULL);
    pthread_cond_init(&created->ended, NULL);
    created->thread_limit = count;
    *workers = created;
    return NEPH_OK;
}

static struct neph_task *take_task(struct neph_workers *workers)
{
    struct neph_task *task = workers->first;
    workers->first = task->next;
    if (!workers->first)
        workers->last = NULL;
    workers->waiting_count--;
    return task;
}

/* Run a task. Called with the lock, which is released during the task. */
static void run_task(struct neph_workers *workers, struct neph_task *task)
{
    pthread_mutex_unlock(&workers->lock);
    task->work(task->context);
    pthread_mutex_lock(&workers->lock);
    task->is_done = true;
    workers->task_count--;
    pthread_cond_broadcast(&workers->ended);
}

static void *work(void *argument)
{
    struct neph_workers *workers = argument;
    pthread_mutex_lock(&workers->lock);
    for (;;) {
        while (!workers->first && !workers->is_ending) {
            workers->idle_count++;
            pthread_cond_wait(&workers->added, &workers->lock);
            workers->idle_count--;
        }
        if (!workers->first)
            break;
        run_task(workers, take_task(workers));
    }
    pthread_mutex_unlock(&workers->lock);
    return NULL;
}

/* Create a thread if more are needed. Called with the lock. False: no thread exists at all. */
static bool has_thread(struct neph_workers *workers)
{
    if (workers->waiting_count >= workers->idle_count &&
        workers->thread_count < workers->thread_limit &&
        pthread_create(&workers->threads[workers->thread_count], NULL, work, workers) == 0)
        workers->thread_count++;
    return workers->thread_count > 0;
}

void neph_workers_add(struct neph_workers *workers, struct neph_task *task)
{
    task->next = NULL;
    task->is_done = false;
    pthread_mutex_lock(&workers->lock);
    workers->task_count++;
    if (has_thread(workers)) {
        *(workers->last ? &workers->last->next : &workers->first) = task;
        workers->last = task;
        workers->waiting_count++;
        pthread_cond_signal(&workers->added);
    } else {
        run_task(workers, task);
    }
    pthread_mutex_unlock(&workers->lock);
}

bool neph_workers_is_done(struct neph_workers *workers, const struct neph_task *task)
{
    pthread_mutex_lock(&workers->lock);
    const bool is_done = task->is_done;
    pthread_mutex_unlock(&workers->lock);
    return is_done;
}

void neph_workers_wait(struct neph_workers *workers, const struct neph_task *task)
{
    pthread_mutex_lock(&workers->lock);
    while (!task->is_done)
        pthread_cond_wait(&workers->ended, &workers->lock);
    pthread_mutex_unlock(&workers->lock);
}

void neph_workers_wait_for_all(struct neph_workers *workers)
{
    pthread_mutex_lock(&workers->lock);
    while (workers->task_count > 0)
        pthread_cond_wait(&workers->ended, &workers->lock);
    pthread_mutex_unlock(&workers->lock);
}

void neph_workers_destroy(struct neph_workers *workers)
{
    if (!workers)
        return;
    pthread_mutex_lock(&workers->lock);
    workers->is_ending = true;
    pthread_cond_broadcast(&workers->added);
    pthread_mutex_unlock(&workers->lock);
    for (int i = 0; i < workers->thread_count; i++)
        pthread_join(workers->threads[i], NULL);
    pthread_cond_destroy(&workers->ended);
    pthread_cond_destroy(&workers->added);
    pthread_mutex_destroy(&workers->lock);
    free(workers);
}
