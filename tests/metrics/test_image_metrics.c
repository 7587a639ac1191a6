/* SPDX-License-Identifier: MIT
 *
 * Image metrics against numpy (image_reference.py), published values, closed forms and properties.
 */
#include "tests/metrics/extractor_test.h"

#include "tests/metrics/image_reference.h"

#include "metrics/extractors/code_value.h"
#include "metrics/extractors/extractors.h"
#include "metrics/extractors/ms_ssim.h"
#include "metrics/extractors/two_seed.h"
#include "metrics/statistics.h"

/* Both sides sum a few hundred thousand terms in double precision. The only further approximation
 * is the table of code values, which has its own bound below. */
static const double sums_relative = 1e-11;

/* ---- frames ---------------------------------------------------------------------------------- */

struct frames {
    struct neph_image *reference, *test, *second;
    struct neph_viewing viewing;
};

static struct neph_image *blank(int width_px, int height_px, float *planes[3])
{
    struct neph_image *image = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_image_create(width_px, height_px, &image, &diag), &diag);
    neph_assert_ok(neph_image_add_rgb(image, NULL, planes, &diag), &diag);
    return image;
}

static int pattern(int x, int y, int c)
{
    return (3 * x + 5 * y + 40 * ((x / 8 + y / 8) % 2) + 11 * c) % 97;
}

/* As frames() in image_reference.py. */
static struct frames made_up(int width_px, int height_px, uint64_t seed)
{
    float *planes[3][3];
    struct frames frames = {.reference = blank(width_px, height_px, planes[0]),
                            .test = blank(width_px, height_px, planes[1]),
                            .second = blank(width_px, height_px, planes[2]),
                            .viewing = NEPH_VIEWING_DEFAULTS};
    for (int y = 0; y < height_px; y++) {
        for (int x = 0; x < width_px; x++) {
            for (int c = 0; c < 3; c++) {
                size_t i = (size_t)y * (size_t)width_px + (size_t)x;
                float clean = (float)pattern(x + 1, y + 1, c) / 32.0f;
                float moved = (float)pattern(x + x / 16 % 3, y + y / 16 % 3, c) / 32.0f;
                float noise[3];
                for (int k = 0; k < 3; k++)
                    noise[k] = (float)(neph_test_random(&seed) & 255);
                planes[0][c][i] = clean + noise[0] / 1024.0f;
                planes[1][c][i] = fmaxf(0.0f, moved + noise[1] / 512.0f - 0.1875f);
                planes[2][c][i] = clean + noise[2] / 1024.0f;
            }
        }
    }
    return frames;
}

/* Grey frames from numbers; NULL second: none. */
static struct frames grey(int width_px, int height_px, const float *reference, const float *test)
{
    float *planes[2][3];
    struct frames frames = {.reference = blank(width_px, height_px, planes[0]),
                            .test = blank(width_px, height_px, planes[1]),
                            .viewing = NEPH_VIEWING_DEFAULTS};
    for (size_t i = 0; i < neph_image_pixel_count(frames.reference); i++) {
        for (int c = 0; c < 3; c++) {
            planes[0][c][i] = reference[i];
            planes[1][c][i] = test[i];
        }
    }
    return frames;
}

static void drop(struct frames *frames)
{
    neph_image_destroy(frames->reference);
    neph_image_destroy(frames->test);
    neph_image_destroy(frames->second);
}

static struct neph_frame_pair make_frames_pair(const struct frames *frames)
{
    return extraction_pair(frames->reference, frames->second, frames->test, "radiance", 0,
                           &frames->viewing);
}

static struct extraction run(const struct neph_extractor *extractor, const struct frames *frames,
                             const char *const *assignments)
{
    struct neph_frame_pair pair = make_frames_pair(frames);
    struct extraction extraction = extraction_begin(extractor, &pair, assignments);
    extraction_frame(&extraction, &pair);
    return extraction;
}

/* The values of a map, all planes; for the caller to free. */
static double *read_map_values(const struct extraction *extraction, int map, size_t *count)
{
    int plane_count = extraction->extractor->maps[map].plane_count;
    plane_count = plane_count ? plane_count : extraction->plane_count;
    size_t all = (size_t)plane_count * (size_t)extraction->width_px * (size_t)extraction->height_px;
    double *values = extraction_map(extraction, map);
    *count = 0;
    for (size_t i = 0; i < all; i++)
        if (!isnan(values[i]))
            values[(*count)++] = values[i];
    return values;
}

