/* SPDX-License-Identifier: MIT
 *
 * The judge of nights over thousands of simulated ones: how often it alarms when nothing changed,
 * how soon when something did. Numbers only. Nights hang together (an autoregressive series of
 * first order), hosts drift, some nights are loaded, and some durations are simply off.
 */
#include "tests/neph_test.h"

#include "harness/night/judge.h"

enum { SCENES = 24, PER_SCENE = 4, SERIES = SCENES * PER_SCENE, NIGHTS_MAX = 120, PLANTED_AT = 45 };

/* What is measured in each scene: an error that is the same every night, one with noise of its own,
 * and two durations. */
enum { MARCH_ERROR, CYCLES_ERROR, MARCH_TIME, CYCLES_TIME };

static const struct {
    const char *engine, *metric, *truth;
    enum neph_series_kind kind;
} sorts[PER_SCENE] = {
    [MARCH_ERROR] = {"march", "rel_rmse", "exact", NEPH_SERIES_FIXED},
    [CYCLES_ERROR] = {"cycles", "rel_rmse", "exact", NEPH_SERIES_DRAWN},
    [MARCH_TIME] = {"march", "time", NULL, NEPH_SERIES_TIMED},
    [CYCLES_TIME] = {"cycles", "time", NULL, NEPH_SERIES_TIMED},
};

static const double drawn_error = 0.02; /* of the noisy error, as it says of itself */
static const double alpha = 0.005;      /* of the nightly */

/* What is done to the numbers from a night on. */
struct plant {
    double error, time; /* factors less 1 */
    bool everywhere;    /* in all scenes; else in one */
};

static double normal(uint64_t *random)
{
    const double u = neph_test_uniform(random, 1e-300, 1.0), v = neph_test_uniform(random, 0, 1);
    return sqrt(-2.0 * log(u)) * cos(2.0 * 3.14159265358979 * v);
}

/* An autoregressive series of first order with the deviation 1. */
static double follow(double last, double correlation, uint64_t *random)
{
    return correlation * last + sqrt(1.0 - correlation * correlation) * normal(random);
}

struct world {
    uint64_t random;
    double base[SERIES], own[SERIES]; /* the level of a series, and how far off it is tonight */
    double drift;                     /* of the host, beyond what the calibration kernel sees */
    double past[SERIES][NIGHTS_MAX], errors[SERIES][NIGHTS_MAX];
};

static void begin_world(struct world *world, uint64_t seed)
{
    world->random = seed;
    world->drift = normal(&world->random);
    for (int i = 0; i < SERIES; i++) {
        world->base[i] = exp(neph_test_uniform(&world->random, -5.0, 1.0));
        world->own[i] = normal(&world->random);
    }
}

/* Durations: 3 % of noise with a memory, 1.5 % of drift with a long one, one night in thirty on
 * which the machine is loaded, one duration in a hundred that is off by itself. */
static double duration(struct world *world, int i, double load)
{
    const bool is_off = neph_test_uniform(&world->random, 0.0, 1.0) < 0.01;
    const double off = is_off ? neph_test_uniform(&world->random, 0.0, 1.0) : 0.0;
    const double share = neph_test_uniform(&world->random, 0.5, 1.0);
    world->own[i] = follow(world->own[i], 0.3, &world->random);
    return world->base[i] * exp(0.03 * world->own[i] + 0.015 * world->drift + load * share + off);
}

static double error_of(struct world *world, int i, double *standard_error)
{
    *standard_error = NAN;
    if (sorts[i % PER_SCENE].kind == NEPH_SERIES_FIXED)
        return world->base[i];
    *standard_error = drawn_error * world->base[i];
    world->own[i] = follow(world->own[i], 0.2, &world->random);
    return world->base[i] * (1.0 + drawn_error * world->own[i]);
}

static bool is_planted(const struct plant *plant, int i)
{
    return plant->everywhere || i / PER_SCENE == 7;
}

