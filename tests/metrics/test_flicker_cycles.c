/* SPDX-License-Identifier: MIT
 *
 * The budget of flicker by period: planted periods are found, no others are, the parts add up to
 * the variance, and a missing value has a reason. bench_cycles does the same with all periods.
 */
#include "tests/metrics/flicker_test.h"

#include "tests/metrics/cycle_signal.h"
#include "tests/metrics/metrics_test.h"

#include <sched.h>

/* ---- frequencies ----------------------------------------------------------------------------- */

static struct neph_cycle_frequencies candidates_of(int frame_count, const char *declared,
                                                   struct neph_arena *memory)
{
    struct neph_cycle_declared parsed = {.count = 0};
    struct neph_cycle_frequencies frequencies = {.items = NULL};
    struct neph_diag diag = {0};
    neph_assert_ok(neph_cycle_parse(declared, &parsed, &diag), &diag);
    neph_assert_ok(neph_cycle_candidates(frame_count, &parsed, memory, &frequencies, &diag), &diag);
    return frequencies;
}

static bool has_period(const struct neph_cycle_frequencies *frequencies, int period)
{
    for (int i = 0; i < frequencies->count; i++)
        if (frequencies->items[i].period == period)
            return true;
    return false;
}

/* Farey's sequence of order 32 between 0 and 1/2: half of the sum of Euler's totients of 2..32,
 * 323, and the one half that belongs to 2. */
static void test_each_frequency_has_one_period(void **state)
{
    struct neph_arena memory = {0};
    struct neph_cycle_frequencies frequencies = candidates_of(256, "", &memory);
    assert_int_equal(frequencies.count, 162);
    for (int i = 0; i < frequencies.count; i++) {
        const struct neph_cycle_frequency f = frequencies.items[i];
        assert_int_equal(cycle_divisor(f.period, f.m), 1);
        assert_true(f.m >= 1 && 2 * f.m <= f.period && f.period <= 32);
        assert_true(i == 0 ||
                    neph_cycle_per_frame(frequencies.items[i - 1]) < neph_cycle_per_frame(f));
    }
    neph_arena_finish(&memory);
}

static void test_few_frames_have_few_periods(void **state)
{
    const int cases[][2] = {{16, 2}, {63, 7}, {64, 8}, {255, 31}, {256, 32}, {2048, 32}};
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        struct neph_arena memory = {0};
        struct neph_cycle_frequencies frequencies = candidates_of(cases[i][0], "", &memory);
        assert_int_equal(neph_cycle_longest(cases[i][0]), cases[i][1]);
        assert_true(has_period(&frequencies, cases[i][1]));
        assert_false(has_period(&frequencies, cases[i][1] + 1));
        neph_arena_finish(&memory);
    }
}

static void test_declared_periods_and_their_beats(void **state)
{
    struct neph_arena memory = {0};
    struct neph_cycle_frequencies frequencies = candidates_of(
        256, "slot 4, TAA jitter 7, ray 9,long 65", &memory);
    assert_true(has_period(&frequencies, 36));  /* of 4 and 9 */
    assert_true(has_period(&frequencies, 63));  /* of 7 and 9 */
    assert_false(has_period(&frequencies, 65)); /* fewer than four periods */
    assert_false(has_period(&frequencies, 56));
    neph_arena_finish(&memory);
    const char *const bad[] = {"slot",    "slot 1",   "7.5,slot",
                               "a 70000", "a 4,,b 7", "2,2,2,2,2,2,2,2,2,2,2,2,2,2,2,2,2"};
    for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
        struct neph_cycle_declared declared = {.count = -1};
        struct neph_diag diag = {0};
        assert_int_equal(neph_cycle_parse(bad[i], &declared, &diag), NEPH_ERR_INPUT);
        assert_non_null(strstr(diag.message, bad[i]));
        assert_int_equal(declared.count, -1);
    }
}

