/* SPDX-License-Identifier: MIT
 *
 * Noise or bias: closed forms, and false alarms and power over simulated renders.
 */
#include "tests/neph_test.h"

#include "metrics/significance.h"
#include "metrics/z_test.h"

enum { W = 32, H = 32, P = W * H, PAIRS = 1000, SEED = 20261129 };

/* ---- closed forms ---------------------------------------------------------------------------- */

/* Even degrees of freedom: Poisson's sum e^-x (1 + x + x^2/2 + ...). */
static double chi_squared_by_poisson(double value, int dof)
{
    double term = exp(-0.5 * value), sum = 0.0;
    for (int i = 0; i < dof / 2; i++) {
        sum += term;
        term *= 0.5 * value / (i + 1);
    }
    return sum;
}

/* Quantiles: NIST/SEMATECH e-Handbook, 1.3.6.7.4. */
static void test_chi_squared(void **state)
{
    neph_assert_close(neph_chi_squared_p(3.841458820694124, 1.0), 0.05, 1e-12, 0.0);
    neph_assert_close(neph_chi_squared_p(18.307038053275146, 10.0), 0.05, 1e-12, 0.0);
    neph_assert_close(neph_chi_squared_p(124.342113404004, 100.0), 0.05, 1e-11, 0.0);
    neph_assert_close(neph_chi_squared_p(9.210340371976182, 2.0), 0.01, 1e-12, 0.0);
    neph_assert_close(neph_chi_squared_p(6.25, 1.0), neph_normal_p(2.5), 1e-12, 0.0);
    assert_true(neph_chi_squared_p(0.0, 5.0) == 1.0);
    for (int dof = 2; dof < 1000; dof = 3 * dof + 2)
        for (double ratio = 0.3; ratio < 1.5; ratio += 0.2)
            neph_assert_close(neph_chi_squared_p(ratio * dof, dof),
                              chi_squared_by_poisson(ratio * dof, dof), 1e-10, 1e-14);
    /* The median is near dof - 2/3 (Wilson and Hilferty): error of p about 1 / dof. */
    neph_assert_close(neph_chi_squared_p(1e6 - 2.0 / 3.0, 1e6), 0.5, 0.0, 2e-6);
}

/* The stated error of Wallace's approximation against exact quantiles. */
static void test_deviate_of_student(void **state)
{
    for (double dof = 1.0; dof < 2000.0; dof *= 1.5)
        for (double z = 0.25; z <= 6.0; z += 0.25) {
            const double t = neph_student_critical(neph_normal_p(z), dof);
            if (t > 1e8) /* the critical value is not as exact */
                continue;
            const double found = neph_z_from_student(t, dof);
            assert_true(found <= z + 0.01 && found >= z - (dof >= 8.0 ? 0.06 : 0.9));
            neph_assert_close(neph_z_from_student(-t, dof), -found, 0.0, 0.0);
        }
}

/* ---- planes of known values ------------------------------------------------------------------ */

struct pair {
    double mean[2][P], variance[2][P];
    struct neph_z_side side[2];
};

static struct pair *make_pair(void)
{
    struct pair *pair = calloc(1, sizeof(*pair));
    assert_non_null(pair);
    for (int s = 0; s < 2; s++)
        pair->side[s] = (struct neph_z_side){.mean = pair->mean[s],
                                             .variance = pair->variance[s],
                                             .correlation = 1.0,
                                             .rounding = 1e-7};
    return pair;
}

static double judge(const struct pair *pair, struct neph_z_plane *plane)
{
    struct neph_diag diag = {.line = 0};
    neph_assert_ok(neph_z_test(&pair->side[0], &pair->side[1], W, H, SEED, NULL, plane, &diag),
                   &diag);
    return neph_z_combine(plane, 1);
}

