/* SPDX-License-Identifier: MIT */
#include "tests/neph_test.h"

#include "base/clock.h"

#include <time.h>

static void test_wall_time_passes_in_sleep(void **state)
{
    double start_s = neph_wall_s();
    struct timespec pause = {.tv_nsec = 30 * 1000 * 1000};
    nanosleep(&pause, NULL);
    double passed_s = neph_wall_s() - start_s;
    assert_true(passed_s >= 0.030); /* nanosleep never returns early without a signal */
    assert_true(passed_s < 10.0);
}

static void test_cpu_time_passes_in_work_and_not_in_sleep(void **state)
{
    double start_s = neph_cpu_s();
    struct timespec pause = {.tv_nsec = 200 * 1000 * 1000};
    nanosleep(&pause, NULL);
    double slept_s = neph_cpu_s() - start_s;
    assert_true(slept_s < 0.1);

    double wall_start_s = neph_wall_s();
    while (neph_cpu_s() - start_s < slept_s + 0.05)
        assert_true(neph_wall_s() - wall_start_s < 60.0);
}

#include "tests/main.h"