/* A metric of one map over the whole image, with the pool from its table. */
static double pooled(const struct extraction *extraction, const char *name)
{
    const struct neph_metric *metric = extraction->extractor->metrics;
    while (metric->name && strcmp(metric->name, name) != 0)
        metric++;
    assert_non_null(metric->name);
    if (metric->pool == NEPH_POOL_SCALAR)
        return extraction_scalar(extraction, name);
    size_t count;
    double *values = read_map_values(extraction, metric->map, &count);
    assert_true(count > 0);
    struct neph_sum sum = {0};
    for (size_t i = 0; i < count; i++)
        neph_sum_add(&sum, values[i]);
    double mean = neph_sum_value(&sum) / (double)count;
    double value = NAN;
    switch (metric->pool) {
    case NEPH_POOL_MEAN:
        value = mean;
        break;
    case NEPH_POOL_ROOT_MEAN:
        value = sqrt(fmax(mean, 0.0));
        break;
    case NEPH_POOL_PSNR:
        value = 10.0 * log10(metric->parameter * metric->parameter / mean);
        break;
    case NEPH_POOL_PERCENTILE:
        value = neph_percentile(values, count, metric->parameter);
        break;
    default:
        fail_msg("'%s' has a pool that this test does not know", name);
    }
    free(values);
    return value;
}

static double measured(const struct neph_extractor *extractor, const struct frames *frames,
                       const char *const *assignments, const char *name)
{
    struct extraction extraction = run(extractor, frames, assignments);
    double value = pooled(&extraction, name);
    extraction_end(&extraction);
    return value;
}

static const char *find_extractor_obstacle(const struct neph_extractor *extractor,
                                           const struct frames *frames)
{
    struct neph_frame_pair pair = make_frames_pair(frames);
    struct neph_settings settings = neph_options_default(extractor->options);
    return extractor->obstacle(&pair, &settings);
}

static void test_tables(void **state)
{
    extraction_check_table(&neph_extractor_stops);
    extraction_check_table(&neph_extractor_pu21);
    extraction_check_table(&neph_extractor_ssim);
    extraction_check_table(&neph_extractor_shift);
    extraction_check_table(&neph_extractor_two_seed);
    extraction_check_table(&neph_extractor_published);
    extraction_check_table(&neph_extractor_published_ssim);
}

/* ---- against numpy --------------------------------------------------------------------------- */

static void check_pointwise(const struct image_reference *expected, const struct frames *frames)
{
    neph_assert_close(measured(&neph_extractor_stops, frames, NULL, "stops_mean"),
                      expected->stops_mean, sums_relative, 0.0);
    neph_assert_close(measured(&neph_extractor_stops, frames, NULL, "stops_p50"),
                      expected->stops_p50, sums_relative, 0.0);
    neph_assert_close(measured(&neph_extractor_stops, frames, NULL, "stops_p95"),
                      expected->stops_p95, sums_relative, 0.0);
    neph_assert_close(measured(&neph_extractor_pu21, frames, NULL, "pu_psnr"),
                      10.0 * log10(256.0 * 256.0 / expected->pu_mse), 1e-10, 0.0);
    neph_assert_close(measured(&neph_extractor_two_seed, frames, NULL, "mse_unbiased"),
                      expected->mse_unbiased, sums_relative, 0.0);
    neph_assert_close(measured(&neph_extractor_two_seed, frames, NULL, "rmse_unbiased"),
                      sqrt(expected->mse_unbiased), sums_relative, 0.0);
    neph_assert_close(measured(&neph_extractor_two_seed, frames, NULL, "reference_noise_rmse"),
                      sqrt(expected->noise_variance), sums_relative, 0.0);
    neph_assert_close(measured(&neph_extractor_two_seed, frames, NULL, "mse_mean_reference"),
                      expected->mse_mean_reference, sums_relative, 0.0);
}

static void check_shift(const struct image_reference *expected, const struct frames *frames)
{
    struct extraction extraction = run(&neph_extractor_shift, frames, NULL);
    neph_assert_close(pooled(&extraction, "rmse_shift1"), sqrt(expected->mse_shift1), sums_relative,
                      0.0);
    size_t count;
    double *as_is = read_map_values(&extraction, 0, &count);
    double sum = 0.0;
    for (size_t i = 0; i < count; i++)
        sum += as_is[i];
    neph_assert_close(sum / (double)count, expected->mse, sums_relative, 0.0);
    free(as_is);
    extraction_end(&extraction);
}

