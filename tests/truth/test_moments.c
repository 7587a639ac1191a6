/* SPDX-License-Identifier: MIT
 *
 * Means with standard errors, and the doubt about these: of distributions with known moments.
 */
#include "tests/neph_test.h"

#include "base/doubt.h"
#include "truth/moments.h"

static double uniform(uint64_t *seed)
{
    return (double)(neph_test_random(seed) >> 11) * 0x1p-53;
}

static double draw_normal(uint64_t *seed)
{
    const double radius = sqrt(-2.0 * log(1.0 - uniform(seed)));
    return radius * cos(2.0 * M_PI * uniform(seed));
}

/* A large mean, so that sums of powers about 0 would cancel. */
static double draw_offset(uint64_t *seed)
{
    return 1e6 + draw_normal(seed);
}

static double draw_lognormal(uint64_t *seed)
{
    return exp(3.0 * draw_normal(seed));
}

/* One value of a thousand is 1000: a path that meets a narrow peak. */
static double draw_rare(uint64_t *seed)
{
    return uniform(seed) < 1e-3 ? 1000.0 : uniform(seed);
}

static struct neph_moments_estimate draw(double (*value)(uint64_t *seed), int count, uint64_t seed)
{
    struct neph_moments moments = {.count = 0.0};
    for (int i = 0; i < count; i++)
        neph_moments_add(&moments, value(&seed));
    return neph_moments_estimate(&moments);
}

/* The relative variance of the variance of n normal numbers is 2 / (n - 1); its own standard error
 * with n = 4000 is 5 %. */
static void test_normal_noise_is_trusted(void **state)
{
    const int count = 4000;
    double (*const values[])(uint64_t * seed) = {draw_normal, draw_offset};
    for (size_t i = 0; i < 2; i++) {
        const struct neph_moments_estimate made = draw(values[i], count, 5);
        neph_assert_close(made.doubt, 2.0 / (count - 1), 0.15, 0.0);
        neph_assert_close(made.standard_error, 1.0 / sqrt(count), 0.05, 0.0);
        neph_assert_close(made.mean, i * 1e6, 0.0, 4.0 * made.standard_error);
    }
    assert_true(draw(draw_normal, 40, 5).doubt < NEPH_DOUBTFUL);
    assert_true(draw(draw_normal, 10, 5).doubt > NEPH_DOUBTFUL); /* few */
}

/* The largest of a thousand values of exp(3 x) make most of the variance. With a peak of
 * probability p the doubt of n values is about 1 / (n p) once it is met. */
static void test_heavy_tails_are_doubted(void **state)
{
    int doubted = 0;
    for (uint64_t seed = 1; seed <= 20; seed++)
        doubted += draw(draw_lognormal, 1000, seed).doubt > NEPH_DOUBTFUL;
    print_message("%d of 20 lognormal samples are doubted\n", doubted);
    assert_true(doubted >= 19);
    neph_assert_close(draw(draw_rare, 100000, 3).doubt, 0.01, 0.4, 0.0);
    assert_true(draw(draw_rare, 4000, 3).doubt > NEPH_DOUBTFUL);
}

static void test_values_without_noise(void **state)
{
    struct neph_moments moments = {.count = 0.0};
    assert_true(isnan(neph_moments_estimate(&moments).mean));
    neph_moments_add(&moments, 0.1);
    assert_true(neph_moments_estimate(&moments).mean == 0.1);
    assert_true(isnan(neph_moments_estimate(&moments).standard_error));
    for (int i = 0; i < 100; i++)
        neph_moments_add(&moments, i % 2 ? 0.1 : 0.1 * (1.0 + 0x1p-52)); /* rounding */
    const struct neph_moments_estimate made = neph_moments_estimate(&moments);
    assert_true(made.doubt == 0.0 && made.standard_error == 0.0);
}

#include "tests/main.h"