static void test_who_made_a_period(void **state)
{
    const struct {
        int period;
        const char *maker;
    } cases[] = {{7, "TAA jitter"},
                 {4, "slot"},
                 {2, "slot"},
                 {16, "ray dither"},
                 {28, "beat of slot and TAA jitter"},
                 {14, "beat of slot and TAA jitter"},
                 {9, ""}};
    struct neph_cycle_declared declared = {.count = 0};
    neph_assert_ok(neph_cycle_parse("slot 4, TAA jitter 7,  ray dither  32", &declared, NULL),
                   NULL);
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        char text[80] = "?";
        neph_cycle_explain(&declared, cases[i].period, text, sizeof(text));
        assert_string_equal(text, cases[i].maker);
    }
}

/* ---- found periods --------------------------------------------------------------------------- */

static void assert_found(const struct cycle_plan *plan, int side_px, int frame_count,
                         double tolerance)
{
    const struct cycle_result result = cycle_try(plan, side_px, side_px, frame_count);
    if (result.missed || result.extra || !(result.worst <= tolerance))
        fail_msg("periods %d and %d, general %d, random phase %d, noise %g, colour %d, seed %llu: "
                 "missed %d (period %d), not planted %d (period %d), RMS off by %g (period %d)",
                 plan->periods[0], plan->periods[1], plan->is_general, plan->random_phase,
                 plan->noise, (int)plan->colour, (unsigned long long)plan->seed, result.missed,
                 result.missed_period, result.extra, result.extra_period, result.worst,
                 result.worst_period);
}

/* The closest periods, periods that share bins, and primes; sines and waveforms, in phase and not.
 * The remaining error is the rounding of floats, 2^-24 of 0.1, and that of an inverse in which two
 * waves differ by 0.2. */
static void test_pairs_are_found(void **state)
{
    const int pairs[][2] = {{31, 32}, {30, 32}, {16, 32}, {7, 8}, {2, 4}, {29, 3}, {13, 26}};
    const int count = (int)(sizeof(pairs) / sizeof(pairs[0]));
    for (int i = 0; i < neph_test_paths(2 * count); i++) {
        const struct cycle_plan plan = {.periods = {pairs[i % count][0], pairs[i % count][1]},
                                        .is_general = i & 1,
                                        .random_phase = (i & 2) != 0,
                                        .rms = 0.02,
                                        .seed = 40 + (uint64_t)i};
        assert_found(&plan, 8, 256, 1e-4);
    }
}

/* Under noise of the same RMS, over a mask of 10,000 pixels: within 2 %. */
static void test_cycles_are_found_in_noise(void **state)
{
    const int pairs[][2] = {{31, 32}, {7, 0}, {8, 32}, {24, 5}};
    const int count = (int)(sizeof(pairs) / sizeof(pairs[0]));
    for (int i = 0; i < neph_test_paths(2 * count); i++) {
        const struct cycle_plan plan = {.periods = {pairs[i % count][0], pairs[i % count][1]},
                                        .is_general = i & 1,
                                        .random_phase = i >= count,
                                        .rms = 0.02,
                                        .noise = 0.02,
                                        .seed = 60 + (uint64_t)i};
        assert_found(&plan, 100, 256, 0.02);
    }
}

/* At a level of 0.1 % no period is expected in these 30. */
static void test_noise_has_no_cycles(void **state)
{
    for (int i = 0; i < neph_test_paths(3 * CYCLE_COLOUR_COUNT); i++) {
        const struct cycle_plan plan = {.noise = 0.02,
                                        .colour = (enum cycle_colour)(i % CYCLE_COLOUR_COUNT),
                                        .seed = 80 + (uint64_t)i};
        assert_found(&plan, 40, 256, 0.0);
    }
}

/* In four pixels under noise of four times the RMS, 31 frames cannot always be distinguished from
 * 30 or 32: a wrong period states that it is uncertain. */
