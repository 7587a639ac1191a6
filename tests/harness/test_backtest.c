/* SPDX-License-Identifier: MIT
 *
 * The judgement of nightly runs over thousands of simulated runs: the rate of false alarms when
 * nothing changes, and the delay until a change is found. The values are correlated over time (an
 * autoregressive series of first order), hosts drift, some runs are on a loaded machine, and some
 * durations are outliers.
 *
 *   test_backtest STORE.json    the same with runs that are drawn, three in a row, from the
 *                               durations of real ones, as `neph store export` prints them
 */
#include "tests/neph_test.h"

#include "harness/json.h"
#include "harness/night/judge.h"

enum { SCENES = 24, PER_SCENE = 4, SERIES = SCENES * PER_SCENE, NIGHTS_MAX = 120, PLANTED_AT = 45 };

/* Measurements of a scene: an error that is equal in every run, one with noise, and two durations.
 */
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

static const double drawn_error = 0.02; /* relative standard error of the noisy error */
static const double alpha = 0.005;      /* of the nightly runs */

/* A change of the values from one run on. */
struct plant {
    double fixed, drawn, time; /* factors minus 1 */
    bool everywhere;           /* in all scenes; otherwise in one */
};

static double normal(uint64_t *random)
{
    const double u = neph_test_uniform(random, 1e-300, 1.0), v = neph_test_uniform(random, 0, 1);
    return sqrt(-2.0 * log(u)) * cos(2.0 * 3.14159265358979 * v);
}

/* An autoregressive series of first order with a standard deviation of 1. */
static double follow(double last, double correlation, uint64_t *random)
{
    return correlation * last + sqrt(1.0 - correlation * correlation) * normal(random);
}