static void check_ssim(const struct image_reference *expected, const struct frames *frames)
{
    static const char *const display[] = {"code=display", NULL}, *const shrunk[] = {"decimate=1",
                                                                                    NULL};
    struct extraction extraction = run(&neph_extractor_ssim, frames, NULL);
    neph_assert_close(pooled(&extraction, "ssim_mean"), expected->ssim_mean, sums_relative, 0.0);
    neph_assert_close(pooled(&extraction, "ssim_p5"), expected->ssim_p5, 1e-10, 0.0);
    size_t width = (size_t)expected->width_px, height = (size_t)expected->height_px;
    double *map = extraction_map(&extraction, extraction_map_index(&neph_extractor_ssim, "ssim"));
    neph_assert_close(map[5 * width + 5], expected->ssim_first, 1e-10, 0.0);
    neph_assert_close(map[(height - 6) * width + width - 6], expected->ssim_last, 1e-10, 0.0);
    for (size_t i = 0; i < width * height; i++) {
        bool is_inside = i % width >= 5 && i % width < width - 5 && i / width >= 5 &&
                         i / width < height - 5;
        assert_int_equal(isnan(map[i]), !is_inside);
    }
    free(map);
    if (expected->ms_ssim != 0.0)
        neph_assert_close(pooled(&extraction, "ms_ssim"), expected->ms_ssim, sums_relative, 0.0);
    extraction_end(&extraction);
    neph_assert_close(measured(&neph_extractor_ssim, frames, display, "ssim_mean"),
                      expected->ssim_display, sums_relative, 0.0);
    if (expected->ms_ssim_display != 0.0)
        neph_assert_close(measured(&neph_extractor_ssim, frames, display, "ms_ssim"),
                          expected->ms_ssim_display, sums_relative, 0.0);
    if (expected->ssim_decimated != 0.0)
        neph_assert_close(measured(&neph_extractor_ssim, frames, shrunk, "ssim_mean"),
                          expected->ssim_decimated, sums_relative, 0.0);
}

static void check_published_ssim(const struct image_reference *expected,
                                 const struct frames *frames)
{
    struct extraction extraction = run(&neph_extractor_published_ssim, frames, NULL);
    const struct {
        const char *metric;
        double value;
    } numbers[] = {{"srgb_ssim", expected->srgb_ssim},
                   {"srgb_ssim_luma", expected->srgb_ssim_luma},
                   {"srgb_ssim_7x7", expected->srgb_ssim_7x7}};
    for (size_t i = 0; i < sizeof(numbers) / sizeof(numbers[0]); i++)
        neph_assert_close(pooled(&extraction, numbers[i].metric), numbers[i].value, sums_relative,
                          0.0);
    extraction_end(&extraction);
}

static void test_against_numpy(void **state)
{
    for (size_t i = 0; i < sizeof(image_references) / sizeof(image_references[0]); i++) {
        const struct image_reference *expected = &image_references[i];
        struct frames frames = made_up(expected->width_px, expected->height_px,
                                       (uint64_t)expected->seed);
        frames.viewing.white_cd_per_m2 = expected->white_cd_per_m2;
        frames.viewing.exposure_ev = expected->exposure_ev;
        check_pointwise(expected, &frames);
        check_shift(expected, &frames);
        check_ssim(expected, &frames);
        check_published_ssim(expected, &frames);
        drop(&frames);
    }
}

/* ---- code values ----------------------------------------------------------------------------- */

/* PU21 of a luminance in cd/m2, "banding glare" (Mantiuk and Azimi, table 1); 0.005 to 10000. */
static double pu21(double luminance_cd_per_m2)
{
    const double x = pow(fmin(fmax(luminance_cd_per_m2, 0.005), 1e4), 0.9062562627);
    const double ratio = (0.353487901 + 0.3734658629 * x) / (1.0 + 8.277049286e-05 * x);
    return fmax(596.3148142 * (pow(ratio, 0.09150303166) - 0.9099517204), 0.0);
}

/* 255 times the sRGB encoding of a display value. */
static double display_code(double value)
{
    const double x = fmin(fmax(value, 0.0), 1.0);
    return 255.0 * (x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1.0 / 2.4) - 0.055);
}

/* 100 cd/m2 is the code 256 (Mantiuk and Azimi, section 3). The parameters have ten published
 * digits, which give it within half a code; black is 0. */
static void test_pu21_published(void **state)
{
    assert_int_equal(lround(pu21(100.0)), 256);
    neph_assert_close(pu21(0.005), 0.0, 0.0, 1e-6);
    /* The formula in 30 digits, at 1 and 10000 cd/m2. */
    neph_assert_close(pu21(1.0), 36.543911139419208, 1e-13, 0.0);
    neph_assert_close(pu21(1e4), 595.39392002009492, 1e-13, 0.0);
    neph_assert_close(display_code(1.0), 255.0, 1e-15, 0.0);
    neph_assert_close(display_code(0.18), 117.6458, 0.0, 1e-3);
    assert_true(neph_code_peak(NEPH_CODE_PU21) == 256.0);
    assert_true(neph_code_peak(NEPH_CODE_DISPLAY) == 255.0);
}

/* The table against the formula: over all its octaves, at the ends of its pieces and outside of its
 * range. 1e-10 is the bound that code_value.h states. */
