/* SPDX-License-Identifier: MIT
 *
 * Limits from repeated runs: published factors, and whether the limits of 10 simulated runs hold on
 * 100 others, for noise of several shapes.
 */
#include "tests/neph_test.h"

#include "metrics/run_limit.h"

#include <string.h>

enum { RUNS = 10, OTHERS = 100, NUMBERS = 20, SEED = 20261129 };

/* Quantiles of Student's t: NIST/SEMATECH e-Handbook, 1.3.6.7.2. */
static void test_published_factors(void **state)
{
    const struct neph_run_limit_family one = {0.5, 0.9, 1}, two = {0.5, 0.9, 2};
    neph_assert_close(neph_run_limit_alarm_rate(&one), 0.05, 1e-15, 0.0);
    neph_assert_close(neph_run_limit_factor(&one, 10, NEPH_RUN_LIMIT_ABOVE), 1.833 * sqrt(1.1), 0.0,
                      6e-4);
    neph_assert_close(neph_run_limit_factor(&one, 5, NEPH_RUN_LIMIT_BELOW), 2.132 * sqrt(1.2), 0.0,
                      6e-4);
    neph_assert_close(neph_run_limit_factor(&two, 10, NEPH_RUN_LIMIT_ABOVE), 2.262 * sqrt(1.1), 0.0,
                      6e-4);
    neph_assert_close(neph_run_limit_factor(&one, 10, NEPH_RUN_LIMIT_EITHER), 2.262 * sqrt(1.1),
                      0.0, 6e-4);
    const struct neph_run_limit_family usual = {0.95, 0.95, 1};
    neph_assert_close(neph_run_limit_factor(&usual, 10, NEPH_RUN_LIMIT_ABOVE), 3.87, 0.0, 5e-3);
}

/* The bound by hand: mean 2, deviation 1, on either scale. */
static void test_bounds(void **state)
{
    const struct neph_run_limit_family family = {0.5, 0.9, 1};
    const double values[] = {1.0, 2.0, 3.0, 1.0, 2.0, 3.0, 2.0}, s = sqrt(4.0 / 6.0);
    const double k = neph_run_limit_factor(&family, 7, NEPH_RUN_LIMIT_ABOVE);
    double powers[7], errors[7], negative[7], limit = 0.0;
    for (int i = 0; i < 7; i++) {
        powers[i] = exp(values[i]);
        errors[i] = 1.0 - exp(values[i] - 5.0);
        negative[i] = -values[i];
    }
    assert_null(neph_run_limit(&family, powers, 7, NEPH_RUN_LIMIT_ABOVE, NAN, &limit));
    neph_assert_close(limit, exp(2.0 + k * s), 1e-12, 0.0);
    assert_null(neph_run_limit(&family, values, 7, NEPH_RUN_LIMIT_BELOW, INFINITY, &limit));
    neph_assert_close(limit, 2.0 - k * s, 1e-12, 0.0);
    assert_null(neph_run_limit(&family, errors, 7, NEPH_RUN_LIMIT_BELOW, 1.0, &limit));
    neph_assert_close(limit, 1.0 - exp(k * s - 3.0), 1e-12, 0.0);
    for (int sign = 0; sign < 2; sign++) {
        assert_null(neph_run_limit(&family, sign ? negative : values, 7, NEPH_RUN_LIMIT_EITHER, NAN,
                                   &limit));
        neph_assert_close(limit, 2.0 + neph_run_limit_factor(&family, 7, NEPH_RUN_LIMIT_EITHER) * s,
                          1e-12, 0.0);
    }
}

static void test_no_limit(void **state)
{
    const struct neph_run_limit_family family = {0.95, 0.95, 1};
    const double rare[] = {0.0, 0.0, 0.0, 0.0, 1e-3}, wide[] = {1.0, 20.0, 30.0, 3.0, 2.0};
    const double huge[] = {1e-300, 1e300, 1.0, 2.0, 3.0};
    double limit = -1.0;
    assert_true(neph_run_values_are_equal(rare, 4) && !neph_run_values_are_equal(rare, 5));
    assert_non_null(strstr(neph_run_limit(&family, rare, 5, NEPH_RUN_LIMIT_ABOVE, NAN, &limit),
                           "more than half"));
    assert_non_null(strstr(neph_run_limit(&family, wide, 5, NEPH_RUN_LIMIT_BELOW, INFINITY, &limit),
                           "more runs"));
    assert_non_null(
        strstr(neph_run_limit(&family, huge, 5, NEPH_RUN_LIMIT_ABOVE, NAN, &limit), "more runs"));
    assert_true(limit == -1.0);
}

/* ---- simulated runs -------------------------------------------------------------------------- */

static double draw_normal(uint64_t *random)
{
    const double u = neph_test_uniform(random, 0x1p-60, 1.0);
    return sqrt(-2.0 * log(u)) * cos(neph_test_uniform(random, 0.0, 2.0 * M_PI));
}

static double draw_exponential(uint64_t *random)
{
    return -log(neph_test_uniform(random, 0x1p-60, 1.0));
}

/* Shapes of noise: from z, a standard normal number that other numbers of the run share in part. */
static double shape_normal(double z, uint64_t *random)
{
    (void)random;
    return 1.0 + 0.02 * z;
}

static double shape_log_normal(double z, uint64_t *random)
{
    (void)random;
    return exp(0.5 * z);
}

static double shape_gamma(double z, uint64_t *random) /* of shape 2, less what is shared */
{
    return draw_exponential(random) + draw_exponential(random) + 0.0 * z;
}

static double shape_exponential(double z, uint64_t *random)
{
    (void)z;
    return draw_exponential(random);
}