static void measure(struct world *world, int night, const struct plant *plant)
{
    const bool loaded = neph_test_uniform(&world->random, 0.0, 1.0) < 1.0 / 30.0;
    const double load = loaded ? neph_test_uniform(&world->random, 0.1, 0.7) : 0.0;
    world->drift = follow(world->drift, 0.9, &world->random);
    for (int i = 0; i < SERIES; i++) {
        const bool is_time = sorts[i % PER_SCENE].kind == NEPH_SERIES_TIMED;
        world->past[i][night] = is_time ? duration(world, i, load)
                                        : error_of(world, i, &world->errors[i][night]);
        if (plant && night >= PLANTED_AT && is_planted(plant, i))
            world->past[i][night] *= 1.0 + (is_time ? plant->time : plant->error);
    }
}

static struct neph_verdicts judge(const struct world *world, int night)
{
    struct neph_series series[SERIES];
    struct neph_verdicts verdicts;
    for (int i = 0; i < SERIES; i++)
        series[i] = (struct neph_series){.name = "",
                                         .engine = sorts[i % PER_SCENE].engine,
                                         .metric = sorts[i % PER_SCENE].metric,
                                         .truth = sorts[i % PER_SCENE].truth,
                                         .kind = sorts[i % PER_SCENE].kind,
                                         .unit = 1e-5,
                                         .tonight = world->past[i][night],
                                         .standard_error = world->errors[i][night],
                                         .past = world->past[i],
                                         .past_errors = world->errors[i],
                                         .past_count = night};
    neph_assert_ok(neph_judge(series, SERIES, alpha, &verdicts, NULL), NULL);
    return verdicts;
}

static bool alarms(const struct world *world, int night)
{
    struct neph_verdicts verdicts = judge(world, night);
    const bool alarm = verdicts.worse > 0;
    assert_true(verdicts.compared > 0);
    neph_verdicts_finish(&verdicts);
    return alarm;
}

/* ---- how sure a rate is ---------------------------------------------------------------------- */

/* P(X <= k) of n draws with the probability p. */
static double binomial_below(int k, int n, double p)
{
    double sum = 0.0;
    for (int i = 0; i <= k; i++)
        sum += exp(lgamma(n + 1.0) - lgamma(i + 1.0) - lgamma(n - i + 1.0) + i * log(p) +
                   (n - i) * log1p(-p));
    return sum;
}

/* The limits of Clopper and Pearson, Biometrika 26, 1934, at 95 %, by bisection. */
static void clopper_pearson(int k, int n, double *low, double *high)
{
    double bounds[2] = {0.0, 1.0};
    for (int side = 0; side < 2; side++) {
        double a = 0.0, b = 1.0;
        for (int i = 0; i < 60; i++) {
            const double p = 0.5 * (a + b);
            const double tail = side ? binomial_below(k, n, p) : 1.0 - binomial_below(k - 1, n, p);
            const bool too_small = side ? tail > 0.025 : tail < 0.025;
            *(too_small ? &a : &b) = p;
        }
        if ((side == 0 && k > 0) || (side == 1 && k < n))
            bounds[side] = 0.5 * (a + b);
    }
    *low = bounds[0];
    *high = bounds[1];
}

static void test_intervals_of_rates(void **state)
{
    (void)state;
    double low, high;
    clopper_pearson(0, 100, &low, &high); /* 1 - 0.025^(1/100) */
    neph_assert_close(low, 0.0, 0.0, 0.0);
    neph_assert_close(high, 1.0 - pow(0.025, 0.01), 1e-9, 0.0);
    clopper_pearson(5, 10, &low, &high); /* Clopper and Pearson's chart: 0.187 to 0.813 */
    neph_assert_close(low, 0.1871, 0.0, 1e-4);
    neph_assert_close(high, 0.8129, 0.0, 1e-4);
}

/* ---- quiet nights ---------------------------------------------------------------------------- */

