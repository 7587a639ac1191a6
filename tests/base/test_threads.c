/* SPDX-License-Identifier: MIT */
#include "tests/neph_test.h"

#include "base/threads.h"

#include <sched.h>
#include <stdatomic.h>
#include <time.h>
#include <unistd.h>

static void count_visit(int row, void *context)
{
    atomic_int *visits = context;
    atomic_fetch_add(&visits[row], 1);
}

static void test_each_row_exactly_once(void **state)
{
    static const int counts[] = {0, 1, 2, 3, 7, 64, 1000, 20011};
    for (size_t i = 0; i < sizeof(counts) / sizeof(counts[0]); i++) {
        atomic_int *visits = calloc((size_t)counts[i] + 1, sizeof(*visits));
        struct neph_diag diag = {0};
        neph_assert_ok(neph_parallel_rows(counts[i], count_visit, visits, &diag), &diag);
        for (int row = 0; row < counts[i]; row++)
            assert_int_equal(atomic_load(&visits[row]), 1);
        assert_int_equal(atomic_load(&visits[counts[i]]), 0);
        free(visits);
    }
}

static void test_negative_count_is_no_work(void **state)
{
    neph_assert_ok(neph_parallel_rows(-3, count_visit, NULL, NULL), NULL);
}

static void harmonic_row(int row, void *context)
{
    double *sums = context;
    for (int i = 1; i < 2000; i++)
        sums[row] += 1.0 / (i + row);
}

/* The same bits as with one thread, on every run. */
static void test_result_does_not_depend_on_threads(void **state)
{
    enum { ROWS = 500 };
    double alone[ROWS] = {0}, together[ROWS] = {0};
    for (int row = 0; row < ROWS; row++)
        harmonic_row(row, alone);
    neph_assert_ok(neph_parallel_rows(ROWS, harmonic_row, together, NULL), NULL);
    assert_memory_equal(alone, together, sizeof(alone));
}

struct meeting {
    atomic_int arrived;
    int expected;
};

/* All rows wait for each other, which is impossible with fewer threads. */
static void meet(int row, void *context)
{
    (void)row;
    struct meeting *meeting = context;
    atomic_fetch_add(&meeting->arrived, 1);
    for (int i = 0; i < 5000 && atomic_load(&meeting->arrived) < meeting->expected; i++)
        nanosleep(&(struct timespec){.tv_nsec = 1000 * 1000}, NULL);
}

static void test_rows_run_at_the_same_time(void **state)
{
    if (neph_processor_count() < 2)
        skip();
    struct meeting meeting = {.expected = neph_processor_count()};
    time_t start = time(NULL);
    neph_assert_ok(neph_parallel_rows(meeting.expected, meet, &meeting, NULL), NULL);
    assert_true(time(NULL) - start < 5);
}

static void test_processor_count_follows_affinity(void **state)
{
    cpu_set_t before, one;
    assert_int_equal(sched_getaffinity(0, sizeof(before), &before), 0);
    assert_int_equal(neph_processor_count(), CPU_COUNT(&before));
    int first = 0;
    while (!CPU_ISSET(first, &before))
        first++;
    CPU_ZERO(&one);
    CPU_SET(first, &one);
    assert_int_equal(sched_setaffinity(0, sizeof(one), &one), 0);
    int count = neph_processor_count();
    assert_int_equal(sched_setaffinity(0, sizeof(before), &before), 0);
    assert_int_equal(count, 1);
}

static void test_thread_count(void **state)
{
    assert_int_equal(neph_thread_count(), neph_processor_count());
    neph_set_thread_count(3);
    assert_int_equal(neph_thread_count(), 3);
    assert_int_equal(setenv("NEPH_THREADS", "many", 1), 0);
    assert_int_equal(neph_thread_count(), neph_processor_count());
    assert_int_equal(unsetenv("NEPH_THREADS"), 0);
}

static void answer(void *context)
{
    atomic_store((atomic_int *)context, 1);
}

static void hang(void *context)
{
    while (!atomic_load((atomic_int *)context))
        usleep(1000);
}

static void test_a_hanging_call_is_abandoned(void **state)
{
    static atomic_int answered, released; /* the thread may outlive this function */
    assert_true(neph_call_with_timeout(60.0, answer, &answered));
    assert_int_equal(atomic_load(&answered), 1);
    assert_false(neph_call_with_timeout(0.05, hang, &released));
    atomic_store(&released, 1);
}

#include "tests/main.h"
