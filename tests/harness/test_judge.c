/* SPDX-License-Identifier: MIT
 *
 * The judgement of nightly runs on series with known answers. Its error rates: test_backtest.c.
 */
#include "tests/neph_test.h"

#include "harness/night/judge.h"
#include "metrics/significance.h"

static const double alpha = 0.005;

static struct neph_series fixed(const double *past, double tonight)
{
    return (struct neph_series){.name = "a",
                                .kind = NEPH_SERIES_FIXED,
                                .unit = 1e-5,
                                .tonight = tonight,
                                .standard_error = NAN,
                                .past = past,
                                .past_count = 1};
}

static struct neph_judgement judge_one(const struct neph_series *series)
{
    struct neph_verdicts verdicts;
    neph_assert_ok(neph_judge(series, 1, alpha, &verdicts, NULL), NULL);
    const struct neph_judgement judgement = verdicts.series[0];
    neph_verdicts_finish(&verdicts);
    return judgement;
}

static void test_fixed_series(void **state)
{
    static const struct {
        double before, tonight;
        bool is_signed;
        enum neph_judged judged;
    } cases[] = {
        {0.25, 0.25, false, NEPH_JUDGED_SAME},
        {0.25, 0.25 * (1 + 1e-12), false, NEPH_JUDGED_SAME},
        {0.25, 0.2505, false, NEPH_JUDGED_MOVED},
        {0.25, 0.2575, false, NEPH_JUDGED_WORSE},
        {0.25, 0.2425, false, NEPH_JUDGED_BETTER},
        {-0.25, -0.2425, true, NEPH_JUDGED_BETTER},
        {-0.25, -0.2575, true, NEPH_JUDGED_WORSE},
        {-0.25, 0.26, true, NEPH_JUDGED_WORSE},
        {1e-9, 3e-9, false, NEPH_JUDGED_MOVED}, /* a change far below the unit */
        {0.0, 1e-3, false, NEPH_JUDGED_WORSE},
        {NAN, 0.25, false, NEPH_JUDGED_NOT},
        {0.25, NAN, false, NEPH_JUDGED_NOT},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct neph_series series = fixed(&cases[i].before, cases[i].tonight);
        series.is_signed = cases[i].is_signed;
        assert_int_equal(judge_one(&series).judged, cases[i].judged);
    }
    const double before = 0.25;
    const struct neph_series worse = fixed(&before, 0.2575);
    neph_assert_close(judge_one(&worse).change, 0.03, 1e-12, 0.0);
    neph_assert_close(judge_one(&worse).baseline, 0.25, 0.0, 0.0);
}

static struct neph_series drawn(const double *past, const double *errors, double tonight,
                                double error)
{
    struct neph_series series = fixed(past, tonight);
    series.kind = NEPH_SERIES_DRAWN;
    series.past_errors = errors;
    series.standard_error = error;
    return series;
}

/* A single test: its p-value is that of z = difference / hypot(errors). */
static void test_a_drawn_series_by_its_errors(void **state)
{
    const double before = 1.0, error = 0.03;
    for (double z = 0.5; z < 6.0; z += 0.5) {
        const struct neph_series series = drawn(&before, &error, 1.0 + z * 0.05, 0.04);
        const struct neph_judgement judgement = judge_one(&series);
        neph_assert_close(judgement.p, neph_normal_p(z), 1e-9, 0.0);
        assert_int_equal(judgement.judged,
                         judgement.p <= alpha ? NEPH_JUDGED_WORSE : NEPH_JUDGED_SAME);
    }
}

/* Eleven runs of one program are one random draw with an unknown noise: another program's draw is
 * not yet a change, nor is it after a week of equal bits when other draws are known. */
static void test_repeated_bits_are_one_draw(void **state)
{
    uint64_t random = 5;
    double past[40];
    for (int i = 0; i < 11; i++)
        past[i] = 1.0;
    struct neph_series series = drawn(past, NULL, 1.02, NAN);
    series.past_count = 11;
    assert_int_equal(judge_one(&series).judged, NEPH_JUDGED_NOT);
    for (int i = 0; i < 33; i++)
        past[i] = 1.0 + 0.01 * neph_test_uniform(&random, -1.7, 1.7);
    series.past_count = 33;
    series.tonight = 1.025;
    const struct neph_judgement first = judge_one(&series);
    for (int i = 33; i < 40; i++)
        past[i] = 1.025;
    series.past_count = 40;
    neph_assert_close(judge_one(&series).p, first.p, 0.0, 0.0);
}