static void test_a_wrong_period_says_so(void **state)
{
    int wrong = 0;
    for (int i = 0; i < neph_test_paths(16); i++) {
        const struct cycle_plan plan = {.periods = {31, 0},
                                        .random_phase = true,
                                        .rms = 0.02,
                                        .noise = 0.08,
                                        .seed = 1 + (uint64_t)i};
        struct neph_arena memory = {0};
        struct neph_cycle_frames frames = {.values = NULL};
        double truth[CYCLE_LIMIT];
        cycle_make(&frames, &plan, 2, 2, 256, &memory, truth);
        struct neph_cycle_findings findings = cycle_search(&frames, &memory);
        for (int f = 0; f < findings.count; f++) {
            const bool is_right = findings.items[f].frequency.period == 31;
            wrong += !is_right;
            assert_true(is_right || findings.items[f].also_period == 31);
        }
        neph_arena_finish(&memory);
    }
    assert_true(wrong > 0 || neph_test_path_step() > 1); /* few tests may have none */
}

/* ---- budget ---------------------------------------------------------------------------------- */

static struct extraction run_cycles(const struct sequence *reference, const struct sequence *test)
{
    const struct neph_viewing viewing = NEPH_VIEWING_DEFAULTS;
    struct neph_frame_pair pair = flicker_pair(reference, test, 0, &viewing);
    struct extraction extraction = extraction_begin(&neph_extractor_cycles, &pair, NULL);
    for (int t = 0; t < test->frame_count; t++) {
        pair = flicker_pair(reference, test, t, &viewing);
        extraction_frame(&extraction, &pair);
    }
    extraction_flush(&extraction);
    return extraction;
}

enum { W = 20, H = 3, N = 256 };

/* Luma of pixel x in frame t: rows differ in the signal next to the cycles. */
static double budget_luma(int x, int y, int t, double noise)
{
    const double u = (double)t / (double)N;
    const double cycles = 0.01 * cos(2.0 * M_PI * t / 31.0 + 0.3 * x) +
                          0.008 * cos(2.0 * M_PI * t / 32.0 + 0.7 * x * x) +
                          0.006 * (t % 4 == x % 4);
    return 0.4 + cycles + (y == 0 ? 0.0 : 0.05 * u) + (y == 2 ? noise : 0.0);
}

static void fill_budget(struct sequence *test)
{
    uint64_t random = 17;
    for (int t = 0; t < N; t++)
        for (int y = 0; y < H; y++)
            for (int x = 0; x < W; x++)
                sequence_set_luma(test, t, x, y, budget_luma(x, y, t, 0.01 * normal(&random)));
}

static double *part_map(const struct extraction *extraction, const char *name)
{
    return extraction_map(extraction, extraction_map_index(extraction->extractor, name));
}

/* Parseval: the variances of each period, of the line and of the noise, each computed separately,
 * and their cross terms add up to the variance of the stored frames. d is stored as a float. */
static void test_parts_add_up_to_the_variance(void **state)
{
    struct sequence test = sequence_create(W, H, N), reference = sequence_create(W, H, 1);
    fill_budget(&test);
    struct extraction extraction = run_cycles(&reference, &test);
    static const char *const parts[] = {
        "cycle_2_squared",     "cycle_4_squared",     "cycle_31_squared", "cycle_32_squared",
        "cycle_drift_squared", "cycle_noise_squared", "cycle_overlap"};
    double sums[W * H] = {0.0};
    assert_true(extraction_scalar(&extraction, "cycle_count") == 4.0);
    for (size_t p = 0; p < sizeof(parts) / sizeof(parts[0]); p++) {
        double *map = part_map(&extraction, parts[p]);
        for (int i = 0; i < W * H; i++)
            sums[i] += map[i];
        free(map);
    }
    double *variance = part_map(&extraction, "cycle_variance");
    for (int i = 0; i < W * H; i++) {
        long double d[N];
        for (int t = 0; t < N; t++)
            d[t] = luma_of(&test, t, i % W, i / W, 0.0);
        neph_assert_close(variance[i], (double)variance_of(d, N), 1e-6, 1e-12);
        neph_assert_close(sums[i], variance[i], 1e-12, 0.0);
    }
    free(variance);
    extraction_end(&extraction);
    sequence_destroy(&reference);
    sequence_destroy(&test);
}