struct world {
    uint64_t random;
    double base[SERIES], own[SERIES]; /* level of a series, and its deviation in this run */
    double drift;                     /* of the host, not seen by the calibration kernel */
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

/* Durations have 3 % of correlated noise, 1.5 % of slow drift, a loaded machine in one run of
 * thirty, and an outlier in one of a hundred. */
static double duration(struct world *world, int i, double load)
{
    const bool is_off = neph_test_uniform(&world->random, 0.0, 1.0) < 0.01;
    const double off = is_off ? neph_test_uniform(&world->random, 0.0, 1.0) : 0.0;
    const double share = neph_test_uniform(&world->random, 0.5, 1.0);
    world->own[i] = follow(world->own[i], 0.3, &world->random);
    return world->base[i] * exp(0.03 * world->own[i] + 0.015 * world->drift + load * share + off);
}

static double draw_error(struct world *world, int i, double *standard_error)
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

static double plant_factor(const struct plant *plant, enum neph_series_kind kind)
{
    return 1.0 + (kind == NEPH_SERIES_TIMED   ? plant->time
                  : kind == NEPH_SERIES_DRAWN ? plant->drawn
                                              : plant->fixed);
}

static void measure(struct world *world, int night, const struct plant *plant)
{
    const bool loaded = neph_test_uniform(&world->random, 0.0, 1.0) < 1.0 / 30.0;
    const double load = loaded ? neph_test_uniform(&world->random, 0.1, 0.7) : 0.0;
    world->drift = follow(world->drift, 0.9, &world->random);
    for (int i = 0; i < SERIES; i++) {
        const bool is_time = sorts[i % PER_SCENE].kind == NEPH_SERIES_TIMED;
        world->past[i][night] = is_time ? duration(world, i, load)
                                        : draw_error(world, i, &world->errors[i][night]);
        if (plant && night >= PLANTED_AT && is_planted(plant, i))
            world->past[i][night] *= plant_factor(plant, sorts[i % PER_SCENE].kind);
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

/* --- intervals of rates ----------------------------------------------------------------------- */

/* P(X <= k) of n draws with the probability p. */
static double binomial_below(int k, int n, double p)
{
    double sum = 0.0;
    for (int i = 0; i <= k; i++)
        sum += exp(lgamma(n + 1.0) - lgamma(i + 1.0) - lgamma(n - i + 1.0) + i * log(p) +
                   (n - i) * log1p(-p));
    return sum;
}

/* The interval of Clopper and Pearson, Biometrika 26, 1934, at 95 %, by bisection. */
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
    double low, high;
    clopper_pearson(0, 100, &low, &high); /* 1 - 0.025^(1/100) */
    neph_assert_close(low, 0.0, 0.0, 0.0);
    neph_assert_close(high, 1.0 - pow(0.025, 0.01), 1e-9, 0.0);
    clopper_pearson(5, 10, &low, &high); /* Clopper and Pearson's chart: 0.187 to 0.813 */
    neph_assert_close(low, 0.1871, 0.0, 1e-4);
    neph_assert_close(high, 0.8129, 0.0, 1e-4);
}

/* --- runs without a change -------------------------------------------------------------------- */

static void test_unchanged_runs_give_no_alarm(void **state)
{
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

/* Number of runs until the first alarm, 1 for the run of the change; 0: none in three weeks. */
static int measure_delay(struct world *world, uint64_t seed, const struct plant *plant)
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
    /* `share`: part of all repetitions with an alarm within three weeks; `median`: run by which
     * half of them have one. An error that is equal in every run is always found. For a noisy error
     * with a standard error of 2 %, a change of 3 % in one scene is below the floor. So is 5 % of a
     * duration with this much noise. Nothing is required for these two. */
    static const struct {
        const char *what;
        struct plant plant;
        double share;
        int median;
    } plants[] = {
        {"fixed error +1 %, one scene", {0.01, 0.0, 0.0, false}, 1.0, 1},
        {"fixed error +3 %, one scene", {0.03, 0.0, 0.0, false}, 1.0, 1},
        {"fixed error +10 %, one scene", {0.10, 0.0, 0.0, false}, 1.0, 1},
        {"fixed error +1 %, all scenes", {0.01, 0.0, 0.0, true}, 1.0, 1},
        {"fixed error +3 %, all scenes", {0.03, 0.0, 0.0, true}, 1.0, 1},
        {"drawn error +3 %, one scene", {0.0, 0.03, 0.0, false}, 0.0, 21},
        {"drawn error +10 %, one scene", {0.0, 0.10, 0.0, false}, 0.5, 21},
        {"drawn error +20 %, one scene", {0.0, 0.20, 0.0, false}, 0.5, 21},
        {"drawn error +1 %, all scenes", {0.0, 0.01, 0.0, true}, 0.0, 21},
        {"drawn error +3 %, all scenes", {0.0, 0.03, 0.0, true}, 0.5, 21},
        {"5 % slower, one scene", {0.0, 0.0, 0.05, false}, 0.0, 21},
        {"20 % slower, one scene", {0.0, 0.0, 0.20, false}, 0.5, 7},
        {"5 % slower, all scenes", {0.0, 0.0, 0.05, true}, 0.5, 14},
        {"20 % slower, all scenes", {0.0, 0.0, 0.20, true}, 1.0, 5},
    };
    struct world *world = malloc(sizeof(*world));
    const int runs = neph_test_by_day(3, 40);
    int delays[64];
    for (size_t p = 0; p < COUNT(plants); p++) {
        int found = 0;
        for (int run = 0; run < runs; run++) {
            const int delay = measure_delay(world, 5000 + (uint64_t)run, &plants[p].plant);
            if (delay > 0)
                delays[found++] = delay;
        }
        qsort(delays, (size_t)found, sizeof(*delays), by_delay);
        print_message("%-29s found in %d of %d within three weeks", plants[p].what, found, runs);
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

/* --- measured runs ---------------------------------------------------------------------------- */

enum { SAMPLE_SERIES = 64, SAMPLE_NIGHTS = 400, SAMPLE_LEAST = 10, BLOCK = 3, RESAMPLED = 60 };

/* Logarithms of durations, relative to their mean. */
struct sample {
    int series, nights;
    double level[SAMPLE_SERIES][SAMPLE_NIGHTS];
};

/* NaN: not measured. `busy` durations were measured on a busy machine; a run does not use them. */
static double find_night_value(const json_t *night, const char *series, bool with_busy)
{
    size_t i;
    const json_t *m;
    json_array_foreach(json_object_get(night, "measurements"), i, m)
    {
        const char *kind = neph_json_text(m, "kind");
        const bool counts = strcmp(kind, "timed") == 0 || (with_busy && strcmp(kind, "busy") == 0);
        if (counts && strcmp(neph_json_text(m, "series"), series) == 0)
            return json_number_value(json_object_get(m, "value"));
    }
    return NAN;
}

/* False: too few runs. */
static bool take_series(struct sample *sample, const json_t *nights, const char *series,
                        bool with_busy)
{
    double sum = 0.0, *level = sample->level[sample->series];
    int count = 0;
    for (int n = 0; n < sample->nights; n++) {
        level[n] = log(find_night_value(json_array_get(nights, (size_t)n), series, with_busy));
        sum += isfinite(level[n]) ? level[n] : 0.0;
        count += isfinite(level[n]);
    }
    for (int n = 0; n < sample->nights; n++)
        level[n] -= sum / count;
    return count >= SAMPLE_LEAST;
}

static bool is_timed(const json_t *m)
{
    const char *kind = neph_json_text(m, "kind");
    return strcmp(kind, "timed") == 0 || strcmp(kind, "busy") == 0;
}

/* Runs in which times were measured, even on a busy machine. */
static json_t *timed_nights(const json_t *document)
{
    size_t n, i;
    json_t *night, *kept = json_array();
    const json_t *m, *step;
    json_array_foreach(json_object_get(document, "nights"), n, night)
    {
        bool timed = false;
        json_array_foreach(json_object_get(night, "measurements"), i, m) timed |= is_timed(m);
        json_array_foreach(json_object_get(night, "steps"), i, step)
            timed |= strncmp(neph_json_text(step, "name"), "speed ", 6) == 0;
        if (timed && json_array_size(kept) < SAMPLE_NIGHTS)
            neph_json_add(&kept, json_incref(night));
    }
    return kept;
}

static void take_sample(struct sample *sample, const json_t *document, bool with_busy)
{
    json_t *nights = timed_nights(document), *names = json_object();
    size_t n, i;
    const json_t *night, *m;
    const char *series;
    json_t *unused;
    *sample = (struct sample){.nights = (int)json_array_size(nights)};
    json_array_foreach(nights, n, night)
        json_array_foreach(json_object_get(night, "measurements"), i, m) if (is_timed(m))
            neph_json_set(&names, neph_json_text(m, "series"), json_true());
    json_object_foreach(names, series, unused) if (sample->series < SAMPLE_SERIES)
        sample->series += take_series(sample, nights, series, with_busy);
    json_decref(names);
    json_decref(nights);
}

/* Draws blocks of three consecutive runs with all their series, which keeps effects that last for
 * days or affect all series. */
static void draw_runs(const struct sample *sample, uint64_t *random, double factor,
                      double past[SAMPLE_SERIES][RESAMPLED])
{
    for (int night = 0; night < RESAMPLED; night += BLOCK) {
        const int from = (int)neph_test_uniform(random, 0.0, sample->nights - BLOCK + 1);
        for (int k = 0; k < BLOCK && night + k < RESAMPLED; k++)
            for (int i = 0; i < sample->series; i++)
                past[i][night + k] = exp(sample->level[i][from + k]) *
                                     (night + k >= PLANTED_AT ? factor : 1.0);
    }
}

static bool alarms_resampled(const struct sample *sample, double past[SAMPLE_SERIES][RESAMPLED],
                             int night)
{
    struct neph_series series[SAMPLE_SERIES];
    struct neph_verdicts verdicts;
    for (int i = 0; i < sample->series; i++)
        series[i] = (struct neph_series){.name = "",
                                         .engine = "any",
                                         .metric = "time",
                                         .kind = NEPH_SERIES_TIMED,
                                         .tonight = past[i][night],
                                         .standard_error = NAN,
                                         .past = past[i],
                                         .past_count = night};
    neph_assert_ok(neph_judge(series, sample->series, alpha, &verdicts, NULL), NULL);
    const bool alarm = verdicts.worse > 0;
    neph_verdicts_finish(&verdicts);
    return alarm;
}

/* Results of a simulation. */
struct rehearsal {
    int quiet, false_alarms; /* runs without a change */
    int runs, found;         /* runs in which all durations grew, within the two weeks that remain
                                */
    int delays[64];          /* runs until the change was found, sorted */
};

static struct rehearsal resample(const struct sample *sample, int runs, double factor)
{
    static double past[SAMPLE_SERIES][RESAMPLED];
    struct rehearsal made = {.runs = runs};
    uint64_t random = 77;
    for (int run = 0; run < runs; run++) {
        bool is_found = false;
        draw_runs(sample, &random, factor, past);
        for (int night = 1; night < RESAMPLED; night++) {
            const bool alarm = alarms_resampled(sample, past, night);
            made.quiet += night < PLANTED_AT;
            made.false_alarms += alarm && night < PLANTED_AT;
            if (alarm && night >= PLANTED_AT && !is_found)
                made.delays[made.found++] = night - PLANTED_AT + 1;
            is_found = is_found || (alarm && night >= PLANTED_AT);
        }
    }
    qsort(made.delays, (size_t)made.found, sizeof(made.delays[0]), by_delay);
    return made;
}

static void print_rehearsal(const struct sample *sample, const struct rehearsal *made, int percent)
{
    double low, high;
    clopper_pearson(made->false_alarms, made->quiet, &low, &high);
    print_message("%d nights, %d durations: %d false alarms in %d nights, %.4f a night, 95 %% %.4f "
                  "to %.4f (Clopper-Pearson); all %d %% slower: found in %d of %d within two weeks",
                  sample->nights, sample->series, made->false_alarms, made->quiet,
                  (double)made->false_alarms / made->quiet, low, high, percent, made->found,
                  made->runs);
    if (made->found > 0)
        print_message(", median on night %d", made->delays[made->found / 2]);
    print_message("\n");
}

static int rehearse(const char *path)
{
    static struct sample sample;
    json_t *document = json_load_file(path, 0, NULL);
    take_sample(&sample, document, false);
    json_decref(document);
    if (sample.series == 0) {
        fprintf(stderr, "'%s' has %d nights, and no duration in %d of them, which is the least\n",
                path, sample.nights, SAMPLE_LEAST);
        return 66;
    }
    for (int percent = 5; percent <= 20; percent *= 2) {
        const struct rehearsal made = resample(&sample, 50, 1.0 + 0.01 * percent);
        print_rehearsal(&sample, &made, percent);
    }
    return 0;
}

/* A store export with simulated runs; draws from it have the same statistics. */
static json_t *make_document(struct world *world, int nights)
{
    json_t *list = json_array();
    for (int night = 0; night < nights; night++) {
        json_t *measurements = json_array();
        measure(world, night, NULL);
        for (int i = 0; i < SERIES; i++)
            if (sorts[i % PER_SCENE].kind == NEPH_SERIES_TIMED)
                neph_json_add(&measurements,
                              json_pack("{s:o, s:s, s:f}", "series", json_sprintf("%d", i), "kind",
                                        "timed", "value", world->past[i][night]));
        neph_json_add(&measurements, json_pack("{s:s, s:s, s:f}", "series", "error", "kind",
                                               "fixed", "value", 0.25));
        neph_json_add(&list, json_pack("{s:o}", "measurements", measurements));
    }
    return json_pack("{s:o}", "nights", list);
}

static void test_runs_are_drawn_from_a_store(void **state)
{
    static struct sample sample;
    struct world *world = malloc(sizeof(*world));
    begin_world(world, 5);
    json_t *document = make_document(world, 30);
    take_sample(&sample, document, false);
    assert_int_equal(sample.nights, 30);
    assert_int_equal(sample.series, SERIES / 2);
    const double first = sample.level[0][3] - sample.level[0][4];
    neph_assert_close(first, log(world->past[MARCH_TIME][3] / world->past[MARCH_TIME][4]), 1e-9,
                      0.0);
    const int runs = neph_test_by_day(4, 50);
    const struct rehearsal made = resample(&sample, runs, 1.2);
    print_rehearsal(&sample, &made, 20);
    assert_int_equal(made.quiet, runs * (PLANTED_AT - 1));
    assert_true(made.false_alarms < 0.02 * made.quiet);
    assert_int_equal(made.found, runs);
    json_decref(document);
    free(world);
}

/* Real runs on two cores that a dozen other programs were using (tests/data/README.md): with the
 * usual durations only, and with those of the busy machine, which are off by factors. */
static void test_runs_of_a_loaded_machine(void **state)
{
    static struct sample sample;
    json_t *document = json_load_file(NEPH_SOURCE_DIR "/tests/data/nights.json", 0, NULL);
    double low, high;
    for (int with_busy = 0; with_busy < 2; with_busy++) {
        take_sample(&sample, document, with_busy);
        assert_true(sample.nights >= 2 * SAMPLE_LEAST);
        assert_int_equal(sample.series, with_busy ? 4 : 2);
        print_message(with_busy ? "busy steps, too: " : "as nights have them: ");
        for (int percent = 20; percent <= 100; percent += 80) {
            const struct rehearsal made = resample(&sample, neph_test_by_day(4, 50),
                                                   1.0 + 0.01 * percent);
            print_rehearsal(&sample, &made, percent);
            clopper_pearson(made.false_alarms, made.quiet, &low, &high);
            assert_true(low < 0.01);
            if (neph_test_is_night())
                assert_true((double)made.false_alarms / made.quiet < 0.01);
            if (neph_test_is_night() && with_busy && percent == 100)
                assert_true(made.found > made.runs / 2);
        }
    }
    json_decref(document);
}

int main(int argc, char **argv)
{
    if (argc == 2)
        return rehearse(argv[1]);
    const struct CMUnitTest tests[] = {
#include "cases/test_backtest.inc"
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
