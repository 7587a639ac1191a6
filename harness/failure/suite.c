/* SPDX-License-Identifier: MIT */
#include "harness/failure/suite.h"

#include "base/clock.h"
#include "base/interrupt.h"
#include "harness/engines/engines.h"
#include "harness/failure/expectations.h"
#include "harness/failure/plan.h"
#include "harness/failure/share.h"
#include "harness/failure/trial.h"

#include <stdio.h>
#include <string.h>

/* Guesses before the first is over, on two cores. */
static const double picture_typical_s = 0.2, take_typical_s = 3.0;

/* A page that is looked at while the run goes on need not be younger. */
static const double shown_every_s = 2.0;

struct work {
    struct neph_failure_bench bench;
    double start_s, shown_s;
};

/* ---- what is ahead --------------------------------------------------------------------------- */

static void expect_references(struct neph_failure_bench *bench,
                              const struct neph_failure_point *point)
{
    const struct neph_failing *failing = &point->scene->failing;
    bool is_asked = false;
    for (int c = 0; c < bench->suite->column_count; c++)
        is_asked |= bench->suite->columns[c].is_preset &&
                    neph_failure_is_asked(bench->suite, point, c);
    if (is_asked && failing->truth == NEPH_FAILING_MARCH && bench->params->width_px == 0 &&
        !bench->params->on_device)
        neph_progress_expect(&bench->progress, NEPH_FAILURE_KIND_REFERENCE,
                             neph_reference_picture_count(point->scene, 0, failing->frame_count),
                             picture_typical_s);
}

static void expect_point(struct neph_failure_bench *bench, const struct neph_failure_point *point)
{
    expect_references(bench, point);
    for (int c = 0; c < bench->suite->column_count; c++) {
        const struct neph_failure_column *column = &bench->suite->columns[c];
        if (neph_failure_is_asked(bench->suite, point, c))
            neph_progress_expect(&bench->progress,
                                 column->is_preset ? NEPH_FAILURE_KIND_TAKE
                                                   : NEPH_FAILURE_KIND_ENGINE + c,
                                 1, column->is_preset ? take_typical_s : column->engine->typical_s);
    }
}

/* A share, too, expects the whole: the time left is that of all. */
static void expect(struct neph_failure_bench *bench)
{
    const struct neph_failure_suite *suite = bench->suite;
    for (int row = 0; row < suite->row_count;) {
        const struct neph_failure_point point = neph_failure_point_at(suite, row);
        expect_point(bench, &point);
        row += point.row_count;
    }
}

/* What is over in this process is told to the one that has the line on the terminal. */
static void exchange(struct neph_failure_bench *bench, const struct neph_share *share,
                     const struct neph_progress *before)
{
    for (int k = 0; k < NEPH_PROGRESS_KINDS; k++) {
        int steps = bench->progress.kinds[k].done - before->kinds[k].done;
        double seconds = bench->progress.kinds[k].spent_s - before->kinds[k].spent_s;
        if (share->index > 0 && steps > 0)
            neph_share_tell(share, k, steps, seconds);
        if (share->index > 0)
            continue;
        neph_share_hear(share, k, &steps, &seconds);
        neph_progress_credit(&bench->progress, k, steps, seconds);
    }
}

/* ---- showing --------------------------------------------------------------------------------- */

static enum neph_status show(struct work *work, enum neph_failure_state state,
                             struct neph_diag *diag)
{
    const struct neph_failure_params *params = work->bench.params;
    struct neph_failure_suite *suite = work->bench.suite;
    const double now_s = neph_wall_s();
    const bool is_due = state != NEPH_FAILURE_RUNNING || now_s - work->shown_s >= shown_every_s;
    suite->state = state;
    suite->seconds = now_s - work->start_s;
    suite->left_s = neph_progress_left_s(&work->bench.progress);
    neph_progress_count(&work->bench.progress, &suite->steps_done, &suite->steps_total);
    neph_failure_count(suite);
    if (!params->show || !is_due)
        return NEPH_OK;
    const enum neph_status status = params->show(suite, params->context, diag);
    work->shown_s = neph_wall_s();
    return status;
}

