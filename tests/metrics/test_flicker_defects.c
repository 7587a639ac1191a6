/* SPDX-License-Identifier: MIT
 *
 * Planted defects through the meter: each must get its name, and no other.
 */
#include "tests/metrics/flicker_test.h"

#include "metrics/extractors/flicker_verdict.h"
#include "metrics/mask.h"
#include "metrics/meter.h"

/* A fence in front of a smooth sky: vertical bars of 1 px, 100 apart, so 1 % of the pixels. */
enum { W = 200, H = 48, N = 64, BAR_PITCH = 100, BAR_AT = 37 };

static bool is_bar(int x)
{
    return x % BAR_PITCH == BAR_AT;
}

/* ---- defects: luma added to the frame -------------------------------------------------------- */

/* The inputs of a defect. */
struct place {
    int t, x, y;
    uint64_t *random;
};

typedef double defect_function(struct place place);

/* The bars are missing in one of four frames. */
static double blinking_fence(struct place place)
{
    return is_bar(place.x) && place.t % 4 == 2 ? 0.2 : 0.0;
}

/* Every other frame. */
static double alternating_fence(struct place place)
{
    return is_bar(place.x) && place.t % 2 ? 0.1 : 0.0;
}

/* The variance of 0.2 in one frame of four is 0.2^2 * 3 / 16; here on 1 % of the pixels. */
static const double blink_std = 0.0866025403784438647;

static double noise_of_equal_energy(struct place place)
{
    return 0.1 * blink_std * normal(place.random);
}

static double noisy_fence(struct place place)
{
    return is_bar(place.x) ? blink_std * normal(place.random) : 0.0;
}

/* Noise common to all pixels, as from a fluctuating exposure. */
static double trembling(struct place place)
{
    static const signed char steps[N] = {
        3,  -2, 5,  0,  -4, 1, 2,  -1, 0,  4, -3, 2,  -5, 1,  3,  -2, -1, 0, 2,  -4, 5, 1,
        -2, 3,  -3, 0,  1,  4, -1, 2,  -5, 0, 2,  -3, 1,  5,  -2, 0,  -1, 3, 4,  -4, 2, -2,
        1,  0,  3,  -5, -1, 2, 0,  -3, 4,  1, -2, 5,  0,  -1, -4, 3,  2,  1, -3, 0};
    return 0.01 * steps[place.t];
}

static double fade_even(struct place place)
{
    return 0.3 * place.t / N;
}

static double fade_smooth(struct place place)
{
    const double s = (double)place.t / (N - 1);
    return 0.3 * s * s * (3.0 - 2.0 * s);
}

static double fade_decaying(struct place place)
{
    return 0.3 * exp(-place.t / 6.0);
}

static double fade_out_and_back(struct place place)
{
    const double s = (double)place.t / (N - 1);
    return 0.3 * 4.0 * s * (1.0 - s);
}

static double cut(struct place place)
{
    return place.t < 21 ? 0.0 : 0.3;
}

static double nothing(struct place place)
{
    (void)place;
    return 0.0;
}

static double everything(struct place place)
{
    return blinking_fence(place) + fade_smooth(place) + 0.01 * normal(place.random);
}

/* A dither that rotates through the 2x2 everywhere. */
static double turning_dither(struct place place)
{
    static const int turn[4] = {0, 1, 3, 2};
    return place.t % 4 == turn[(place.x & 1) + 2 * (place.y & 1)] ? 0.1 : 0.0;
}

/* All pixels at once. */
static double blinking_wall(struct place place)
{
    return place.t % 4 == 2 ? 0.1 : 0.0;
}

/* ---- through the meter ----------------------------------------------------------------------- */

static double luma_at(int x, int y)
{
    return is_bar(x) ? 0.25 : 0.4 + 0.1 * y / H;
}

/* A frame with depth: bars at 2 m, a wall behind at 10 m. */
static void fill_frame(struct neph_image *image, defect_function *defect, int t, uint64_t *random)
{
    float *planes[3];
    assert_true(neph_image_rgb(image, NULL, planes));
    float *depth = neph_image_channel(image, "Z");
    for (int y = 0; y < H; y++) {
        for (int x = 0; x < W; x++) {
            const struct place place = {t, x, y, random};
            const double grey = linear_of(luma_at(x, y) + defect(place));
            for (int c = 0; c < 3; c++)
                planes[c][y * W + x] = (float)grey;
            depth[y * W + x] = is_bar(x) ? 2.0f : 10.0f;
        }
    }
}

