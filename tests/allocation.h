/* SPDX-License-Identifier: MIT
 *
 * Every allocation of an operation fails once, and the operation must report it, clean up and
 * change nothing. Included once by each test_allocation_*.c, which is linked with --wrap for the
 * functions below: this intercepts calls in the project's own objects, not allocations inside
 * libpng, OpenEXR, libyaml and the C++ library. Of several allocations that are reached by the same
 * calls (in a loop) only the first and the last fail. The run under AddressSanitizer detects leaks.
 */
#ifndef NEPH_TESTS_ALLOCATION_H
#define NEPH_TESTS_ALLOCATION_H

#include "tests/neph_test.h"

#include <execinfo.h>
#include <sched.h>
#include <stdatomic.h>

enum { ALLOCATIONS_MAX = 4096, CALLS_MAX = 32 };

/* The index of the failing allocation, counted from 0 over all threads, and whether all later ones
 * fail, too. */
struct allocation_plan {
    atomic_int done;
    int fail_at; /* -1: none */
    bool for_good;
    uint64_t calls[ALLOCATIONS_MAX]; /* digests of the calls that led to each when none failed */
};

static struct allocation_plan *allocation_plan(void)
{
    static struct allocation_plan plan = {.fail_at = -1};
    return &plan;
}

/* The release build has no unwind tables, so its calls are not known: then each allocation is one
 * of its own. */
static uint64_t digest_calls(int index)
{
    void *addresses[CALLS_MAX];
    const int count = backtrace(addresses, CALLS_MAX);
    uint64_t digest = count > 3 ? 0 : (uint64_t)index;
    for (int i = 0; i < count; i++) {
        digest ^= (uintptr_t)addresses[i];
        digest = neph_test_random(&digest);
    }
    return digest;
}

static bool allocation_fails(void)
{
    struct allocation_plan *plan = allocation_plan();
    const int index = atomic_fetch_add(&plan->done, 1);
    if (plan->fail_at < 0 && index < ALLOCATIONS_MAX)
        plan->calls[index] = digest_calls(index);
    return plan->fail_at >= 0 && (plan->for_good ? index >= plan->fail_at : index == plan->fail_at);
}

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *old, size_t size);
char *__real_strdup(const char *text);
char *__real_strndup(const char *text, size_t size);
int __real_vasprintf(char **text, const char *format, va_list arguments);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *old, size_t size);
char *__wrap_strdup(const char *text);
char *__wrap_strndup(const char *text, size_t size);
int __wrap_vasprintf(char **text, const char *format, va_list arguments)
    __attribute__((format(printf, 2, 0)));

void *__wrap_malloc(size_t size)
{
    return allocation_fails() ? NULL : __real_malloc(size);
}

void *__wrap_calloc(size_t count, size_t size)
{
    return allocation_fails() ? NULL : __real_calloc(count, size);
}

void *__wrap_realloc(void *old, size_t size)
{
    return allocation_fails() ? NULL : __real_realloc(old, size);
}

char *__wrap_strdup(const char *text)
{
    return allocation_fails() ? NULL : __real_strdup(text);
}

char *__wrap_strndup(const char *text, size_t size)
{
    return allocation_fails() ? NULL : __real_strndup(text, size);
}

int __wrap_vasprintf(char **text, const char *format, va_list arguments)
{
    return allocation_fails() ? -1 : __real_vasprintf(text, format, arguments);
}

/* Does its work and frees everything. */
typedef enum neph_status allocation_user(void *context, struct neph_diag *diag);

static enum neph_status run_failing(allocation_user *work, void *context, int fail_at,
                                    bool for_good, struct neph_diag *diag)
{
    struct allocation_plan *plan = allocation_plan();
    atomic_store(&plan->done, 0);
    plan->for_good = for_good;
    plan->fail_at = fail_at;
    const enum neph_status status = work(context, diag);
    plan->fail_at = -1;
    return status;
}

/* Restricts the process to one processor: without memory for more threads, a loop over rows runs on
 * one thread without an error, which these tests do not examine. */
static void stay_on_one_processor(void)
{
    cpu_set_t allowed, one;
    CPU_ZERO(&one);
    assert_int_equal(sched_getaffinity(0, sizeof(allowed), &allowed), 0);
    for (int i = 0; i < CPU_SETSIZE && CPU_COUNT(&one) == 0; i++)
        if (CPU_ISSET(i, &allowed))
            CPU_SET(i, &one);
    assert_int_equal(sched_setaffinity(0, sizeof(one), &one), 0);
}

/* Whether the allocations before and after it, of `count`, are reached by the same calls. */
static bool is_repeated(int index, int count)
{
    const uint64_t *calls = allocation_plan()->calls;
    bool before = false, after = false;
    for (int i = 0; i < count; i++)
        if (calls[i] == calls[index]) {
            before |= i < index;
            after |= i > index;
        }
    return before && after;
}

static void assert_every_failure_is_reported(const char *name, allocation_user *work, void *context)
{
    struct neph_diag diag = {0};
    stay_on_one_processor();
    neph_assert_ok(run_failing(work, context, -1, false, &diag), &diag);
    const int count = atomic_load(&allocation_plan()->done);
    if (count == 0)
        fail_msg("%s allocates nothing", name);
    neph_assert_in_range(count, 1, ALLOCATIONS_MAX);
    int failed = 0;
    for (int k = 0; k < 2 * count; k++) {
        if (is_repeated(k / 2, count))
            continue;
        diag = (struct neph_diag){0};
        const enum neph_status status = run_failing(work, context, k / 2, k % 2 == 1, &diag);
        if (status != NEPH_ERR_MEMORY || !diag.message[0])
            fail_msg("%s, allocation %d of %d: %s: %s", name, k / 2, count,
                     neph_status_name(status), diag.message);
        failed++;
    }
    neph_assert_ok(run_failing(work, context, -1, false, &diag), &diag); /* it still works */
    print_message("%s: %d of %d allocations failed\n", name, failed / 2, count);
}

#endif
