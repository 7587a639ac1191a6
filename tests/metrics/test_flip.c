/* SPDX-License-Identifier: MIT
 *
 * FLIP against a second implementation (flip_reference.py), against consequences of its definition,
 * and against known output of the public tool.
 */
#include "tests/metrics/extractor_test.h"

#include "base/sort.h"
#include "metrics/extractors/extractors.h"
#include "metrics/extractors/flip.h"
#include "metrics/meter.h"

#include <float.h>
#include <sched.h>

/* ---- images by exact rules, the same as in flip_reference.py --------------------------------- */

typedef double picture_rule(uint32_t x, uint32_t y, uint32_t c, uint32_t seed, bool test);

static uint32_t hash32(uint32_t x, uint32_t y, uint32_t c, uint32_t seed)
{
    uint32_t h = x * 374761393u + y * 668265263u + c * 2246822519u + seed * 3266489917u;
    h = (h ^ (h >> 13)) * 1274126177u;
    return h ^ (h >> 16);
}

static double unit(uint32_t h)
{
    return (h >> 8) * 0x1p-24;
}

static double noise(uint32_t x, uint32_t y, uint32_t c, uint32_t seed, bool test)
{
    return unit(hash32(x, y, c, seed + test));
}

static double near(uint32_t x, uint32_t y, uint32_t c, uint32_t seed, bool test)
{
    const bool differs = test && (hash32(x, y, c, seed + 1) & 1);
    return unit(hash32(x, y, c, seed) ^ (differs ? 0x300u : 0u));
}

static double dark(uint32_t x, uint32_t y, uint32_t c, uint32_t seed, bool test)
{
    return unit(hash32(x, y, c, seed)) * (test ? 0x1p-13 : 0x1p-14);
}

static double bright(uint32_t x, uint32_t y, uint32_t c, uint32_t seed, bool test)
{
    return unit(hash32(x, y, c, seed + test)) * 8.0;
}

static double wires(uint32_t x, uint32_t y, uint32_t c, uint32_t seed, bool test)
{
    (void)seed;
    const bool damaged = test && x % 2 == 0 && y % 2 == 0;
    return (3 * x + y) % 17 == 0 && !damaged ? 0.03125 : (x + 2 * y + 40 * c) / 1024.0;
}

static double huge(uint32_t x, uint32_t y, uint32_t c, uint32_t seed, bool test)
{
    return ldexp(unit(hash32(x, y, c, seed + test)), (int)(hash32(x, y, 0, seed) % 128));
}

static double night(uint32_t x, uint32_t y, uint32_t c, uint32_t seed, bool test)
{
    const bool lit = hash32(x, y, 0, seed) % 16 == 0;
    return lit ? unit(hash32(x, y, c, seed + test)) * 64.0 : 0.0;
}

static double sky(uint32_t x, uint32_t y, uint32_t c, uint32_t seed, bool test)
{
    (void)seed;
    const double dx = x - 9.0, dy = y - 8.0;
    return (dx * dx + dy * dy < 12.0 ? 4096.0 : 0.0) + (40 + 10 * c + 2 * (x + test) + y) / 64.0;
}

static double below_zero(uint32_t x, uint32_t y, uint32_t c, uint32_t seed, bool test)
{
    return unit(hash32(x, y, c, seed + test)) * 2.0 - 0.75;
}

struct expected {
    double mean, max, weighted_median, first, middle;
};

struct ldr_case {
    picture_rule *rule;
    int width_px, height_px;
    uint32_t seed;
    double pixels_per_degree;
    struct neph_flip_display display;
    struct expected expected;
};

struct hdr_case {
    picture_rule *rule;
    int width_px, height_px;
    uint32_t seed;
    double pixels_per_degree;
    int tone;
    double start_ev, stop_ev;
    int exposures;
    struct expected expected;
};

#include "tests/metrics/flip_reference.h"

enum { COUNT_OF_LDR = sizeof(ldr_cases) / sizeof(ldr_cases[0]) };

/* A pair of images, R G B planes. */
struct pictures {
    int width_px, height_px;
    float *planes[2][3];
};

static size_t pixel_count(const struct pictures *pictures)
{
    return (size_t)pictures->width_px * (size_t)pictures->height_px;
}

static struct pictures empty_pictures(int width_px, int height_px)
{
    struct pictures pictures = {.width_px = width_px, .height_px = height_px};
    for (int i = 0; i < 6; i++) {
        pictures.planes[i / 3][i % 3] = calloc(pixel_count(&pictures), sizeof(float));
        assert_non_null(pictures.planes[i / 3][i % 3]);
    }
    return pictures;
}

static struct pictures draw(picture_rule *rule, int width_px, int height_px, uint32_t seed)
{
    struct pictures pictures = empty_pictures(width_px, height_px);
    for (int test = 0; test < 2; test++)
        for (uint32_t c = 0; c < 3; c++)
            for (int i = 0; i < width_px * height_px; i++)
                pictures.planes[test][c][i] = (float)rule((uint32_t)(i % width_px),
                                                          (uint32_t)(i / width_px), c, seed, test);
    return pictures;
}

static void free_pictures(struct pictures *pictures)
{
    for (int i = 0; i < 6; i++)
        free(pictures->planes[i / 3][i % 3]);
}