static void test_codes_follow_their_formula(void **state)
{
    enum { COUNT = 200000 };
    float *grey_values = malloc(COUNT * sizeof(*grey_values));
    double *codes = malloc(COUNT * sizeof(*codes));
    assert_true(grey_values && codes);
    for (int i = 0; i < COUNT; i++)
        grey_values[i] = (float)exp2(-24.0 + 40.0 * i / COUNT);
    for (int i = 0; i < 24 * 32; i++) /* a power of two and its 32 parts, exactly */
        grey_values[i] = ldexpf(1.0f + (float)(i % 32) / 32.0f, i / 32 - 12);
    grey_values[1000] = 0.0f;
    grey_values[1001] = -1.0f;
    grey_values[1002] = 3e38f;
    const float *const planes[3] = {grey_values, grey_values, grey_values};
    struct neph_viewing viewing = NEPH_VIEWING_DEFAULTS;
    viewing.exposure_ev = -3.0;
    viewing.white_cd_per_m2 = 80.0; /* together 10 cd/m2 for 1 */
    for (int kind = NEPH_CODE_PU21; kind <= NEPH_CODE_DISPLAY; kind++) {
        struct neph_arena memory = {0};
        struct neph_code *code = NULL;
        neph_assert_ok(neph_code_create((enum neph_code_kind)kind, &viewing, &memory, &code, NULL),
                       NULL);
        neph_code_pixels(code, planes, 0, COUNT, codes);
        double worst = 0.0;
        for (int i = 0; i < COUNT; i++) {
            double value = (double)grey_values[i] * (kind == NEPH_CODE_PU21 ? 10.0 : 0.125);
            double exact = kind == NEPH_CODE_PU21 ? pu21(value) : display_code(value);
            worst = fmax(worst, fabs(codes[i] - exact));
        }
        print_message("%s: farthest from the formula %.3g codes\n",
                      kind == NEPH_CODE_PU21 ? "pu21" : "display", worst);
        assert_true(worst < 1e-10);
        neph_arena_finish(&memory);
    }
    free(grey_values);
    free(codes);
}

/* 100 against 50 cd/m2 everywhere, from the two codes. */
static void test_pu_psnr_closed_form(void **state)
{
    struct frames frames = grey(3, 1, (float[]){1, 1, 1}, (float[]){0.5f, 0.5f, 0.5f});
    double d = pu21(100.0) - pu21(50.0);
    neph_assert_close(measured(&neph_extractor_pu21, &frames, NULL, "pu_psnr"),
                      20.0 * log10(256.0 / d), 1e-11, 0.0);
    frames.viewing.exposure_ev = 1.0; /* the exposure is on the display's side of the scale */
    frames.viewing.white_cd_per_m2 = 50.0;
    neph_assert_close(measured(&neph_extractor_pu21, &frames, NULL, "pu_psnr"),
                      20.0 * log10(256.0 / d), 1e-11, 0.0);
    drop(&frames);
}

/* ---- stops ----------------------------------------------------------------------------------- */

static void test_stops_closed_form(void **state)
{
    /* Mean 2: the floor is 2e-4. Twice as bright, half, black against 2^-10, both below it. */
    struct frames frames = grey(4, 1, (float[]){4, 4 - 0x1p-10f, 0x1p-10f, 0},
                                (float[]){8, 2 - 0x1p-11f, 0, 1e-5f});
    struct extraction extraction = run(&neph_extractor_stops, &frames, NULL);
    double *stops = extraction_map(&extraction,
                                   extraction_map_index(&neph_extractor_stops, "stops"));
    neph_assert_close(stops[0], 1.0, 1e-15, 0.0);
    neph_assert_close(stops[1], -1.0, 1e-15, 0.0);
    neph_assert_close(stops[2], log2(2e-4 / 0x1p-10), 1e-14, 0.0);
    assert_true(stops[3] == 0.0);
    free(stops);
    neph_assert_close(pooled(&extraction, "stops_p50"), 1.0, 1e-15, 0.0);
    extraction_end(&extraction);

    float *planes[3];
    assert_true(neph_image_rgb(frames.reference, NULL, planes));
    for (int c = 0; c < 3; c++)
        memset(planes[c], 0, 4 * sizeof(float));
    assert_non_null(
        strstr(find_extractor_obstacle(&neph_extractor_stops, &frames), "not positive"));
    drop(&frames);
}

/* A black frame in the middle of a sequence has no values; it is not compared to a floor of 0. */
static void test_stops_of_a_black_frame(void **state)
{
    struct frames frames = grey(2, 1, (float[]){1, 1}, (float[]){2, 2});
    struct frames black = grey(2, 1, (float[]){0, 0}, (float[]){2, 2});
    struct neph_frame_pair first = make_frames_pair(&frames), second = make_frames_pair(&black);
    struct extraction extraction = extraction_begin(&neph_extractor_stops, &first, NULL);
    extraction_frame(&extraction, &second);
    double *stops = extraction_map(&extraction, 1);
    assert_true(isnan(stops[0]) && isnan(stops[1]));
    free(stops);
    extraction_end(&extraction);
    drop(&frames);
    drop(&black);
}

