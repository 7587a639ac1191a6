/* SPDX-License-Identifier: MIT
 *
 * Estimates of the remaining time.
 */
#include "tests/neph_test.h"

#include "harness/progress.h"

static void step(struct neph_progress *progress, int kind, double seconds)
{
    progress->kind = kind;
    neph_progress_step(progress, "a step", "over", seconds);
}

static void test_nothing_is_known_before_the_first_step(void **state)
{
    const struct neph_progress progress = neph_progress_start(true, 5);
    assert_true(neph_progress_left_s(&progress) < 0.0);
}

/* Two steps of 100 s and 18 of 1 s: a mean over all steps would be off by a factor of ten. */
static void test_kinds_have_paces_of_their_own(void **state)
{
    struct neph_progress progress = neph_progress_start(true, 0);
    neph_progress_expect(&progress, 0, 2, 50.0);
    neph_progress_expect(&progress, 7, 18, 0.0);
    assert_true(neph_progress_left_s(&progress) == 100.0);
    step(&progress, 0, 100.0);
    step(&progress, 7, 1.0);
    assert_true(neph_progress_left_s(&progress) == 100.0 + 17.0);
    step(&progress, 0, 100.0);
    assert_true(neph_progress_left_s(&progress) == 17.0);
}

static void test_steps_that_fall_away_are_not_waited_for(void **state)
{
    struct neph_progress progress = neph_progress_start(true, 0);
    int done, total;
    neph_progress_expect(&progress, 3, 4, 2.0);
    neph_progress_expect(&progress, 3, -3, 0.0);
    assert_true(neph_progress_left_s(&progress) == 2.0);
    neph_progress_count(&progress, &done, &total);
    assert_int_equal(done, 0);
    assert_int_equal(total, 1);
}

/* References of a study are steps that were not announced. */
static void test_no_count_passes_its_total(void **state)
{
    struct neph_progress progress = neph_progress_start(true, 0);
    int done, total;
    neph_progress_expect(&progress, 0, 2, 1.0);
    for (int i = 0; i < 4; i++)
        step(&progress, 2, 1.0);
    neph_progress_credit(&progress, 3, 5, 5.0);
    neph_progress_count(&progress, &done, &total);
    assert_int_equal(done, 9);
    assert_int_equal(total, 2 + 9);
    assert_true(neph_progress_left_s(&progress) == 2.0);
}

/* Two processes: the other's finished work counts, and both share the remaining work. */
static void test_others_shorten_the_time(void **state)
{
    struct neph_progress progress = neph_progress_start(true, 0);
    progress.workers = 2;
    neph_progress_expect(&progress, 1, 10, 4.0);
    assert_true(neph_progress_left_s(&progress) == 20.0);
    step(&progress, 1, 2.0);
    neph_progress_credit(&progress, 1, 3, 6.0);
    assert_true(neph_progress_left_s(&progress) == 6.0);
}

#include "tests/main.h"
