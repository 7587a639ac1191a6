/* SPDX-License-Identifier: MIT
 *
 * Tests of one frame of temporal anti-aliasing against its CPU reference, with bad numbers, and of
 * its neighbourhood, motion and clamp against closed forms; and of the jitter. The blend:
 * check_blend.c. Many frames: check_film.c. */
#include "renderer/realtime/anti_aliasing/check_taa.h"

#include "renderer/realtime/jitter.h"

/* --- jitter -------------------------------------------------------------------------------- */

/* Values from an analysis of Unreal Engine 4.26's jitter; printed with 9 digits from float32. */
static void test_the_eight_places_are_those_of_unreal(void **state)
{
    static const double listed_px[8][2] = {
        {-0.163972363, 0.284008324},   {-0.208000556, -0.360267729}, {0.172162965, 0.144461900},
        {-0.430473328, 0.156679258},   {0.0485312343, -0.275233328}, {0.0647613853, 0.367280841},
        {-0.147184864, -0.0535709597}, {0.366960347, -0.307915747},
    };
    double sum_px[2] = {0.0, 0.0};
    for (uint32_t i = 0; i < 16; i++) {
        double offset_px[2];
        neph_rt_jitter(RT_JITTER_UE, 8, i, offset_px);
        for (int axis = 0; axis < 2; axis++) {
            neph_assert_close(offset_px[axis], listed_px[i % 8][axis], 0.0, 1e-6);
            sum_px[axis] += offset_px[axis] / 16.0;
        }
    }
    /* The mean offset of the image; published with three digits. */
    neph_assert_close(sum_px[0], -0.037, 0.0, 5e-4);
    neph_assert_close(sum_px[1], -0.006, 0.0, 5e-4);
}

static void test_jitter_stays_in_the_pixel_and_repeats(void **state)
{
    static const int kinds[] = {RT_JITTER_NONE, RT_JITTER_UE, RT_JITTER_HALTON};
    for (int k = 0; k < 3; k++)
        for (int length = 1; length <= 64; length++)
            for (uint32_t i = 0; i < 64; i++) {
                double offset_px[2], again_px[2];
                neph_rt_jitter(kinds[k], length, i, offset_px);
                neph_rt_jitter(kinds[k], length, i + 3 * (uint32_t)length, again_px);
                assert_memory_equal(offset_px, again_px, sizeof(offset_px));
                const double most_px = k == 0 ? 0.0 : 0.5;
                assert_true(fabs(offset_px[0]) <= most_px && fabs(offset_px[1]) <= most_px);
            }
    double offset_px[2];
    neph_rt_jitter(RT_JITTER_HALTON, 8, 5, offset_px); /* 6 = 110 in base 2, 20 in base 3 */
    neph_assert_close(offset_px[0], 3.0 / 8.0 - 0.5, 0.0, 1e-15);
    neph_assert_close(offset_px[1], 2.0 / 9.0 - 0.5, 0.0, 1e-15);
}

/* --- views, pictures, cameras ---------------------------------------------------------------- */

static const int sizes_px[][2] = {{1, 1}, {2, 3}, {5, 4}, {64, 36}, {127, 33}, {641, 363}};
enum { SIZES = COUNT(sizes_px) };

static void run(struct test_passes *test)
{
    test_passes_run(test, "anti-aliasing");
    test_take(test, RT_TAA_OUT);
}

/* --- against the CPU reference ---------------------------------------------------------------- */

static void test_the_pass_equals_the_cpu_reference(void **state)
{
    uint64_t seed = 1;
    int resting = 0; /* static frames with a GPU's kernel: odd seeds compile it on any device */
    for (int round = 0; round < 120; round++) {
        const uint64_t start = seed;
        char text[768];
        struct neph_settings settings = random_settings(&seed, text, sizeof(text));
        if (round % 4 == 0)
            settings.values[RT_SOLID_MOTION] = settings.values[RT_WIND] = 0;
        const int size = round == 60 && neph_test_is_night() ? SIZES - 1 : round % (SIZES - 1);
        const int origin_px[2] = {round % 3 * 4, round % 2 * 8};
        OWNED(passes) struct test_passes test;
        test_passes_open(*state, &settings, sizes_px[size], origin_px, start, &test);
        test.view.is_cut = round % 8 == 1;
        if (round % 8 >= 6)
            test_make_parallel(&test.view, 5.0f);
        const double most = fill_round(&test, round, &seed);
        test_passes_run(&test, "anti-aliasing");
        cpu_taa(&test.cpu);
        compare(&test, most, start, text);
        resting += neph_rt_is_view_static(&test.view) && test.device.kind == NEPH_RT_GPU;
    }
    assert_true(resting >= 8);
}