static void test_quiet_nights_are_quiet(void **state)
{
    (void)state;
    struct world *world = malloc(sizeof(*world));
    int nights = 0, false_alarms = 0;
    double low, high;
    for (int run = 0; run < neph_test_by_day(3, 40); run++) {
        begin_world(world, 1000 + (uint64_t)run);
        for (int night = 0; night < NIGHTS_MAX; night++) {
            measure(world, night, NULL);
            if (night == 0)
                continue;
            nights++;
            false_alarms += alarms(world, night);
        }
    }
    clopper_pearson(false_alarms, nights, &low, &high);
    print_message("%d quiet nights of %d series: %d false alarms, %.4f a night, 95 %% %.4f to "
                  "%.4f (Clopper-Pearson)\n",
                  nights, SERIES, false_alarms, (double)false_alarms / nights, low, high);
    assert_true(low < 0.01);
    if (neph_test_is_night())
        assert_true((double)false_alarms / nights < 0.01);
    free(world);
}

/* ---- planted changes ------------------------------------------------------------------------- */

/* Nights until the first alarm, 1 being that of the change; 0: none in three weeks. */
static int delay_of(struct world *world, uint64_t seed, const struct plant *plant)
{
    enum { PATIENCE = 21 };
    begin_world(world, seed);
    for (int night = 0; night < PLANTED_AT + PATIENCE; night++) {
        measure(world, night, plant);
        if (night >= PLANTED_AT && alarms(world, night))
            return night - PLANTED_AT + 1;
    }
    return 0;
}

static int by_delay(const void *a, const void *b)
{
    return *(const int *)a - *(const int *)b;
}

static void test_planted_changes_are_found(void **state)
{
    (void)state;
    /* `share` is of all runs, within three weeks and by night, when there are forty; `median` is
     * the night by which half of these are found. 5 % in one scene is below the floor of durations
     * that are this unsteady: nothing is promised of it. */
    static const struct {
        const char *what;
        struct plant plant;
        double share;
        int median;
    } plants[] = {
        {"error +1 %, one scene", {0.01, 0.0, false}, 1.0, 1},
        {"error +3 %, one scene", {0.03, 0.0, false}, 1.0, 1},
        {"error +10 %, one scene", {0.10, 0.0, false}, 1.0, 1},
        {"error +1 %, all scenes", {0.01, 0.0, true}, 1.0, 1},
        {"error +3 %, all scenes", {0.03, 0.0, true}, 1.0, 1},
        {"5 % slower, one scene", {0.0, 0.05, false}, 0.0, 21},
        {"20 % slower, one scene", {0.0, 0.20, false}, 0.5, 7},
        {"5 % slower, all scenes", {0.0, 0.05, true}, 0.5, 14},
        {"20 % slower, all scenes", {0.0, 0.20, true}, 1.0, 5},
    };
    struct world *world = malloc(sizeof(*world));
    const int runs = neph_test_by_day(3, 40);
    int delays[64];
    for (size_t p = 0; p < COUNT(plants); p++) {
        int found = 0;
        for (int run = 0; run < runs; run++) {
            const int delay = delay_of(world, 5000 + (uint64_t)run, &plants[p].plant);
            if (delay > 0)
                delays[found++] = delay;
        }
        qsort(delays, (size_t)found, sizeof(*delays), by_delay);
        print_message("%-24s found in %d of %d within three weeks", plants[p].what, found, runs);
        if (found > 0)
            print_message("; median on night %d, latest %d", delays[found / 2], delays[found - 1]);
        print_message("\n");
        if (plants[p].share == 1.0 || neph_test_is_night()) {
            assert_true(found >= plants[p].share * runs);
            assert_true(found == 0 || delays[found / 2] <= plants[p].median);
        }
    }
    free(world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_intervals_of_rates),
        cmocka_unit_test(test_quiet_nights_are_quiet),
        cmocka_unit_test(test_planted_changes_are_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