/* NEPH_TEST_SEED, or the given seed; printed, so that a failure can be reproduced. */
static uint64_t test_seed(uint64_t usual)
{
    const char *wanted = getenv("NEPH_TEST_SEED");
    const uint64_t seed = wanted ? strtoull(wanted, NULL, 0) : usual;
    print_message("NEPH_TEST_SEED=%llu\n", (unsigned long long)seed);
    return seed;
}

/* ---- core ------------------------------------------------------------------------------------ */

/* The map for the caller to free; `first` 1: the images are swapped. */
static double *flip_of(const struct pictures *pictures, int first, double pixels_per_degree,
                       struct neph_flip_display display)
{
    struct neph_diag diag = {0};
    struct neph_flip *flip = NULL;
    double *map = calloc(pixel_count(pictures), sizeof(*map));
    assert_non_null(map);
    struct neph_arena memory = {0};
    neph_assert_ok(neph_flip_create(pixels_per_degree, &memory, &flip, &diag), &diag);
    neph_assert_ok(neph_flip_map(flip, pictures->width_px, pictures->height_px,
                                 (const float *const *)pictures->planes[first],
                                 (const float *const *)pictures->planes[!first], &display, 1, map,
                                 &diag),
                   &diag);
    neph_arena_finish(&memory);
    return map;
}

static struct expected facts_of(const double *map, int width_px, int height_px)
{
    const size_t count = (size_t)width_px * (size_t)height_px;
    double *sorted = malloc(count * sizeof(*sorted));
    assert_non_null(sorted);
    memcpy(sorted, map, count * sizeof(*sorted));
    neph_sort_doubles(sorted, count);
    double sum = 0.0, running = 0.0;
    for (size_t i = 0; i < count; i++)
        sum += sorted[i];
    struct expected facts = {
        .mean = sum / (double)count,
        .max = sorted[count - 1],
        .first = map[0],
        .middle = map[(size_t)(height_px / 2) * (size_t)width_px + (size_t)(width_px / 2)],
    };
    for (size_t i = 0; i < count && running <= 0.5 * sum; i++) {
        running += sorted[i];
        facts.weighted_median = sorted[i];
    }
    free(sorted);
    return facts;
}

/* Two evaluations in double precision, with 15 printed digits. The compared values are powers:
 * c^0.7 of a difference near rounding, and d^0.5 of features that are differences themselves. So a
 * flat image has features of sqrt(1e-16) = 1e-8, which change FLIP by a relative 1e-8 |log FLIP|.
 */
static void assert_facts(const struct expected *actual, const struct expected *expected)
{
    neph_assert_close(actual->mean, expected->mean, 1e-7, 0.0);
    neph_assert_close(actual->max, expected->max, 1e-7, 0.0);
    neph_assert_close(actual->weighted_median, expected->weighted_median, 1e-7, 0.0);
    neph_assert_close(actual->first, expected->first, 1e-7, 0.0);
    neph_assert_close(actual->middle, expected->middle, 1e-7, 0.0);
}

static void test_second_implementation(void **state)
{
    for (int i = 0; i < COUNT_OF_LDR; i++) {
        const struct ldr_case *it = &ldr_cases[i];
        struct pictures pictures = draw(it->rule, it->width_px, it->height_px, it->seed);
        double *map = flip_of(&pictures, 0, it->pixels_per_degree, it->display);
        const struct expected facts = facts_of(map, it->width_px, it->height_px);
        print_message("case %d: mean off by %.2g\n", i, facts.mean - it->expected.mean);
        assert_facts(&facts, &it->expected);
        free(map);
        free_pictures(&pictures);
    }
}

/* Grey on grey: no blur, no features, no chroma. HyAB is the difference of CIE lightness, here with
 * libm; 9 digits of the white leave a chroma of 1e-9 of the greys. */
static void test_uniform_greys(void **state)
{
    const double greys[] = {0.0, 0.001, 0.02, 0.18, 0.5, 1.0};
    struct pictures pictures = empty_pictures(5, 4);
    for (int i = 0; i < 36; i++) {
        double lightness[2];
        for (int test = 0; test < 2; test++) {
            const float grey = (float)greys[test ? i % 6 : i / 6];
            for (size_t p = 0; p < 3 * pixel_count(&pictures); p++)
                pictures.planes[test][p % 3][p / 3] = grey;
            const double y = (double)grey;
            lightness[test] =
                116.0 * (y > 216.0 / 24389.0 ? cbrt(y) : y * 841.0 / 108.0 + 4.0 / 29.0) - 16.0;
        }
        const double difference = pow(fabs(lightness[0] - lightness[1]), 0.7);
        const double largest = 41.27609841185736, knee = 0.4 * largest;
        const double expected = difference < knee
                                    ? difference / knee * 0.95
                                    : 0.95 + (difference - knee) / (largest - knee) * 0.05;
        double *map = flip_of(&pictures, 0, 67.0, (struct neph_flip_display){0.0, NEPH_FLIP_NONE});
        for (size_t p = 0; p < pixel_count(&pictures); p++)
            neph_assert_close(map[p], expected, 1e-7, 0.0);
        free(map);
    }
    free_pictures(&pictures);
}

/* ---- consequences of the definition ---------------------------------------------------------- */

