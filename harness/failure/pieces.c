/* SPDX-License-Identifier: MIT */
#include "harness/failure/pieces.h"

#include "harness/failure/trial.h"

#include <stdlib.h>

static double cost_of(const struct neph_failing *failing)
{
    return (double)failing->frame_count * failing->width_px * failing->height_px * failing->steps;
}

/* Presets have one truth at a point, engines another. */
static bool has_earlier(const struct neph_failure_suite *suite,
                        const struct neph_failure_point *point, int column)
{
    for (int c = 0; c < column; c++)
        if (suite->columns[c].is_preset == suite->columns[column].is_preset &&
            neph_failure_is_asked(suite, point, c))
            return true;
    return false;
}

static void list_point(const struct neph_failure_suite *suite,
                       const struct neph_failure_point *point, struct neph_failure_pieces *pieces)
{
    for (int c = 0; c < suite->column_count; c++)
        if (neph_failure_is_asked(suite, point, c))
            pieces->list[pieces->count++] = (struct neph_failure_piece){
                point->first_row, c, has_earlier(suite, point, c), cost_of(&point->scene->failing)};
}

static int compare_pieces(const void *a, const void *b)
{
    const struct neph_failure_piece *x = a, *y = b;
    if (x->is_later != y->is_later)
        return x->is_later ? 1 : -1;
    if (x->cost != y->cost)
        return x->cost > y->cost ? -1 : 1;
    return x->row != y->row ? x->row - y->row : x->column - y->column;
}

enum neph_status neph_failure_pieces_list(const struct neph_failure_suite *suite, bool are_spread,
                                          struct neph_failure_pieces *pieces,
                                          struct neph_diag *diag)
{
    const size_t most = (size_t)suite->row_count * (size_t)suite->column_count;
    *pieces = (struct neph_failure_pieces){.list = calloc(most + 1, sizeof(*pieces->list))};
    if (!pieces->list)
        return neph_fail_memory(diag);
    for (int row = 0; row < suite->row_count;) {
        const struct neph_failure_point point = neph_failure_point_at(suite, row);
        list_point(suite, &point, pieces);
        row += point.row_count;
    }
    if (are_spread)
        qsort(pieces->list, (size_t)pieces->count, sizeof(*pieces->list), compare_pieces);
    return NEPH_OK;
}
