/* SPDX-License-Identifier: MIT
 *
 * The branch-free functions against libm in long double, at random bit patterns of the whole range
 * and at critical values.
 */
#include "tests/neph_test.h"

#include "metrics/vector_math.h"

#include <float.h>

enum { DRAW_COUNT = 200000 };

/* NEPH_TEST_SEED, or the given seed; printed, so that a failure can be reproduced. */
static uint64_t test_seed(uint64_t usual)
{
    const char *wanted = getenv("NEPH_TEST_SEED");
    const uint64_t seed = wanted ? strtoull(wanted, NULL, 0) : usual;
    print_message("NEPH_TEST_SEED=%llu\n", (unsigned long long)seed);
    return seed;
}

/* Any positive finite double, each exponent equally likely, including denormals. */
static double draw_positive(uint64_t *random)
{
    const uint64_t bits = neph_test_random(random) % 0x7ff0000000000000u;
    return neph_of_bits(bits ? bits : 1);
}

/* A relative error, and for denormal results one unit in the last place more. */
static void assert_near(double actual, long double exact, double relative, double argument)
{
    if (exact > (long double)DBL_MAX && isinf(actual))
        return;
    const long double allowed = relative * fabsl(exact) + 0x1p-1074L;
    if (fabsl((long double)actual - exact) <= allowed)
        return;
    fail_msg("at %a: %.17g, exact %.20Lg, relative error %.3Lg, allowed %.3g", argument, actual,
             exact, fabsl((long double)actual / exact - 1.0L), relative);
}

static void test_log2(void **state)
{
    uint64_t random = test_seed(11);
    for (int i = 0; i < DRAW_COUNT; i++) {
        const double x = draw_positive(&random);
        assert_near(neph_log2(x), log2l(x), 1e-15, x);
        const double near_one = 1.0 + ldexp(neph_test_uniform(&random, -1.0, 1.0), -(i % 53));
        assert_near(neph_log2(near_one), log2l(near_one), 1e-15, near_one);
    }
    assert_true(neph_log2(1.0) == 0.0);
    for (int k = -1074; k <= 1023; k++)
        assert_true(neph_log2(ldexp(1.0, k)) == k);
    assert_true(neph_log2(0.0) == -INFINITY && neph_log2(-0.0) == -INFINITY);
    assert_true(neph_log2(INFINITY) == INFINITY);
    assert_true(isnan(neph_log2(-1.0)) && isnan(neph_log2(-INFINITY)) && isnan(neph_log2(NAN)));
}

static void test_exp2(void **state)
{
    uint64_t random = test_seed(12);
    for (int i = 0; i < DRAW_COUNT; i++) {
        const double y = neph_test_uniform(&random, -1080.0, 1024.0);
        assert_near(neph_exp2(y), exp2l(y), 1e-15, y);
        const double small = ldexp(neph_test_uniform(&random, -1.0, 1.0), -(i % 60));
        assert_near(neph_exp2(small), exp2l(small), 1e-15, small);
    }
    for (int k = -1074; k <= 1023; k++)
        assert_true(neph_exp2(k) == ldexp(1.0, k));
    assert_true(neph_exp2(-INFINITY) == 0.0 && neph_exp2(-1e300) == 0.0);
    assert_true(neph_exp2(INFINITY) == INFINITY && neph_exp2(1e300) == INFINITY);
    assert_true(isnan(neph_exp2(NAN)));
}

static void test_cbrt(void **state)
{
    uint64_t random = test_seed(14);
    for (int i = 0; i < DRAW_COUNT; i++) {
        const double x = draw_positive(&random);
        assert_near(neph_cbrt(x), cbrtl(x), 1e-15, x);
        assert_true(neph_cbrt(-x) == -neph_cbrt(x));
    }
    for (int i = 0; i < DRAW_COUNT;
         i++) { /* the guess depends on the mantissa and exponent mod 3 */
        const double x = exp2(3.0 * i / DRAW_COUNT);
        assert_near(neph_cbrt(x), cbrtl(x), 1e-15, x);
    }
    assert_true(neph_cbrt(0.0) == 0.0 && signbit(neph_cbrt(-0.0)));
    assert_true(neph_cbrt(INFINITY) == INFINITY && neph_cbrt(-INFINITY) == -INFINITY);
    assert_true(isnan(neph_cbrt(NAN)));
    assert_near(neph_cbrt(DBL_MAX), cbrtl(DBL_MAX), 1e-15, DBL_MAX);
    assert_near(neph_cbrt(0x1p-1074), cbrtl(0x1p-1074L), 1e-15, 0x1p-1074);
}

/* In arrays, so that the vectorised loop itself runs. */
enum { LANE_COUNT = 1003 };

NEPH_VECTOR static void all_of_them(const double *restrict x, double *restrict result, int count)
{
    for (int i = 0; i < count; i++)
        result[i] = neph_log2(x[i]) + neph_exp2(x[i]) + neph_cbrt(x[i]);
}

static void test_lanes_give_the_bits_of_single_calls(void **state)
{
    static double x[LANE_COUNT], together[LANE_COUNT];
    uint64_t random = test_seed(15);
    for (int i = 0; i < LANE_COUNT; i++)
        x[i] = i == 0 ? 0.0 : ldexp(neph_test_uniform(&random, 0.0, 1.0), i % 20 - 10);
    all_of_them(x, together, LANE_COUNT);
    for (int i = 0; i < LANE_COUNT; i++) {
        double alone;
        all_of_them(&x[i], &alone, 1);
        assert_true(neph_bits_of(alone) == neph_bits_of(together[i]));
    }
}

#include "tests/main.h"
