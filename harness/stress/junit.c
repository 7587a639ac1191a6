/* SPDX-License-Identifier: MIT
 *
 * The results of the stress tests as JUnit test cases.
 */
#include "harness/stress/output.h"

#include "harness/stress/floors.h"

#include <math.h>

/* Fails to compile when a verdict is added, as each one has a JUnit result. */
_Static_assert(NEPH_STRESS_VERDICTS == 12, "a new kind");

static enum neph_junit_result junit_result(enum neph_stress_verdict verdict)
{
    if (neph_stress_verdicts[verdict].is_unexpected)
        return NEPH_JUNIT_FAILED;
    return verdict == NEPH_STRESS_PASS ? NEPH_JUNIT_PASSED : NEPH_JUNIT_SKIPPED;
}

static void add_cell(const struct neph_stress_suite *suite, const struct neph_stress_row *row,
                     int column, struct neph_junit *junit)
{
    struct neph_arena *arena = &junit->arena;
    const struct neph_stress_cell *cell = &row->cells[column];
    const char *group = neph_arena_format(arena, "stress %s%s%s", row->scene->name,
                                          row->point[0] ? " " : "", row->point);
    const char *name = neph_arena_format(arena, "%s %s over %s", suite->columns[column].name,
                                         neph_failing_measure_name(row->limit->measure),
                                         row->limit->over);
    const char *why = cell->why && cell->why[0] ? cell->why : row->limit->reason;
    const char *verdict = neph_stress_verdicts[cell->verdict].name;
    const struct neph_stress_floor of_preset = neph_stress_find_floor(suite, row, column);
    const char *floor = of_preset.name ? neph_arena_format(arena, ", floor %.4g", of_preset.value)
                                       : "";
    const char *message = isnan(cell->value)
                              ? neph_arena_format(arena, "%s: %s", verdict, why)
                              : neph_arena_format(arena, "%s: %.4g, limit %.4g%s: %s", verdict,
                                                  cell->value, row->limit->limit, floor, why);
    neph_junit_add(junit, group, name, junit_result(cell->verdict),
                   cell->verdict == NEPH_STRESS_PASS ? "" : message);
}

void neph_stress_junit(const struct neph_stress_suite *suite, struct neph_junit *junit)
{
    junit->seconds = suite->seconds;
    for (int r = 0; r < suite->row_count; r++)
        for (int c = 0; c < suite->column_count; c++)
            if (suite->rows[r].cells[c].verdict != NEPH_STRESS_NOT_PLANNED)
                add_cell(suite, &suite->rows[r], c, junit);
    neph_junit_add(junit, "stress", "verdict",
                   suite->passes ? NEPH_JUNIT_PASSED : NEPH_JUNIT_FAILED,
                   suite->passes ? ""
                   : suite->counts.compared > 0
                       ? neph_arena_format(&junit->arena, "%d of %d results are not as expected",
                                           suite->counts.news, suite->counts.compared)
                       : "nothing was compared");
}
