/* SPDX-License-Identifier: MIT
 *
 * Order statistics against sorted values.
 */
#include "tests/neph_test.h"

#include "base/sort.h"
#include "metrics/select.h"
#include "metrics/statistics.h"

struct set {
    double *values; /* ascending */
    uint32_t *keys; /* in the original order */
    size_t first[3];
    uint32_t counts[3];
    struct neph_key_runs runs;
    struct neph_selector *selector;
};

/* `values` are floats; they are stored in three runs with a gap between them, one of them empty. */
static void create_set(struct set *set, const float *values, size_t count)
{
    const size_t part = count / 3;
    set->values = malloc(count * sizeof(*set->values));
    set->keys = calloc(count + 5, sizeof(*set->keys));
    assert_true(set->values && set->keys);
    for (size_t i = 0; i < count; i++) {
        set->values[i] = (double)values[i];
        set->keys[i < part ? i : i + 5] = neph_key_of(set->values[i]);
    }
    neph_sort_doubles(set->values, count);
    set->first[0] = 0;
    set->counts[0] = (uint32_t)part;
    set->first[1] = part;
    set->counts[1] = 0;
    set->first[2] = part + 5;
    set->counts[2] = (uint32_t)(count - part);
    set->runs = (struct neph_key_runs){set->keys, set->first, set->counts, 3, count};
    struct neph_diag diag = {0};
    neph_assert_ok(neph_selector_create(&set->runs, &set->selector, &diag), &diag);
}

static void destroy_set(struct set *set)
{
    neph_selector_destroy(set->selector);
    free(set->values);
    free(set->keys);
}

static void test_keys_keep_the_order(void **state)
{
    static const double ascending[] = {-1e300, -1.0, -1e-40, 0.0, 1e-45, 1e-40, 0.5, 1.0, 1e300};
    for (size_t i = 0; i < sizeof(ascending) / sizeof(ascending[0]); i++) {
        assert_true(i == 0 || neph_key_of(ascending[i]) > neph_key_of(ascending[i - 1]));
        double back = neph_key_value(neph_key_of(ascending[i]));
        double expected = fabs(ascending[i]) > 1e100 ? copysign((double)FLT_MAX, ascending[i])
                                                     : (double)(float)ascending[i];
        assert_true(back == expected);
    }
}

/* Values with equal upper bits, equal values, few values, and values of all sizes and signs. */
static float draw(uint64_t *random, int kind)
{
    switch (kind) {
    case 0:
        return (float)neph_test_uniform(random, 1.0, 1.0001);
    case 1:
        return (float)(neph_test_random(random) % 7);
    case 2:
        return (float)(exp2(neph_test_uniform(random, -140.0, 120.0)) *
                       (neph_test_random(random) % 2 ? 1.0 : -1.0));
    default:
        return (float)neph_test_uniform(random, 0.0, 3.0);
    }
}

static void test_ranks_and_percentiles(void **state)
{
    uint64_t random = 1234;
    enum { COUNT_MAX = 5000 };
    static float values[COUNT_MAX];
    for (int round = 0; round < 40; round++) {
        size_t count = round < 8 ? (size_t)round + 1 : 1 + neph_test_random(&random) % COUNT_MAX;
        for (size_t i = 0; i < count; i++)
            values[i] = draw(&random, round % 4);
        struct set set;
        create_set(&set, values, count);
        for (int i = 0; i < 50; i++) {
            size_t rank = i == 0 ? 0 : i == 1 ? count - 1 : neph_test_random(&random) % count;
            assert_true(neph_key_value(neph_select_rank(set.selector, rank)) == set.values[rank]);
            double share = i == 0 ? 0.0 : i == 1 ? 1.0 : neph_test_uniform(&random, 0.0, 1.0);
            neph_assert_close(neph_select_percentile(set.selector, share),
                              neph_percentile(set.values, count, share), 1e-15, 0.0);
        }
        destroy_set(&set);
    }
}

/* Announced or not, in time or in between: the percentiles are the same. */
static void test_expected_percentiles(void **state)
{
    uint64_t random = 777;
    enum { COUNT_MAX = 5000, SHARES = 5 };
    static float values[COUNT_MAX];
    struct neph_diag diag = {0};
    for (int round = 0; round < 80; round++) {
        size_t count = 1 + neph_test_random(&random) % (round < 8 ? 4 : COUNT_MAX);
        for (size_t i = 0; i < count; i++)
            values[i] = draw(&random, round % 4);
        struct set set;
        create_set(&set, values, count);
        for (int again = 0; again < 4; again++) {
            double shares[SHARES];
            int share_count = (int)(neph_test_random(&random) % (SHARES + 1));
            for (int i = 0; i < SHARES; i++)
                shares[i] = neph_test_uniform(&random, 0.0, 1.0);
            const double before = neph_test_uniform(&random, 0.0, 1.0);
            const double percentile = neph_select_percentile(set.selector, before);
            neph_assert_ok(neph_select_expect(set.selector, shares, share_count, &diag), &diag);
            assert_true(neph_select_percentile(set.selector, before) == percentile);
            for (int i = 0; i < SHARES; i++)
                neph_assert_close(neph_select_percentile(set.selector, shares[i]),
                                  neph_percentile(set.values, count, shares[i]), 1e-15, 0.0);
        }
        destroy_set(&set);
    }
}

/* The definition: step through the sorted values until the running sum exceeds the share. Shares
 * that the rounding of this sum could decide are skipped. */
static void test_weighted_percentiles(void **state)
{
    uint64_t random = 4321;
    enum { COUNT_MAX = 3000 };
    static float values[COUNT_MAX];
    for (int round = 0; round < 40; round++) {
        size_t count = 1 + neph_test_random(&random) % (round < 8 ? 4 : COUNT_MAX);
        double total = 0.0;
        for (size_t i = 0; i < count; i++) {
            values[i] = fabsf(draw(&random, round % 4));
            total += (double)values[i];
        }
        struct set set;
        create_set(&set, values, count);
        for (int i = 0; i < 50; i++) {
            double share = neph_test_uniform(&random, 0.0, 1.0), running = 0.0;
            size_t k = 0;
            for (; k + 1 < count; k++) {
                running += set.values[k];
                if (running > share * total)
                    break;
            }
            bool is_close = fabs(running - share * total) < 1e-12 * total ||
                            fabs(running - set.values[k] - share * total) < 1e-12 * total;
            if (!is_close)
                assert_true(neph_select_weighted(set.selector, share) ==
                            (total > 0.0 ? set.values[k] : 0.0));
        }
        assert_true(neph_select_weighted(set.selector, 1.0) == set.values[count - 1]);
        destroy_set(&set);
    }
    neph_selector_destroy(NULL);
}

#include "tests/main.h"
