/* SPDX-License-Identifier: MIT
 *
 * The difference of two measurements by paired draws of tiles: the coverage of 95 % intervals, the
 * error rate of a p-value of 0.05, and cancellation of common noise.
 */
#include "tests/metrics/metrics_test.h"

#include "metrics/extractors/extractors.h"
#include "metrics/series.h"

enum { SIDE = 32, PIXELS = SIDE * SIDE };

static struct neph_measurement *measure_once(const struct neph_image *reference,
                                             const struct neph_image *test, bool draws, int *count)
{
    const struct neph_extractor *extractor = neph_extractor_find("error");
    const struct neph_meter_choice choice = {extractor, neph_options_default(extractor->options)};
    struct neph_mask *mask = create_mask(reference, "all");
    const struct neph_meter_params params = {.choices = &choice,
                                             .choice_count = 1,
                                             .viewing = NEPH_VIEWING_DEFAULTS,
                                             .masks = (const struct neph_mask *const *)&mask,
                                             .mask_count = 1,
                                             .frame_count = 1,
                                             .intervals = true,
                                             .draws = draws};
    struct neph_meter *meter = NULL;
    neph_assert_ok(neph_meter_create(&params, &meter, NULL), NULL);
    neph_assert_ok(neph_meter_frame(meter, reference, NULL, test, NULL), NULL);
    struct neph_measurement *measurements = neph_meter_release(meter, count);
    neph_meter_destroy(meter);
    neph_mask_destroy(mask);
    return measurements;
}

static const struct neph_measurement *named(const struct neph_measurement *list, int count,
                                            const char *metric)
{
    for (int i = 0; i < count; i++)
        if (strcmp(list[i].metric->name, metric) == 0)
            return &list[i];
    fail_msg("no %s", metric);
    return NULL;
}

/* 1 plus `shared` noise of one seed and `own` noise of the other, which varies slightly over x. */
static struct neph_image *noisy(double shared, uint64_t shared_seed, double own, uint64_t own_seed)
{
    struct neph_image *image = create_image(SIDE, SIDE);
    float *planes[3];
    neph_assert_ok(neph_image_add_rgb(image, NULL, planes, NULL), NULL);
    for (int i = 0; i < PIXELS; i++) {
        const double uneven = 0.5 + (double)(i % SIDE) / SIDE;
        const double value = 1.0 + uneven * (shared * neph_test_uniform(&shared_seed, -1.0, 1.0) +
                                             own * neph_test_uniform(&own_seed, -1.0, 1.0));
        for (int c = 0; c < 3; c++)
            planes[c][i] = (float)value;
    }
    return image;
}

static struct neph_image *flat(void)
{
    return noisy(0.0, 0, 0.0, 0);
}

/* Two measurements of the same reference, which have draws. */
struct pair {
    struct neph_measurement *of_a, *of_b;
    int count_a, count_b;
};

static struct pair measure_pair(const struct neph_image *reference, const struct neph_image *a,
                                const struct neph_image *b)
{
    struct pair pair;
    pair.of_a = measure_once(reference, a, true, &pair.count_a);
    pair.of_b = measure_once(reference, b, true, &pair.count_b);
    return pair;
}

static void finish_pair(struct pair *pair)
{
    neph_measurements_destroy(pair->of_a, pair->count_a);
    neph_measurements_destroy(pair->of_b, pair->count_b);
}

static struct neph_paired paired_of(const struct pair *pair, const char *metric)
{
    const struct neph_measurement *first = named(pair->of_a, pair->count_a, metric);
    const struct neph_measurement *second = named(pair->of_b, pair->count_b, metric);
    assert_non_null(first->draws);
    assert_non_null(second->draws);
    return neph_series_paired_draws(first->value, first->draws, second->value, second->draws);
}

static const char *const metrics[] = {"mae", "rmse", "p95", "bias"};

enum { METRIC_COUNT = sizeof(metrics) / sizeof(metrics[0]) };

