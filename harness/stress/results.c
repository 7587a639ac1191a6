/* SPDX-License-Identifier: MIT
 *
 * Verdicts of the stress tests: table, judgement, counts, order.
 */
#include "harness/stress/results.h"

#include <math.h>
#include <stdlib.h>

/* Fails to compile when a kind is added, as the tables of this file need a row for it. */
_Static_assert(NEPH_STRESS_EXPECTED_COUNT == 4, "a new kind");
_Static_assert(NEPH_STRESS_VERDICTS == 12, "a new kind");

const struct neph_stress_verdict_info neph_stress_verdicts[NEPH_STRESS_VERDICTS] = {
    [NEPH_STRESS_FAIL] = {"fail", "FAIL", true, true, true, 0},
    [NEPH_STRESS_NO_NUMBER] = {"no_number", "NONE", true, false, false, 1},
    [NEPH_STRESS_NEW_PASS] = {"unexpected_pass", "PASS!", true, true, false, 2},
    [NEPH_STRESS_FLAKE] = {"flake", "flake", false, true, true, 3},
    [NEPH_STRESS_KNOWN_FAIL] = {"known_fail", "known", false, true, true, 4},
    [NEPH_STRESS_NOT_RENDERED] = {"not_rendered", "not rendered", false, false, false, 5},
    [NEPH_STRESS_PASS] = {"pass", "", false, true, false, 6},
    [NEPH_STRESS_SKIP] = {"skip", "skip", false, false, false, 7},
    [NEPH_STRESS_CANNOT] = {"cannot", "cannot", false, false, false, 8},
    [NEPH_STRESS_MISSING] = {"missing", "missing", false, false, false, 9},
    [NEPH_STRESS_NOT_YET] = {"not_yet", "not yet", false, false, false, 10},
    [NEPH_STRESS_NOT_PLANNED] = {"not_asked", "-", false, false, false, 11},
};

enum neph_stress_verdict neph_stress_judge(double value, double limit,
                                           enum neph_stress_expected expected)
{
    static const enum neph_stress_verdict table[NEPH_STRESS_EXPECTED_COUNT][2] = {
        [NEPH_STRESS_PASSES] = {NEPH_STRESS_FAIL, NEPH_STRESS_PASS},
        [NEPH_STRESS_FAILS] = {NEPH_STRESS_KNOWN_FAIL, NEPH_STRESS_NEW_PASS},
        [NEPH_STRESS_FLAKES] = {NEPH_STRESS_FLAKE, NEPH_STRESS_PASS},
        [NEPH_STRESS_SKIPS] = {NEPH_STRESS_SKIP, NEPH_STRESS_SKIP},
    };
    if (isnan(value) && expected != NEPH_STRESS_SKIPS)
        return NEPH_STRESS_NO_NUMBER;
    return table[expected][value <= limit];
}

void neph_stress_count(struct neph_stress_suite *suite)
{
    struct neph_stress_counts *counts = &suite->counts;
    *counts = (struct neph_stress_counts){.compared = 0};
    for (int r = 0; r < suite->row_count; r++)
        for (int c = 0; c < suite->column_count; c++) {
            const enum neph_stress_verdict verdict = suite->rows[r].cells[c].verdict;
            counts->verdicts[verdict]++;
            counts->compared += neph_stress_verdicts[verdict].is_compared;
            counts->news += neph_stress_verdicts[verdict].is_unexpected;
        }
    suite->passes = counts->compared > 0 && counts->news == 0;
}

double neph_stress_excess(const struct neph_stress_row *row, const struct neph_stress_cell *cell)
{
    if (isnan(cell->value))
        return NAN;
    if (row->limit->limit > 0.0)
        return cell->value / row->limit->limit;
    return cell->value > 0.0 ? INFINITY : 0.0;
}

/* -1, 0 or 1; cells without a value come last. */
static int compare_excess(double a, double b)
{
    if (isnan(a) || isnan(b))
        return (isnan(a) > isnan(b)) - (isnan(a) < isnan(b));
    return (a < b) - (a > b);
}

static int compare_spots(const void *a_, const void *b_)
{
    const struct neph_stress_cell_id *a = a_, *b = b_;
    const struct neph_stress_cell *of_a = &a->row->cells[a->column];
    const struct neph_stress_cell *of_b = &b->row->cells[b->column];
    const int ranks = neph_stress_verdicts[of_a->verdict].rank -
                      neph_stress_verdicts[of_b->verdict].rank;
    if (ranks != 0)
        return ranks;
    const int order = compare_excess(neph_stress_excess(a->row, of_a),
                                     neph_stress_excess(b->row, of_b));
    if (order != 0)
        return order;
    return a->row != b->row ? (a->row < b->row ? -1 : 1) : a->column - b->column;
}

struct neph_stress_cell_id *neph_stress_worst(const struct neph_stress_suite *suite, int *count)
{
    const size_t most = (size_t)suite->row_count * (size_t)suite->column_count;
    struct neph_stress_cell_id *spots = calloc(most + 1, sizeof(*spots));
    *count = 0;
    for (int r = 0; r < suite->row_count && spots; r++)
        for (int c = 0; c < suite->column_count; c++)
            if (suite->rows[r].cells[c].verdict != NEPH_STRESS_NOT_PLANNED)
                spots[(*count)++] = (struct neph_stress_cell_id){&suite->rows[r], c};
    if (spots)
        qsort(spots, (size_t)*count, sizeof(*spots), compare_spots);
    return spots;
}

void neph_stress_finish(struct neph_stress_suite *suite)
{
    for (int s = 0; s < suite->scene_count; s++)
        neph_scene_destroy(suite->scenes[s]);
    neph_arena_finish(&suite->arena);
    *suite = (struct neph_stress_suite){.scenes = NULL};
}
