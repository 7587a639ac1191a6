/* SPDX-License-Identifier: MIT
 *
 * Methods of the presets after the article and after other engines, on the device and in closed
 * form: weights, neighbourhood clamps, history rejection and fallback colours as published.
 */
#include "renderer/realtime/reconstruction/check_reconstruct.h"

#include "renderer/realtime/jitter.h"
#include "renderer/realtime/shared/check_reference_dither.h"

/* --- the article ------------------------------------------------------------------------------ */

/* The first slice of the noise advances by the golden ratio: 0.618034 of a turn per frame. */
static void test_a_slice_turns(void **state)
{
    OWNED(memory) uint32_t *ranks = calloc(NEPH_RT_NOISE_COUNT, sizeof(*ranks));
    uint64_t seed = 41;
    for (size_t i = 0; i < NEPH_RT_NOISE_COUNT; i++)
        ranks[i] = (uint32_t)(neph_test_random(&seed) % 4096);
    const struct cpu_dither dither = {0, ranks};
    for (int i = 0; i < 64; i++) {
        const int x = i * 5 % 64, y = i;
        const double first = cpu_dither(&dither, RT_DITHER_SPATIOTEMPORAL, x, y, 0, 0);
        for (uint32_t frame = 0; frame < 33; frame += 4) {
            const double value = cpu_dither(&dither, RT_DITHER_SLICE, x, y, frame, 0);
            const double turned = first + 0.6180339887498949 * frame;
            /* a value has 24 bits; the step has 32 bits, times 32 frames */
            neph_assert_close(value, turned - floor(turned), 0, 2 * 0x1p-24);
        }
    }
}

/* The article's slot override uses 1000 km for the sky, while 20 km are stored with rays: a ridge
 * at 18 km does not get rays of the sky. */
static void test_the_sky_of_the_override(void **state)
{
    OWNED(passes) struct test_passes test;
    test_open(*state, 20, 20, 1, &test, "override=parallel");
    test_fill(&test, RT_HALF_DEPTH, NEPH_GPU_FAR_M, 0, 0, 0);
    const int other = (cpu_default_slot(&test.view, 2, 2) + 2) % 4;
    const int *place = cpu_slot_place(&test.view, other);
    cpu_put_half(&test.cpu, RT_HALF_DEPTH, 4 + place[0], 4 + place[1], (float[4]){18000});
    test_passes_run(&test, "tile index");
    OWNED(memory) uint32_t *words = test_download(&test, RT_TILE);
    float tile[4];
    neph_rt_load(&test.view.targets[RT_TILE], words, 2 * test.view.targets[RT_TILE].width + 2,
                 tile);
    assert_int_equal((int)tile[0], other);
}

/* A history with its lookup position as its value, in half-resolution texels. For a static camera
 * the position differs by the two frames' jitter, or not at all. */
static void test_history_follows_the_jitter(void **state)
{
    static const struct {
        const char *assignments;
        double follows;
    } cases[] = {
        {"jittered_depth=on reproject_jitter=on", 1},
        {"jittered_depth=on reproject_jitter=off", 0},
        {"jittered_depth=off reproject_jitter=on", 0}, /* rays of media are not jittered */
    };
    for (int i = 0; i < 3; i++) {
        OWNED(passes) struct test_passes test;
        reconstruct_open(*state, 32, 24, &test, "box=none fresh_weight=0 target_format=float %s",
                         cases[i].assignments);
        const float now_px[2] = {0.25f, -0.375f}, before_px[2] = {-0.125f, 0.25f};
        memcpy(test.view.jitter_px, now_px, sizeof(now_px));
        memcpy(test.view.jitter_before_px, before_px, sizeof(before_px));
        for (size_t k = 0; k < test_elements(&test, RT_HISTORY); k++)
            test_set(&test, RT_HISTORY_BEFORE, k,
                     (float[4]){(float)(k % 16), (float)(k / 16), 0, 1});
        reconstruct_run(&test);
        float value[4];
        cpu_fetch_half(&test.cpu, RT_HISTORY, 7, 5, value);
        /* half a texel per pixel; float32 positions of up to 32 px */
        neph_assert_close(value[0], 7 + cases[i].follows * 0.1875, 0, 1e-5);
        neph_assert_close(value[1], 5 - cases[i].follows * 0.3125, 0, 1e-5);
    }
}

