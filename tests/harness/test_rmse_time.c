/* SPDX-License-Identifier: MIT
 *
 * Time to a given error on series of sample counts with a known law: error^2 = bias^2 + c / t^a.
 */
#include "tests/neph_test.h"

#include "harness/run/rmse_time.h"

#include <math.h>

enum { RUNGS = 4 };

/* Points at 1, 2, 4, 8 s; the first has the noise `first_noise`. */
static void make_ladder(double first_noise, double power, double bias,
                        struct neph_rmse_level rungs[RUNGS])
{
    for (int k = 0; k < RUNGS; k++) {
        const double render_s = (double)(1 << k);
        const double noise2 = first_noise * first_noise / pow(render_s, power);
        rungs[k] = (struct neph_rmse_level){render_s, noise2, noise2 + bias * bias, bias * bias, 0};
    }
}

static const double rounding = 1e-12; /* relative, of a few logarithms in double */

static void expect(const struct neph_rmse_level rungs[RUNGS], double rmse,
                   enum neph_rmse_found found, double render_s)
{
    const struct neph_rmse_time time = neph_rmse_time_to(rungs, RUNGS, rmse);
    assert_string_equal(neph_rmse_found_name(time.found), neph_rmse_found_name(found));
    if (isnan(render_s))
        assert_true(isnan(time.render_s));
    else
        assert_true(fabs(time.render_s / render_s - 1.0) < rounding);
}

static void test_laws_are_found_within_and_beyond(void **state)
{
    static const double powers[] = {1.0, 1.5};
    static const struct {
        double part; /* of the first point's noise */
        enum neph_rmse_found found;
    } cases[] = {{2.0, NEPH_RMSE_BEFORE},
                 {0.8, NEPH_RMSE_WITHIN},
                 {0.4, NEPH_RMSE_WITHIN},
                 {0.1, NEPH_RMSE_BEYOND}};
    for (int p = 0; p < 2; p++) {
        struct neph_rmse_level rungs[RUNGS];
        make_ladder(0.05, powers[p], 0.0, rungs);
        assert_true(fabs(neph_rmse_law_fit(rungs, RUNGS).slope + powers[p]) < rounding);
        for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++)
            expect(rungs, 0.05 * cases[i].part, cases[i].found,
                   pow(cases[i].part, -2.0 / powers[p]));
    }
}

static void test_a_rung_is_its_own_time(void **state)
{
    struct neph_rmse_level rungs[RUNGS];
    make_ladder(0.05, 1.0, 0.02, rungs);
    for (int k = 1; k < RUNGS; k++)
        expect(rungs, sqrt(rungs[k].error2) * (1.0 + 1e-14), NEPH_RMSE_WITHIN, (double)(1 << k));
}

static void test_bias_costs_time_and_is_a_floor(void **state)
{
    struct neph_rmse_level rungs[RUNGS];
    make_ladder(0.05, 1.0, 0.006, rungs);
    /* 1 %: the noise must fall to 0.8 %. */
    expect(rungs, 0.01, NEPH_RMSE_BEYOND, pow(0.05 / 0.008, 2.0));
    expect(rungs, 0.0059, NEPH_RMSE_NEVER, NAN);
    expect(rungs, 0.001, NEPH_RMSE_NEVER, NAN);
}

static void test_a_bias_that_is_not_known_decides_nothing(void **state)
{
    struct neph_rmse_level rungs[RUNGS];
    make_ladder(0.05, 1.0, 0.0, rungs);
    for (int k = 0; k < RUNGS; k++) /* as much as the noise itself scatters */
        rungs[k].bias2 = (k % 2 ? 0.3 : -0.3) * rungs[k].noise2;
    assert_true(neph_rmse_law_fit(rungs, RUNGS).bias2_high > 1e-4);
    expect(rungs, 0.01, NEPH_RMSE_UNKNOWN, NAN);
}

static void test_noise_that_does_not_fall_is_not_extrapolated(void **state)
{
    struct neph_rmse_level rungs[RUNGS];
    make_ladder(0.05, 0.0, 0.0, rungs);
    expect(rungs, 0.01, NEPH_RMSE_UNKNOWN, NAN);
    expect(rungs, 0.10, NEPH_RMSE_UNKNOWN, NAN);
}

/* A point with a small error by chance is followed by a larger error: the later crossing counts. */
static void test_the_last_crossing_counts(void **state)
{
    struct neph_rmse_level rungs[RUNGS];
    make_ladder(0.05, 1.0, 0.0, rungs);
    const double rmse = 0.05 / sqrt(6.0);
    rungs[1].error2 = -1e-6;
    expect(rungs, rmse, NEPH_RMSE_WITHIN, 6.0);
}

/* Equal times have no slope, and an almost constant error has no limit. */
static void test_times_that_tell_nothing_are_not_extrapolated(void **state)
{
    struct neph_rmse_level rungs[RUNGS];
    make_ladder(0.05, 1.0, 0.0, rungs);
    for (int k = 0; k < RUNGS; k++)
        rungs[k].render_s = 1.0;
    assert_true(isnan(neph_rmse_law_fit(rungs, RUNGS).slope));
    expect(rungs, 0.01, NEPH_RMSE_UNKNOWN, NAN);
    expect(rungs, 0.10, NEPH_RMSE_UNKNOWN, NAN);
    make_ladder(0.05, 1e-6, 0.0, rungs);
    assert_true(neph_rmse_law_fit(rungs, RUNGS).slope < 0.0);
    expect(rungs, 0.01, NEPH_RMSE_UNKNOWN, NAN);
    expect(rungs, 0.10, NEPH_RMSE_UNKNOWN, NAN);
}

/* A busy machine changes the order of times. The law is a function of time, and stays valid. */
static void test_the_order_of_the_rungs_is_that_of_their_times(void **state)
{
    static const int order[RUNGS] = {2, 0, 3, 1};
    struct neph_rmse_level rungs[RUNGS], mixed[RUNGS];
    make_ladder(0.05, 1.0, 0.0, rungs);
    for (int k = 0; k < RUNGS; k++)
        mixed[k] = rungs[order[k]];
    expect(mixed, 0.05 * 2.0, NEPH_RMSE_BEFORE, 0.25);
    expect(mixed, 0.05 / sqrt(3.0), NEPH_RMSE_WITHIN, 3.0);
    expect(mixed, 0.05 / sqrt(6.0), NEPH_RMSE_WITHIN, 6.0);
    expect(mixed, 0.05 / 4.0, NEPH_RMSE_BEYOND, 16.0);
}

#include "tests/main.h"
