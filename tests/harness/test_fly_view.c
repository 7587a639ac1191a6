/* SPDX-License-Identifier: MIT
 *
 * The view of `neph fly`: display codes from its own table, glyphs, and the maps against the
 * metrics after which they are named.
 */
#include "tests/harness/image_test.h"

#include "harness/engines/frame_stats.h"
#include "harness/fly/canvas.h"
#include "harness/fly/encode.h"
#include "harness/fly/heat.h"
#include "harness/fly/times.h"
#include "metrics/display.h"

/* ---- display codes --------------------------------------------------------------------------- */

enum { CODE_COUNT = 1 << 16 };

/* Evenly spaced to beyond white, and down to 16 octaves below it. */
static void make_values(float *values)
{
    for (int i = 0; i < CODE_COUNT; i++)
        values[i] = i % 2 ? (float)i / (float)CODE_COUNT * 1.05f
                          : (float)exp2(-16.0 * i / CODE_COUNT);
    values[0] = -1.0f;
    values[2] = 0.0f;
    values[4] = INFINITY;
    values[6] = 1.0f;
}

/* Distance from the border of two codes, as a share of the code, at which OpenColorIO may choose
 * the other one: its straight part has the slope 12.9232 at the junction instead of 12.92 (2.5e-4),
 * and on its way over XYZ it rounds about ten times in float32. */
static double border_share(double value)
{
    return value <= 0.0031308 ? 2.6e-4 : 1e-6;
}

static void assert_same_code(double value, int code, int expected)
{
    const double encoded = value <= 0.0031308 ? 12.92 * value
                                              : 1.055 * pow(value, 1.0 / 2.4) - 0.055;
    const double border = fmin(code, expected) + 0.5;
    if (code == expected)
        return;
    assert_int_equal(abs(code - expected), 1);
    neph_assert_close(255.0 * encoded, border, border_share(value), 0.0);
}

static void test_codes_are_those_of_the_display(void **state)
{
    float *values = calloc(CODE_COUNT, sizeof(*values));
    uint8_t *codes = calloc(CODE_COUNT, 3), *expected = calloc(CODE_COUNT, 3);
    const float *const rgb[3] = {values, values, values};
    struct neph_encoder *encoder = NULL;
    struct neph_diag diag = {0};
    make_values(values);
    neph_assert_ok(neph_encoder_create(&encoder, &diag), &diag);
    for (double ev = -2.0; ev <= 1.0; ev += 1.5) {
        neph_assert_ok(neph_encoder_run(encoder, rgb, 256, CODE_COUNT / 256, ev, codes, &diag),
                       &diag);
        neph_assert_ok(neph_display_encode(rgb, CODE_COUNT, ev, expected, &diag), &diag);
        for (int i = 0; i < 3 * CODE_COUNT; i++)
            assert_same_code(values[i / 3] * exp2(ev), codes[i], expected[i]);
    }
    neph_encoder_destroy(encoder);
    free(expected);
    free(codes);
    free(values);
}

static void test_a_pixel_with_a_nan_is_magenta(void **state)
{
    const float planes[3][2] = {{0.5f, 0.5f}, {NAN, 0.5f}, {0.5f, 0.5f}};
    const float *const rgb[3] = {planes[0], planes[1], planes[2]};
    struct neph_encoder *encoder = NULL;
    uint8_t codes[6];
    neph_assert_ok(neph_encoder_create(&encoder, NULL), NULL);
    neph_assert_ok(neph_encoder_run(encoder, rgb, 2, 1, 0.0, codes, NULL), NULL);
    assert_memory_equal(codes, ((const uint8_t[]){255, 0, 255, 188, 188, 188}), 6);
    neph_encoder_destroy(encoder);
}

/* --- glyphs ----------------------------------------------------------------------------------- */

static void test_letters_of_all_texts_are_there_and_differ(void **state)
{
    static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.,:;+-*/=%()[]<>'\"!?&#_| ";
    const uint8_t *box = neph_font_glyph('~');
    for (size_t i = 0; letters[i]; i++) {
        const uint8_t *glyph = neph_font_glyph(letters[i]);
        assert_memory_not_equal(glyph, box, NEPH_GLYPH_HEIGHT);
        for (size_t j = 0; j < i; j++)
            assert_memory_not_equal(glyph, neph_font_glyph(letters[j]), NEPH_GLYPH_HEIGHT);
        for (int row = 0; row < NEPH_GLYPH_HEIGHT; row++)
            assert_true(glyph[row] < 1 << NEPH_GLYPH_WIDTH);
    }
    assert_ptr_equal(neph_font_glyph('q'), neph_font_glyph('Q'));
    assert_ptr_equal(neph_font_glyph('\xc3'), box);
}

/* An image of 7 x 400 pixels is enlarged 92 times; text stays inside the canvas and at its place,
 * even when it is longer than the canvas. */