/* ---- SSIM ------------------------------------------------------------------------------------ */

static void test_identical_images(void **state)
{
    struct frames frames = made_up(180, 177, 9);
    float *from[3], *to[3];
    assert_true(neph_image_rgb(frames.reference, NULL, from));
    assert_true(neph_image_rgb(frames.test, NULL, to));
    for (int c = 0; c < 3; c++)
        memcpy(to[c], from[c], neph_image_pixel_count(frames.test) * sizeof(float));
    struct extraction extraction = run(&neph_extractor_ssim, &frames, NULL);
    assert_true(pooled(&extraction, "ssim_mean") == 1.0);
    assert_true(pooled(&extraction, "ssim_p5") == 1.0);
    assert_true(pooled(&extraction, "ms_ssim") == 1.0);
    extraction_end(&extraction);
    assert_true(measured(&neph_extractor_stops, &frames, NULL, "stops_p95") == 0.0);
    assert_true(measured(&neph_extractor_shift, &frames, NULL, "rmse_shift1") == 0.0);
    extraction = run(&neph_extractor_pu21, &frames, NULL);
    double *squares = extraction_map(&extraction, 0);
    for (size_t i = 0; i < neph_image_pixel_count(frames.test); i++)
        assert_true(squares[i] == 0.0);
    free(squares);
    extraction_end(&extraction);
    drop(&frames);
}

/* Flat images have no variance: SSIM is its luminance factor, a closed form of two codes. */
static void test_ssim_of_flat_images(void **state)
{
    enum { SIDE = 176 };
    float *values[2] = {malloc(SIDE * SIDE * sizeof(float)), malloc(SIDE * SIDE * sizeof(float))};
    assert_true(values[0] && values[1]);
    for (int i = 0; i < SIDE * SIDE; i++) {
        values[0][i] = 1.0f;
        values[1][i] = 0.25f;
    }
    struct frames frames = grey(SIDE, SIDE, values[0], values[1]);
    double x = pu21(100.0), y = pu21(25.0);
    double c1 = 2.56 * 2.56;
    double luminance = (2.0 * x * y + c1) / (x * x + y * y + c1);
    struct extraction extraction = run(&neph_extractor_ssim, &frames, NULL);
    neph_assert_close(pooled(&extraction, "ssim_mean"), luminance, 1e-11, 0.0);
    neph_assert_close(pooled(&extraction, "ms_ssim"), pow(luminance, 0.1333), 1e-11, 0.0);
    extraction_end(&extraction);
    drop(&frames);
    free(values[0]);
    free(values[1]);
}

static void test_ssim_is_symmetric(void **state)
{
    struct frames frames = made_up(181, 190, 11);
    double one_way = measured(&neph_extractor_ssim, &frames, NULL, "ssim_mean");
    double multiple = measured(&neph_extractor_ssim, &frames, NULL, "ms_ssim");
    struct neph_image *swapped = frames.reference;
    frames.reference = frames.test;
    frames.test = swapped;
    neph_assert_close(measured(&neph_extractor_ssim, &frames, NULL, "ssim_mean"), one_way, 1e-14,
                      0.0);
    neph_assert_close(measured(&neph_extractor_ssim, &frames, NULL, "ms_ssim"), multiple, 1e-14,
                      0.0);
    drop(&frames);
}

static void test_ssim_of_small_images(void **state)
{
    struct frames frames = made_up(10, 30, 12);
    assert_non_null(strstr(find_extractor_obstacle(&neph_extractor_ssim, &frames), "11x11"));
    drop(&frames);
    frames = made_up(11, 11, 13); /* one window */
    assert_null(find_extractor_obstacle(&neph_extractor_ssim, &frames));
    struct extraction extraction = run(&neph_extractor_ssim, &frames, NULL);
    size_t count;
    free(read_map_values(&extraction, 0, &count));
    assert_int_equal(count, 1);
    extraction_end(&extraction);
    drop(&frames);
    frames = made_up(175, 176, 14);
    extraction = run(&neph_extractor_ssim, &frames, NULL);
    double value = 0.0;
    assert_non_null(strstr(neph_extractor_ssim.scalar(extraction.state, 0, &value), "176"));
    extraction_end(&extraction);
    drop(&frames);
}