static const double distances[] = {10.0, 30.0, 67.0206432765823, 131.7, 200.0};
static picture_rule *const rules[] = {noise, near,  dark, bright,    wires,
                                      huge,  night, sky,  below_zero};

struct draw {
    struct pictures pictures;
    double pixels_per_degree;
    struct neph_flip_display display;
};

static struct draw draw_any(uint64_t *random)
{
    struct draw any = {
        .pixels_per_degree = distances[neph_test_random(random) % 5],
        .display = {.exposure_ev = neph_test_uniform(random, -3.0, 3.0),
                    .tone = (enum neph_flip_tone)(neph_test_random(random) % 4)},
    };
    picture_rule *rule = rules[neph_test_random(random) % 9];
    const int width_px = 1 + (int)(neph_test_random(random) % 40);
    const int height_px = 1 + (int)(neph_test_random(random) % 30);
    any.pictures = draw(rule, width_px, height_px, (uint32_t)neph_test_random(random));
    return any;
}

static void test_properties(void **state)
{
    uint64_t random = test_seed(21);
    for (int i = 0; i < 60; i++) {
        struct draw any = draw_any(&random);
        const size_t bytes = pixel_count(&any.pictures) * sizeof(double);
        double *map = flip_of(&any.pictures, 0, any.pixels_per_degree, any.display);
        double *swapped = flip_of(&any.pictures, 1, any.pixels_per_degree, any.display);
        assert_memory_equal(map, swapped, bytes);
        for (size_t p = 0; p < pixel_count(&any.pictures); p++)
            assert_true(map[p] >= 0.0 && map[p] <= 1.0);

        for (int c = 0; c < 3; c++)
            memcpy(any.pictures.planes[1][c], any.pictures.planes[0][c],
                   pixel_count(&any.pictures) * sizeof(float));
        double *same = flip_of(&any.pictures, 0, any.pixels_per_degree, any.display);
        for (size_t p = 0; p < pixel_count(&any.pictures); p++)
            assert_true(same[p] == 0.0);
        free(map);
        free(swapped);
        free(same);
        free_pictures(&any.pictures);
    }
}

/* The same scene further right and lower: tiles, vectors and their tails are at other positions, so
 * equal bits mean that none of them matters. */
static double moved_noise(uint32_t x, uint32_t y, uint32_t c, uint32_t seed, bool test)
{
    return noise(x + 19, y + 11, c, seed, test);
}

static void test_tiles_do_not_show(void **state)
{
    enum { WIDTH = 300, HEIGHT = 290, DX = 19, DY = 11, MARGIN = 10 };
    const struct neph_flip_display display = {0.0, NEPH_FLIP_NONE};
    struct pictures whole = draw(noise, WIDTH + DX, HEIGHT + DY, 77);
    struct pictures moved = draw(moved_noise, WIDTH, HEIGHT, 77);
    double *whole_map = flip_of(&whole, 0, 67.0206432765823, display);
    double *moved_map = flip_of(&moved, 0, 67.0206432765823, display);
    for (size_t y = MARGIN; y < HEIGHT - MARGIN; y++)
        assert_memory_equal(whole_map + (y + DY) * (WIDTH + DX) + DX + MARGIN,
                            moved_map + y * WIDTH + MARGIN, (WIDTH - 2 * MARGIN) * sizeof(double));
    free(whole_map);
    free(moved_map);
    free_pictures(&whole);
    free_pictures(&moved);
}

/* Several displays at once: the largest of their values at each pixel, to the bit. */
static void test_largest_of_displays(void **state)
{
    const struct neph_flip_display displays[] = {
        {-4.0, NEPH_FLIP_ACES}, {-1.0, NEPH_FLIP_ACES}, {1.0, NEPH_FLIP_REINHARD}};
    struct pictures pictures = draw(bright, 210, 37, 88);
    const size_t count = pixel_count(&pictures);
    double *single[3], *together = calloc(count, sizeof(*together));
    assert_non_null(together);
    struct neph_flip *flip = NULL;
    struct neph_diag diag = {0};
    struct neph_arena memory = {0};
    neph_assert_ok(neph_flip_create(67.0, &memory, &flip, &diag), &diag);
    neph_assert_ok(neph_flip_map(flip, pictures.width_px, pictures.height_px,
                                 (const float *const *)pictures.planes[0],
                                 (const float *const *)pictures.planes[1], displays, 3, together,
                                 &diag),
                   &diag);
    neph_arena_finish(&memory);
    int chosen[3] = {0};
    for (int i = 0; i < 3; i++)
        single[i] = flip_of(&pictures, 0, 67.0, displays[i]);
    for (size_t p = 0; p < count; p++) {
        assert_true(together[p] == fmax(fmax(single[0][p], single[1][p]), single[2][p]));
        for (int i = 0; i < 3; i++)
            chosen[i] += together[p] == single[i][p];
    }
    for (int i = 0; i < 3; i++) {
        assert_true(chosen[i] > 0); /* otherwise the test has no power */
        free(single[i]);
    }
    free(together);
    free_pictures(&pictures);
}