static struct neph_image *create_frame(void)
{
    struct neph_image *image = NULL;
    struct neph_diag diag = {0};
    float *planes[3], *depth;
    neph_assert_ok(neph_image_create(W, H, &image, &diag), &diag);
    neph_assert_ok(neph_image_add_rgb(image, NULL, planes, &diag), &diag);
    neph_assert_ok(neph_image_add_channel(image, "Z", &depth, &diag), &diag);
    return image;
}

static struct neph_mask *create_mask(const struct neph_image *image, const char *name)
{
    struct neph_mask *mask = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_mask_create(image, name, NULL, &mask, &diag), &diag);
    return mask;
}

/* The pixels outside of the edges. */
static void invert(struct neph_mask *mask)
{
    snprintf(mask->name, sizeof(mask->name), "beside");
    for (size_t i = 0; i < (size_t)W * H; i++)
        mask->inside[i] = !mask->inside[i];
    mask->pixel_count = (size_t)W * H - mask->pixel_count;
}

enum { ALL, EDGE, BESIDE, MASK_COUNT };

struct measured {
    struct neph_meter *meter;
    struct neph_mask *masks[MASK_COUNT];
};

static struct measured measure(defect_function *defect)
{
    struct measured measured;
    struct neph_diag diag = {0};
    uint64_t random = 20261121;
    struct neph_image *reference = create_frame(), *test = create_frame();
    fill_frame(reference, nothing, 0, &random);
    measured.masks[ALL] = create_mask(reference, "all");
    measured.masks[EDGE] = create_mask(reference, "depth_edge");
    measured.masks[BESIDE] = create_mask(reference, "depth_edge");
    invert(measured.masks[BESIDE]);
    const struct neph_meter_choice choice = {&neph_extractor_flicker,
                                             neph_options_default(neph_extractor_flicker.options)};
    const struct neph_meter_params params = {
        .choices = &choice,
        .choice_count = 1,
        .viewing = NEPH_VIEWING_DEFAULTS,
        .masks = (const struct neph_mask *const *)measured.masks,
        .mask_count = MASK_COUNT,
        .frame_count = N,
    };
    neph_assert_ok(neph_meter_create(&params, &measured.meter, &diag), &diag);
    for (int t = 0; t < N; t++) {
        fill_frame(test, defect, t, &random);
        neph_assert_ok(neph_meter_frame(measured.meter, reference, NULL, test, &diag), &diag);
    }
    neph_assert_ok(neph_meter_finish(measured.meter, &diag), &diag);
    neph_image_destroy(reference);
    neph_image_destroy(test);
    return measured;
}

static void finish(struct measured *measured)
{
    neph_meter_destroy(measured->meter);
    for (int m = 0; m < MASK_COUNT; m++)
        neph_mask_destroy(measured->masks[m]);
}

static double value_of(const struct measured *measured, const char *metric, int mask)
{
    int count = 0;
    const struct neph_measurement *all = neph_meter_measurements(measured->meter, &count);
    for (int i = 0; i < count; i++) {
        if (strcmp(all[i].metric->name, metric) != 0 ||
            strcmp(all[i].mask, measured->masks[mask]->name) != 0)
            continue;
        if (!all[i].defined)
            fail_msg("'%s' is undefined: %s", metric, all[i].undefined_because);
        return all[i].value;
    }
    fail_msg("no measurement '%s'", metric);
    return NAN;
}

static enum neph_flicker_kind verdict(const struct measured *measured, int mask)
{
    return neph_flicker_verdict(value_of(measured, "cyclic_share", mask),
                                value_of(measured, "restless_share", mask));
}

/* ---- tests ----------------------------------------------------------------------------------- */

