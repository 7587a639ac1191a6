/* SPDX-License-Identifier: MIT
 *
 * Worker threads that run submitted tasks.
 */
#include "tests/neph_test.h"

#include "base/workers.h"

#include <pthread.h>
#include <stdatomic.h>

enum { TASKS = 500 };

struct counted {
    struct neph_task task;
    atomic_int *at_work, *most_at_work;
    int times, result; /* of this task */
};

static void count(void *context)
{
    struct counted *counted = context;
    const int now = atomic_fetch_add(counted->at_work, 1) + 1;
    int most = atomic_load(counted->most_at_work);
    while (most < now && !atomic_compare_exchange_weak(counted->most_at_work, &most, now))
        ;
    for (int i = 0; i <= counted->times; i++)
        counted->result = i;
    atomic_fetch_sub(counted->at_work, 1);
}

static struct neph_workers *create(int count)
{
    struct neph_workers *workers = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_workers_create(count, &workers, &diag), &diag);
    return workers;
}

/* Each task runs once, by at most the given number of threads, whichever task is awaited. */
static void test_all_is_done(void **state)
{
    for (int threads = 1; threads <= 4; threads++) {
        static struct counted counted[TASKS];
        atomic_int at_work = 0, most_at_work = 0;
        struct neph_workers *workers = create(threads);
        for (int i = 0; i < TASKS; i++) {
            counted[i] = (struct counted){{.work = count, .context = &counted[i]},
                                          &at_work,
                                          &most_at_work,
                                          1 + i % 7 * 1000,
                                          -1};
            neph_workers_add(workers, &counted[i].task);
        }
        for (int i = TASKS / 2; i >= 0; i -= 50) {
            neph_workers_wait(workers, &counted[i].task);
            assert_true(neph_workers_have_done(workers, &counted[i].task));
            assert_int_equal(counted[i].result, counted[i].times);
        }
        if (threads % 2)
            neph_workers_wait_for_all(workers);
        neph_workers_destroy(workers); /* destruction waits for all, too */
        for (int i = 0; i < TASKS; i++)
            assert_int_equal(counted[i].result, counted[i].times);
        neph_assert_in_range(most_at_work, 1, threads);
    }
}

struct meeting {
    struct neph_task task;
    pthread_barrier_t *all;
};

static void meet(void *context)
{
    pthread_barrier_wait(((struct meeting *)context)->all);
}

/* Tasks that wait for each other all get a thread: the test ends, or never. */
static void test_as_many_at_a_time(void **state)
{
    enum { THREADS = 3, ROUNDS = 20 };
    struct neph_workers *workers = create(THREADS);
    for (int round = 0; round < ROUNDS; round++) {
        pthread_barrier_t all;
        struct meeting meetings[THREADS];
        pthread_barrier_init(&all, NULL, THREADS);
        for (int i = 0; i < THREADS; i++) {
            meetings[i] = (struct meeting){{.work = meet, .context = &meetings[i]}, &all};
            neph_workers_add(workers, &meetings[i].task);
        }
        neph_workers_wait_for_all(workers);
        pthread_barrier_destroy(&all);
    }
    neph_workers_destroy(workers);
}

static void test_without_work(void **state)
{
    struct neph_workers *workers = create(2);
    neph_workers_wait_for_all(workers);
    neph_workers_destroy(workers);
    neph_workers_destroy(NULL);
}

#include "tests/main.h"
