/* SPDX-License-Identifier: MIT
 *
 * Tests of temporal upsampling: its places, one frame against the CPU reference, many frames of a
 * pattern with a closed form, and the pipeline with screen_percent below 100.
 */
#include "renderer/realtime/anti_aliasing/check_taa.h"
#include "tests/renderer/sequence_test.h"

#include "renderer/realtime/jitter.h"
#include "scenes/injection.h"

static const int sizes_px[][2] = {{1, 1}, {2, 3}, {5, 4}, {64, 36}, {127, 33}};
enum { SIZES = COUNT(sizes_px) };

/* --- sizes and places ------------------------------------------------------------------------- */

static void test_less_is_rendered_by_the_percentage(void **state)
{
    static const struct {
        int picture_px, percent, rendered_px;
    } cases[] = {{1920, 50, 960}, {1080, 67, 724}, {1917, 50, 959}, {641, 100, 641},
                 {641, 99, 635},  {1, 50, 1},      {2, 50, 1},      {3, 50, 2}};
    for (size_t i = 0; i < COUNT(cases); i++)
        assert_int_equal(neph_rt_rendered_px(cases[i].picture_px, cases[i].percent),
                         cases[i].rendered_px);
}

/* A published table has 18, 23, 32 and 72 places for 8 and sides 1.5, 1.7, 2 and 3 times as long,
 * rounded up; here rounded to nearest, and odd lengths stay odd, so that four slots see all
 * places. */
static void test_places_grow_with_the_square(void **state)
{
    assert_int_equal(neph_rt_jitter_length(8, 100), 8);
    assert_int_equal(neph_rt_jitter_length(8, 50), 32);
    assert_int_equal(neph_rt_jitter_length(8, 67), 18);
    assert_int_equal(neph_rt_jitter_length(8, 59), 23);
    for (int percent = 50; percent <= 100; percent++)
        for (int length = 1; length <= 64; length++) {
            const int grown = neph_rt_jitter_length(length, percent);
            const double exact = length * 1e4 / percent / percent;
            assert_true(length % 2 == 0 || grown % 2 == 1);
            assert_true(fabs(grown - exact) <= (length % 2 ? 1.5 : 0.5));
        }
    assert_int_equal(neph_rt_jitter_length(7, 100), 7);
}

/* --- against the CPU reference --------------------------------------------------------------- */

static void test_the_pass_equals_the_cpu_reference(void **state)
{
    static const char *const percents[] = {"50", "58", "67", "77", "99", "100"};
    uint64_t seed = 20261125;
    for (int round = 0; round < neph_test_by_day(18, 60); round++) {
        const uint64_t start = seed;
        char text[896];
        random_settings(&seed, text, 768);
        const size_t length = strlen(text);
        snprintf(text + length, sizeof(text) - length, "taa=upsampling screen_percent=%s",
                 percents[round % 6]);
        const struct neph_settings settings = test_settings(text);
        OWNED(passes) struct test_passes test;
        test_passes_open(*state, &settings, sizes_px[round % SIZES], (int[2]){0, 0}, 3 * start,
                         &test);
        const double most = fill_round(&test, round, &seed);
        test_passes_run(&test, "upsampling");
        cpu_taa(&test.cpu);
        compare(&test, most, start, text);
    }
}

/* At 100 % the source of a pixel is the pixel itself, because no other ray is nearer within half a
 * pixel; the distance box is the same as in anti-aliasing. Only the places of the rays are rounded
 * differently: a few ulps. */
static void test_at_full_size_it_is_anti_aliasing(void **state)
{
    static const char *const kinds[] = {"taa=on", "taa=upsampling"};
    static const char *const passes[] = {"anti-aliasing", "upsampling"};
    uint32_t *words[2];
    size_t count = 0;
    for (int k = 0; k < 2; k++) {
        OWNED(passes) struct test_passes test;
        uint64_t seed = 5;
        test_open(*state, 64, 36, 0, &test,
                  "taa_box=distance taa_contrast=0 target_format=float %s", kinds[k]);
        test.view.has_history = 1;
        test.view.jitter_px[0] = 0.3f;
        test.view.jitter_px[1] = -0.45f;
        move_camera(&test.view, 0.02, 0.1, &seed);
        fill_depths(&test, &seed);
        fill_colours(&test, RT_COLOR, 1.0, &seed);
        fill_colours(&test, RT_TAA_BEFORE, 1.0, &seed);
        test_passes_run(&test, passes[k]);
        words[k] = test_download(&test, RT_TAA_OUT);
        count = neph_rt_device_words(&test.device, RT_TAA_OUT);
    }
    for (size_t i = 0; i < count; i++) {
        float on, upsampling;
        memcpy(&on, &words[0][i], sizeof(on));
        memcpy(&upsampling, &words[1][i], sizeof(upsampling));
        neph_assert_close(upsampling, on, 0.0, 4e-6);
    }
    free(words[0]);
    free(words[1]);
}