/* A negative image has a negative structure, which has no real power. */
static void test_ms_ssim_of_a_negative(void **state)
{
    enum { SIDE = 176 };
    double *images[2] = {malloc(SIDE * SIDE * sizeof(double)),
                         malloc(SIDE * SIDE * sizeof(double))};
    assert_true(images[0] && images[1]);
    uint64_t random = 3;
    for (int i = 0; i < SIDE * SIDE; i++) {
        images[0][i] = neph_test_uniform(&random, 0.0, 256.0);
        images[1][i] = 256.0 - images[0][i];
    }
    struct neph_structure first;
    const char *reason = NULL;
    double value = 0.0;
    neph_assert_ok(neph_structure_compare(images[0], images[1], NEPH_STRUCTURE_GAUSSIAN, SIDE, SIDE,
                                          256.0, NULL, &first, NULL),
                   NULL);
    assert_true(first.structure < 0.0);
    neph_assert_ok(
        neph_ms_ssim(images[0], images[1], SIDE, SIDE, 256.0, &first, &reason, &value, NULL), NULL);
    assert_non_null(strstr(reason, "negative"));
    assert_int_equal(neph_structure_compare(images[0], images[1], NEPH_STRUCTURE_GAUSSIAN, 10, 11,
                                            256.0, NULL, &first, NULL),
                     NEPH_ERR_INTERNAL);
    free(images[0]);
    free(images[1]);
}

/* ---- shift ----------------------------------------------------------------------------------- */

static double measure_shift_gain(const struct frames *frames)
{
    struct extraction extraction = run(&neph_extractor_shift, frames, NULL);
    size_t count;
    double *as_is = read_map_values(&extraction, 0, &count),
           *moved = read_map_values(&extraction, 1, &count);
    double as_is_sum = 0.0, moved_sum = 0.0;
    for (size_t i = 0; i < count; i++) {
        as_is_sum += as_is[i];
        moved_sum += moved[i];
    }
    free(as_is);
    free(moved);
    extraction_end(&extraction);
    return sqrt(moved_sum / as_is_sum);
}

enum { FIELD_WIDTH = 64, FIELD_HEIGHT = 48 };

/* A bright band from x = 20, `width_px` wide, shifted by `lean` px to the right per row. */
static void draw_band(float *values, int first_x, int width_px, double lean)
{
    for (int y = 0; y < FIELD_HEIGHT; y++) {
        for (int x = 0; x < FIELD_WIDTH; x++) {
            int across = x - first_x - (int)(lean * y);
            values[y * FIELD_WIDTH + x] = across >= 0 && across < width_px ? 3.0f : 1.0f;
        }
    }
}

static double gain_of_band(int reference_px, int test_px, int moved_px, double lean)
{
    float reference[FIELD_WIDTH * FIELD_HEIGHT], test[FIELD_WIDTH * FIELD_HEIGHT];
    draw_band(reference, 20, reference_px, lean);
    draw_band(test, 20 + moved_px, test_px, lean);
    struct frames frames = grey(FIELD_WIDTH, FIELD_HEIGHT, reference, test);
    double gain = measure_shift_gain(&frames);
    drop(&frames);
    return gain;
}

/* A band moved by n px is wrong over n px at each border; a shift corrects one of them: sqrt((n -
 * 1) / n). A band wider by n is wrong at one border. A missing band, or one of different
 * brightness, cannot be corrected by a shift. */
static void test_shift_tells_moved_from_wrong(void **state)
{
    for (int moved_px = -1; moved_px <= 1; moved_px += 2) {
        assert_true(gain_of_band(12, 12, moved_px, 0.0) == 0.0);
        assert_true(gain_of_band(12, 12, moved_px, 0.3) == 0.0);
        assert_true(gain_of_band(1, 1, moved_px, 0.7) == 0.0); /* a wire */
    }
    neph_assert_close(gain_of_band(12, 12, 2, 0.0), sqrt(1.0 / 2.0), 1e-14, 0.0);
    neph_assert_close(gain_of_band(12, 12, 5, 0.0), sqrt(4.0 / 5.0), 1e-14, 0.0);
    neph_assert_close(gain_of_band(12, 20, 0, 0.0), sqrt(7.0 / 8.0), 1e-14, 0.0);
    neph_assert_close(gain_of_band(12, 0, 0, 0.0), 1.0, 1e-14, 0.0);
    neph_assert_close(gain_of_band(1, 0, 0, 0.0), 1.0, 1e-14, 0.0);
    neph_assert_close(gain_of_band(1, 0, 0, 0.7), 1.0, 1e-14, 0.0);
}

/* Half the contrast at the right position, and a shift by one pixel under noise: the same two
 * extremes. */
static void test_shift_of_noisy_edges(void **state)
{
    float reference[FIELD_WIDTH * FIELD_HEIGHT], weak[FIELD_WIDTH * FIELD_HEIGHT],
        moved[FIELD_WIDTH * FIELD_HEIGHT];
    draw_band(reference, 20, 6, 0.4);
    draw_band(moved, 21, 6, 0.4);
    uint64_t random = 77;
    for (int i = 0; i < FIELD_WIDTH * FIELD_HEIGHT; i++) {
        double noise = neph_test_uniform(&random, -0.05, 0.05);
        weak[i] = (float)(1.0 + 0.5 * ((double)reference[i] - 1.0) + noise);
        moved[i] += (float)noise;
    }
    struct frames frames = grey(FIELD_WIDTH, FIELD_HEIGHT, reference, moved);
    double of_moved = measure_shift_gain(&frames);
    drop(&frames);
    frames = grey(FIELD_WIDTH, FIELD_HEIGHT, reference, weak);
    double of_weak = measure_shift_gain(&frames);
    drop(&frames);
    print_message("gain: moved %.3f, weak %.3f\n", of_moved, of_weak);
    /* Moved: only the noise of variance 0.1^2 / 12 remains of 2^2 on two pixels of each row. */
    assert_true(of_moved < 1.1 * sqrt(0.01 / 12.0 / (4.0 * 2.0 / FIELD_WIDTH)));
    assert_true(of_weak > 0.95);
}