/* Without noise each part is as planted, to the rounding of d to a float. */
static void test_parts_are_what_was_planted(void **state)
{
    struct sequence test = sequence_create(W, H, N), reference = sequence_create(W, H, 1);
    fill_budget(&test);
    struct extraction extraction = run_cycles(&reference, &test);
    /* A pulse in one frame of four: half of its cosines' power at 1/4, half at 1/2. */
    const struct {
        const char *name;
        double square;
    } parts[] = {
        {"cycle_31_squared", 0.5 * 0.01 * 0.01},
        {"cycle_32_squared", 0.5 * 0.008 * 0.008},
        {"cycle_4_squared", 2.0 * 0.006 * 0.006 / 16.0},
        {"cycle_2_squared", 0.006 * 0.006 / 16.0},
        {"repeats_4_squared", 3.0 * 0.006 * 0.006 / 16.0},
        {"cycle_drift_squared", 0.05 * 0.05 * (1.0 - 1.0 / (256.0 * 256.0)) / 12.0},
    };
    for (size_t p = 0; p < sizeof(parts) / sizeof(parts[0]); p++) {
        double *map = part_map(&extraction, parts[p].name);
        for (int x = 0; x < W; x++)
            neph_assert_close(map[W + x], parts[p].square, 1e-4, 0.0);
        free(map);
    }
    extraction_end(&extraction);
    sequence_destroy(&reference);
    sequence_destroy(&test);
}

/* ---- masks ----------------------------------------------------------------------------------- */

enum { MASK_W = 48, MASK_H = 32 };

struct over_masks {
    struct neph_image *images[2]; /* reference, test */
    struct neph_mask *masks[3];
    struct neph_meter *meter;
};

/* A sine of `period` inside of mask.thin, noise of the same RMS everywhere. */
static struct over_masks measure_masks(int period, int frame_count, const char *declared)
{
    struct over_masks over = {.meter = NULL};
    struct neph_diag diag = {0};
    float *planes[2][3];
    for (int i = 0; i < 2; i++) {
        over.images[i] = create_image(MASK_W, MASK_H);
        neph_assert_ok(neph_image_add_rgb(over.images[i], NULL, planes[i], &diag), &diag);
        float *thin = add_channel(over.images[i], "mask.thin", NULL);
        for (int p = 0; p < MASK_W * MASK_H; p++) {
            thin[p] = p % MASK_W < MASK_W / 2;
            for (int c = 0; c < 3; c++)
                planes[i][c][p] = (float)linear_of(0.5);
        }
    }
    if (declared)
        neph_assert_ok(
            neph_image_set_attribute(over.images[1], NEPH_CYCLE_ATTRIBUTE, &diag, "%s", declared),
            &diag);
    static const char *const names[3] = {"all", "thin", "thin"};
    for (int m = 0; m < 2; m++)
        over.masks[m] = create_mask(over.images[0], names[m]);
    over.masks[2] = create_mask(over.images[0], "thin");
    over.masks[2]->pixel_count = 0;
    snprintf(over.masks[2]->name, sizeof(over.masks[2]->name), "rest");
    for (size_t p = 0; p < MASK_W * MASK_H; p++) {
        over.masks[2]->inside[p] = !over.masks[2]->inside[p];
        over.masks[2]->pixel_count += over.masks[2]->inside[p];
    }
    const struct neph_meter_choice choice = {&neph_extractor_cycles,
                                             neph_options_default(neph_extractor_cycles.options)};
    const struct neph_meter_params params = {.choices = &choice,
                                             .choice_count = 1,
                                             .viewing = NEPH_VIEWING_DEFAULTS,
                                             .masks = (const struct neph_mask *const *)over.masks,
                                             .mask_count = 3,
                                             .frame_count = frame_count,
                                             .intervals = true};
    neph_assert_ok(neph_meter_create(&params, &over.meter, &diag), &diag);
    uint64_t random = 5;
    for (int t = 0; t < frame_count; t++) {
        for (int p = 0; p < MASK_W * MASK_H; p++) {
            const bool thin = p % MASK_W < MASK_W / 2;
            const double wave = thin && period ? 0.02 * sqrt(2.0) * sin(2.0 * M_PI * t / period + p)
                                               : 0.0;
            const double luma = 0.5 + wave + 0.02 * normal(&random);
            for (int c = 0; c < 3; c++)
                planes[1][c][p] = (float)linear_of(luma);
        }
        neph_assert_ok(neph_meter_frame(over.meter, over.images[0], NULL, over.images[1], &diag),
                       &diag);
    }
    neph_assert_ok(neph_meter_finish(over.meter, &diag), &diag);
    return over;
}