/* Equal distributions: 5 of 100 p-values are below 0.05 and 5 of 100 intervals miss 0, plus or
 * minus three standard deviations of such a count, 2.2 each. (Of 200 it was 8 to 13, and 4 for
 * p95.) */
static void test_it_errs_as_often_as_it_says(void **state)
{
    uint64_t seed = test_seed(20261122);
    struct neph_image *reference = flat();
    int below[METRIC_COUNT] = {0}, missed[METRIC_COUNT] = {0};
    const int rounds = neph_test_paths(100);
    const int most = (int)(0.05 * rounds + 3.0 * sqrt(0.05 * 0.95 * rounds));
    for (int i = 0; i < rounds; i++) {
        const uint64_t shared = neph_test_random(&seed);
        struct neph_image *a = noisy(0.1, shared, 0.05, neph_test_random(&seed));
        struct neph_image *b = noisy(0.1, shared, 0.05, neph_test_random(&seed));
        struct pair pair = measure_pair(reference, a, b);
        for (int m = 0; m < METRIC_COUNT; m++) {
            const struct neph_paired paired = paired_of(&pair, metrics[m]);
            assert_true(paired.difference.defined);
            assert_int_equal(paired.difference.n, 64);
            below[m] += paired.p < 0.05;
            missed[m] += paired.difference.low > 0.0 || paired.difference.high < 0.0;
        }
        finish_pair(&pair);
        neph_image_destroy(a);
        neph_image_destroy(b);
    }
    for (int m = 0; m < METRIC_COUNT; m++) {
        print_message("%s: p < 0.05 in %d of %d, 0 outside in %d\n", metrics[m], below[m], rounds,
                      missed[m]);
        neph_assert_in_range(below[m], 0, most);
        neph_assert_in_range(missed[m], 0, most);
    }
    neph_image_destroy(reference);
}

/* One per cent more of the same noise: negligible for either interval, and certain in the
 * difference. */
static void test_what_both_share_falls_out(void **state)
{
    struct neph_image *reference = flat(), *a = noisy(0.101, 7, 0.0, 1), *b = noisy(0.1, 7, 0.0, 1);
    struct pair pair = measure_pair(reference, a, b);
    const struct neph_measurement *mae = named(pair.of_a, pair.count_a, "mae");
    const struct neph_paired paired = paired_of(&pair, "mae");
    neph_assert_close(paired.difference.value, 0.01 * mae->value / 1.01, 1e-5, 0.0);
    assert_true(mae->high - mae->low > 3.0 * paired.difference.value);
    assert_true(paired.difference.low > 0.0 && paired.p < 1e-6);
    finish_pair(&pair);
    neph_image_destroy(reference);
    neph_image_destroy(a);
    neph_image_destroy(b);
}

static void test_nothing_is_made_up(void **state)
{
    struct neph_image *reference = flat(), *a = noisy(0.1, 1, 0.0, 1);
    struct pair pair = measure_pair(reference, a, a);
    struct neph_paired paired = paired_of(&pair, "mae");
    assert_true(paired.p == 1.0 && paired.difference.value == 0.0);
    finish_pair(&pair);
    struct neph_draws one = {.tile_count = 64, .tiles = 1}, other = one;
    assert_true(neph_series_paired_draws(2.0, &one, 1.0, &other).p == 0.0); /* exactly 1 apart */
    other.tiles = 2;
    paired = neph_series_paired_draws(2.0, &one, 1.0, &other);
    assert_true(!paired.difference.defined && paired.p == 1.0);
    other = one;
    other.values[500] = NAN;
    assert_false(neph_series_paired_draws(2.0, &one, 1.0, &other).difference.defined);
    int count = 0;
    struct neph_measurement *measured = measure_once(reference, a, false, &count);
    assert_null(named(measured, count, "mae")->draws); /* not requested */
    neph_measurements_destroy(measured, count);
    measured = measure_once(reference, a, true, &count);
    assert_null(named(measured, count, "max_abs")->draws); /* a maximum has no interval */
    neph_measurements_destroy(measured, count);
    neph_image_destroy(reference);
    neph_image_destroy(a);
}

#include "tests/main.h"
