/* SPDX-License-Identifier: MIT
 *
 * Shares of parts: games with known shares, and random games order by order.
 */
#include "tests/neph_test.h"

#include "harness/study/attribution_value.h"

enum { RANDOM_GAMES = 100 };

static bool has(neph_part_set set, int part)
{
    return (set >> part & 1U) != 0;
}

static bool is_child(int part)
{
    return part >= NEPH_PART_REPROJECTION && part <= NEPH_PART_NOISE;
}

static void test_there_are_136_states(void **state)
{
    int count = 0;
    for (neph_part_set set = 0; set < NEPH_PART_SETS; set++)
        count += neph_part_set_is_state(set);
    assert_int_equal(count, 2 * 2 * 2 * (1 + 16));
    for (int part = 0; part < NEPH_PARTS; part++)
        assert_int_equal(neph_part_needs_rays((enum neph_attribution_part_id)part), is_child(part));
    assert_int_equal(neph_part_set_without(NEPH_PARTS_ALL, NEPH_PART_RAYS),
                     1U << NEPH_PART_UPSCALE | 1U << NEPH_PART_BLUR | 1U << NEPH_PART_ALIASING);
    assert_int_equal(neph_part_set_without(NEPH_PARTS_ALL, NEPH_PART_BOX),
                     NEPH_PARTS_ALL & ~(1U << NEPH_PART_BOX));
}

/* Each part adds its own amount: that is its share. */
static void test_parts_that_add_up_have_no_interaction(void **state)
{
    static const double sizes[NEPH_PARTS] = {8.0, 1.0, -0.5, 4.0, 2.0, 0.25, 12.0, 4.0};
    double game[NEPH_PART_SETS];
    for (neph_part_set set = 0; set < NEPH_PART_SETS; set++) {
        game[set] = neph_part_set_is_state(set) ? 0.0 : NAN; /* not to be read */
        for (int i = 0; i < NEPH_PARTS; i++)
            game[set] += has(set, i) ? sizes[i] : 0.0;
    }
    const struct neph_attribution_values values = neph_attribution_divide(game);
    assert_int_equal(values.order_count, 8064);
    neph_assert_close(values.all, 30.75, 0.0, 0.0);
    neph_assert_close(values.interaction, 0.0, 0.0, 1e-12);
    assert_true(neph_attribution_explains(&values));
    for (int i = 0; i < NEPH_PARTS; i++) {
        neph_assert_close(values.parts[i].share, sizes[i], 1e-12, 0.0);
        neph_assert_close(values.parts[i].alone, sizes[i], 1e-12, 0.0);
        neph_assert_close(values.parts[i].without, i == NEPH_PART_RAYS ? 16.25 : 30.75 - sizes[i],
                          1e-12, 0.0);
    }
}

/* An error of a child is 0 without rays, and still no error of rays. */
static void test_an_error_of_a_child_is_the_childs(void **state)
{
    for (int child = NEPH_PART_REPROJECTION; child <= NEPH_PART_NOISE; child++) {
        double game[NEPH_PART_SETS];
        for (neph_part_set set = 0; set < NEPH_PART_SETS; set++)
            game[set] = has(set, child) ? 9.0 : 0.0;
        const struct neph_attribution_values values = neph_attribution_divide(game);
        for (int i = 0; i < NEPH_PARTS; i++) {
            neph_assert_close(values.parts[i].share, i == child ? 9.0 : 0.0, 0.0, 1e-12);
            neph_assert_close(values.parts[i].alone, i == child ? 9.0 : 0.0, 0.0, 1e-12);
        }
        neph_assert_close(values.parts[NEPH_PART_RAYS].without, 0.0, 0.0, 0.0);
        neph_assert_close(values.interaction, 0.0, 0.0, 1e-12);
    }
}

/* (upscale + aliasing)^2 with 2 and 3: by itself 4 and 9, together 25; the product, 12, is the
 * interaction, and is divided in halves. */