/* All eight directions are found, up to the border, where the outermost pixels are repeated. */
static void test_every_move(void **state)
{
    enum { WIDTH = 29, HEIGHT = 19 };
    for (int dy = -1; dy <= 1; dy++) {
        for (int dx = -1; dx <= 1; dx++) {
            float reference[WIDTH * HEIGHT], test[WIDTH * HEIGHT];
            for (int y = 0; y < HEIGHT; y++) {
                for (int x = 0; x < WIDTH; x++) {
                    test[y * WIDTH + x] = (float)((x * 37 + y * 101 + x * y * 13) % 251);
                }
            }
            for (int y = 0; y < HEIGHT; y++) {
                for (int x = 0; x < WIDTH; x++) {
                    int from_x = x + dx < 0 ? 0 : x + dx >= WIDTH ? WIDTH - 1 : x + dx;
                    int from_y = y + dy < 0 ? 0 : y + dy >= HEIGHT ? HEIGHT - 1 : y + dy;
                    reference[y * WIDTH + x] = test[from_y * WIDTH + from_x];
                }
            }
            struct frames frames = grey(WIDTH, HEIGHT, reference, test);
            assert_true(measured(&neph_extractor_shift, &frames, NULL, "rmse_shift1") == 0.0);
            drop(&frames);
        }
    }
}

/* ---- two seeds ------------------------------------------------------------------------------- */

/* A known bias of 0.03 under noise of standard deviation 0.1 in the test and both references: the
 * product gives 0.03^2 plus the test's own variance; against the mean of both, half a seed's
 * variance more. Four standard errors of the mean of n products. */
static void test_two_seeds_remove_the_noise(void **state)
{
    enum { SIDE = 300, SAMPLES = 3 * SIDE * SIDE };
    const double sigma = 0.1, bias = 0.03;
    float *planes[3][3];
    struct frames frames = {.reference = blank(SIDE, SIDE, planes[0]),
                            .test = blank(SIDE, SIDE, planes[1]),
                            .second = blank(SIDE, SIDE, planes[2]),
                            .viewing = NEPH_VIEWING_DEFAULTS};
    uint64_t random = 4242;
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < SAMPLES; i++) {
            double normal = 0.0;
            for (int u = 0; u < 12; u++) /* variance 1 */
                normal += neph_test_uniform(&random, -0.5, 0.5);
            planes[k][i % 3][i / 3] = (float)(2.0 + (k == 1 ? bias : 0.0) + sigma * normal);
        }
    }
    double variance = sigma * sigma, four_errors = 4.0 * 2.0 * variance / sqrt(SAMPLES);
    neph_assert_close(measured(&neph_extractor_two_seed, &frames, NULL, "mse_unbiased"),
                      bias * bias + variance, 0.0, four_errors);
    neph_assert_close(measured(&neph_extractor_two_seed, &frames, NULL, "mse_mean_reference"),
                      bias * bias + 1.5 * variance, 0.0, four_errors);
    double noise = measured(&neph_extractor_two_seed, &frames, NULL, "reference_noise_rmse");
    neph_assert_close(noise * noise, variance, 0.0, four_errors);
    assert_false(neph_is_at_noise_floor(sqrt(bias * bias + variance), noise));
    assert_true(neph_is_at_noise_floor(bias, noise));
    drop(&frames);
}

