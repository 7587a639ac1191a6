/* SPDX-License-Identifier: MIT
 *
 * Floors as columns of the stress tests, and their values beside those of presets.
 */
#include "harness/stress/floors.h"

#include "harness/engines/engines.h"
#include "harness/study/floor_plan.h"

#include <math.h>

/* Fails to compile when a measure is added: all but the count of bad values have floors. */
_Static_assert(NEPH_FAILING_MEASURES == 8, "a new kind");

/* All presets of a scene march its number of steps, whichever number that is. */
enum { ANY_STEPS = 8 };

enum neph_status neph_stress_add_floors(struct neph_stress_suite *suite, struct neph_diag *diag)
{
    const char *presets[NEPH_STRESS_COLUMNS_MAX];
    int columns[NEPH_STRESS_TRIAL_COLUMNS_MAX], count = 0;
    struct neph_floor_plan plan;
    for (int c = 0; c < suite->column_count; c++)
        if (suite->columns[c].is_preset) {
            presets[count] = suite->columns[c].name;
            columns[count++] = c;
        }
    const enum neph_status status = neph_floor_plan_make(presets, count, ANY_STEPS, &suite->arena,
                                                         &plan, diag);
    if (status)
        return status;
    for (int f = 0; f < plan.floor_count; f++) {
        columns[count + f] = suite->column_count + f;
        suite->columns[columns[count + f]] = (struct neph_stress_column){
            plan.words[count + f], neph_engine_find("realtime"), true};
    }
    for (int p = 0; p < count; p++)
        for (int i = 0; i < NEPH_STUDY_FLOOR_CANDIDATES; i++)
            suite->floors[columns[p]].candidates[i] = columns[plan.floors[p].candidates[i]];
    suite->floor_count = plan.floor_count;
    suite->has_floors = count > 0;
    return NEPH_OK;
}

/* Whether a value of a row has a floor beside it. */
static bool is_above_floor(const struct neph_stress_suite *suite, const struct neph_stress_row *row,
                           int column)
{
    return suite->has_floors && row->is_moving && suite->columns[column].is_preset &&
           row->limit->measure != NEPH_FAILING_BAD_VALUES &&
           row->cells[column].verdict != NEPH_STRESS_NOT_PLANNED;
}

void neph_stress_plan_floor_cells(const struct neph_stress_suite *suite,
                                  struct neph_stress_row *row)
{
    for (int f = suite->column_count; f < suite->column_count + suite->floor_count; f++)
        row->cells[f] = (struct neph_stress_cell){NAN, NEPH_STRESS_NOT_PLANNED, "", NULL, NULL};
    for (int c = 0; c < suite->column_count; c++)
        for (int i = 0; i < NEPH_STUDY_FLOOR_CANDIDATES && is_above_floor(suite, row, c); i++) {
            const int floor = suite->floors[c].candidates[i];
            if (floor >= suite->column_count)
                row->cells[floor].verdict = NEPH_STRESS_NOT_YET;
        }
}

struct neph_stress_floor neph_stress_find_floor(const struct neph_stress_suite *suite,
                                                const struct neph_stress_row *row, int column)
{
    struct neph_stress_floor lower = {NAN, NAN, NULL};
    if (!is_above_floor(suite, row, column))
        return lower;
    for (int i = 0; i < NEPH_STUDY_FLOOR_CANDIDATES; i++) {
        const int floor = suite->floors[column].candidates[i];
        const double value = row->cells[floor].value;
        if (isnan(value)) /* the other configuration would be no lower bound */
            return (struct neph_stress_floor){NAN, NAN, NULL};
        if (!lower.name || value < lower.value)
            lower = (struct neph_stress_floor){value, NAN, suite->columns[floor].name};
    }
    const double value = row->cells[column].value;
    if (isfinite(value) && isfinite(lower.value) && lower.value > 0.0)
        lower.times = value / lower.value;
    return lower;
}

json_t *neph_stress_floors_json(const struct neph_stress_suite *suite)
{
    json_t *list = suite->has_floors ? json_array() : json_null();
    for (int c = 0; c < suite->column_count && suite->has_floors; c++) {
        const int *candidates = suite->floors[c].candidates;
        if (suite->columns[c].is_preset)
            neph_json_add(&list, json_pack("{s:s, s:[s,s]}", "column", suite->columns[c].name,
                                           "floors", suite->columns[candidates[0]].name,
                                           suite->columns[candidates[1]].name));
    }
    return list;
}