static void test_threads_do_not_show(void **state)
{
    cpu_set_t all, one;
    assert_int_equal(sched_getaffinity(0, sizeof(all), &all), 0);
    CPU_ZERO(&one);
    for (int cpu = 0; cpu < CPU_SETSIZE && CPU_COUNT(&one) == 0; cpu++)
        if (CPU_ISSET(cpu, &all))
            CPU_SET(cpu, &one);
    const struct neph_flip_display display = {0.0, NEPH_FLIP_ACES};
    struct pictures pictures = draw(sky, 530, 270, 78);
    double *many = flip_of(&pictures, 0, 40.0, display);
    assert_int_equal(sched_setaffinity(0, sizeof(one), &one), 0);
    double *alone = flip_of(&pictures, 0, 40.0, display);
    assert_int_equal(sched_setaffinity(0, sizeof(all), &all), 0);
    assert_memory_equal(many, alone, pixel_count(&pictures) * sizeof(double));
    free(many);
    free(alone);
    free_pictures(&pictures);
}

static void test_distance_out_of_range(void **state)
{
    const double bad[] = {0.0, -67.0, 0.99, 1000.1, INFINITY, NAN};
    for (int i = 0; i < 6; i++) {
        struct neph_flip *flip = NULL;
        struct neph_arena memory = {0};
        struct neph_diag diag = {0};
        assert_int_equal(neph_flip_create(bad[i], &memory, &flip, &diag), NEPH_ERR_INPUT);
        assert_null(flip);
        assert_non_null(strstr(diag.message, "outside 1..1000"));
    }
}

/* ---- extractors ------------------------------------------------------------------------------ */

/* A pair of frames with these images; free_images() after it. */
static struct neph_frame_pair pair_of(const struct pictures *pictures, int frame,
                                      const struct neph_viewing *viewing)
{
    struct neph_image *images[2];
    struct neph_diag diag = {0};
    for (int i = 0; i < 2; i++) {
        float *planes[3];
        neph_assert_ok(
            neph_image_create(pictures->width_px, pictures->height_px, &images[i], &diag), &diag);
        neph_assert_ok(neph_image_add_rgb(images[i], NULL, planes, &diag), &diag);
        for (int c = 0; c < 3; c++)
            memcpy(planes[c], pictures->planes[i][c], pixel_count(pictures) * sizeof(float));
    }
    return extraction_pair(images[0], NULL, images[1], "radiance", frame, viewing);
}

static void free_images(struct neph_frame_pair *pair)
{
    neph_image_destroy((struct neph_image *)pair->reference_image);
    neph_image_destroy((struct neph_image *)pair->test_image);
}

static void test_tables(void **state)
{
    extraction_check_table(&neph_extractor_flip);
    extraction_check_table(&neph_extractor_flip40);
    extraction_check_table(&neph_extractor_hdr_flip);
    extraction_check_table(&neph_extractor_flip_alternation);
}

/* The map of a single-frame extractor for a pair, for the caller to free. */
static double *still_map(const struct neph_extractor *extractor, const struct pictures *pictures,
                         struct neph_viewing viewing, const char *const *assignments)
{
    struct neph_frame_pair pair = pair_of(pictures, 0, &viewing);
    struct extraction extraction = extraction_begin(extractor, &pair, assignments);
    extraction_frame(&extraction, &pair);
    double *map = extraction_map(&extraction, 0);
    extraction_end(&extraction);
    free_images(&pair);
    return map;
}

static void test_extractors_take_their_conditions(void **state)
{
    struct pictures pictures = draw(bright, 45, 31, 79);
    const size_t bytes = pixel_count(&pictures) * sizeof(double);
    struct neph_viewing viewing = NEPH_VIEWING_DEFAULTS;
    viewing.exposure_ev = -1.5;
    const struct neph_flip_display plain = {-1.5, NEPH_FLIP_NONE}, hable = {-1.5, NEPH_FLIP_HABLE};
    const struct {
        const struct neph_extractor *extractor;
        const char *assignments[2];
        double *expected;
    } cases[] = {
        {&neph_extractor_flip, {NULL}, flip_of(&pictures, 0, viewing.pixels_per_degree, plain)},
        {&neph_extractor_flip40, {NULL}, flip_of(&pictures, 0, 40.0, plain)},
        {&neph_extractor_flip40, {"tone=hable"}, flip_of(&pictures, 0, 40.0, hable)},
    };
    for (int i = 0; i < 3; i++) {
        double *map = still_map(cases[i].extractor, &pictures, viewing, cases[i].assignments);
        assert_memory_equal(map, cases[i].expected, bytes);
        free(map);
        free(cases[i].expected);
    }
    free_pictures(&pictures);
}

/* ---- HDR-FLIP -------------------------------------------------------------------------------- */