/* --- 3x3 rays -----------------------------------------------------------------------------------
 */

static const int order[9][2] = {{1, 1}, {2, 1}, {0, 1}, {1, 2}, {1, 0},
                                {2, 2}, {0, 2}, {2, 0}, {0, 0}};

/* Nine tiles with the light 1 to 9 in that order and one depth each. */
static void open_nine(struct neph_vulkan *vulkan, const char *assignments, const float depths_m[9],
                      struct test_passes *test)
{
    reconstruct_open(vulkan, 12, 12, test, "target_format=float %s", assignments);
    for (int i = 0; i < 9; i++) {
        const int *at = order[i];
        const float light = 1.0f + (float)i;
        float tile[4];
        int place[2];
        cpu_fetch_tile(&test->cpu, RT_TILE, at[0], at[1], tile);
        tile[1] = cpu_stored_depth_m(&test->view, depths_m[i]) * 1e-4f;
        cpu_put_tile(&test->cpu, RT_TILE, at[0], at[1], tile);
        cpu_put_tile(&test->cpu, RT_RAY, at[0], at[1], (float[4]){light, light, light, 1});
        reconstruct_marched(test, at[0], at[1], place);
        cpu_put_half(&test->cpu, RT_HALF_DEPTH, place[0], place[1], (float[4]){depths_m[i]});
    }
}

/* The texel of the middle tile beside its ray, which has no ray of its own. */
static void skipped_one(const struct test_passes *test, int half_pixel[2])
{
    reconstruct_marched(test, 1, 1, half_pixel);
    half_pixel[0] ^= 1;
}

/* A channel of that texel's result. */
static double skipped_value(const struct test_passes *test, int channel)
{
    int at[2];
    skipped_one(test, at);
    return half_value(test, RT_HISTORY, at[0], at[1], channel);
}

/* Squared distance from a texel of the middle tile to one of the nine rays, in tiles, and its
 * bilinear weight. */
static double distance_squared(const int half_pixel[2], int ray, double *bilinear)
{
    double sum = 0.0;
    *bilinear = 1.0;
    for (int axis = 0; axis < 2; axis++) {
        const double way = (half_pixel[axis] + 0.5) / 2 - (order[ray][axis] + 0.5);
        *bilinear *= fmax(1.0 - fabs(way), 0.0);
        sum += way * way;
    }
    return sum;
}

static const float mixed_m[9] = {100, 90, 104, 400, NEPH_GPU_FAR_M, 95, 130, NEPH_GPU_FAR_M, 50};

static double mean_of_nine(const int half_pixel[2], bool is_bilateral)
{
    double sum = 0.0, total = 0.0;
    for (int i = 0; i < 9; i++) {
        double weight;
        const double square = distance_squared(half_pixel, i, &weight);
        if (is_bilateral)
            weight = mixed_m[i] < NEPH_GPU_FAR_M ? exp(-square) / (fabs(100.0 - mixed_m[i]) + 2.0)
                                                 : 0.0;
        sum += weight * (1 + i);
        total += weight;
    }
    return sum / total;
}

static void test_fallback_colours(void **state)
{
    static const struct {
        const char *assignments;
        double expected; /* 0: a mean */
    } cases[] = {
        {"fallback=nearest", 1},
        {"fallback=around", 3}, /* 104 m */
        {"fallback=tile", 1},
        {"fallback=bilinear", 0},
        {"fallback=bilateral upscale_tolerance_m=2", 0},
    };
    for (int i = 0; i < 5; i++) {
        OWNED(passes) struct test_passes test;
        open_nine(*state, cases[i].assignments, mixed_m, &test);
        test.view.has_history = 0;
        int at[2];
        skipped_one(&test, at);
        cpu_put_half(&test.cpu, RT_HALF_DEPTH, at[0], at[1], (float[4]){100});
        reconstruct_run(&test);
        const double expected = cases[i].expected ? cases[i].expected : mean_of_nine(at, i == 4);
        /* nine sums and products in float32 */
        neph_assert_close(half_value(&test, RT_HISTORY, at[0], at[1], 0), expected, 2e-6, 0);
    }
}