static void test_a_product_is_an_interaction(void **state)
{
    double game[NEPH_PART_SETS];
    for (neph_part_set set = 0; set < NEPH_PART_SETS; set++) {
        const double sum = (has(set, NEPH_PART_UPSCALE) ? 2.0 : 0.0) +
                           (has(set, NEPH_PART_ALIASING) ? 3.0 : 0.0);
        game[set] = sum * sum;
    }
    const struct neph_attribution_values values = neph_attribution_divide(game);
    neph_assert_close(values.interaction, 12.0, 1e-12, 0.0);
    neph_assert_close(values.parts[NEPH_PART_UPSCALE].share, 10.0, 1e-12, 0.0);
    neph_assert_close(values.parts[NEPH_PART_ALIASING].share, 15.0, 1e-12, 0.0);
    assert_false(neph_attribution_explains(&values));
}

/* A product of box and upscale belongs to the later of them. Box is at place k = 2 .. 5 of rays and
 * their children, alike often, and upscale comes into one of the six gaps: it is the later one in 6
 * - k of six, in the mean in 5 of 12 orders. */
static void test_a_product_with_a_child_is_the_later_ones(void **state)
{
    double game[NEPH_PART_SETS];
    for (neph_part_set set = 0; set < NEPH_PART_SETS; set++)
        game[set] = has(set, NEPH_PART_BOX) && has(set, NEPH_PART_UPSCALE) ? 6.0 : 0.0;
    const struct neph_attribution_values values = neph_attribution_divide(game);
    neph_assert_close(values.parts[NEPH_PART_BOX].share, 3.5, 1e-12, 0.0);
    neph_assert_close(values.parts[NEPH_PART_UPSCALE].share, 2.5, 1e-12, 0.0);
    neph_assert_close(values.parts[NEPH_PART_RAYS].share, 0.0, 0.0, 1e-12);
    neph_assert_close(values.interaction, 6.0, 1e-12, 0.0);
}

static void test_fifteen_percent_are_explained(void **state)
{
    struct neph_attribution_values values = {.all = 100.0, .interaction = -15.0};
    assert_true(neph_attribution_explains(&values));
    values.interaction = 15.1;
    assert_false(neph_attribution_explains(&values));
    values.interaction = -15.1;
    assert_false(neph_attribution_explains(&values));
}

/* Adds the contributions in each order that begins with the parts `real`; returns the number of
 * orders. */
static int walk_orders(const double *game, neph_part_set real, double path[NEPH_PARTS],
                       double shares[NEPH_PARTS])
{
    int count = real == NEPH_PARTS_ALL;
    for (int i = 0; i < NEPH_PARTS && count > 0; i++)
        shares[i] += path[i];
    for (int i = 0; i < NEPH_PARTS; i++) {
        if (has(real, i) || (is_child(i) && !has(real, NEPH_PART_RAYS)))
            continue;
        path[i] = game[real | 1U << i] - (real ? game[real] : 0.0);
        count += walk_orders(game, real | 1U << i, path, shares);
    }
    return count;
}

static void test_random_games_order_by_order(void **state)
{
    const char *wanted = getenv("NEPH_TEST_SEED");
    uint64_t random = wanted ? strtoull(wanted, NULL, 0) : 20261129;
    print_message("NEPH_TEST_SEED=%llu\n", (unsigned long long)random);
    for (int g = 0; g < RANDOM_GAMES; g++) {
        double game[NEPH_PART_SETS], path[NEPH_PARTS], shares[NEPH_PARTS] = {0.0}, sum = 0.0;
        for (neph_part_set set = 0; set < NEPH_PART_SETS; set++)
            game[set] = neph_test_uniform(&random, 0.0, 1.0);
        const struct neph_attribution_values values = neph_attribution_divide(game);
        assert_int_equal(walk_orders(game, 0, path, shares), 8064);
        for (int i = 0; i < NEPH_PARTS; i++) {
            neph_assert_close(values.parts[i].share, shares[i] / 8064.0, 0.0, 1e-12);
            sum += values.parts[i].share;
        }
        neph_assert_close(sum, game[NEPH_PARTS_ALL], 0.0, 1e-12);
    }
}

#include "tests/main.h"