/* Holm: the same deviation among fifty without one needs a p-value fifty times as large. */
static void test_all_chances_share_one_alpha(void **state)
{
    enum { MANY = 50 };
    const double before = 1.0, error = 0.03, same = 0.25;
    struct neph_series series[MANY + 2];
    struct neph_verdicts verdicts;
    for (int i = 0; i < MANY; i++)
        series[i] = drawn(&before, &error, i == 3 ? 1.16 : 1.001, 0.04);
    series[MANY] = fixed(&same, 0.25); /* deterministic: no test, no correction */
    series[MANY + 1] = drawn(&before, NULL, 1.0, NAN);
    neph_assert_ok(neph_judge(series, MANY + 2, alpha, &verdicts, NULL), NULL);
    assert_int_equal(verdicts.compared, MANY + 2);
    assert_int_equal(verdicts.chances, MANY);
    neph_assert_close(verdicts.series[3].p, MANY * neph_normal_p(3.2), 1e-9, 0.0);
    assert_int_equal(verdicts.series[3].judged, NEPH_JUDGED_SAME);
    neph_verdicts_finish(&verdicts);
}

/* Runs about a level with a known deviation, from the generator of all property tests. */
static void fill(double *past, int count, double level, double deviation, uint64_t *random)
{
    for (int i = 0; i < count; i++)
        past[i] = level * (1.0 + deviation * neph_test_uniform(random, -1.7, 1.7));
}

static struct neph_series timed(const double *past, int count, double tonight)
{
    struct neph_series series = fixed(past, tonight);
    series.kind = NEPH_SERIES_TIMED;
    series.past_count = count;
    return series;
}

/* A machine that is busy for two runs; a lasting change; too few runs; a faster one. */
static void test_durations(void **state)
{
    uint64_t random = 7;
    double past[40];
    fill(past, 40, 2.0, 0.01, &random);
    past[39] = 3.0;
    struct neph_series series = timed(past, 40, 3.0);
    assert_int_equal(judge_one(&series).judged, NEPH_JUDGED_SAME);
    past[38] = 2.9;
    assert_int_equal(judge_one(&series).judged, NEPH_JUDGED_WORSE);
    neph_assert_close(judge_one(&series).change, 0.45, 0.02, 0.0);
    past[38] = past[39] = series.tonight = 1.0;
    assert_int_equal(judge_one(&series).judged, NEPH_JUDGED_BETTER);
    series = timed(past, 7, 9.0);
    assert_int_equal(judge_one(&series).judged, NEPH_JUDGED_NOT);
    assert_true(isnan(judge_one(&series).change));
}

/* A change just above the floor is found, one just below is not. */
static void test_the_floor_is_the_visible_change(void **state)
{
    uint64_t random = 11;
    double past[40];
    for (int i = 0; i < 20; i++) {
        fill(past, 38, 2.0, neph_test_uniform(&random, 0.005, 0.1), &random);
        past[38] = past[39] = 2.0;
        struct neph_series series = timed(past, 38, 2.0);
        const struct neph_judgement quiet = judge_one(&series);
        series.past_count = 40;
        for (int side = 0; side < 2; side++) {
            const double factor = 1.0 + quiet.floor * (side ? 1.01 : 0.99);
            past[38] = past[39] = series.tonight = quiet.baseline * factor;
            assert_int_equal(judge_one(&series).judged,
                             side ? NEPH_JUDGED_WORSE : NEPH_JUDGED_SAME);
        }
    }
}