static void test_text_stays_on_the_canvas(void **state)
{
    static const uint8_t white[3] = {255, 255, 255};
    static uint8_t grey[7 * 40 * 3];
    char text[1000];
    struct neph_canvas canvas;
    memset(text, 'M', sizeof(text) - 1);
    text[sizeof(text) - 1] = '\0';
    memset(grey, 100, sizeof(grey));
    neph_assert_ok(neph_canvas_init(&canvas, 7, 40, NULL), NULL);
    assert_int_equal(canvas.width_px, 7 * 92);
    assert_int_equal(canvas.height_px, 40 * 92);
    neph_canvas_show(&canvas, grey);
    neph_canvas_text(&canvas, 1, white, text);
    neph_canvas_text(&canvas, 100000, white, text);
    const int line_px = neph_canvas_line_px(&canvas);
    int whites = 0, dark = 0, others = 0;
    for (int y = 0; y < canvas.height_px; y++)
        for (int x = 0; x < canvas.width_px; x++) {
            const uint8_t code = canvas.rgb[3 * (y * canvas.width_px + x)];
            whites += code == 255;
            dark += code == 25;
            others += (code == 255 || code == 25) && y / line_px != 1;
        }
    assert_int_equal(others, 0);
    /* An M has 18 dots: five, five and two rows of its seven have 2, 3 and 4. */
    const int columns = (canvas.width_px - 4) / neph_canvas_column_px(&canvas);
    int dots = 0;
    for (int row = 0; row < NEPH_GLYPH_HEIGHT; row++)
        dots += __builtin_popcount(neph_font_glyph('M')[row]);
    assert_int_equal(whites, columns * dots);
    assert_int_equal(whites + dark, line_px * (4 + columns * neph_canvas_column_px(&canvas)));
    neph_canvas_finish(&canvas);
}

static void test_pixels_are_made_larger_and_the_line_stands_on_them(void **state)
{
    const uint8_t rgb[2 * 1 * 3] = {10, 20, 30, 40, 50, 60};
    struct neph_canvas canvas;
    neph_assert_ok(neph_canvas_init(&canvas, 2, 1, NULL), NULL);
    neph_canvas_show(&canvas, rgb);
    const size_t row = 3 * (size_t)canvas.width_px, last = row * ((size_t)canvas.height_px - 1);
    assert_memory_equal(canvas.rgb + last, rgb, 3);
    assert_memory_equal(canvas.rgb + last + row / 2 - 3, rgb, 3);
    assert_memory_equal(canvas.rgb + last + row / 2, rgb + 3, 3);
    neph_canvas_split(&canvas, 1.0);
    assert_memory_equal(canvas.rgb + row - 3, ((const uint8_t[]){0, 0, 0}), 3);
    neph_canvas_finish(&canvas);
}

/* ---- maps ------------------------------------------------------------------------------------ */

/* By hand: differences of 0.5, -0.25 and 0 in one channel of two pixels; the reference's mean is 1.
 */
static void test_an_error_is_that_of_all_channels(void **state)
{
    struct neph_image *reference = grey_image(2, 1, 1.0f), *test = grey_image(2, 1, 1.0f);
    struct neph_relative_error error;
    uint8_t rgb[6];
    neph_image_channel(test, "G")[0] = 1.5f;
    neph_image_channel(test, "B")[1] = 0.75f;
    neph_assert_ok(neph_heat_error(reference, test, 0.0, 0.1, &error, rgb, NULL), NULL);
    assert_true(error.bias == 0.25 / 6.0);
    assert_true(error.rmse == sqrt((0.25 + 0.0625) / 6.0));
    /* The luminance is off by 0.36 and -0.018, on a scale of 0.1. */
    const struct neph_display_legend *legend = neph_display_difference_legend();
    assert_memory_equal(rgb, legend->above, 3);
    assert_true(rgb[5] > rgb[3]); /* towards blue */
    struct neph_image *wide = grey_image(3, 1, 1.0f);
    assert_int_equal(neph_heat_error(reference, wide, 0.0, 0.1, &error, rgb, NULL),
                     NEPH_ERR_ENGINE);
    neph_image_destroy(wide);
    neph_image_destroy(test);
    neph_image_destroy(reference);
}

/* Code values 128 -+ 8 as linear radiance. */
static float linear_from_code(double code)
{
    return (float)pow((code / 255.0 + 0.055) / 1.055, 2.4);
}

/* Flicker with an amplitude of 8/255 at periods of 4, 2 and 8 frames, one in each row, and a drift.
 * Only the first has an a4. A run of 70 frames keeps 64. */