static void test_hdr_second_implementation(void **state)
{
    for (size_t i = 0; i < sizeof(hdr_cases) / sizeof(hdr_cases[0]); i++) {
        const struct hdr_case *it = &hdr_cases[i];
        struct pictures pictures = draw(it->rule, it->width_px, it->height_px, it->seed);
        struct neph_viewing viewing = NEPH_VIEWING_DEFAULTS;
        viewing.pixels_per_degree = it->pixels_per_degree;
        struct neph_frame_pair pair = pair_of(&pictures, 0, &viewing);
        char tone[32];
        snprintf(tone, sizeof(tone), "tone=%s", neph_flip_tones[it->tone]);
        struct extraction extraction = extraction_begin(&neph_extractor_hdr_flip, &pair,
                                                        (const char *[]){tone, NULL});
        extraction_frame(&extraction, &pair);
        /* Luminance sums of three products in another order: 1e-15 relative, and the same for the
         * stops. */
        neph_assert_close(extraction_scalar(&extraction, "hdr_flip_start_ev"), it->start_ev, 0.0,
                          1e-13);
        neph_assert_close(extraction_scalar(&extraction, "hdr_flip_stop_ev"), it->stop_ev, 0.0,
                          1e-13);
        assert_true(extraction_scalar(&extraction, "hdr_flip_exposures") == it->exposures);
        double *map = extraction_map(&extraction, 0);
        const struct expected facts = facts_of(map, it->width_px, it->height_px);
        assert_facts(&facts, &it->expected);
        free(map);
        extraction_end(&extraction);
        free_images(&pair);
        free_pictures(&pictures);
    }
}

/* The published values have single precision: a few units of 2^-24. */
static void test_tone_inverses(void **state)
{
    const double published[] = {
        [NEPH_FLIP_NONE] = 0.85,
        [NEPH_FLIP_ACES] = 2.118872,
        [NEPH_FLIP_REINHARD] = 5.666667,
        [NEPH_FLIP_HABLE] = 3.127750,
    };
    for (int tone = 0; neph_flip_tones[tone]; tone++)
        neph_assert_close(neph_flip_tone_inverse((enum neph_flip_tone)tone, 0.85), published[tone],
                          8 * 0x1p-24, 0.0);
}

/* NVlabs/flip 1.6 reports success with a mean of 0 here, as its exposure range is infinite. */
static void test_median_of_zero_is_no_agreement(void **state)
{
    struct pictures pictures = draw(night, 40, 25, 35);
    double *map = still_map(&neph_extractor_hdr_flip, &pictures, NEPH_VIEWING_DEFAULTS, NULL);
    const struct expected facts = facts_of(map, 40, 25);
    assert_true(facts.mean > 0.1);
    free(map);
    free_pictures(&pictures);
}

static void test_hdr_obstacles(void **state)
{
    struct pictures black = empty_pictures(4, 3);
    const struct neph_viewing viewing = NEPH_VIEWING_DEFAULTS;
    struct neph_frame_pair pair = pair_of(&black, 0, &viewing);
    const struct neph_extractor *extractor = &neph_extractor_hdr_flip;
    struct neph_settings settings = neph_options_default(extractor->options);
    struct neph_diag diag = {0};
    assert_non_null(strstr(extractor->obstacle(&pair, &settings), "no positive luminance"));
    neph_assert_ok(neph_options_set(extractor->options, "x", "start_ev=2", &settings, &diag),
                   &diag);
    assert_non_null(strstr(extractor->obstacle(&pair, &settings), "no positive luminance"));
    neph_assert_ok(neph_options_set(extractor->options, "x", "stop_ev=0", &settings, &diag), &diag);
    assert_non_null(strstr(extractor->obstacle(&pair, &settings), "not below stop_ev"));
    neph_assert_ok(neph_options_set(extractor->options, "x", "stop_ev=5", &settings, &diag), &diag);
    assert_null(extractor->obstacle(&pair, &settings));
    free_images(&pair);
    free_pictures(&black);
}

static void test_exposures_are_frozen(void **state)
{
    struct pictures first = draw(bright, 20, 12, 81), second = draw(bright, 20, 12, 82);
    for (size_t i = 0; i < 3 * pixel_count(&second); i++)
        second.planes[0][i % 3][i / 3] *= 64.0f;
    const struct neph_viewing viewing = NEPH_VIEWING_DEFAULTS;
    struct neph_frame_pair pairs[2] = {pair_of(&first, 0, &viewing), pair_of(&second, 1, &viewing)};
    struct extraction run = extraction_begin(&neph_extractor_hdr_flip, &pairs[0], NULL);
    extraction_frame(&run, &pairs[0]);
    const double start_ev = extraction_scalar(&run, "hdr_flip_start_ev");
    const double stop_ev = extraction_scalar(&run, "hdr_flip_stop_ev");
    extraction_frame(&run, &pairs[1]);
    assert_true(extraction_scalar(&run, "hdr_flip_start_ev") == start_ev);
    double *frozen = extraction_map(&run, 0);

    char start[64], stop[64];
    snprintf(start, sizeof(start), "start_ev=%.17g", start_ev);
    snprintf(stop, sizeof(stop), "stop_ev=%.17g", stop_ev);
    double *given = still_map(&neph_extractor_hdr_flip, &second, viewing,
                              (const char *[]){start, stop, "exposures=2", NULL});
    double *own = still_map(&neph_extractor_hdr_flip, &second, viewing, NULL);
    assert_memory_equal(frozen, given, pixel_count(&second) * sizeof(double));
    assert_memory_not_equal(frozen, own, pixel_count(&second) * sizeof(double));
    free(frozen);
    free(given);
    free(own);
    extraction_end(&run);
    for (int i = 0; i < 2; i++)
        free_images(&pairs[i]);
    free_pictures(&first);
    free_pictures(&second);
}