/* In all settings, with invalid numbers in frame and history. The output is a valid colour and
 * equals the CPU reference, within a tolerance relative to the largest representable number,
 * 65504. */
static void test_the_guard_keeps_bad_numbers_out(void **state)
{
    static const float bad[] = {NAN, INFINITY, -INFINITY, -1.0f, 1e30f, -1e30f, 0.0f};
    uint64_t seed = 20261122;
    for (int round = 0; round < 40; round++) {
        const uint64_t start = seed;
        char text[768];
        struct neph_settings settings = random_settings(&seed, text, sizeof(text));
        settings.values[RT_TAA_GUARD] = 1;
        OWNED(passes) struct test_passes test;
        test_passes_open(*state, &settings, sizes_px[round % (SIZES - 1)], (int[2]){0, 0}, start,
                         &test);
        test.view.has_history = round % 8 != 0;
        move_camera(&test.view, 0.02, 0.1, &seed);
        fill_depths(&test, &seed);
        for (int t = 0; t < 2; t++) {
            const int target = t ? RT_COLOR : RT_TAA_BEFORE;
            fill_colours(&test, target, 1.0, &seed);
            const uint64_t one_in = (uint64_t[]){1, 3, 30}[neph_test_random(&seed) % 3];
            for (size_t i = 0; i < test_elements(&test, target); i++) {
                float colour[4];
                test_get(&test, target, i, colour);
                if (neph_test_random(&seed) % one_in == 0)
                    colour[neph_test_random(&seed) % 3] = bad[neph_test_random(&seed) % 7];
                test_set(&test, target, i, colour);
            }
        }
        test_passes_run(&test, "anti-aliasing");
        cpu_taa(&test.cpu);
        compare(&test, 65504.0, start, text);
        test_take(&test, RT_TAA_OUT);
        for (size_t i = 0; i < test_elements(&test, RT_TAA_OUT); i++) {
            float colour[4];
            test_get(&test, RT_TAA_OUT, i, colour);
            for (int c = 0; c < 3; c++)
                if (!(colour[c] >= 0.0f && colour[c] <= 65504.0f))
                    fail_msg("seed %llu, %s: %g", (unsigned long long)start, text,
                             (double)colour[c]);
        }
    }
}

/* --- motion ---------------------------------------------------------------------------------- */

/* Place in the frame before of the point at `depth_m` behind a pixel's centre, in double. */
static bool place_before(const struct neph_gpu_view *view, int x, int y, double depth_m,
                         double place_px[2])
{
    const struct neph_gpu_view_camera *now = &view->now, *before = &view->before;
    const double right = (2.0 * (x + 0.5) / view->size_px[0] - 1.0) * now->half_width;
    const double up = (1.0 - 2.0 * (y + 0.5) / view->size_px[1]) * now->half_height;
    const double spread_m = now->is_parallel ? 1.0 : depth_m;
    double across = 0.0, height = 0.0, depth = 0.0;
    for (int c = 0; c < 3; c++) {
        const double point = now->forward[c] + right * now->right[c] + up * now->up[c] -
                             before->position_m[c] / spread_m;
        across += point * before->right[c];
        height += point * before->up[c];
        depth += point * before->forward[c];
    }
    if (now->is_parallel)
        depth = 1.0;
    place_px[0] = view->size_px[0] * (0.5 + 0.5 * across / (depth * before->half_width));
    place_px[1] = view->size_px[1] * (0.5 - 0.5 * height / (depth * before->half_height));
    return depth > 0.0 && place_px[0] > 0.0 && place_px[0] < view->size_px[0] &&
           place_px[1] > 0.0 && place_px[1] < view->size_px[1];
}