/* A history that is rejected because of the scene uses fallback_rejected; off the screen or in a
 * first frame it uses fallback. */
static void test_rejected_is_not_absent(void **state)
{
    for (int is_rejected = 0; is_rejected < 2; is_rejected++) {
        OWNED(passes) struct test_passes test;
        open_nine(*state, "fallback=tile fallback_rejected=around reject_depth=0.1", mixed_m,
                  &test);
        int at[2];
        skipped_one(&test, at);
        cpu_put_half(&test.cpu, RT_HALF_DEPTH, at[0], at[1], (float[4]){100});
        test_fill(&test, RT_HALF_DEPTH_BEFORE, 500, 0, 0, 0);
        test.view.has_history = (uint32_t)is_rejected;
        reconstruct_run(&test);
        assert_true(half_value(&test, RT_HISTORY, at[0], at[1], 0) == (is_rejected ? 3.0f : 1.0f));
    }
}

/* --- rejection ----------------------------------------------------------------------------------
 */

static int count_void(struct test_passes *test)
{
    int count = 0;
    for (size_t i = 0; i < test_elements(test, RT_HISTORY_STATE); i++) {
        float value[4];
        test_get(test, RT_HISTORY, i, value);
        count += value[0] == 0.0f;
    }
    return count;
}

/* Bright history, dark rays, no fresh texel. */
static void open_bright(struct neph_vulkan *vulkan, const char *assignments,
                        struct test_passes *test)
{
    reconstruct_open(vulkan, 32, 24, test, "box=none fresh_weight=0 %s", assignments);
    test_fill(test, RT_HISTORY_BEFORE, 1, 1, 1, 1);
}

/* The depth test compares one texel, or 3x3; or one texel unless the wind has moved the history by
 * more than an eighth of a pixel: here 1 m is a quarter. */
static void test_texels_of_the_rejection_test(void **state)
{
    static const struct {
        const char *around;
        float wind_m;
        int rejected;
    } cases[] = {{"on", 0.0f, 0},    {"off", 0.0f, 1},   {"moved", 0.0f, 1},
                 {"moved", 0.3f, 1}, {"moved", 1.0f, 0}, {"off", 1.0f, 1}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        OWNED(passes) struct test_passes test;
        char words[64];
        snprintf(words, sizeof(words), "reject_depth=0.1 reject_around=%s", cases[i].around);
        open_bright(*state, words, &test);
        test.view.wind_m[0] = cases[i].wind_m;
        cpu_put_half(&test.cpu, RT_HALF_DEPTH_BEFORE, 7, 6, (float[4]){50});
        reconstruct_run(&test);
        assert_int_equal(count_void(&test), cases[i].rejected);
    }
}

/* Static history is multiplied with the history gain, per channel; moving history by half at one
 * and a half times box_motion_px, and fully at 0. */
static void test_history_is_relit(void **state)
{
    static const struct {
        const char *words;
        double parts; /* relative to box_motion_px */
        double expected[3];
    } cases[] = {{"relight=0.1", 0.0, {0.98, 1.0, 1.04}},
                 {"relight=0", 0.0, {1.0, 1.0, 1.0}},
                 {"relight=0.1", 1.5, {0.99, 1.0, 1.02}},
                 {"relight=0.1", 2.0, {1.0, 1.0, 1.0}}};
    const double px_per_m = 32.0 / (2.0 * 100.0 * 0.4663077 * 32.0 / 24.0);
    for (size_t i = 0; i < COUNT(cases); i++) {
        OWNED(passes) struct test_passes test;
        char words[128];
        snprintf(words, sizeof(words),
                 "target_format=float gradient=on box_motion_px=1 box_change=1 %s", cases[i].words);
        open_bright(*state, words, &test);
        test_fill(&test, RT_CHANGE, 0.98f, 1.0f, 1.04f, 0.0f);
        test.view.wind_m[0] = (float)(cases[i].parts / px_per_m);
        reconstruct_run(&test);
        float value[4];
        cpu_fetch_half(&test.cpu, RT_HISTORY, 8, 6,
                       value); /* in the middle, where rays are level */
        for (int c = 0; c < 3; c++)
            neph_assert_close(value[c], cases[i].expected[c], 0.0, 1e-3);
    }
}

