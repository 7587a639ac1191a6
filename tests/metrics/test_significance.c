/* SPDX-License-Identifier: MIT
 *
 * Z-scores and family thresholds against tabulated values of the normal distribution.
 */
#include "tests/neph_test.h"

#include "metrics/significance.h"

/* NIST/SEMATECH e-Handbook, table of the normal distribution: two-sided critical values. */
static void test_critical_values(void **state)
{
    neph_assert_close(neph_normal_critical(0.05), 1.959963984540054, 1e-13, 0.0);
    neph_assert_close(neph_normal_critical(0.01), 2.575829303548901, 1e-13, 0.0);
    neph_assert_close(neph_normal_p(3.0), 0.002699796063260189, 1e-13, 0.0);
    neph_assert_close(neph_normal_p(-3.0), neph_normal_p(3.0), 0.0, 0.0);
    neph_assert_close(neph_normal_p(0.0), 1.0, 0.0, 0.0);
}

static void test_sidak(void **state)
{
    neph_assert_close(neph_sidak_alpha(0.05, 1), 0.05, 1e-15, 0.0);
    neph_assert_close(neph_sidak_alpha(0.05, 10), 0.005116196891823743, 1e-13, 0.0);
    for (int n = 1; n < 1000; n *= 3)
        neph_assert_close(1.0 - pow(1.0 - neph_sidak_alpha(0.01, n), n), 0.01, 1e-11, 0.0);
}

/* Box-Muller noise of known variance: the moments are 0 and 1, and a wrong variance is detected. */
static void test_moments_of_noise(void **state)
{
    enum { N = 100000 };
    float *test = malloc(3 * N * sizeof(float)), *truth = test + N, *variance = test + 2 * N;
    assert_non_null(test);
    uint64_t random = 20261121;
    for (int i = 0; i < N; i++) {
        const double u = neph_test_uniform(&random, 1e-300, 1.0);
        const double v = neph_test_uniform(&random, 0.0, 6.283185307179586);
        const double sigma = 0.5 + (i % 7);
        truth[i] = (float)(i % 13);
        variance[i] = (float)(sigma * sigma);
        test[i] = (float)(truth[i] + sigma * sqrt(-2.0 * log(u)) * cos(v));
    }
    struct neph_z_moments moments = neph_z_scores(test, truth, variance, N, 0.0);
    assert_int_equal(moments.count, N);
    /* Standard errors: 1 / sqrt(N) and sqrt(2 / N); four of them. */
    neph_assert_close(moments.mean, 0.0, 0.0, 4.0 / sqrt(N));
    neph_assert_close(moments.variance, 1.0, 0.0, 4.0 * sqrt(2.0 / N));
    for (int i = 0; i < N; i++)
        variance[i] *= 1.1f;
    moments = neph_z_scores(test, truth, variance, N, 0.0);
    assert_true(moments.variance < 1.0 / 1.1 + 4.0 * sqrt(2.0 / N) && moments.variance < 0.95);
    free(test);
}

static void test_moments_of_halves_are_those_of_the_whole(void **state)
{
    const float test[5] = {1.0f, -2.0f, 0.5f, 4.0f, -1.0f};
    const float truth[5] = {0.0f}, variance[5] = {1.0f, 1.0f, 1.0f, 1.0f, 1.0f};
    const struct neph_z_moments whole = neph_z_scores(test, truth, variance, 5, 0.0);
    const struct neph_z_moments parts = neph_z_merge(
        neph_z_scores(test, truth, variance, 2, 0.0),
        neph_z_scores(test + 2, truth + 2, variance + 2, 3, 0.0));
    assert_int_equal(parts.count, 5);
    neph_assert_close(parts.mean, whole.mean, 1e-14, 0.0);
    neph_assert_close(parts.variance, whole.variance, 1e-14, 0.0);
    const struct neph_z_moments none = {0, NAN, NAN};
    neph_assert_close(neph_z_merge(none, whole).variance, whole.variance, 0.0, 0.0);
    neph_assert_close(neph_z_merge(whole, none).mean, whole.mean, 0.0, 0.0);
}

static void test_nothing_random(void **state)
{
    const float same[2] = {1.0f, 2.0f}, zero[2] = {0.0f, 0.0f}, other[2] = {1.0f, 3.0f};
    assert_int_equal(neph_z_scores(same, same, zero, 2, 0.0).count, 0);
    assert_true(isinf(neph_z_scores(other, same, zero, 2, 0.0).mean));
    assert_true(isinf(neph_z_scores(other, same, zero, 2, 0.9).mean));
    assert_int_equal(neph_z_scores(other, same, zero, 2, 1.1).count, 0);
    /* 1 / 0.1 = 10 is excluded with a floor of 0.2, and is the only value without. */
    const float little[2] = {0.01f, 0.01f};
    assert_int_equal(neph_z_scores(other, same, little, 2, 0.2).count, 0);
    neph_assert_close(neph_z_scores(other, same, little, 2, 0.0).mean, 5.0, 1e-6, 0.0);
}

#include "tests/main.h"