/* Whether the place is too close to a side to decide whether it is in the frame. */
static bool is_at_a_side(const double place_px[2], const int size_px[2])
{
    for (int axis = 0; axis < 2; axis++)
        if (fabs(place_px[axis]) < motion_error_px ||
            fabs(place_px[axis] - size_px[axis]) < motion_error_px)
            return true;
    return false;
}

static double nearest_of_five_m(const struct test_passes *test, int x, int y)
{
    double nearest_m = pixel_value(test, RT_DEPTH, x, y, 0);
    for (int i = 0; i < 4; i++)
        nearest_m = fmin(
            nearest_m, pixel_value(test, RT_DEPTH, x + (i % 2 ? 2 : -2), y + (i / 2 ? 2 : -2), 0));
    return nearest_m;
}

/* The history's colours are the places of its pixels, which a bilinear filter reproduces. */
static void test_the_history_comes_from_where_things_were(void **state)
{
    uint64_t seed = 7;
    static const char *const motions[] = {"taa_motion=centre", "taa_motion=cross"};
    static const int size_px[2] = {127, 33};
    for (int round = 0; round < 10; round++) {
        char text[256];
        snprintf(text, sizeof(text),
                 "%s taa_filter=off taa_box=none taa_alpha=0 taa_hdr_weight=off taa_contrast=0 "
                 "taa_history=bilinear target_format=float",
                 motions[round % 2]);
        const struct neph_settings settings = test_settings(text);
        OWNED(passes) struct test_passes test;
        test_passes_open(*state, &settings, size_px, (int[2]){4, 8}, seed, &test);
        test.view.has_history = 1;
        if (round >= 8)
            test_make_parallel(&test.view, 1.0f);
        move_camera(&test.view, round < 8 ? 0.1 : 0.0,
                    round < 4    ? 0.2
                    : round >= 8 ? 0.5
                                 : 0.0,
                    &seed);
        fill_depths(&test, &seed);
        for (int y = 0; y < size_px[1]; y++)
            for (int x = 0; x < size_px[0]; x++) {
                cpu_put_full(&test.cpu, RT_TAA_BEFORE, x, y,
                             (float[4]){(float)x + 0.5f, (float)y + 0.5f, 1.0f});
                cpu_put_full(&test.cpu, RT_COLOR, x, y, (float[4]){0.0f, 0.0f, 2.0f});
            }
        run(&test);
        int inside = 0, outside = 0;
        for (int y = 0; y < size_px[1]; y++)
            for (int x = 0; x < size_px[0]; x++) {
                double place_px[2];
                const double depth_m = round % 2 ? nearest_of_five_m(&test, x, y)
                                                 : pixel_value(&test, RT_DEPTH, x, y, 0);
                const bool is_in = place_before(&test.view, x, y, depth_m, place_px);
                if (is_at_a_side(place_px, size_px))
                    continue;
                assert_int_equal(pixel_value(&test, RT_TAA_OUT, x, y, 2) < 1.5, is_in);
                inside += is_in;
                outside += !is_in;
                for (int axis = 0; axis < 2 && is_in; axis++) {

                    const double held_px = fmin(fmax(place_px[axis], 0.5), size_px[axis] - 0.5);
                    /* the frame, which is black here, has more weight in moving pixels */
                    const double weight = pixel_value(&test, RT_TAA_OUT, x, y, 2) - 1.0;
                    neph_assert_close(pixel_value(&test, RT_TAA_OUT, x, y, axis) / (1.0 - weight),
                                      held_px, 0.0, motion_error_px);
                }
            }
        assert_true(inside > 1000 && outside > 100);
    }
}

/* --- the frame, resets ----------------------------------------------------------------------- */

/* Without history the output is the filtered frame, for any contents of the history. */
static void test_a_cut_and_the_first_frame_take_nothing_over(void **state)
{
    static const struct {
        const char *cut_reset;
        uint32_t has_history, is_cut;
        bool is_reset;
    } cases[] = {{"on", 0, 0, true},  {"off", 0, 0, true},  {"on", 1, 1, true},
                 {"on", 1, 0, false}, {"off", 1, 1, false}, {"off", 1, 0, false}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        OWNED(passes) struct test_passes test;
        uint64_t seed = 3;
        test_open(*state, 64, 36, seed, &test, "taa_filter=off taa_box=none cut_reset=%s",
                  cases[i].cut_reset);
        test.view.has_history = cases[i].has_history;
        test.view.is_cut = cases[i].is_cut;
        fill_depths(&test, &seed);
        test_fill(&test, RT_COLOR, 1, 0.5f, 0.25f, 0);
        test_fill(&test, RT_TAA_BEFORE, 7, 8, 9, 0);
        run(&test);
        for (int y = 0; y < 36; y++)
            for (int x = 0; x < 64; x++)
                assert_int_equal(pixel_value(&test, RT_TAA_OUT, x, y, 0) == 1.0, cases[i].is_reset);
    }
}