static const struct neph_measurement *measurement_of(const struct over_masks *over,
                                                     const char *metric, const char *mask)
{
    int count = 0;
    const struct neph_measurement *all = neph_meter_measurements(over->meter, &count);
    for (int i = 0; i < count; i++)
        if (strcmp(all[i].metric->name, metric) == 0 && strcmp(all[i].mask, mask) == 0)
            return &all[i];
    fail_msg("'%s' was not measured over '%s'", metric, mask);
    return NULL;
}

static void end_masks(struct over_masks *over)
{
    neph_meter_destroy(over->meter);
    for (int m = 0; m < 3; m++)
        neph_mask_destroy(over->masks[m]);
    for (int i = 0; i < 2; i++)
        neph_image_destroy(over->images[i]);
}

static void assert_undefined(const struct over_masks *over, const char *metric, const char *mask,
                             const char *because)
{
    const struct neph_measurement *measured = measurement_of(over, metric, mask);
    if (measured->defined)
        fail_msg("'%s' over '%s' is %g", metric, mask, measured->value);
    if (!strstr(measured->undefined_because, because))
        fail_msg("'%s' over '%s': %s", metric, mask, measured->undefined_because);
}

/* Half of the frame has it; an interval contains the truth. */
static void test_a_mask_without_a_cycle_says_so(void **state)
{
    struct over_masks over = measure_masks(7, 256, NULL);
    const struct neph_measurement *all = measurement_of(&over, "cycle_7", "all");
    const struct neph_measurement *thin = measurement_of(&over, "cycle_7", "thin");
    assert_true(all->defined && thin->defined);
    neph_assert_close(thin->value, 0.02, 0.02, 0.0);
    neph_assert_close(all->value, 0.02 / sqrt(2.0), 0.02, 0.0);
    assert_int_equal(thin->interval, NEPH_INTERVAL_TILES);
    assert_true(thin->low > 0.0 && thin->low <= thin->value && thin->high >= thin->value);
    assert_undefined(&over, "cycle_7", "rest", "not above the noise of the mask");
    assert_undefined(&over, "cycle_8", "thin", "not above the noise floor");
    assert_undefined(&over, "cycle_drift", "all", "not above the noise of the mask");
    neph_assert_close(measurement_of(&over, "repeats_14", "thin")->value, thin->value, 1e-12, 0.0);
    neph_assert_close(measurement_of(&over, "cycle_noise", "rest")->value, 0.02, 0.02, 0.0);
    end_masks(&over);
}

static void test_what_few_frames_cannot_say(void **state)
{
    struct over_masks over = measure_masks(7, 64, NULL);
    assert_true(measurement_of(&over, "cycle_7", "thin")->defined);
    assert_undefined(&over, "cycle_9", "all", "longer than an eighth of the frames");
    assert_undefined(&over, "cycle_long_1", "all", "longer than 32 frames");
    end_masks(&over);
}

