/* SPDX-License-Identifier: MIT
 *
 * The floors of the stress tests without a renderer: which configuration counts, and where floors
 * are planned.
 */
#include "tests/neph_test.h"

#include "harness/stress/floors.h"
#include "harness/stress/suite.h"
#include "harness/stress/trial.h"

#include <math.h>

/* Presets 0 and 1, an engine, and two floors; the row's scene moves. */
enum { FLOOR_COLUMNS = 3, FLOORS = 2 };
static const double floor_values[FLOOR_COLUMNS + FLOORS] = {6.0, INFINITY, 5.0, 4.0, 2.0};

static struct neph_stress_suite make_floor_suite(void)
{
    return (struct neph_stress_suite){
        .column_count = FLOOR_COLUMNS,
        .floor_count = FLOORS,
        .columns = {{.name = "a", .is_preset = true},
                    {.name = "b", .is_preset = true},
                    {.name = "march"},
                    {.name = "off+x", .is_preset = true},
                    {.name = "off+y", .is_preset = true}},
        .floors = {{{3, 4}}, {{3, 3}}},
        .has_floors = true,
    };
}

static void test_the_floor_is_the_lower_of_two(void **state)
{
    const struct neph_stress_suite suite = make_floor_suite();
    const struct neph_failing_limit limit = {.measure = NEPH_FAILING_FLICKER};
    struct neph_stress_cell cells[FLOOR_COLUMNS + FLOORS];
    struct neph_stress_row row = {.limit = &limit, .is_moving = true, .cells = cells};
    for (int c = 0; c < FLOOR_COLUMNS + FLOORS; c++)
        cells[c] = (struct neph_stress_cell){.value = floor_values[c], .verdict = NEPH_STRESS_PASS};
    struct neph_stress_floor floor = neph_stress_find_floor(&suite, &row, 0);
    assert_string_equal(floor.name, "off+y");
    assert_true(floor.value == 2.0 && floor.times == 3.0);
    floor = neph_stress_find_floor(&suite, &row, 1);
    assert_string_equal(floor.name, "off+x");
    assert_true(floor.value == 4.0 && isnan(floor.times)); /* infinity has no ratio */
    assert_null(neph_stress_find_floor(&suite, &row, 2).name);
    cells[3].value = NAN; /* the lower of both is unknown */
    assert_null(neph_stress_find_floor(&suite, &row, 0).name);
    cells[3].value = cells[4].value = 0.0;
    floor = neph_stress_find_floor(&suite, &row, 0);
    assert_true(floor.name && floor.value == 0.0 && isnan(floor.times));
    row.is_moving = false;
    assert_null(neph_stress_find_floor(&suite, &row, 0).name);
}

/* Floors are measured where a preset with that floor is, and change no count of verdicts. */
static void test_floors_are_planned_beside_presets(void **state)
{
    struct neph_stress_suite suite = make_floor_suite();
    const struct neph_failing_limit flicker = {.measure = NEPH_FAILING_FLICKER},
                                    bad_values = {.measure = NEPH_FAILING_BAD_VALUES};
    static const struct {
        bool is_moving, has_preset_a, has_limit;
        enum neph_stress_verdict floors[FLOORS];
    } cases[] = {
        {true, true, true, {NEPH_STRESS_NOT_YET, NEPH_STRESS_NOT_YET}},
        {true, false, true, {NEPH_STRESS_NOT_YET, NEPH_STRESS_NOT_PLANNED}},
        {false, true, true, {NEPH_STRESS_NOT_PLANNED, NEPH_STRESS_NOT_PLANNED}},
        {true, true, false, {NEPH_STRESS_NOT_PLANNED, NEPH_STRESS_NOT_PLANNED}},
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        struct neph_stress_cell cells[FLOOR_COLUMNS + FLOORS] = {{0}};
        struct neph_stress_row row = {.limit = cases[i].has_limit ? &flicker : &bad_values,
                                      .is_moving = cases[i].is_moving,
                                      .cells = cells};
        for (int c = 0; c < FLOOR_COLUMNS; c++)
            cells[c].verdict = NEPH_STRESS_PASS;
        if (!cases[i].has_preset_a)
            cells[0].verdict = NEPH_STRESS_NOT_PLANNED;
        neph_stress_plan_floor_cells(&suite, &row);
        for (int f = 0; f < FLOORS; f++)
            assert_int_equal(cells[FLOOR_COLUMNS + f].verdict, cases[i].floors[f]);
        suite.rows = &row;
        suite.row_count = 1;
        neph_stress_count(&suite);
        assert_int_equal(suite.counts.verdicts[NEPH_STRESS_NOT_YET], 0);
    }
}

/* The quick tier has no floors; presets with the same settings share one. */
static void test_floors_of_the_tiers(void **state)
{
    static const char *const sun[] = {"sun_flash"}, *const fence[] = {"fence_tiles"};
    static const char *const presets[] = {"fixed", "fixed+box=none", "seed", "off"};
    static const struct {
        const char *const *only;
        int floors, planned;
    } cases[] = {{NULL, 0, 0}, {sun, 2, 2}, {fence, 2, 0}};
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        const struct neph_stress_params params = {.only = cases[i].only,
                                                  .only_count = cases[i].only ? 1 : 0,
                                                  .presets = presets,
                                                  .preset_count = 4};
        struct neph_stress_suite suite = {.scenes = NULL};
        struct neph_diag diag = {.line = 0};
        int planned = 0;
        neph_assert_ok(neph_stress_plan(&params, &suite, &diag), &diag);
        assert_int_equal(suite.floor_count, cases[i].floors);
        const struct neph_stress_point point = neph_stress_point_at(&suite, 0);
        for (int f = 0; f < suite.floor_count; f++)
            planned += neph_stress_has_trial(&suite, &point, suite.column_count + f);
        assert_int_equal(planned, cases[i].planned);
        neph_stress_finish(&suite);
    }
}

#include "tests/main.h"