/* --- the neighbourhood clamp ---------------------------------------------------------------- */

/* Rays of (1, 1, 1) and (3, 2, 1), transmittances 0.2 and 0.6: the range of the clamp has the
 * middle (2, 1.5, 1) and the half-widths (1, 0.5, 0). */
static void open_box(struct neph_vulkan *vulkan, const char *assignments, const float history[4],
                     float age, struct test_passes *test)
{
    reconstruct_open(vulkan, 12, 12, test, "target_format=float %s", assignments);
    test_fill(test, RT_RAY, 1, 1, 1, 0.2f);
    cpu_put_tile(&test->cpu, RT_RAY, 2, 2, (float[4]){3, 2, 1, 0.6f});
    test_fill(test, RT_HISTORY_BEFORE, history[0], history[1], history[2], history[3]);
    test_fill(test, RT_HISTORY_STATE_BEFORE, age, 100, 0, 0);
}

/* Clipping moves towards the middle: (6, 2, 1) keeps a quarter of the way, along red. Clamping
 * gives (3, 2, 1). */
static void test_colours_are_clipped(void **state)
{
    static const struct {
        const char *assignments;
        float history[4];
        double expected[4];
        double age, expected_age;
    } cases[] = {
        {"box_hold=clip", {6, 2, 1, 0.9f}, {3, 1.625, 1, 0.6}, 8, 8},
        {"box_hold=clamp", {6, 2, 1, 0.9f}, {3, 2, 1, 0.6}, 8, 8},
        {"box_hold=clip history_age_max=16 box_age=0.5", {6, 2, 1, 0.9f}, {3, 1.625, 1, 0.6}, 8, 4},
        {"box_hold=clip history_age_max=16 box_age=0.5",
         {6, 2, 1, 0.9f},
         {3, 1.625, 1, 0.6},
         200,
         8},
        {"box_hold=clip history_age_max=16 box_age=0.5", {6, 2, 1, 0.9f}, {3, 1.625, 1, 0.6}, 1, 1},
        /* no loss of age for transmittance only, nor inside the range */
        {"box_hold=clip history_age_max=16 box_age=0.5",
         {2, 1.5f, 1, 0.9f},
         {2, 1.5, 1, 0.6},
         8,
         8},
        /* the range has no width along blue: its middle */
        {"box_hold=clip", {2.5f, 1.5f, 5, 0.4f}, {2, 1.5, 1, 0.4f}, 8, 8},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        OWNED(passes) struct test_passes test;
        open_box(*state, cases[i].assignments, cases[i].history, (float)cases[i].age, &test);
        reconstruct_run(&test);
        int at[2];
        skipped_one(&test, at);
        for (int c = 0; c < 4; c++)
            neph_assert_close(skipped_value(&test, c), cases[i].expected[c], 1e-6, 0);
        neph_assert_close(half_value(&test, RT_HISTORY_STATE, at[0], at[1], 0),
                          cases[i].expected_age, 1e-6, 0);
    }
}

/* HDRP's running mean: a history of n rays weighs v f n / (n + 1), with v = 1/2 if it was clipped,
 * and f its accumulation factor. */