/* Equal variances everywhere: scores, sums, p-values and the least bias by hand. */
static void test_known_values(void **state)
{
    OWNED(memory) struct pair *pair = make_pair();
    struct neph_z_plane plane;
    for (int i = 0; i < P; i++) {
        pair->mean[0][i] = 10.0;
        pair->mean[1][i] = 10.0 + (i % 2 ? 0.5 : -0.5);
        pair->variance[0][i] = pair->variance[1][i] = 0.5; /* standard error of 1 */
    }
    pair->mean[1][5 * W + 7] = 15.0;
    assert_true(judge(pair, &plane) < 0.05);
    assert_int_equal(plane.noisy, P);
    assert_int_equal(plane.beyond[0], 1);
    assert_int_equal(plane.beyond[2], 1);
    assert_int_equal(plane.rejected, 1);
    assert_int_equal(plane.pixel_px[0], 7);
    assert_int_equal(plane.pixel_px[1], 5);
    neph_assert_close(plane.expected[0], P * 0.04550026389635842, 1e-12, 0.0);
    neph_assert_close(plane.tests[NEPH_Z_PIXEL].statistic, 5.0, 1e-6, 0.0);
    neph_assert_close(plane.tests[NEPH_Z_PIXEL].p, 1.0 - pow(1.0 - neph_normal_p(5.0), P), 1e-5,
                      0.0);
    neph_assert_close(plane.bias, (5.0 - 0.5) / P, 1e-9, 0.0);
    neph_assert_close(plane.bias_error, 1.0 / sqrt(P), 1e-12, 0.0);
    neph_assert_close(plane.least_mean,
                      (neph_student_critical(0.04, 2.0 * P) + 0.8416212335729143) / sqrt(P), 1e-9,
                      0.0);
    /* 64 tiles of 4x4; the one with the pixel has the sum 5 - (-0.5 or 0.5) and the error 4. */
    assert_int_equal(plane.tile_px, 4);
    assert_int_equal(plane.tile_count, 64);
    assert_int_equal(plane.tile_corner_px[0], 4);
    neph_assert_close(plane.tests[NEPH_Z_TILE].statistic, 4.5 / 4.0, 0.02, 0.0);
    assert_int_equal(plane.blob.pixels, 1);
}

/* Without noise, equality within rounding is needed; at the border of noise nothing is said. */
static void test_pixels_without_noise(void **state)
{
    OWNED(memory) struct pair *pair = make_pair();
    struct neph_z_plane plane;
    for (int i = 0; i < P; i++)
        pair->mean[0][i] = pair->mean[1][i] = 1.0;
    assert_true(judge(pair, &plane) == 1.0);
    assert_int_equal(plane.noisy + plane.contrary + plane.unjudged, 0);
    pair->mean[1][0] = 1.0 + 3e-7;
    assert_true(judge(pair, &plane) == 1.0);
    pair->mean[1][0] = 1.01;
    assert_true(judge(pair, &plane) == 1.0);
    assert_int_equal(plane.unjudged, 1);
    pair->mean[1][1] = 1.01;
    assert_true(judge(pair, &plane) == 0.0);
    assert_int_equal(plane.contrary, 2);
    pair->variance[0][W + 1] = 1.0;
    assert_true(judge(pair, &plane) > 0.05);
    assert_int_equal(plane.unjudged, 2);
    assert_int_equal(plane.noisy, 1);
}

/* Frames down to a pixel, at whose sides nothing is read. */
static void test_small_frames(void **state)
{
    const double mean[9] = {1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0};
    const double other[9] = {9.0, 2.5, 3.5, 4.0, 4.0, 6.5, 7.5, 7.0, 9.0};
    const double variance[9] = {0.1, 0.1, 0.0, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1};
    const struct neph_z_side sides[2] = {
        {.mean = mean, .variance = variance, .correlation = 1.0, .rounding = 1e-6},
        {.mean = other, .variance = variance, .correlation = 1.0, .rounding = 1e-6}};
    for (int w = 1; w <= 3; w++)
        for (int h = 1; h <= 3; h++) {
            struct neph_z_plane plane;
            neph_assert_ok(neph_z_test(&sides[0], &sides[1], w, h, SEED, NULL, &plane, NULL), NULL);
            const double p = neph_z_combine(&plane, 1);
            assert_true(p >= 0.0 && p <= 1.0);
            assert_int_equal(plane.pixel_px[0] + plane.pixel_px[1], 0);
            assert_true(isfinite(plane.least_mean) && isfinite(plane.least_pixel));
        }
}

