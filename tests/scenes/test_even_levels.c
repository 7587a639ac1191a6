/* SPDX-License-Identifier: MIT
 *
 * Uneven levels as even cells, against cells by hand, and units as files write them.
 */
#include "tests/neph_test.h"

#include "scenes/even_levels.h"
#include "scenes/file_units.h"

#include <float.h>

/* Cells of 0..1, 1..2, 2..4 and 4..6, in two planes beside each other. */
static void test_cells_by_hand(void **state)
{
    const double levels[] = {0.5, 1.5, 2.5, 5.5};
    const float values[] = {1, 10, 2, 20, 4, 40, 8, 80};
    struct neph_even_levels even;
    float to[2 * 8];
    assert_false(neph_are_levels_even((struct neph_levels){levels, 4, false}, 100, &even));
    assert_int_equal(even.count, 7); /* ends at 0, 1, 2, 4 and 7 */
    assert_float_equal(even.first, 0.5, 1e-15);
    assert_float_equal(even.spacing, 1.0, 1e-15);
    const double change = neph_even_levels_resample((struct neph_levels){levels, 4, false}, &even,
                                                    1, 2, values, to);
    static const float expected[] = {1, 10, 2, 20, 4, 40, 4, 40, 8, 80, 8, 80, 8, 80};
    for (size_t i = 0; i < COUNT(expected); i++)
        assert_float_equal(to[i], expected[i], 0);
    assert_float_equal(change, 0.0, 1e-15);
}

/* Cells whose ends are given: half-ways between levels are not their ends. */
static void test_ends_by_hand(void **state)
{
    const double ends[] = {1.0, 2.0, 5.0};
    const float values[] = {7, 3};
    const struct neph_levels cells = {ends, 2, true};
    struct neph_even_levels even;
    float to[4];
    assert_false(neph_are_levels_even(cells, 100, &even));
    assert_int_equal(even.count, 4);
    assert_float_equal(even.first, 1.5, 1e-15);
    assert_float_equal(even.spacing, 1.0, 1e-15);
    assert_float_equal(neph_even_levels_resample(cells, &even, 1, 1, values, to), 0.0, 1e-15);
    static const float expected[] = {7, 3, 3, 3};
    for (size_t i = 0; i < COUNT(expected); i++)
        assert_float_equal(to[i], expected[i], 0);
    assert_true(neph_are_levels_even((struct neph_levels){ends, 1, true}, 100, &even));
    assert_float_equal(even.first, 1.5, 1e-15);
}

/* Fewer cells than the thinnest level needs: each is the mean of those that it overlaps. */
static void test_no_more_than_the_most(void **state)
{
    const double levels[] = {0.5, 1.5, 2.5, 5.5};
    const float values[] = {1, 2, 4, 8};
    struct neph_even_levels even;
    float to[2];
    assert_false(neph_are_levels_even((struct neph_levels){levels, 4, false}, 2, &even));
    assert_int_equal(even.count, 2);
    assert_float_equal(even.spacing, 3.5, 1e-15);
    neph_even_levels_resample((struct neph_levels){levels, 4, false}, &even, 1, 1, values, to);
    assert_float_equal(to[0], (1 + 2 + 1.5 * 4) / 3.5, 1e-6);
    assert_float_equal(to[1], (0.5 * 4 + 3 * 8) / 3.5, 1e-6);
}

/* Heights that stretch by 3 % a level: the sum is the same but for the rounding of float, at most
 * two roundings for each of the terms of one sign. */
static void test_nothing_is_lost(void **state)
{
    enum { LEVELS = 60, PLANES = 3, COLUMNS = 5 };
    uint64_t seed = 7;
    double levels[LEVELS] = {10.0};
    float values[PLANES * LEVELS * COLUMNS], *to;
    struct neph_even_levels even;
    for (int i = 1; i < LEVELS; i++)
        levels[i] = levels[i - 1] + 20.0 * pow(1.03, i);
    for (size_t i = 0; i < COUNT(values); i++)
        values[i] = (float)neph_test_uniform(&seed, 0.0, 1.0);
    assert_false(neph_are_levels_even((struct neph_levels){levels, LEVELS, false}, 1024, &even));
    to = malloc((size_t)(PLANES * COLUMNS * even.count) * sizeof(*to));
    const double change = neph_even_levels_resample((struct neph_levels){levels, LEVELS, false},
                                                    &even, PLANES, COLUMNS, values, to);
    free(to);
    assert_true(fabs(change) < 2.0 * FLT_EPSILON);
}

/* Coordinates in float of even levels stay those levels. */
static void test_even_levels(void **state)
{
    double levels[100];
    struct neph_even_levels even;
    for (int i = 0; i < 100; i++)
        levels[i] = (double)(float)(0.1 + 0.1 * i);
    assert_true(neph_are_levels_even((struct neph_levels){levels, 100, false}, 1024, &even));
    assert_int_equal(even.count, 100);
    assert_float_equal(even.spacing, 0.1, 1e-8);
}

static void test_units(void **state)
{
    static const struct {
        const char *unit;
        enum neph_unit_kind kind;
        double factor;
    } units[] = {
        {"kg m-3", NEPH_UNIT_WATER, 1e3},
        {"g/m3", NEPH_UNIT_WATER, 1.0},
        {"kg m**-3", NEPH_UNIT_WATER, 1e3},
        {"g m^-3", NEPH_UNIT_WATER, 1.0},
        {"kg kg-1", NEPH_UNIT_MIXING_RATIO, 1},
        {"km", NEPH_UNIT_LENGTH, 1e3},
        {"micron", NEPH_UNIT_LENGTH, 1e-6},
        {"\xc2\xb5m", NEPH_UNIT_LENGTH, 1e-6},
        {"km-1", NEPH_UNIT_EXTINCTION, 1e-3},
        {"m-3", NEPH_UNIT_NUMBER, 1e-6},
        {"cm^-3", NEPH_UNIT_NUMBER, 1.0},
        {"1", NEPH_UNIT_ONE, 1.0},
        {"", NEPH_UNIT_UNKNOWN, 1.0},
        {"hPa", NEPH_UNIT_UNKNOWN, 1.0},
        {"degrees_north", NEPH_UNIT_UNKNOWN, 1.0},
    };
    for (size_t i = 0; i < COUNT(units); i++) {
        double factor = 0.0;
        if (neph_unit_find(units[i].unit, &factor) != units[i].kind || factor != units[i].factor)
            fail_msg("%s: %g", units[i].unit, factor);
    }
}

#include "tests/main.h"