static void test_defects_get_their_names(void **state)
{
    enum {
        CALM = NEPH_FLICKER_CALM,
        RESTLESS = NEPH_FLICKER_RESTLESS,
        CYCLIC = NEPH_FLICKER_CYCLIC
    };
    const struct {
        const char *name;
        defect_function *defect;
        int kinds[MASK_COUNT]; /* all, depth_edge, beside */
    } cases[] = {
        {"blinking fence", blinking_fence, {CYCLIC, CYCLIC, CALM}},
        {"alternating fence", alternating_fence, {CYCLIC, CYCLIC, CALM}},
        {"noise of equal energy", noise_of_equal_energy, {RESTLESS, RESTLESS, RESTLESS}},
        {"noisy fence", noisy_fence, {RESTLESS, RESTLESS, CALM}},
        {"trembling", trembling, {RESTLESS, RESTLESS, RESTLESS}},
        {"even fade", fade_even, {CALM, CALM, CALM}},
        {"smooth fade", fade_smooth, {CALM, CALM, CALM}},
        {"decay", fade_decaying, {CALM, CALM, CALM}},
        {"out and back", fade_out_and_back, {CALM, CALM, CALM}},
        {"cut", cut, {CALM, CALM, CALM}},
        {"nothing", nothing, {CALM, CALM, CALM}},
        {"everything", everything, {CYCLIC, CYCLIC, RESTLESS}},
        {"blinking wall", blinking_wall, {CYCLIC, CYCLIC, CYCLIC}},
        {"turning dither", turning_dither, {CYCLIC, CYCLIC, CYCLIC}},
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        struct measured measured = measure(cases[i].defect);
        for (int m = 0; m < MASK_COUNT; m++) {
            const enum neph_flicker_kind found = verdict(&measured, m);
            if ((int)found != cases[i].kinds[m])
                fail_msg("%s at %s: %s", cases[i].name, measured.masks[m]->name,
                         neph_flicker_kind_name(found));
        }
        finish(&measured);
    }
}

/* The values of the fence: a4 of h / 2, a2 of h / 4 only on the bars. The mask of edges is 7 px
 * wide, so a seventh of it blinks. Floats of linear light shift lumas by up to 2^-24. */
static void test_numbers_of_the_blinking_fence(void **state)
{
    struct measured measured = measure(blinking_fence);
    neph_assert_close(value_of(&measured, "a4_mean", ALL), 0.01 * 0.1, 1e-5, 0.0);
    neph_assert_close(value_of(&measured, "a4_p99", EDGE), 0.1, 1e-5, 0.0);
    neph_assert_close(value_of(&measured, "a2_p99", EDGE), 0.05, 1e-5, 0.0);
    neph_assert_close(value_of(&measured, "cyclic_share", EDGE), 1.0 / 7.0, 1e-12, 0.0);
    neph_assert_close(value_of(&measured, "a4_share_4", ALL), 0.01, 1e-12, 0.0);
    neph_assert_close(value_of(&measured, "a4_p95", BESIDE), 0.0, 0.0, 1e-7);
    /* 95 % of the other pixels are exactly 0: the ratio is at its floor of 1/1020. */
    neph_assert_close(neph_flicker_edge_ratio(value_of(&measured, "a4_p95", EDGE),
                                              value_of(&measured, "a4_p95", BESIDE)),
                      0.1 * 1020.0, 1e-5, 0.0);
    neph_assert_close(value_of(&measured, "flicker_frames", ALL), N, 0.0, 0.0);
    assert_true(value_of(&measured, "reference_a4_mean", ALL) == 0.0);
    finish(&measured);
}

/* By its mean deviation, noise of equal energy is far worse. The verdict depends on outliers and
 * their kind. */
static void test_the_mean_would_not_tell(void **state)
{
    struct measured fence = measure(blinking_fence), noise = measure(noise_of_equal_energy);
    assert_true(5.0 * value_of(&fence, "std_mean", ALL) < value_of(&noise, "std_mean", ALL));
    assert_true(value_of(&noise, "cyclic_share", ALL) <= NEPH_FLICKER_SHARE);
    assert_true(value_of(&fence, "cycle_share_p99", EDGE) > 0.999);
    assert_true(value_of(&noise, "cycle_share_mean", ALL) < 0.1);
    finish(&fence);
    finish(&noise);
}

static void test_a_turning_dither_cancels_in_blocks(void **state)
{
    struct measured dither = measure(turning_dither), wall = measure(blinking_wall);
    neph_assert_close(value_of(&dither, "a4_mean", ALL), 0.05, 1e-5, 0.0);
    neph_assert_close(value_of(&wall, "a4_mean", ALL), 0.05, 1e-5, 0.0);
    neph_assert_close(value_of(&dither, "block_a4_p99", ALL), 0.0, 0.0, 1e-7);
    neph_assert_close(value_of(&wall, "block_a4_mean", ALL), 0.05, 1e-5, 0.0);
    finish(&dither);
    finish(&wall);
}