static void test_a_fading_mean(void **state)
{
    static const struct {
        float history[4];
        double held, part;
    } cases[] = {{{2, 1.5f, 1, 0.4f}, 2, 1}, {{6, 2, 1, 0.4f}, 3, 0.5}};
    for (int i = 0; i < 2; i++) {
        OWNED(passes) struct test_passes test;
        open_box(*state, "box_hold=clip history_age_max=16 history_fade=0.95 box_age=0.5",
                 cases[i].history, 8, &test);
        reconstruct_run(&test);
        int at[2];
        reconstruct_marched(&test, 1, 1, at);
        const double weight = cases[i].part * 0.95 * 8 / 9;
        neph_assert_close(half_value(&test, RT_HISTORY, at[0], at[1], 0),
                          1 + weight * (cases[i].held - 1), 1e-6, 0);
        neph_assert_close(half_value(&test, RT_HISTORY_STATE, at[0], at[1], 0), 9, 0, 0);
    }
}

/* Rays of solids have the light 1 to 9 except for the sky's, 5 and 8, which do not count for
 * solids. */
static void test_the_sky_is_not_in_the_box_of_solids(void **state)
{
    static const char *const assignments[] = {"box_depth=1e6 box_same_kind=off",
                                              "box_depth=1e6 box_same_kind=on"};
    static const float depths_m[9] = {100, 100, 100, 100, 100, 100, 100, 100, NEPH_GPU_FAR_M};
    for (int i = 0; i < 2; i++) {
        OWNED(passes) struct test_passes test;
        open_nine(*state, assignments[i], depths_m, &test);
        test_fill(&test, RT_HISTORY_BEFORE, 20, 20, 20, 1);
        reconstruct_run(&test);
        assert_true(skipped_value(&test, 0) == (i ? 8.0f : 9.0f));
    }
}

/* c52e mixes in x / (1 + x): a fifth of the way from 3/4 to 1/2 is 0.7, which is 7/3. */
static void test_fresh_rays_are_mixed_tone_mapped(void **state)
{
    OWNED(passes) struct test_passes test;
    reconstruct_open(*state, 12, 12, &test,
                     "box=none fresh_weight=0.2 fresh_space=channels target_format=float");
    test_fill(&test, RT_RAY, 1, 3, 0, 0.5f);
    test_fill(&test, RT_HISTORY_BEFORE, 3, 3, 0, 1);
    reconstruct_run(&test);
    int at[2];
    reconstruct_marched(&test, 1, 1, at);
    const double expected[4] = {7.0 / 3.0, 3, 0, 0.9};
    for (int c = 0; c < 4; c++)
        neph_assert_close(half_value(&test, RT_HISTORY, at[0], at[1], c), expected[c], 1e-6, 0);
}

/* --- the upscale --------------------------------------------------------------------------------
 */

/* A view of 12x12 pixels; all texels but one have the light 0, all have one depth. */
static void open_upscale(struct neph_vulkan *vulkan, const char *assignments,
                         struct test_passes *test)
{
    test_open(vulkan, 12, 12, 3, test, "upscale_dither=none target_format=float %s", assignments);
    test_fill(test, RT_DEPTH, 100, 0, 0, 0);
    test_fill(test, RT_HALF_DEPTH, 100, 0, 0, 0);
    test_fill(test, RT_HISTORY, 0, 0, 0, 1);
    test_fill(test, RT_HISTORY_STATE, 1, 100, 0, 0);
}

/* Light of pixel (6, 6). */
static double upscale(struct test_passes *test)
{
    float value[4];
    test_passes_run(test, "upscale");
    test_take(test, RT_VOLUME);
    cpu_fetch_full(&test->cpu, RT_VOLUME, 6, 6, value);
    return value[0];
}

/* HDRP's published weights for the upper left pixel of a texel, row by row. */
static void test_square_weights_are_the_published(void **state)
{
    static const double weights[9] = {0.324652, 0.535261, 0.119433, 0.535261, 0.882497,
                                      0.196912, 0.119433, 0.196912, 0.0439369};
    double total = 0.0;
    for (int i = 0; i < 9; i++)
        total += weights[i];
    for (int i = 0; i < 9; i++) {
        OWNED(passes) struct test_passes test;
        open_upscale(*state, "upscale=square", &test);
        cpu_put_half(&test.cpu, RT_HISTORY, 2 + i % 3, 2 + i / 3, (float[4]){1, 0, 0, 1});
        neph_assert_close(upscale(&test), weights[i] / total, 0, 1e-6); /* of six digits */
    }
}