/* --- many frames ------------------------------------------------------------------------------ */

/* Waves with a period of `period_px` output pixels along x, around 1. */
static double wave(double place_px, double period_px)
{
    return 1.0 + 0.5 * sin(2.0 * M_PI * place_px / period_px);
}

/* The wave in a row of the history: its amplitude, and its shift [output px]. */
struct measured_wave {
    double amplitude, shift_px;
};

static struct measured_wave find_wave(const struct test_passes *film, int y, double period_px)
{
    const int first = 24, count = 72; /* away from the sides; whole periods of 6 and 4 */
    double sine = 0.0, cosine = 0.0;
    for (int x = first; x < first + count; x++) {
        const double angle = 2.0 * M_PI * (x + 0.5) / period_px;
        const double value = pixel_value(film, RT_TAA_BEFORE, x, y, 0) - 1.0;
        sine += value * sin(angle) / (0.25 * count);
        cosine += value * cos(angle) / (0.25 * count);
    }
    return (struct measured_wave){hypot(sine, cosine),
                                  -atan2(cosine, sine) / (2.0 * M_PI) * period_px};
}

/* A static camera in front of waves, for 1.5 periods of the jitter. */
static struct measured_wave film_waves(struct neph_vulkan *vulkan, int percent, double period_px)
{
    OWNED(passes) struct test_passes film;
    test_open(vulkan, 120, 8, 0, &film,
              "taa=on screen_percent=%d taa_box=none taa_hdr_weight=off taa_contrast=0 "
              "taa_alpha=0.1 target_format=float",
              percent);
    test_fill(&film, RT_DEPTH, 128, 0, 0, 0);
    const struct neph_gpu_view *view = &film.view;
    const int length = (int)view->settings[RT_TAA_JITTER_LENGTH];
    for (int frame = 0; frame < 5 * length; frame++) {
        double jitter_px[2];
        neph_rt_jitter((int)view->settings[RT_TAA_JITTER], length, (uint32_t)frame, jitter_px);
        film.view.has_history = frame > 0;
        for (int axis = 0; axis < 2; axis++)
            film.view.jitter_px[axis] = (float)jitter_px[axis];
        for (int y = 0; y < (int)view->size_px[1]; y++)
            for (int x = 0; x < (int)view->size_px[0]; x++) {
                const double place = (x + 0.5 + jitter_px[0]) / (double)view->rendered_per_px[0];
                cpu_put_full(&film.cpu, RT_COLOR, x, y, (float[4]){(float)wave(place, period_px)});
            }
        cpu_taa(&film.cpu);
        test_swap(&film, RT_TAA_OUT, RT_TAA_BEFORE);
    }
    const struct measured_wave measured_wave = find_wave(&film, 4, period_px);
    return measured_wave;
}

/* At half the size waves of 6 output pixels have 3 rendered pixels, waves of 4 have 2, which no
 * single frame can show. The Gaussian of 0.47 px reduces them by exp(-2 (pi 0.47 / period)^2): to
 * 0.89 and 0.76. In a frame almost only the nearest ray has weight, so rays farther away count
 * more; and the mean of few frames differs from the mean of all places: 0.03 is allowed. The image
 * does not move, to 0.03 px: a jitter with the wrong sign would blur the waves away or move them by
 * tenths of a pixel. */
static void test_waves_above_frame_resolution_appear(void **state)
{
    static const int percents[] = {50, 67, 77, 99};
    static const double periods_px[] = {6.0, 4.0};
    for (int p = 0; p < neph_test_by_day(2, 4); p++)
        for (int k = 0; k < 2; k++) {
            const struct measured_wave measured_wave = film_waves(*state, percents[p],
                                                                  periods_px[k]);
            const double expected = exp(-2.0 * pow(M_PI * 0.47 / periods_px[k], 2.0));
            print_message("%d %%, waves of %g px: %.3f of them (Gaussian %.3f), %+.3f px off\n",
                          percents[p], periods_px[k], measured_wave.amplitude, expected,
                          measured_wave.shift_px);
            neph_assert_close(measured_wave.amplitude, expected, 0.0, 0.03);
            neph_assert_close(measured_wave.shift_px, 0.0, 0.0, 0.03);
        }
}