/* A change below each scene's floor that is equal in all scenes. */
static void test_an_engine_over_all_scenes(void **state)
{
    enum { SCENES = 40, NIGHTS = 40 };
    static double past[SCENES][NIGHTS];
    struct neph_series series[SCENES];
    struct neph_verdicts verdicts;
    uint64_t random = 3;
    for (int i = 0; i < SCENES; i++) {
        fill(past[i], NIGHTS, 1.0 + i, 0.05, &random);
        for (int night = NIGHTS - 8; night < NIGHTS; night++)
            past[i][night] *= 1.06;
        series[i] = timed(past[i], NIGHTS, 1.06 * (1.0 + i));
        series[i].engine = "march";
        series[i].metric = "time";
    }
    neph_assert_ok(neph_judge(series, SCENES, alpha, &verdicts, NULL), NULL);
    assert_int_equal(verdicts.pool_count, 1);
    assert_int_equal(verdicts.pools[0].scenes, SCENES);
    assert_int_equal(verdicts.pools[0].judgement.judged, NEPH_JUDGED_WORSE);
    neph_assert_close(verdicts.pools[0].judgement.change, 0.06, 0.3, 0.0);
    assert_int_equal(verdicts.worse, 1);
    neph_verdicts_finish(&verdicts);
}

/* A scene without a duration in one run, for example on a busy machine, stays in the mean. A scene
 * without a value in the accepted run, or in other runs, does not and is not counted. */
static void test_one_busy_run_disables_no_mean(void **state)
{
    enum { SCENES = 6, NIGHTS = 40 };
    static double past[SCENES][NIGHTS];
    struct neph_series series[SCENES];
    struct neph_verdicts verdicts;
    uint64_t random = 3;
    for (int i = 0; i < SCENES; i++) {
        fill(past[i], NIGHTS, 1.0 + i, 0.02, &random);
        past[i][20] = NAN;
        past[i][NIGHTS - 1] = past[i][NIGHTS - 2] = 1.3 * (1.0 + i);
        series[i] = timed(past[i], NIGHTS, 1.3 * (1.0 + i));
        series[i].engine = "march";
        series[i].metric = "time";
    }
    past[1][25] = past[4][0] = NAN;
    series[5].past_count = NIGHTS - 1;
    neph_assert_ok(neph_judge(series, SCENES, alpha, &verdicts, NULL), NULL);
    assert_int_equal(verdicts.pool_count, 1);
    assert_int_equal(verdicts.pools[0].scenes, SCENES - 2);
    assert_int_equal(verdicts.pools[0].judgement.judged, NEPH_JUDGED_WORSE);
    assert_int_equal(verdicts.pools[0].judgement.nights, 30);
    neph_verdicts_finish(&verdicts);
}

/* A changed truth changes all engines; a changed engine only itself. */
static void test_a_stale_truth(void **state)
{
    enum { SCENES = 6, SERIES = 3 * SCENES };
    static const char *const engines[] = {"march", "cycles", "povray"};
    const double before = 0.25;
    for (int moved = 1; moved <= 3; moved++) {
        struct neph_series series[SERIES];
        struct neph_verdicts verdicts;
        for (int i = 0; i < SERIES; i++) {
            series[i] = fixed(&before, i % 3 < moved ? 0.28 : 0.25);
            series[i].engine = engines[i % 3];
            series[i].metric = "rel_rmse";
            series[i].truth = "tracer";
        }
        neph_assert_ok(neph_judge(series, SERIES, alpha, &verdicts, NULL), NULL);
        assert_int_equal(verdicts.worse, moved * SCENES);
        assert_int_equal(verdicts.stale_count, moved > 1);
        if (moved > 1) {
            assert_string_equal(verdicts.stale[0].truth, "tracer");
            assert_int_equal(verdicts.stale[0].moved, moved * SCENES);
            assert_int_equal(verdicts.stale[0].all, SERIES);
            assert_int_equal(verdicts.stale[0].families, moved);
        }
        neph_verdicts_finish(&verdicts);
        for (int i = 0; i < SERIES; i++)
            series[i].family = "one program";
        neph_assert_ok(neph_judge(series, SERIES, alpha, &verdicts, NULL), NULL);
        assert_int_equal(verdicts.worse, moved * SCENES);
        assert_int_equal(verdicts.stale_count, 0);
        neph_verdicts_finish(&verdicts);
    }
}

static void test_words(void **state)
{
    for (int kind = 0; kind < NEPH_SERIES_KINDS; kind++)
        assert_int_equal(neph_find_series_kind(neph_series_rule(kind)->word), kind);
    assert_int_equal(neph_find_series_kind("slow"), NEPH_SERIES_KINDS);
}

#include "tests/main.h"