/* A missing exposure follows the rule; 0 EV is a given exposure. */
static void test_one_exposure_is_enough(void **state)
{
    struct pictures pictures = draw(bright, 20, 12, 81);
    const struct neph_viewing viewing = NEPH_VIEWING_DEFAULTS;
    struct neph_frame_pair pair = pair_of(&pictures, 0, &viewing);
    struct extraction rule = extraction_begin(&neph_extractor_hdr_flip, &pair, NULL);
    const double start_ev = extraction_scalar(&rule, "hdr_flip_start_ev");
    const double stop_ev = extraction_scalar(&rule, "hdr_flip_stop_ev");
    assert_true(start_ev < 0.0 && stop_ev > start_ev);
    const struct {
        const char *given[3];
        double start_ev, stop_ev;
    } cases[] = {
        {{"stop_ev=7"}, start_ev, 7.0},
        {{"start_ev=-20"}, -20.0, stop_ev},
        {{"stop_ev=0", "start_ev=-3"}, -3.0, 0.0},
        {{"stop_ev=9", "start_ev=0"}, 0.0, 9.0},
        {{"stop_ev=9", "stop_ev=auto"}, start_ev, stop_ev},
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        struct extraction run = extraction_begin(&neph_extractor_hdr_flip, &pair, cases[i].given);
        assert_true(extraction_scalar(&run, "hdr_flip_start_ev") == cases[i].start_ev);
        assert_true(extraction_scalar(&run, "hdr_flip_stop_ev") == cases[i].stop_ev);
        extraction_end(&run);
    }
    struct neph_settings settings = neph_options_default(neph_extractor_hdr_flip.options);
    struct neph_diag diag = {0};
    neph_assert_ok(
        neph_options_set(neph_extractor_hdr_flip.options, "x", "start_ev=100", &settings, &diag),
        &diag);
    void *opaque = calloc(1, neph_extractor_hdr_flip.state_size);
    assert_int_equal(neph_extractor_hdr_flip.init(opaque, &pair, &settings, &diag), NEPH_ERR_INPUT);
    assert_non_null(strstr(diag.message, "from 100 EV down to"));
    free(opaque);
    extraction_end(&rule);
    free_images(&pair);
    free_pictures(&pictures);
}

/* Light below zero is black, before any curve: the tool's curves make it bright (aces gives 0.675
 * for -0.3). With given exposures, so that the reference's luminances have no effect. */
static void test_negative_light_is_black(void **state)
{
    static const char *const tones[] = {"tone=none", "tone=aces", "tone=reinhard", "tone=hable"};
    struct pictures pictures = draw(below_zero, 33, 21, 84), clamped = draw(below_zero, 33, 21, 84);
    for (size_t i = 0; i < 6 * pixel_count(&clamped); i++) {
        float *value = &clamped.planes[i % 6 / 3][i % 3][i / 6];
        *value = *value < 0.0f ? 0.0f : *value;
    }
    for (size_t t = 0; t < COUNT(tones); t++) {
        const char *const settings[] = {"start_ev=-2", "stop_ev=3", tones[t], NULL};
        double *map = still_map(&neph_extractor_hdr_flip, &pictures, NEPH_VIEWING_DEFAULTS,
                                settings);
        double *expected = still_map(&neph_extractor_hdr_flip, &clamped, NEPH_VIEWING_DEFAULTS,
                                     settings);
        assert_memory_equal(map, expected, pixel_count(&pictures) * sizeof(double));
        free(map);
        free(expected);
    }
    free_pictures(&pictures);
    free_pictures(&clamped);
}

/* The exposures are the reference's, so reference and test cannot be swapped. The unit of radiance
 * has no effect: 16 times as bright is 4 stops less, to the bit. */
static void test_hdr_symmetries(void **state)
{
    struct pictures pictures = draw(sky, 41, 23, 83);
    const size_t bytes = pixel_count(&pictures) * sizeof(double);
    for (size_t i = 0; i < pixel_count(&pictures); i++)
        pictures.planes[1][0][i] *= 1.5f;
    double *map = still_map(&neph_extractor_hdr_flip, &pictures, NEPH_VIEWING_DEFAULTS, NULL);
    for (int i = 0; i < 6; i++)
        for (size_t p = 0; p < pixel_count(&pictures); p++)
            pictures.planes[i / 3][i % 3][p] *= 16.0f;
    double *brighter = still_map(&neph_extractor_hdr_flip, &pictures, NEPH_VIEWING_DEFAULTS, NULL);
    for (size_t p = 0; p < pixel_count(&pictures); p++)
        neph_assert_close(brighter[p], map[p], 1e-9, 0.0); /* log2 and back: 1e-15 of exposure */
    for (int c = 0; c < 3; c++) {
        float *plane = pictures.planes[0][c];
        pictures.planes[0][c] = pictures.planes[1][c];
        pictures.planes[1][c] = plane;
    }
    double *swapped = still_map(&neph_extractor_hdr_flip, &pictures, NEPH_VIEWING_DEFAULTS, NULL);
    const double mean = facts_of(brighter, 41, 23).mean;
    assert_true(fabs(facts_of(swapped, 41, 23).mean - mean) > 1e-4 * mean);
    assert_memory_not_equal(swapped, brighter, bytes);
    free(map);
    free(brighter);
    free(swapped);
    free_pictures(&pictures);
}

/* ---- FLIP between frames --------------------------------------------------------------------- */