/* Weighted Holm by hand: weights 0.8, 0.05, 0.05, 0.05, 0.05. */
static void test_combination(void **state)
{
    struct neph_z_plane plane = {.noisy = 0};
    const double p[NEPH_Z_KIND_COUNT] = {0.02, 0.001, 0.5, 0.004, 1.0};
    const double expected[NEPH_Z_KIND_COUNT] = {0.02 * 0.95 / 0.8, 0.001 / 0.05, 1.0,
                                                0.02 * 0.95 / 0.8, 1.0};
    for (int k = 0; k < NEPH_Z_KIND_COUNT; k++)
        plane.tests[k].p = p[k];
    neph_assert_close(neph_z_combine(&plane, 1), 0.02, 1e-12, 0.0);
    neph_assert_close(plane.tests[1].adjusted, expected[1], 1e-12, 0.0);
    neph_assert_close(plane.tests[0].adjusted, expected[0], 1e-12, 0.0);
    neph_assert_close(plane.tests[3].adjusted, fmax(expected[0], 0.004 * 0.15 / 0.05), 1e-12, 0.0);
}

/* Two and four repeats of known values. */
static void test_repeats(void **state)
{
    static float planes[4][P];
    static double mean[P], variance[P];
    const float *repeats[4] = {planes[0], planes[1], planes[2], planes[3]};
    struct neph_z_side side = {.rounding = 1e-7};
    uint64_t random = SEED;
    for (int r = 0; r < 4; r++)
        for (int i = 0; i < P; i++)
            planes[r][i] = (float)(i % 2 ? r : neph_test_uniform(&random, 0.0, 1.0));
    neph_assert_ok(neph_z_from_repeats(repeats, 4, W, H, mean, variance, &side, NULL), NULL);
    neph_assert_close(mean[1], 1.5, 1e-12, 0.0);
    neph_assert_close(variance[1], 5.0 / 3.0 / 4.0, 1e-12, 0.0); /* of 0 1 2 3, by 4 */
    neph_assert_close(side.dof, 3.0, 0.0, 0.0);
    assert_true(side.correlation > 5.0); /* every second pixel moves with the others */
    for (int r = 0; r < 4; r++)
        for (int i = 0; i < P; i++)
            planes[r][i] = (float)neph_test_uniform(&random, 0.0, 1.0);
    neph_assert_ok(neph_z_from_repeats(repeats, 4, W, H, mean, variance, &side, NULL), NULL);
    neph_assert_close(side.correlation, 1.0, 0.0, 0.0);
}

/* ---- simulated renders ----------------------------------------------------------------------- */

static double draw_normal(uint64_t *random)
{
    const double u = neph_test_uniform(random, 1e-300, 1.0);
    return sqrt(-2.0 * log(u)) * cos(neph_test_uniform(random, 0.0, 6.283185307179586));
}

static double draw_exponential(uint64_t *random)
{
    return -log(neph_test_uniform(random, 1e-300, 1.0));
}

/* Samples of mean 1. */
static double sample_normal(uint64_t *random)
{
    return 1.0 + 0.5 * draw_normal(random);
}

static double sample_lognormal(uint64_t *random)
{
    return exp(1.2 * draw_normal(random) - 0.72);
}

static double sample_shadow(uint64_t *random) /* one of ten paths finds the light */
{
    return neph_test_uniform(random, 0.0, 1.0) < 0.1 ? 10.0 : 0.0;
}