static void test_a_declared_long_period(void **state)
{
    struct over_masks over = measure_masks(56, 256, "slot 4, ray dither 56");
    neph_assert_close(measurement_of(&over, "cycle_long_1_frames", "all")->value, 56.0, 0.0, 0.0);
    neph_assert_close(measurement_of(&over, "cycle_long_1", "thin")->value, 0.02, 0.02, 0.0);
    end_masks(&over);
}

static void test_a_bad_declaration_is_told(void **state)
{
    struct over_masks over = measure_masks(0, 16, "slot four");
    const char *obstacle = neph_meter_obstacle(over.meter, neph_quantity_find("radiance"),
                                               &neph_extractor_cycles);
    assert_non_null(obstacle);
    assert_non_null(strstr(obstacle, NEPH_CYCLE_ATTRIBUTE));
    end_masks(&over);
}

/* ---- further cases --------------------------------------------------------------------------- */

/* A reference with the same flicker as the test leaves nothing. */
static void test_the_reference_is_taken_out(void **state)
{
    struct sequence test = sequence_create(W, H, 64), reference = sequence_create(W, H, 64);
    for (int t = 0; t < 64; t++)
        for (int i = 0; i < W * H; i++) {
            sequence_set_luma(&test, t, i % W, i / W,
                              0.4 + 0.1 * (t % 3 == 0) + 0.01 * (t % 5 == 0));
            sequence_set_luma(&reference, t, i % W, i / W, 0.4 + 0.1 * (t % 3 == 0));
        }
    struct extraction extraction = run_cycles(&reference, &test);
    assert_true(extraction_scalar(&extraction, "cycle_count") == 1.0);
    double *map = part_map(&extraction, "cycle_5_squared");
    neph_assert_close(map[0], 0.01 * 0.01 * 4.0 / 25.0, 1e-4, 0.0);
    free(map);
    extraction_end(&extraction);
    sequence_destroy(&reference);
    sequence_destroy(&test);
}

static void test_still_frames_have_nothing(void **state)
{
    struct sequence test = sequence_create(W, H, 32), reference = sequence_create(W, H, 1);
    struct extraction extraction = run_cycles(&reference, &test);
    assert_true(extraction_scalar(&extraction, "cycle_count") == 0.0);
    double *map = part_map(&extraction, "cycle_variance");
    for (int i = 0; i < W * H; i++)
        assert_true(map[i] == 0.0);
    free(map);
    extraction_end(&extraction);
    sequence_destroy(&reference);
    sequence_destroy(&test);
}

static void allow_processors(const cpu_set_t *allowed)
{
    assert_int_equal(sched_setaffinity(0, sizeof(*allowed), allowed), 0);
}

static void test_bits_do_not_depend_on_threads(void **state)
{
    struct sequence test = sequence_create(W, H, N), reference = sequence_create(W, H, 1);
    fill_budget(&test);
    cpu_set_t all, one;
    assert_int_equal(sched_getaffinity(0, sizeof(all), &all), 0);
    CPU_ZERO(&one);
    for (int cpu = 0; cpu < CPU_SETSIZE && CPU_COUNT(&one) == 0; cpu++)
        if (CPU_ISSET(cpu, &all))
            CPU_SET(cpu, &one);
    struct extraction many = run_cycles(&reference, &test);
    allow_processors(&one);
    struct extraction single = run_cycles(&reference, &test);
    allow_processors(&all);
    for (int map = 0; map < neph_extractor_cycles.map_count; map++) {
        double *a = extraction_map(&many, map), *b = extraction_map(&single, map);
        assert_memory_equal(a, b, (size_t)W * H * sizeof(*a));
        free(a);
        free(b);
    }
    extraction_end(&many);
    extraction_end(&single);
    sequence_destroy(&reference);
    sequence_destroy(&test);
}

static void test_table_is_sound(void **state)
{
    extraction_check_table(&neph_extractor_cycles);
}

#include "tests/main.h"