/* Runs frames[0 .. frame_count - 1] (indices of images; -1 as reference: the first one's). */
static struct extraction run_sequence(const struct pictures *pictures, const int *test,
                                      const int *reference, int frame_count,
                                      const struct neph_viewing *viewing, const char *cycles)
{
    struct extraction run = {0};
    for (int i = 0; i < frame_count; i++) {
        struct pictures frame = pictures[0];
        for (int c = 0; c < 3; c++) {
            frame.planes[0][c] = pictures[reference[i]].planes[0][c];
            frame.planes[1][c] = pictures[test[i]].planes[0][c];
        }
        struct neph_frame_pair pair = pair_of(&frame, i, viewing);
        if (i == 0)
            run = extraction_begin(&neph_extractor_flip_alternation, &pair,
                                   (const char *[]){cycles, NULL});
        extraction_frame(&run, &pair);
        free_images(&pair);
    }
    extraction_flush(&run);
    return run;
}

/* The expected map number `map` of the extractor: `share` times FLIP of images 0 and 1. */
static void assert_share(const struct extraction *run, int map, const double *pair_map,
                         double share)
{
    double *values = extraction_map(run, map);
    for (int i = 0; i < run->width_px * run->height_px; i++)
        neph_assert_close(values[i], share * pair_map[i], 1e-15, 0.0);
    free(values);
}

static void test_alternation(void **state)
{
    const struct neph_viewing viewing = NEPH_VIEWING_DEFAULTS;
    struct pictures pictures[2] = {draw(noise, 21, 13, 84), draw(noise, 21, 13, 86)};
    struct pictures both = pictures[0];
    for (int c = 0; c < 3; c++)
        both.planes[1][c] = pictures[1].planes[0][c];
    double *flip = flip_of(&both, 0, viewing.pixels_per_degree,
                           (struct neph_flip_display){0.0, NEPH_FLIP_NONE});
    const struct {
        int test[10], reference[10], frame_count;
        const char *cycles;
        double shares[4]; /* 1 apart, 2 apart, and of the reference itself */
    } cases[] = {
        {{0, 1, 0, 1, 0, 1}, {0}, 6, "cycles=1", {1.0, 0.0, 0.0, 0.0}},
        {{0, 0, 1, 1, 0, 0}, {0}, 6, "cycles=1", {0.5, 1.0, 0.0, 0.0}},
        {{0, 0, 0, 1, 0, 0}, {0}, 6, "cycles=1", {0.5, 0.5, 0.0, 0.0}},
        {{0, 0, 0, 1, 0, 0, 1, 0, 1, 1}, {0}, 10, "cycles=1", {0.5, 0.5, 0.0, 0.0}},
        {{0, 0, 0, 1, 0, 0, 0, 1, 0, 0}, {0}, 10, "cycles=2", {0.5, 0.5, 0.0, 0.0}},
        {{0, 1, 0, 1, 0, 1}, {0, 1, 0, 1, 0, 1}, 6, "cycles=1", {0.0, 0.0, 1.0, 0.0}},
        {{0, 0, 0, 0, 0, 0}, {0, 1, 1, 0, 0, 1}, 6, "cycles=1", {-0.5, -1.0, 0.5, 1.0}},
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        struct extraction run = run_sequence(pictures, cases[i].test, cases[i].reference,
                                             cases[i].frame_count, &viewing, cases[i].cycles);
        for (int map = 0; map < 4; map++)
            assert_share(&run, map, flip, cases[i].shares[map]);
        extraction_end(&run);
    }
    free(flip);
    for (int i = 0; i < 2; i++)
        free_pictures(&pictures[i]);
}

static void test_a_short_sequence_is_an_obstacle(void **state)
{
    const struct neph_viewing viewing = NEPH_VIEWING_DEFAULTS;
    const struct neph_settings settings = neph_options_default(
        neph_extractor_flip_alternation.options);
    struct pictures pictures = empty_pictures(2, 2);
    struct neph_frame_pair pair = pair_of(&pictures, 0, &viewing);
    for (int frame_count = 0; frame_count < 9; frame_count++) { /* 0: not known beforehand */
        pair.frame_count = frame_count;
        const char *obstacle = neph_extractor_flip_alternation.obstacle(&pair, &settings);
        assert_true((obstacle != NULL) == (frame_count > 0 && frame_count < 6));
    }
    free_images(&pair);
    free_pictures(&pictures);
}

static void test_alternation_needs_whole_cycles(void **state)
{
    const struct neph_viewing viewing = NEPH_VIEWING_DEFAULTS;
    struct pictures pictures[2] = {draw(noise, 5, 3, 87), draw(noise, 5, 3, 89)};
    const int test[9] = {0, 1, 0, 1, 0, 1, 0, 1, 0}, reference[9] = {0};
    const struct {
        int frame_count;
        const char *cycles;
        bool has_1, has_2;
    } cases[] = {
        {1, "cycles=1", false, false}, {4, "cycles=1", false, false}, {5, "cycles=1", true, false},
        {6, "cycles=1", true, true},   {8, "cycles=2", false, false}, {9, "cycles=2", true, false},
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        struct extraction run = run_sequence(pictures, test, reference, cases[i].frame_count,
                                             &viewing, cases[i].cycles);
        double *one = extraction_map(&run, 0), *two = extraction_map(&run, 1);
        for (int p = 0; p < 15; p++) {
            assert_true(isnan(one[p]) == !cases[i].has_1);
            assert_true(isnan(two[p]) == !cases[i].has_2);
        }
        free(one);
        free(two);
        extraction_end(&run);
    }
    for (int i = 0; i < 2; i++)
        free_pictures(&pictures[i]);
}

