/* SPDX-License-Identifier: MIT */
#include "harness/failure/results.h"

#include <math.h>
#include <stdlib.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_FAILURE_EXPECTED_COUNT == 4, "a new kind");
_Static_assert(NEPH_FAILURE_VERDICTS == 12, "a new kind");

const struct neph_failure_verdict_info neph_failure_verdicts[NEPH_FAILURE_VERDICTS] = {
    [NEPH_FAILURE_FAIL] = {"fail", "FAIL", true, true, true, 0},
    [NEPH_FAILURE_NO_NUMBER] = {"no_number", "NONE", true, false, false, 1},
    [NEPH_FAILURE_NEW_PASS] = {"unexpected_pass", "PASS!", true, true, false, 2},
    [NEPH_FAILURE_FLAKE] = {"flake", "flake", false, true, true, 3},
    [NEPH_FAILURE_KNOWN_FAIL] = {"known_fail", "known", false, true, true, 4},
    [NEPH_FAILURE_NOT_RENDERED] = {"not_rendered", "not rendered", false, false, false, 5},
    [NEPH_FAILURE_PASS] = {"pass", "", false, true, false, 6},
    [NEPH_FAILURE_SKIP] = {"skip", "skip", false, false, false, 7},
    [NEPH_FAILURE_CANNOT] = {"cannot", "cannot", false, false, false, 8},
    [NEPH_FAILURE_MISSING] = {"missing", "missing", false, false, false, 9},
    [NEPH_FAILURE_NOT_YET] = {"not_yet", "not yet", false, false, false, 10},
    [NEPH_FAILURE_NOT_ASKED] = {"not_asked", "-", false, false, false, 11},
};

enum neph_failure_verdict neph_failure_judge(double value, double limit,
                                             enum neph_failure_expected expected)
{
    static const enum neph_failure_verdict table[NEPH_FAILURE_EXPECTED_COUNT][2] = {
        [NEPH_FAILURE_PASSES] = {NEPH_FAILURE_FAIL, NEPH_FAILURE_PASS},
        [NEPH_FAILURE_FAILS] = {NEPH_FAILURE_KNOWN_FAIL, NEPH_FAILURE_NEW_PASS},
        [NEPH_FAILURE_FLAKES] = {NEPH_FAILURE_FLAKE, NEPH_FAILURE_PASS},
        [NEPH_FAILURE_SKIPS] = {NEPH_FAILURE_SKIP, NEPH_FAILURE_SKIP},
    };
    if (isnan(value) && expected != NEPH_FAILURE_SKIPS)
        return NEPH_FAILURE_NO_NUMBER;
    return table[expected][value <= limit];
}

void neph_failure_count(struct neph_failure_suite *suite)
{
    struct neph_failure_counts *counts = &suite->counts;
    *counts = (struct neph_failure_counts){.compared = 0};
    for (int r = 0; r < suite->row_count; r++)
        for (int c = 0; c < suite->column_count; c++) {
            const enum neph_failure_verdict verdict = suite->rows[r].cells[c].verdict;
            counts->verdicts[verdict]++;
            counts->compared += neph_failure_verdicts[verdict].is_compared;
            counts->news += neph_failure_verdicts[verdict].is_news;
        }
    suite->passes = counts->compared > 0 && counts->news == 0;
}

double neph_failure_excess(const struct neph_failure_row *row, const struct neph_failure_cell *cell)
{
    if (isnan(cell->value))
        return NAN;
    if (row->limit->limit > 0.0)
        return cell->value / row->limit->limit;
    return cell->value > 0.0 ? INFINITY : 0.0;
}

/* -1, 0, 1; what has no number is behind what has. */
static int compare_excess(double a, double b)
{
    if (isnan(a) || isnan(b))
        return (isnan(a) > isnan(b)) - (isnan(a) < isnan(b));
    return (a < b) - (a > b);
}

static int compare_spots(const void *a_, const void *b_)
{
    const struct neph_failure_spot *a = a_, *b = b_;
    const struct neph_failure_cell *of_a = &a->row->cells[a->column];
    const struct neph_failure_cell *of_b = &b->row->cells[b->column];
    const int ranks = neph_failure_verdicts[of_a->verdict].rank -
                      neph_failure_verdicts[of_b->verdict].rank;
    if (ranks != 0)
        return ranks;
    const int order = compare_excess(neph_failure_excess(a->row, of_a),
                                     neph_failure_excess(b->row, of_b));
    if (order != 0)
        return order;
    return a->row != b->row ? (a->row < b->row ? -1 : 1) : a->column - b->column;
}

struct neph_failure_spot *neph_failure_worst(const struct neph_failure_suite *suite, int *count)
{
    const size_t most = (size_t)suite->row_count * (size_t)suite->column_count;
    struct neph_failure_spot *spots = calloc(most + 1, sizeof(*spots));
    *count = 0;
    for (int r = 0; r < suite->row_count && spots; r++)
        for (int c = 0; c < suite->column_count; c++)
            if (suite->rows[r].cells[c].verdict != NEPH_FAILURE_NOT_ASKED)
                spots[(*count)++] = (struct neph_failure_spot){&suite->rows[r], c};
    if (spots)
        qsort(spots, (size_t)*count, sizeof(*spots), compare_spots);
    return spots;
}

void neph_failure_finish(struct neph_failure_suite *suite)
{
    for (int s = 0; s < suite->scene_count; s++)
        neph_scene_destroy(suite->scenes[s]);
    free(suite->scenes);
    neph_arena_finish(&suite->arena);
    *suite = (struct neph_failure_suite){.scenes = NULL};
}