/* A lit pixel spreads with the weights exp(-2.29 d^2) of the distance of its ray from the other
 * pixels' centres. Colours of a ramp, rendered with jittered rays, are the same as without jitter:
 * to
 * 0.04 px, the accuracy of nine samples of the Gaussian. A driver's exp(x) is off by up to 3 + 2
 * |x| ulps, here 25. */
static void test_the_filter_is_about_the_unjittered_place(void **state)
{
    OWNED(passes) struct test_passes test;
    test_open(*state, 16, 16, 0, &test, "target_format=float taa_hdr_weight=off");
    for (uint32_t frame = 0; frame < 8; frame++) {
        double jitter_px[2];
        neph_rt_jitter(RT_JITTER_UE, 8, frame, jitter_px);
        for (int axis = 0; axis < 2; axis++)
            test.view.jitter_px[axis] = (float)jitter_px[axis];
        for (int y = 0; y < 16; y++)
            for (int x = 0; x < 16; x++)
                cpu_put_full(&test.cpu, RT_COLOR, x, y,
                             (float[4]){x == 8 && y == 8, (float)(x + jitter_px[0]) + 1.0f,
                                        (float)(y + jitter_px[1]) + 1.0f});
        run(&test);
        double sum = 0.0;
        for (int i = 0; i < 9; i++)
            sum += exp(-2.29 *
                       (pow(i % 3 - 1 + jitter_px[0], 2) + pow(i / 3 - 1 + jitter_px[1], 2)));
        for (int y = 1; y < 15; y++)
            for (int x = 1; x < 15; x++) {
                const double distance = pow(8 - x + jitter_px[0], 2) + pow(8 - y + jitter_px[1], 2);
                const bool is_near = abs(8 - x) <= 1 && abs(8 - y) <= 1;
                neph_assert_close(pixel_value(&test, RT_TAA_OUT, x, y, 0),
                                  is_near ? exp(-2.29 * distance) / sum : 0.0, 64.0 * float_ulp,
                                  0.0);
                neph_assert_close(pixel_value(&test, RT_TAA_OUT, x, y, 1), x + 1.0, 0.0, 0.04);
                neph_assert_close(pixel_value(&test, RT_TAA_OUT, x, y, 2), y + 1.0, 0.0, 0.04);
            }
    }
}

/* --- the box --------------------------------------------------------------------------------- */

/* A history that is too bright is clamped to the box's upper limit. One colour of nine is 1: at the
 * centre, at a side and at a corner of the 3x3 pixels. */