static double sample_fireflies(uint64_t *random) /* one of 200 paths has half of the light */
{
    const bool hit = neph_test_uniform(random, 0.0, 1.0) < 0.005;
    return 0.5 * neph_test_uniform(random, 0.8, 1.2) + (hit ? 100.0 * draw_exponential(random) : 0);
}

/* Some pixels are on the edge of a bright object: 6 of 10 samples are on it, with little noise. */
static double sample_edge(uint64_t *random)
{
    return neph_test_uniform(random, 0.0, 1.0) < 0.6 ? neph_test_uniform(random, 1.6, 1.61) : 0.1;
}

struct noise {
    const char *name;
    double (*sample)(uint64_t *random);
    int samples[2];  /* of the reference and of the test */
    int repeats;     /* 0: variance layers */
    bool is_blurred; /* by a pixel filter of 3x3 pixels */
};

static const struct noise noises[] = {
    {"normal", sample_normal, {4, 4}, 0, false},
    {"gamma", draw_exponential, {16, 16}, 0, false},
    {"gamma", draw_exponential, {32, 2}, 0, false},
    {"lognormal", sample_lognormal, {8, 8}, 0, false},
    {"lognormal", sample_lognormal, {32, 4}, 0, false},
    {"shadow", sample_shadow, {8, 8}, 0, false},
    {"shadow", sample_shadow, {4, 32}, 0, false},
    {"fireflies", sample_fireflies, {8, 8}, 0, false},
    {"fireflies", sample_fireflies, {64, 4}, 0, false},
    {"edges", sample_edge, {6, 6}, 0, false},
    {"edges", sample_edge, {40, 4}, 0, false},
    {"two seeds", draw_exponential, {4, 4}, 2, false},
    {"filtered", sample_normal, {4, 4}, 4, true},
};

/* A scene with a sky without noise above objects of different brightness. */
static double get_light(int i)
{
    const int x = i % W, y = i / W;
    return y < H / 8 ? 0.0 : 0.2 + 1.8 * x / W + (x / 6 + y / 6) % 2;
}

static void render(const struct noise *noise, int samples, uint64_t *random, double *mean,
                   double *variance)
{
    for (int i = 0; i < P; i++) {
        const double light = get_light(i);
        double sum = 0.0, squares = 0.0;
        for (int k = 0; k < samples && light > 0.0; k++) {
            const double value = light * noise->sample(random);
            sum += value;
            squares += value * value;
        }
        mean[i] = light > 0.0 ? sum / samples : 1.0;
        variance[i] = fmax(0.0, squares - sum * sum / samples) / (samples - 1.0) / samples;
        variance[i] = variance[i] < 1e-14 * mean[i] * mean[i] ? 0.0 : variance[i];
    }
}

static double blur(const double *mean, int i)
{
    double sum = 0.0;
    int count = 0;
    for (int y = i / W - 1; y <= i / W + 1; y++)
        for (int x = i % W - 1; x <= i % W + 1; x++)
            if (x >= 0 && y >= 0 && x < W && y < H) {
                sum += mean[y * W + x];
                count++;
            }
    return sum / count;
}

static void render_side(const struct noise *noise, int which, uint64_t *random, struct pair *pair)
{
    static float planes[4][P];
    const float *repeats[4] = {planes[0], planes[1], planes[2], planes[3]};
    double *mean = pair->mean[which], *variance = pair->variance[which];
    for (int r = 0; r < noise->repeats; r++) {
        render(noise, noise->samples[which], random, mean, variance);
        for (int i = 0; i < P; i++)
            planes[r][i] = (float)(noise->is_blurred ? blur(mean, i) : mean[i]);
    }
    if (noise->repeats == 0)
        render(noise, noise->samples[which], random, mean, variance);
    else
        neph_assert_ok(neph_z_from_repeats(repeats, noise->repeats, W, H, mean, variance,
                                           &pair->side[which], NULL),
                       NULL);
}