/* ---- through the meter ----------------------------------------------------------------------- */

/* The values of extractor flip over the whole frame. */
static struct neph_meter *measure(const struct pictures *pictures, double pixels_per_degree)
{
    struct neph_viewing viewing = NEPH_VIEWING_DEFAULTS;
    viewing.pixels_per_degree = pixels_per_degree;
    struct neph_frame_pair pair = pair_of(pictures, 0, &viewing);
    struct neph_mask *mask = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_mask_create(pair.reference_image, "all", NULL, &mask, &diag), &diag);
    const struct neph_meter_choice choice = {&neph_extractor_flip,
                                             neph_options_default(neph_extractor_flip.options)};
    const struct neph_meter_params params = {
        .choices = &choice,
        .choice_count = 1,
        .viewing = viewing,
        .masks = (const struct neph_mask *const[]){mask},
        .mask_count = 1,
    };
    struct neph_meter *meter = NULL;
    neph_assert_ok(neph_meter_create(&params, &meter, &diag), &diag);
    neph_assert_ok(neph_meter_frame(meter, pair.reference_image, NULL, pair.test_image, &diag),
                   &diag);
    neph_mask_destroy(mask);
    free_images(&pair);
    return meter;
}

static const struct neph_measurement *measured(const struct neph_meter *meter, const char *name)
{
    int count = 0;
    const struct neph_measurement *all = neph_meter_measurements(meter, &count);
    for (int i = 0; i < count; i++)
        if (strcmp(all[i].metric->name, name) == 0)
            return &all[i];
    fail_msg("no measurement '%s'", name);
    return NULL;
}

static void test_numbers_through_the_meter(void **state)
{
    for (int i = 0; i < COUNT_OF_LDR; i++) {
        const struct ldr_case *it = &ldr_cases[i];
        if (it->display.exposure_ev != 0.0 || it->display.tone != NEPH_FLIP_NONE)
            continue;
        struct pictures pictures = draw(it->rule, it->width_px, it->height_px, it->seed);
        struct neph_meter *meter = measure(&pictures, it->pixels_per_degree);
        neph_assert_close(measured(meter, "flip_mean")->value, it->expected.mean, 1e-7, 0.0);
        /* Order statistics are stored as floats: half a unit in the last place more. */
        neph_assert_close(measured(meter, "flip_max")->value, it->expected.max, 2e-7, 0.0);
        neph_assert_close(measured(meter, "flip_wmedian")->value, it->expected.weighted_median,
                          2e-7, 0.0);
        neph_meter_destroy(meter);
        free_pictures(&pictures);
    }
}

/* idiff of OpenImageIO 2.4.7 passes such an image, and FLIP's tool turns NaN into black. */
static void test_not_a_number_is_not_black(void **state)
{
    struct pictures pictures = draw(noise, 16, 9, 90);
    pictures.planes[1][1][37] = NAN;
    struct neph_meter *meter = measure(&pictures, 67.0);
    const struct neph_measurement *mean = measured(meter, "flip_mean");
    assert_false(mean->defined);
    assert_non_null(mean->undefined_because);
    assert_true(mean->bad_count == 1);
    neph_meter_destroy(meter);
    free_pictures(&pictures);
}

/* Dark wires before a bright sky, with half of their pixels missing. */
static double broken_wires(uint32_t x, uint32_t y, uint32_t c, uint32_t seed, bool test)
{
    (void)seed;
    const double behind = 0.3 + 0.1 * c + 0.001 * y;
    const bool wire = x % 40 == 20 && !(test && y % 2 == 0);
    return wire ? 0.02 : behind;
}

/* Every wire is damaged, and the mean is below the 0.05 at which FLIP's tool fails a test. Closer
 * to the screen (fewer pixels per degree) the damage is more visible, yet the mean decreases. */
static void test_a_mean_hides_wires(void **state)
{
    struct pictures pictures = draw(broken_wires, 160, 90, 0);
    struct neph_meter *usual_meter = measure(&pictures, 67.0206432765823);
    struct neph_meter *close_meter = measure(&pictures, 30.0);
    const double usual_mean = measured(usual_meter, "flip_mean")->value;
    const double usual_median = measured(usual_meter, "flip_wmedian")->value;
    const double close_mean = measured(close_meter, "flip_mean")->value;
    const double close_median = measured(close_meter, "flip_wmedian")->value;
    print_message("67 ppd: mean %.4f, weighted median %.4f; 30 ppd: %.4f, %.4f\n", usual_mean,
                  usual_median, close_mean, close_median);
    assert_true(usual_mean < 0.05 && usual_median > 4.0 * usual_mean);
    assert_true(close_mean < usual_mean && close_median > usual_median);
    neph_meter_destroy(usual_meter);
    neph_meter_destroy(close_meter);
    free_pictures(&pictures);
}

#include "tests/main.h"