static void test_the_box_is_that_of_its_name(void **state)
{
    static const struct {
        const char *settings;
        float jitter_px[2];
        double centre, side, corner;
    } cases[] = {
        {"taa_box=none", {0, 0}, 5.0, 5.0, 5.0},
        /* mean of the plus' and the square's extremes */
        {"taa_box=min_max", {0, 0}, 1.0, 1.0, 0.5},
        /* 1/9 + 1.25 sqrt(1/9 - 1/81), or the filtered colour */
        {"taa_box=variance", {0, 0}, 1.0, 0.503948212, 0.503948212},
        {"taa_box=variance taa_sigma=2", {0, 0}, 1.0, 0.739650472, 0.739650472},
        {"taa_box=variance taa_sigma=0", {0, 0}, 1.0, 0.111111111, 0.111111111},
        /* rays within 1.51 px: all, unless the jitter shifts them away; the corner is at 1.41 px */
        {"taa_box=distance", {0, 0}, 1.0, 1.0, 1.0},
        {"taa_box=distance", {0.2f, 0}, 1.0, 1.0, 0.0},
        {"taa_box=distance", {-0.2f, 0}, 1.0, 1.0, 1.0},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        OWNED(passes) struct test_passes test;
        test_open(
            *state, 8, 8, 0, &test,
            "taa_filter=off taa_alpha=0 taa_contrast=0 target_format=float taa_space=linear %s",
            cases[i].settings);
        test.view.has_history = 1;
        memcpy(test.view.jitter_px, cases[i].jitter_px, sizeof(cases[i].jitter_px));
        test_fill(&test, RT_DEPTH, 1, 0, 0, 0);
        test_fill(&test, RT_TAA_BEFORE, 5, 5, 5, 0);
        cpu_put_full(&test.cpu, RT_COLOR, 4, 4, (float[4]){1.0f, 1.0f, 1.0f});
        run(&test);
        neph_assert_close(pixel_value(&test, RT_TAA_OUT, 4, 4, 1), cases[i].centre, 1e-6, 0.0);
        neph_assert_close(pixel_value(&test, RT_TAA_OUT, 3, 4, 1), cases[i].side, 1e-6, 0.0);
        neph_assert_close(pixel_value(&test, RT_TAA_OUT, 3, 3, 1), cases[i].corner, 1e-6, 0.0);
    }
}

/* In YCoCg the box of greys is a line: a coloured history loses its colour there, but not in
 * RGB. */
static void test_the_space_of_the_box_matters(void **state)
{
    static const struct {
        const char *space;
        double red, blue;
    } cases[] = {{"linear", 0.9, 0.1}, {"reinhard", 0.9, 0.1}, {"ycocg", 0.5, 0.5}};
    for (int i = 0; i < 3; i++) {
        OWNED(passes) struct test_passes test;
        test_open(*state, 8, 8, 0, &test,
                  "taa_filter=off taa_alpha=0 taa_contrast=0 target_format=float taa_space=%s",
                  cases[i].space);
        test.view.has_history = 1;
        for (size_t e = 0; e < 64; e++) {
            const float grey = e % 2 ? 1.0f : 0.0f;
            test_set(&test, RT_DEPTH, e, (float[4]){1.0f});
            test_set(&test, RT_COLOR, e, (float[4]){grey, grey, grey});
            test_set(&test, RT_TAA_BEFORE, e, (float[4]){0.9f, 0.5f, 0.1f});
        }
        run(&test);
        neph_assert_close(pixel_value(&test, RT_TAA_OUT, 4, 4, 0), cases[i].red, 1e-6, 0.0);
        neph_assert_close(pixel_value(&test, RT_TAA_OUT, 4, 4, 2), cases[i].blue, 1e-6, 0.0);
    }
}

/* A history between the extremes of its surroundings is returned bit by bit. */
static void test_history_in_the_box_is_unchanged(void **state)
{
    static const char *const spaces[] = {"linear", "reinhard", "ycocg"};
    for (int s = 0; s < 3; s++) {
        OWNED(passes) struct test_passes test;
        uint64_t seed = 17;
        test_open(*state, 64, 36, 0, &test,
                  "taa_filter=off taa_alpha=0 taa_contrast=0 target_format=float taa_space=%s",
                  spaces[s]);
        test.view.has_history = 1;
        fill_colours(&test, RT_TAA_BEFORE, 1.0, &seed);
        for (int y = 0; y < 36; y++)
            for (int x = 0; x < 64; x++) {
                /* each plus has all five kinds, the extremes of all three spaces */
                const int kind = (x + 2 * y) % 5;
                cpu_put_full(&test.cpu, RT_DEPTH, x, y, (float[4]){1.0f});
                cpu_put_full(&test.cpu, RT_COLOR, x, y,
                             (float[4]){kind == 1 || kind == 3 ? 9.0f : 0.0f,
                                        kind == 2 || kind == 3 ? 9.0f : 0.0f,
                                        kind == 1 || kind == 4 ? 9.0f : 0.0f});
            }
        run(&test);
        for (int y = 1; y < 35; y++)
            for (int x = 1; x < 63; x++)
                for (int c = 0; c < 3; c++)
                    assert_true(pixel_value(&test, RT_TAA_OUT, x, y, c) ==
                                pixel_value(&test, RT_TAA_BEFORE, x, y, c));
    }
}

#include "tests/renderer/main.h"