static double shape_squared(double z, uint64_t *random) /* mean squared error of five normal */
{
    double sum = z * z;
    for (int i = 0; i < 4; i++) {
        const double other = draw_normal(random);
        sum += other * other;
    }
    return sum / 5.0;
}

static double shape_uniform(double z, uint64_t *random)
{
    (void)z;
    return neph_test_uniform(random, 1.0, 2.0);
}

static const struct shape {
    const char *name;
    double (*draw)(double z, uint64_t *random);
} shapes[] = {
    {"normal", shape_normal},
    {"log-normal", shape_log_normal},
    {"gamma", shape_gamma},
    {"exponential", shape_exponential},
    {"squared errors", shape_squared},
    {"uniform", shape_uniform},
};

/* The numbers of a run, which have a correlation of 0.7 (before their shape). */
static void draw_run(const struct shape *shape, double numbers[NUMBERS], uint64_t *random)
{
    const double common = draw_normal(random);
    for (int i = 0; i < NUMBERS; i++)
        numbers[i] = shape->draw(sqrt(0.7) * common + sqrt(0.3) * draw_normal(random), random);
}

static void measure_limits(const struct shape *shape, const struct neph_run_limit_family *family,
                           double limits[NUMBERS], uint64_t *random)
{
    double runs[NUMBERS][RUNS], run[NUMBERS];
    for (int r = 0; r < RUNS; r++) {
        draw_run(shape, run, random);
        for (int i = 0; i < NUMBERS; i++)
            runs[i][r] = run[i];
    }
    for (int i = 0; i < NUMBERS; i++)
        assert_null(neph_run_limit(family, runs[i], RUNS, NEPH_RUN_LIMIT_ABOVE, NAN, &limits[i]));
}

static int count_alarms(const struct shape *shape, const double limits[NUMBERS], uint64_t *random)
{
    double run[NUMBERS];
    int alarms = 0;
    for (int other = 0; other < OTHERS; other++) {
        bool is_beyond = false;
        draw_run(shape, run, random);
        for (int i = 0; i < NUMBERS; i++)
            is_beyond |= run[i] > limits[i];
        alarms += is_beyond;
    }
    return alarms;
}

/* Limits of 10 runs hold on 95 % of 100 others in at least 95 % of the sets, and alarms are as rare
 * as stated: each within four standard errors, of a binomial number and of a mean over sets. */
static void test_limits_hold_on_others(void **state)
{
    const struct neph_run_limit_family family = {0.95, 0.95, NUMBERS};
    const int sets = neph_test_paths(900);
    const double error = sqrt(0.05 * 0.95 / sets);
    for (size_t s = 0; s < sizeof(shapes) / sizeof(shapes[0]); s++) {
        uint64_t random = SEED + s;
        int holding = 0;
        double alarms = 0.0, squares = 0.0;
        for (int set = 0; set < sets; set++) {
            double limits[NUMBERS];
            measure_limits(&shapes[s], &family, limits, &random);
            const int beyond = count_alarms(&shapes[s], limits, &random);
            alarms += beyond;
            squares += (double)beyond * beyond;
            holding += beyond <= (1.0 - family.share) * OTHERS;
        }
        print_message("%-14s seed %d: limits hold in %.1f %% of %d sets, alarms %.3f %%\n",
                      shapes[s].name, SEED + (int)s, 100.0 * holding / sets, sets,
                      100.0 * alarms / (sets * OTHERS));
        assert_true(holding >= (family.confidence - 4.0 * error) * sets);
        assert_true(alarms <=
                    neph_run_limit_alarm_rate(&family) * sets * OTHERS + 4.0 * sqrt(squares));
    }
}

/* For one number with normal noise the rate of alarms is a, not only at most a. For a signed number
 * about 0 it is lower, because the larger of both bounds is the limit of both sides. */
static void test_rate_of_one_number_is_exact(void **state)
{
    static const struct {
        enum neph_run_limit_side side;
        double mean, deviation, best;
    } cases[] = {
        {NEPH_RUN_LIMIT_ABOVE, 1.0, 1e-3, NAN},
        {NEPH_RUN_LIMIT_BELOW, 30.0, 0.5, INFINITY},
        {NEPH_RUN_LIMIT_EITHER, 1e-3, 1.0, NAN},
    };
    const struct neph_run_limit_family family = {0.5, 0.8, 1};
    const int sets = neph_test_paths(30000);
    const double rate = neph_run_limit_alarm_rate(&family);
    for (size_t c = 0; c < sizeof(cases) / sizeof(cases[0]); c++) {
        uint64_t random = SEED + c;
        int alarms = 0;
        for (int set = 0; set < sets; set++) {
            double values[RUNS + 1], limit = 0.0;
            for (int r = 0; r <= RUNS; r++)
                values[r] = cases[c].mean + cases[c].deviation * draw_normal(&random);
            assert_null(
                neph_run_limit(&family, values, RUNS, cases[c].side, cases[c].best, &limit));
            alarms += cases[c].side == NEPH_RUN_LIMIT_BELOW ? values[RUNS] < limit
                                                            : fabs(values[RUNS]) > limit;
        }
        print_message("side %zu, seed %d: alarms %.2f %%, expected %.2f %%\n", c, SEED + (int)c,
                      100.0 * alarms / sets, 100.0 * rate);
        const double error = 4.0 * sqrt(rate * (1.0 - rate) * sets);
        const double least = cases[c].side == NEPH_RUN_LIMIT_EITHER ? 0.5 * rate : rate;
        neph_assert_in_range(alarms, least * sets - error, rate * sets + error);
    }
}

#include "tests/main.h"
