/* SPDX-License-Identifier: MIT */
#include "harness/failure/results.h"

#include <math.h>
#include <stdlib.h>

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