/* A run that did not finish has a page that does not say for ever that it runs. */
static void show_end(struct work *work)
{
    struct neph_diag why = {.line = 0};
    if (show(work, NEPH_FAILURE_INTERRUPTED, &why))
        neph_progress_warn("%s", why.message);
}

/* ---- the whole ------------------------------------------------------------------------------- */

static enum neph_status run_point(struct work *work, const struct neph_share *share,
                                  struct neph_failure_point *point, struct neph_diag *diag)
{
    struct neph_failure_bench *bench = &work->bench;
    const int number = bench->suite->rows[point->first_row].point_index;
    enum neph_status status = neph_scene_load_point(point->scene, number, &point->at, diag);
    for (int c = 0; c < bench->suite->column_count && !status; c++) {
        const struct neph_progress before = bench->progress;
        if (!neph_failure_is_asked(bench->suite, point, c))
            continue;
        status = neph_failure_try(bench, point, c, diag);
        exchange(bench, share, &before);
        if (!status && share->index == 0)
            status = show(work, NEPH_FAILURE_RUNNING, diag);
    }
    neph_reference_finish(&point->presets);
    neph_reference_finish(&point->engines);
    neph_scene_destroy(point->at);
    return status;
}

/* Presets share an engine, which is asked once. */
static void probe(struct neph_failure_bench *bench)
{
    struct neph_failure_suite *suite = bench->suite;
    const struct neph_engine *realtime = neph_engine_find("realtime");
    struct neph_engine_info info;
    neph_engine_probe(realtime, &info);
    snprintf(suite->device, sizeof(suite->device), "%s", info.device);
    for (int c = 0; c < suite->column_count; c++)
        if (suite->columns[c].engine == realtime)
            bench->infos[c] = info;
        else
            neph_engine_probe(suite->columns[c].engine, &bench->infos[c]);
}

/* The first row of a point by its number; row_count when there is none. */
static int first_row_of(const struct neph_failure_suite *suite, int number)
{
    int row = 0;
    while (row < suite->row_count && number-- > 0)
        row += neph_failure_point_at(suite, row).row_count;
    return row;
}

/* The points of a share, one after the other. */
static enum neph_status run_share(struct neph_share *share, void *context, struct neph_diag *diag)
{
    struct work *work = context;
    struct neph_failure_bench *bench = &work->bench;
    struct neph_failure_suite *suite = bench->suite;
    enum neph_status status = NEPH_OK;
    int row;
    bench->again = share->again;
    bench->progress = neph_progress_start(bench->params->quiet || share->index > 0 || share->again,
                                          0);
    bench->progress.workers = share->count;
    probe(bench);
    suite->frame_count = 0;
    expect(bench);
    while (!status && (row = first_row_of(suite, neph_share_next(share))) < suite->row_count) {
        struct neph_failure_point point = neph_failure_point_at(suite, row);
        status = run_point(work, share, &point, diag);
    }
    neph_progress_end(&bench->progress);
    return status;
}

enum neph_status neph_failure_run(const struct neph_failure_params *params,
                                  struct neph_store *store, struct neph_failure_suite *suite,
                                  struct neph_diag *diag)
{
    struct work work = {.bench = {.params = params, .suite = suite, .store = store},
                        .start_s = neph_wall_s()};
    enum neph_status status = neph_failure_plan(params, suite, diag);
    if (!status)
        status = neph_failure_expectations_load(NULL, &work.bench.expectations, diag);
    if (!status)
        status = neph_shares_run(params->jobs, run_share, &work, diag);
    json_decref(work.bench.expectations);
    if (!status)
        status = neph_arena_check(&suite->arena, diag);
    if (status == NEPH_ERR_INTERRUPTED) {
        neph_hint(diag, "what is finished is in the store: the same command goes on from there");
        neph_interrupt_acknowledge();
    }
    if (!status)
        return show(&work, NEPH_FAILURE_FINISHED, diag);
    if (status == NEPH_ERR_INTERRUPTED || work.shown_s > 0.0)
        show_end(&work);
    return status;
}