/* A bias of the mean of `errors` standard errors, evenly over all pixels but the sky. */
static void add_bias(struct pair *pair, double errors)
{
    double sum = 0.0;
    int lit = 0;
    for (int i = 0; i < P; i++) {
        sum += pair->variance[0][i] + pair->variance[1][i];
        lit += get_light(i) > 0.0;
    }
    for (int i = 0; i < P; i++)
        pair->mean[1][i] += get_light(i) > 0.0 ? errors * sqrt(sum) / lit : 0.0;
}

/* The number of `count` pairs that are told to differ. */
static int count_alarms(const struct noise *noise, int count, double bias, uint64_t seed)
{
    OWNED(memory) struct pair *pair = make_pair();
    uint64_t random = seed;
    int alarms = 0;
    for (int k = 0; k < count; k++) {
        struct neph_z_plane plane;
        render_side(noise, 0, &random, pair);
        render_side(noise, 1, &random, pair);
        if (bias > 0.0)
            add_bias(pair, bias);
        alarms += judge(pair, &plane) <= NEPH_Z_LEVEL;
    }
    return alarms;
}

/* The most alarms of level 0.05: three standard deviations of the binomial distribution. */
static double most_alarms(int count)
{
    return 0.05 * count + 3.0 * sqrt(0.05 * 0.95 * count);
}

static void test_false_alarms(void **state)
{
    const int count = (PAIRS / (int)COUNT(noises) + 1) / NEPH_TEST_EVERY;
    int total = 0;
    for (size_t n = 0; n < COUNT(noises); n++) {
        const int alarms = count_alarms(&noises[n], count, 0.0, SEED + n);
        print_message("%s, %d and %d samples: %d false alarms in %d pairs, seed %d\n",
                      noises[n].name, noises[n].samples[0], noises[n].samples[1], alarms, count,
                      SEED + (int)n);
        assert_true(alarms <= most_alarms(count) + 1.0);
        total += alarms;
    }
    assert_true(total <= most_alarms(count * (int)COUNT(noises)));
}

/* Where the variance of the mean is well known: not of fireflies, which move it by their own. */
static void test_bias_of_three_errors(void **state)
{
    static const int which[] = {0, 1, 3, 5, 11};
    const int count = PAIRS / (int)COUNT(which) / NEPH_TEST_EVERY;
    int total = 0;
    for (size_t n = 0; n < COUNT(which); n++) {
        const struct noise *noise = &noises[which[n]];
        const int found = count_alarms(noise, count, 3.0, SEED + 100 + n);
        print_message("%s: a bias of three errors found in %d of %d pairs, seed %d\n", noise->name,
                      found, count, SEED + 100 + (int)n);
        total += found;
    }
    assert_true(total >= 0.8 * count * (int)COUNT(which) - (NEPH_TEST_EVERY > 1 ? 8 : 0));
}

/* A square of 6x6 pixels, 3.5 standard errors of a pixel too bright: a blob of one sign. */
static void test_local_bias(void **state)
{
    OWNED(memory) struct pair *pair = make_pair();
    uint64_t random = SEED;
    struct neph_z_plane plane;
    for (int s = 0; s < 2; s++)
        render_side(&noises[1], s, &random, pair);
    for (int i = 0; i < P; i++)
        if (i % W >= 10 && i % W < 16 && i / W >= 20 && i / W < 26)
            pair->mean[1][i] += 3.5 * sqrt(2.0 / 16.0) * get_light(i);
    assert_true(judge(pair, &plane) <= NEPH_Z_LEVEL);
    assert_true(plane.tests[NEPH_Z_BLOB].adjusted <= NEPH_Z_LEVEL);
    assert_true(plane.blob.pixels >= 10 && plane.blob.mean_z > 2.0);
    neph_assert_in_range(plane.blob.box_px[0], 8, 16);
    neph_assert_in_range(plane.blob.box_px[1], 18, 26);
}

#include "tests/main.h"