static void test_pure_functions(void **state)
{
    neph_assert_close(neph_flicker_edge_ratio(0.02, 0.005), 4.0, 1e-15, 0.0);
    neph_assert_close(neph_flicker_edge_ratio(0.02, 0.0), 20.4, 1e-15, 0.0);
    neph_assert_close(neph_flicker_edge_ratio(0.0, 0.0), 0.0, 0.0, 0.0);
    assert_true(neph_flicker_reference_limited(0.3, 0.11));
    assert_false(neph_flicker_reference_limited(0.3, 0.09));
    assert_false(neph_flicker_reference_limited(0.0, 0.0));
    assert_int_equal(neph_flicker_verdict(0.0, 0.0), NEPH_FLICKER_CALM);
    assert_int_equal(neph_flicker_verdict(0.0, 0.01), NEPH_FLICKER_RESTLESS);
    assert_int_equal(neph_flicker_verdict(0.01, 0.01), NEPH_FLICKER_CYCLIC);
    assert_int_equal(neph_flicker_verdict(NEPH_FLICKER_SHARE, NEPH_FLICKER_SHARE),
                     NEPH_FLICKER_CALM);
    /* White noise keeps nearly all of its mad of 2 s / sqrt(pi); fades keep none. */
    neph_assert_close(neph_flicker_unrest(1.128, 5.0, 128), 1.128 - 10.0 / 127.0, 1e-12, 0.0);
    assert_true(neph_flicker_unrest(1.0 / 127.0, 1.0, 128) == 0.0);
}

enum { NOISE_RUNS = 4000, NOISE_PIXEL_COUNT = 16 * NOISE_RUNS };

static double white_noise(uint64_t *random)
{
    return 0.1 * normal(random);
}

/* Rare, and clamped to one value. */
static double fireflies(uint64_t *random)
{
    return (neph_test_uniform(random, 0.0, 1.0) < 0.06 ? 0.4 : 0.0) + 3e-4 * normal(random);
}

/* The number of noise pixels, of NOISE_PIXEL_COUNT, that are called cyclic. */
static int count_called_cyclic(double (*noise)(uint64_t *random), int frame_count)
{
    uint64_t random = 4;
    const struct neph_flicker_window window = neph_flicker_window_of(frame_count, true, false);
    int called = 0;
    for (int run = 0; run < NOISE_RUNS; run++) {
        struct neph_flicker_sums sums = {0};
        struct neph_arena memory = {0};
        struct neph_diag diag = {0};
        neph_assert_ok(
            neph_flicker_sums_begin(&sums, 16, 1, NEPH_FLICKER_VARIANCE_COUNT, &memory, &diag),
            &diag);
        for (int t = 0; t < frame_count; t += 4) {
            double rows[4][NEPH_FLICKER_LANES];
            const double *const frames[4] = {rows[0], rows[1], rows[2], rows[3]};
            for (int i = 0; i < 4 * NEPH_FLICKER_LANES; i++)
                rows[i / NEPH_FLICKER_LANES][i % NEPH_FLICKER_LANES] = noise(&random);
            const struct neph_flicker_weights weights = neph_flicker_weights_of(t, frame_count);
            neph_flicker_sums_add(&sums, 0, 1, &weights, frames);
        }
        for (int x = 0; x < 16; x++) {
            double values[NEPH_FLICKER_SUM_COUNT];
            neph_flicker_sums_of(&sums, x, 0, values);
            const struct neph_flicker_spectrum spectrum = neph_flicker_spectrum_of(&window, values);
            called += neph_flicker_is_cyclic(&spectrum);
        }
        neph_arena_finish(&memory);
    }
    return called;
}

/* A pixel of white noise is called cyclic once in 1e5, however strong the noise is. */
static void test_noise_is_not_called_cyclic(void **state)
{
    /* 64000 pixels at a level of 1e-5: Poisson with mean 0.64, above 6 once in 1e5. */
    assert_true(count_called_cyclic(white_noise, 32) <= 6);
}

/* The level is for normal noise; other noise is called cyclic more often, a mask is not. */
static void test_fireflies_are_not_called_cyclic(void **state)
{
    const double share_max = 0.5 * NEPH_FLICKER_SHARE;
    assert_true(count_called_cyclic(fireflies, 32) < share_max * NOISE_PIXEL_COUNT);
    assert_true(count_called_cyclic(fireflies, 64) < share_max * NOISE_PIXEL_COUNT);
}

#include "tests/main.h"