static void test_two_seeds_by_hand(void **state)
{
    struct frames frames = grey(2, 1, (float[]){1, 2}, (float[]){2, 2});
    assert_non_null(
        strstr(find_extractor_obstacle(&neph_extractor_two_seed, &frames), "no second reference"));
    float *planes[3];
    frames.second = blank(2, 1, planes);
    for (int c = 0; c < 3; c++) {
        planes[c][0] = 3;
        planes[c][1] = 4;
    }
    assert_null(find_extractor_obstacle(&neph_extractor_two_seed, &frames));
    /* (2 - 1)(2 - 3) and (2 - 2)(2 - 4) */
    assert_true(measured(&neph_extractor_two_seed, &frames, NULL, "mse_unbiased") == -0.5);
    assert_true(measured(&neph_extractor_two_seed, &frames, NULL, "rmse_unbiased") == 0.0);
    assert_true(measured(&neph_extractor_two_seed, &frames, NULL, "mse_mean_reference") == 0.5);
    neph_assert_close(measured(&neph_extractor_two_seed, &frames, NULL, "reference_noise_rmse"),
                      sqrt(2.0), 1e-15, 0.0);

    struct neph_frame_pair pair = make_frames_pair(&frames);
    struct extraction extraction = extraction_begin(&neph_extractor_two_seed, &pair, NULL);
    planes[1][1] = INFINITY;
    struct neph_diag diag = {0};
    assert_int_equal(neph_extractor_two_seed.extract(extraction.state, &pair, &diag),
                     NEPH_ERR_GATE);
    assert_non_null(strstr(diag.message, "1 values of the second reference of frame 0"));
    pair.reference_second[0] = NULL;
    assert_int_equal(neph_extractor_two_seed.extract(extraction.state, &pair, NULL),
                     NEPH_ERR_INPUT);
    extraction_end(&extraction);
    drop(&frames);
}

/* ---- sizes ----------------------------------------------------------------------------------- */

/* Every extractor on images of one pixel, one row, one column and odd sizes. */
static void test_sizes(void **state)
{
    static const int sizes[][2] = {{1, 1}, {1, 9}, {9, 1}, {8, 8}, {7, 17}, {129, 3}, {131, 9}};
    for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++) {
        struct frames frames = made_up(sizes[i][0], sizes[i][1], 21 + i);
        double rmse_shift1 = measured(&neph_extractor_shift, &frames, NULL, "rmse_shift1");
        double squares = 0.0;
        struct extraction extraction = run(&neph_extractor_shift, &frames, NULL);
        size_t count;
        double *as_is = read_map_values(&extraction, 0, &count);
        for (size_t k = 0; k < count; k++)
            squares += as_is[k];
        free(as_is);
        extraction_end(&extraction);
        assert_true(rmse_shift1 * rmse_shift1 <= squares / (double)count * (1.0 + 1e-12));
        assert_true(isfinite(measured(&neph_extractor_stops, &frames, NULL, "stops_p95")));
        assert_true(isfinite(measured(&neph_extractor_pu21, &frames, NULL, "pu_psnr")));
        assert_true(isfinite(measured(&neph_extractor_two_seed, &frames, NULL, "mse_unbiased")));
        drop(&frames);
    }
}

/* ---- published formulas ---------------------------------------------------------------------- */

static double encode(double value)
{
    const double c = fmin(fmax(value, 0.0), 1.0);
    return c <= 0.0031308 ? 12.92 * c : 1.055 * pow(c, 1.0 / 2.4) - 0.055;
}

/* Sums over four pixels by hand; floats carry 6e-8. */
static void test_published_formulas(void **state)
{
    static const float r[4] = {0.0f, 0.5f, 2.0f, 0.001f}, x[4] = {0.1f, 0.4f, 2.2f, 0.001f};
    struct frames frames = grey(2, 2, r, x);
    double squares = 0.0;
    for (int i = 0; i < 4; i++)
        squares += pow(encode((double)x[i]) - encode((double)r[i]), 2.0) / 4.0;
    const struct {
        const char *metric;
        double value;
    } expected[] = {
        {"tev_rae", (0.1 / 0.01 + 0.1 / 0.51 + 0.2 / 2.01) / 4.0},
        {"tev_rse", (0.01 / 0.01 + 0.01 / 0.26 + 0.04 / 4.01) / 4.0},
        {"pbrt_mrse", (0.01 / 0.0001 + 0.01 / 0.2601 + 0.04 / 4.0401) / 4.0},
        {"smape", (0.1 / 0.11 + 0.1 / 0.91 + 0.2 / 4.21) / 4.0},
        {"srgb_psnr", -10.0 * log10(squares)},
    };
    for (size_t i = 0; i < sizeof(expected) / sizeof(expected[0]); i++)
        neph_assert_close(measured(&neph_extractor_published, &frames, NULL, expected[i].metric),
                          expected[i].value, 1e-6, 0.0);
    drop(&frames);
}

/* A reference of -0.02 has no relative error; the exposure changes only display values. */
static void test_published_limits(void **state)
{
    static const float r[2] = {-0.02f, 0.25f}, x[2] = {0.5f, 0.5f};
    struct frames frames = grey(2, 1, r, x);
    neph_assert_close(measured(&neph_extractor_published, &frames, NULL, "tev_rae"), 0.25 / 0.26,
                      1e-6, 0.0);
    frames.viewing.exposure_ev = 2.0; /* 0.25 is then white, as 0.5 is */
    neph_assert_close(measured(&neph_extractor_published, &frames, NULL, "srgb_psnr"),
                      10.0 * log10(2.0), 1e-6, 0.0);
    drop(&frames);
}

#include "tests/main.h"