/* Pixel (6, 6) is at 3/4 between texels 2 and 3, along both axes. */
static void test_inverse_weights(void **state)
{
    static const struct {
        const char *assignments;
        float other_m; /* depth of three taps; the fourth, of light 1, has the pixel's depth */
        double expected;
    } cases[] = {
        {"upscale=inverse upscale_depth=0.1", 109, 0.5625},
        {"upscale=inverse upscale_depth=0.1", 111, 1 / (1 + 3 / 12.0)},
        {"upscale=inverse upscale_depth=0.1 upscale_tolerance_m=11", 111, 1 / (1 + 3 / 2.0)},
        {"upscale=inverse upscale_same_kind=on", NEPH_GPU_FAR_M, 1},
        {"upscale=bilinear upscale_same_kind=on", NEPH_GPU_FAR_M, 1},
        {"upscale=bilinear upscale_same_kind=off", NEPH_GPU_FAR_M, 0.5625},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        OWNED(passes) struct test_passes test;
        open_upscale(*state, cases[i].assignments, &test);
        test_fill(&test, RT_HALF_DEPTH, cases[i].other_m, 0, 0, 0);
        cpu_put_half(&test.cpu, RT_HALF_DEPTH, 3, 3, (float[4]){100});
        cpu_put_half(&test.cpu, RT_HISTORY, 3, 3, (float[4]){1, 0, 0, 1});
        neph_assert_close(upscale(&test), cases[i].expected, 1e-6, 0);
    }
}

/* Transmittances of 0.99 and 0.97 differ by 2 % of the larger, and by two thirds of the opacity. */
static void test_contrast_of_opacity(void **state)
{
    static const char *const assignments[] = {
        "upscale=nearest upscale_contrast=0.2 contrast=transmittance",
        "upscale=nearest upscale_contrast=0.2 contrast=opacity"};
    for (int i = 0; i < 2; i++) {
        OWNED(passes) struct test_passes test;
        open_upscale(*state, assignments[i], &test);
        test_fill(&test, RT_HALF_DEPTH, 500, 0, 0, 0);
        test_fill(&test, RT_HISTORY, 0, 0, 0, 0.97f);
        cpu_put_half(&test.cpu, RT_HALF_DEPTH, 2, 2, (float[4]){100});
        cpu_put_half(&test.cpu, RT_HISTORY, 2, 2, (float[4]){1, 0, 0, 0.99f});
        neph_assert_close(upscale(&test), i ? 1.0 : 0.25, 1e-6, 0);
    }
}

/* --- lengths of the jitter ----------------------------------------------------------------------
 */

/* Number of jitter positions out of `length` that a slot marched every four frames gets: all of
 * them within 4 length / gcd(4, length) frames. Of 8 a slot gets 2, of 7 all 7, in 28 frames. */
static int places_of_a_slot(int length)
{
    double seen[64][2];
    int count = 0;
    for (uint32_t frame = 0; frame < 4 * 64; frame += 4) {
        double place_px[2];
        neph_rt_jitter(RT_JITTER_UE, length, frame, place_px);
        int k = 0;
        while (k < count && memcmp(seen[k], place_px, sizeof(place_px)))
            k++;
        if (k == count)
            memcpy(seen[count++], place_px, sizeof(place_px));
    }
    return count;
}

static void test_lengths_of_the_jitter(void **state)
{
    for (int length = 1; length <= 64; length++) {
        const int shared = length % 4 == 0 ? 4 : length % 2 == 0 ? 2 : 1;
        assert_int_equal(places_of_a_slot(length), length / shared);
        char assignment[64];
        snprintf(assignment, sizeof(assignment), "taa_jitter_length=%d", length);
        assert_true(test_settings(assignment).values[RT_TAA_JITTER_LENGTH] == length);
    }
    assert_int_equal(places_of_a_slot(8), 2);
    assert_int_equal(places_of_a_slot(7), 7);
}

#include "tests/renderer/main.h"