static void test_flicker_is_that_of_the_metric(void **state)
{
    static const double cosines[8] = {1, M_SQRT1_2, 0, -M_SQRT1_2, -1, -M_SQRT1_2, 0, M_SQRT1_2};
    struct neph_heat_flicker *flicker = NULL;
    struct neph_heat_a4 a4;
    uint8_t rgb[4 * 4 * 3];
    neph_assert_ok(neph_heat_flicker_create(4, 4, &flicker, NULL), NULL);
    for (int frame = 0; frame < 70; frame++) {
        const double codes[4] = {128.0 + 8.0 * cosines[2 * frame % 8],
                                 128.0 + 8.0 * cosines[4 * frame % 8], 128.0 + 0.5 * frame,
                                 128.0 + 8.0 * cosines[frame % 8]};
        struct neph_image *image = grey_image(4, 4, 0.0f);
        for (int c = 0; c < 3; c++)
            for (int i = 0; i < 16; i++)
                image->channels[c].samples[i] = linear_from_code(codes[i / 4]);
        assert_false(frame < NEPH_HEAT_FRAMES_MIN && frame % 4 == 0 &&
                     neph_heat_flicker_show(flicker, &a4, rgb));
        neph_assert_ok(neph_heat_flicker_add(flicker, image, 0.0, NULL), NULL);
        neph_image_destroy(image);
    }
    assert_true(neph_heat_flicker_show(flicker, &a4, rgb));
    assert_int_equal(a4.frame_count, 64);
    assert_true(a4.share_1 == 0.25);
    /* Radiance is float32: its codes are off by about 1e-5, and the drift leaves less. */
    neph_assert_close(a4.mean, 8.0 / 255.0 / 4.0, 0.0, 2e-5);
    /* Half of the scale: the middle of magma in the first row, black in the others. */
    assert_true(rgb[0] > 150 && rgb[1] < 80);
    assert_true(rgb[3 * 4] < 8 && rgb[3 * 8] < 8 && rgb[3 * 12] < 8);
    neph_heat_flicker_forget(flicker);
    assert_false(neph_heat_flicker_show(flicker, &a4, rgb));
    neph_heat_flicker_destroy(flicker);
}

/* In large frames only every third pixel of a row is sampled; the map still covers all pixels. */
static void test_large_frames_are_sampled_in_steps(void **state)
{
    enum { WIDTH_PX = 301, HEIGHT_PX = 200 };
    struct neph_heat_flicker *flicker = NULL;
    struct neph_heat_a4 a4;
    uint8_t *rgb = calloc(WIDTH_PX * HEIGHT_PX, 3);
    neph_assert_ok(neph_heat_flicker_create(WIDTH_PX, HEIGHT_PX, &flicker, NULL), NULL);
    for (int frame = 0; frame < 16; frame++) {
        struct neph_image *image = grey_image(WIDTH_PX, HEIGHT_PX,
                                              linear_from_code(frame % 4 == 0 ? 144.0 : 128.0));
        neph_assert_ok(neph_heat_flicker_add(flicker, image, 0.0, NULL), NULL);
        neph_image_destroy(image);
    }
    assert_true(neph_heat_flicker_show(flicker, &a4, rgb));
    assert_int_equal(a4.frame_count, 16);
    assert_true(a4.share_1 == 1.0);
    neph_assert_close(a4.mean, 8.0 / 255.0, 0.0, 2e-5);
    for (int i = 0; i < 3 * WIDTH_PX * HEIGHT_PX; i++)
        assert_int_equal(rgb[i], rgb[i % 3]);
    neph_heat_flicker_destroy(flicker);
    free(rgb);
}

/* ---- times ----------------------------------------------------------------------------------- */

static void test_a_median_uses_measured_frames(void **state)
{
    static struct neph_fly_times times;
    assert_true(isnan(neph_fly_times_median_s(&times)));
    neph_fly_times_add(&times, 3.0);
    neph_fly_times_add(&times, NAN);
    neph_fly_times_add(&times, 1.0);
    assert_true(neph_fly_times_median_s(&times) == 2.0);
    neph_fly_times_add(&times, 0.5);
    assert_true(neph_fly_times_median_s(&times) == 1.0);
    for (int i = 0; i < NEPH_FLY_TIMES_MAX; i++) /* the oldest are dropped */
        neph_fly_times_add(&times, 7.0);
    assert_true(neph_fly_times_median_s(&times) == 7.0);
}

static void test_passes_are_those_of_the_frame(void **state)
{
    struct neph_fly_passes passes = {.count = 0};
    struct neph_image *image = grey_image(1, 1, 0.0f);
    neph_assert_ok(neph_frame_stats_set(image, "rays", 7.0, NULL), NULL);
    neph_assert_ok(neph_frame_stats_set(image, "gpu_ms", 9.0, NULL), NULL);
    neph_assert_ok(neph_frame_stats_set(image, "depth_map_gpu_ms", 4.0, NULL), NULL);
    neph_fly_passes_add_frame(&passes, image);
    neph_assert_ok(neph_frame_stats_set(image, "depth_map_gpu_ms", 12.0, NULL), NULL);
    neph_fly_passes_add_frame(&passes, image);
    assert_int_equal(passes.count, 1);
    assert_string_equal(passes.passes[0].name, "depth map");
    neph_assert_close(passes.passes[0].mean_s, 0.005, 1e-15, 0.0); /* 4 + (12 - 4) / 8 ms */
    neph_image_destroy(image);
}

#include "tests/main.h"
