/* SPDX-License-Identifier: MIT
 *
 * FLIP against a second implementation (flip_reference.py), against what follows from its
 * definition, and against what the public tool is known to print.
 */
#include "tests/metrics/extractor_test.h"

#include "metrics/flip.h"

#include <float.h>
#include <sched.h>

/* ---- pictures by exact rules, the same as in flip_reference.py --------------------------------
 */

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

/* A pair of pictures, R G B planes. */
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

/* ---- the core ---------------------------------------------------------------------------------
 */

/* The map for the caller to free; `first` 1: the pictures change places. */
static double *flip_of(const struct pictures *pictures, int first, double pixels_per_degree,
                       struct neph_flip_display display)
{
    struct neph_diag diag = {0};
    struct neph_flip *flip = NULL;
    double *map = calloc(pixel_count(pictures), sizeof(*map));
    assert_non_null(map);
    neph_assert_ok(neph_flip_create(pixels_per_degree, &flip, &diag), &diag);
    neph_assert_ok(neph_flip_map(flip, pictures->width_px, pictures->height_px,
                                 (const float *const *)pictures->planes[first],
                                 (const float *const *)pictures->planes[!first], &display, false,
                                 map, &diag),
                   &diag);
    neph_flip_destroy(flip);
    return map;
}

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static struct expected facts_of(const double *map, int width_px, int height_px)
{
    const size_t count = (size_t)width_px * (size_t)height_px;
    double *sorted = malloc(count * sizeof(*sorted));
    assert_non_null(sorted);
    memcpy(sorted, map, count * sizeof(*sorted));
    qsort(sorted, count, sizeof(*sorted), compare);
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

/* Two evaluations in double precision, of 15 printed digits. What is compared are powers: of a
 * difference near rounding, c^0.7, and of features that are differences themselves, d^0.5, so a
 * flat place has features of sqrt(1e-16) = 1e-8, which move FLIP by 1e-8 |log FLIP| of itself. */
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
    (void)state;
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_second_implementation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