/* --- the pipeline ----------------------------------------------------------------------------- */

enum { WIDTH_PX = 64, HEIGHT_PX = 37 };

static void scene_posts(struct test_scene *test)
{
    test_scene_init(test);
    test_add_medium(test, 0.03, 0.05, 0.0);
    for (int i = 0; i < 8; i++)
        test_add_box(test, (struct neph_vec3){-6.0 + 1.5 * i, 0.0, -12.0},
                     (struct neph_vec3){-5.4 + 1.5 * i, 4.0, -11.8});
}

static struct neph_image *render_last_frame(struct neph_vulkan *vulkan,
                                            const struct neph_scene *scene, const char *text,
                                            int frame_count)
{
    const struct neph_settings settings = test_settings(text);
    OWNED(realtime)
    struct neph_realtime *realtime = test_sequence(vulkan, scene, &settings, WIDTH_PX, HEIGHT_PX);
    struct neph_image *image = NULL;
    for (int i = 0; i < frame_count; i++) {
        neph_image_destroy(image);
        image = test_next(realtime, scene, i, NULL);
    }
    return image;
}

/* At half the size, marched whole or split: the output has its own size and aspect, all channels,
 * and at most half of the squared error of its rendered pixels when these are enlarged. */
static void test_smaller_frame_fills_the_output(void **state)
{
    static const char *const images[] = {"split=none screen_percent=50",
                                         "split=four ray_dither=none screen_percent=50"};
    static const char *const larger[] = {
        "split=none screen_percent=50 taa_jitter=none taa_filter=off",
        "split=four ray_dither=none screen_percent=50 taa_jitter=none taa_filter=off"};
    struct test_scene test;
    scene_posts(&test);
    OWNED(image)
    struct neph_image *truth = render_last_frame(*state, &test.scene, "split=none taa=on", 40);
    for (int s = 0; s < 2; s++) {
        OWNED(image)
        struct neph_image *image = render_last_frame(*state, &test.scene, images[s], 64);
        OWNED(image)
        struct neph_image *blocks = render_last_frame(*state, &test.scene, larger[s], 8);
        assert_int_equal(image->width_px, WIDTH_PX);
        assert_int_equal(image->height_px, HEIGHT_PX);
        assert_int_equal(image->channel_count, truth->channel_count);
        const double error = test_rmse(image, truth), of_blocks = test_rmse(blocks, truth);
        print_message("%s: rmse %.4f, of its pixels made larger %.4f\n", images[s], error,
                      of_blocks);
        assert_true(pow(error / of_blocks, 2.0) < 0.5);
        /* 37 rows have 19 rendered ones: row y is within the rendered row (2 y + 1) 19 / 74 */
        const float *depth_m = neph_image_channel(image, "Z");
        for (int y = 0; y < HEIGHT_PX; y++)
            for (int x = 0; x < WIDTH_PX; x += 2)
                assert_true(depth_m[y * WIDTH_PX + x] == depth_m[y * WIDTH_PX + x + 1]);
    }
}

static void test_unsupported_upsampling_is_an_error(void **state)
{
    struct test_scene test;
    scene_posts(&test);
    char reason[256];
    struct neph_settings settings = test_settings("screen_percent=99 taa=off");
    assert_false(neph_realtime_can_render(&test.scene, &settings, reason, sizeof(reason)));
    assert_non_null(strstr(reason, "taa=on"));
    settings = test_settings("screen_percent=100 taa=off");
    assert_true(neph_realtime_can_render(&test.scene, &settings, reason, sizeof(reason)));
    test.scene.injections = &(struct neph_injections){.view.left_px = 4};
    assert_true(neph_realtime_can_render(&test.scene, &settings, reason, sizeof(reason)));
    settings = test_settings("screen_percent=99");
    assert_false(neph_realtime_can_render(&test.scene, &settings, reason, sizeof(reason)));
    assert_non_null(strstr(reason, "inject.view"));
}

#include "tests/renderer/main.h"
