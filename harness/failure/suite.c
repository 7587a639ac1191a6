/* SPDX-License-Identifier: MIT */
#include "harness/failure/suite.h"

#include "base/clock.h"
#include "base/interrupt.h"
#include "harness/engines/engines.h"
#include "harness/engines/vulkan_device.h"
#include "harness/experiment/pool.h"
#include "harness/failure/expectations.h"
#include "harness/failure/letter.h"
#include "harness/failure/plan.h"
#include "harness/failure/trial.h"

#include <stdio.h>
#include <stdlib.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_FAILING_TRUTH_COUNT == 2, "a new kind");

/* Guesses before the first is over, on two cores. */
static const double picture_typical_s = 0.2, take_typical_s = 3.0;

/* A page that is looked at while the run goes on need not be younger. */
static const double shown_every_s = 2.0;

struct work {
    struct neph_failure_bench bench;
    struct neph_failure_pieces pieces; /* of this process, once it is prepared */
    double start_s, shown_s;
};

/* ---- pieces ---------------------------------------------------------------------------------- */

static int compare_pieces(const void *a, const void *b)
{
    const struct neph_failure_piece *x = a, *y = b;
    if (x->is_later != y->is_later)
        return x->is_later ? 1 : -1;
    if (x->cost != y->cost)
        return x->cost > y->cost ? -1 : 1;
    return x->row != y->row ? x->row - y->row : x->column - y->column;
}

static void list_point(const struct neph_failure_suite *suite,
                       const struct neph_failure_point *point, struct neph_failure_pieces *pieces)
{
    const struct neph_failing *failing = &point->scene->failing;
    bool has_truth[2] = {false, false}; /* of engines, of presets */
    for (int c = 0; c < suite->column_count; c++)
        if (neph_failure_is_asked(suite, point, c)) {
            pieces->list[pieces->count++] = (struct neph_failure_piece){
                .row = point->first_row,
                .column = c,
                .is_later = has_truth[suite->columns[c].is_preset],
                .cost = (double)failing->frame_count * failing->width_px * failing->height_px *
                        failing->steps};
            has_truth[suite->columns[c].is_preset] = true;
        }
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

/* A worker, too, expects the whole: the time left is that of all. */
static void expect(struct neph_failure_bench *bench, const struct neph_failure_pieces *pieces)
{
    for (int i = 0; i < pieces->count; i++) {
        const struct neph_failure_piece *piece = &pieces->list[i];
        const struct neph_failure_column *column = &bench->suite->columns[piece->column];
        const struct neph_scene *scene = bench->suite->rows[piece->row].scene;
        neph_progress_expect(&bench->progress, neph_failure_kind(bench->suite, piece->column), 1,
                             column->is_preset ? take_typical_s : column->engine->typical_s);
        if (column->is_preset && !piece->is_later && scene->failing.truth == NEPH_FAILING_MARCH &&
            bench->params->width_px == 0 && !bench->params->on_device)
            neph_progress_expect(&bench->progress, NEPH_FAILURE_KIND_REFERENCE,
                                 neph_reference_picture_count(scene, 0, scene->failing.frame_count),
                                 picture_typical_s);
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

/* ---- letters --------------------------------------------------------------------------------- */

/* Tell of a trial that is over, `before` and `frame_count` being as they were before it. Pictures
 * of a reference are told of once. */
static enum neph_status
tell(const struct neph_failure_bench *bench, const struct neph_worker *worker,
     const struct neph_failure_point *point, const struct neph_failure_piece *piece,
     const struct neph_progress *before, int frame_count, struct neph_diag *diag)
{
    const struct neph_progress *now = &bench->progress;
    const int reference = NEPH_FAILURE_KIND_REFERENCE;
    const int reference_count = now->kinds[reference].done - before->kinds[reference].done;
    const struct neph_failure_letter letter = {
        .first_row = point->first_row,
        .row_count = point->row_count,
        .column = piece->column,
        .frame_count = bench->suite->frame_count - frame_count,
        .seconds = now->kinds[now->kind].spent_s - before->kinds[now->kind].spent_s,
        .reference_count = piece->is_later ? 0 : reference_count,
        .reference_s = piece->is_later
                           ? 0.0
                           : now->kinds[reference].spent_s - before->kinds[reference].spent_s,
    };
    char *text = neph_failure_letter_write(&letter, bench->suite);
    if (!text)
        return neph_fail_memory(diag);
    neph_worker_tell(worker, text);
    free(text);
    return NEPH_OK;
}

/* What another process has told, as if it were of this one. */
static enum neph_status read(struct neph_failure_bench *bench, const char *text,
                             struct neph_diag *diag)
{
    struct neph_failure_letter letter;
    char what[NEPH_FAILURE_NAME_SIZE];
    enum neph_status status = neph_failure_letter_read(text, bench->suite, &letter, diag);
    if (status)
        return status;
    const struct neph_failure_point point = neph_failure_point_at(bench->suite, letter.first_row);
    neph_failure_name(bench->suite, &point, letter.column, what);
    bench->suite->frame_count += letter.frame_count;
    neph_progress_credit(&bench->progress, NEPH_FAILURE_KIND_REFERENCE, letter.reference_count,
                         letter.reference_s);
    bench->progress.kind = neph_failure_kind(bench->suite, letter.column);
    neph_progress_step(&bench->progress, what, "measured", letter.seconds);
    neph_progress_begin(&bench->progress, "several at a time");
    return NEPH_OK;
}

/* ---- the whole ------------------------------------------------------------------------------- */

static bool is_left(const struct neph_failure_suite *suite, const struct neph_failure_piece *piece)
{
    const int row_count = neph_failure_point_at(suite, piece->row).row_count;
    bool is_left = false;
    for (int r = piece->row; r < piece->row + row_count; r++)
        is_left |= suite->rows[r].cells[piece->column].verdict == NEPH_FAILURE_NOT_YET;
    return is_left;
}

static void close_point(struct neph_failure_point *point)
{
    neph_reference_finish(&point->presets);
    neph_reference_finish(&point->engines);
    neph_scene_destroy(point->at);
    *point = (struct neph_failure_point){.scene = NULL};
}

/* `point` is that of the piece before, and then that of this one. */
static enum neph_status run_piece(struct work *work, const struct neph_worker *worker,
                                  const struct neph_failure_piece *piece,
                                  struct neph_failure_point *point, struct neph_diag *diag)
{
    struct neph_failure_bench *bench = &work->bench;
    const struct neph_progress before = bench->progress;
    const int frame_count = bench->suite->frame_count;
    enum neph_status status = NEPH_OK;
    if (!is_left(bench->suite, piece))
        return NEPH_OK;
    if (!point->at || point->first_row != piece->row) {
        close_point(point);
        *point = neph_failure_point_at(bench->suite, piece->row);
        status = neph_scene_load_point(point->scene, bench->suite->rows[piece->row].point_index,
                                       &point->at, diag);
    }
    if (!status)
        status = neph_failure_try(bench, point, piece->column, diag);
    if (status)
        return status;
    return worker->index > 0 ? tell(bench, worker, point, piece, &before, frame_count, diag)
                             : show(work, NEPH_FAILURE_RUNNING, diag);
}

/* Presets share an engine, which is probed once. */
static void probe(struct neph_failure_bench *bench)
{
    struct neph_failure_suite *suite = bench->suite;
    const struct neph_engine *realtime = neph_engine_find("realtime");
    struct neph_engine_info info;
    neph_engine_probe(realtime, bench->params->device, &info);
    snprintf(suite->device, sizeof(suite->device), "%s", info.device);
    for (int c = 0; c < suite->column_count; c++)
        if (suite->columns[c].engine == realtime)
            bench->infos[c] = info;
        else
            neph_engine_probe(suite->columns[c].engine, bench->params->device, &bench->infos[c]);
}

/* Engines are probed, and the time is guessed, once in each process. */
static enum neph_status prepare(struct work *work, bool is_worker, struct neph_diag *diag)
{
    struct neph_failure_bench *bench = &work->bench;
    if (work->pieces.list)
        return NEPH_OK;
    bench->progress = neph_progress_start(bench->params->quiet || is_worker, 0);
    bench->progress.workers = bench->params->jobs;
    probe(bench);
    const enum neph_status status = neph_failure_pieces_list(bench->suite, is_worker, &work->pieces,
                                                             diag);
    if (!status)
        expect(bench, &work->pieces);
    return status;
}

/* The pieces of a worker, one after the other. */
static enum neph_status run_pieces(struct neph_worker *worker, void *context,
                                   struct neph_diag *diag)
{
    struct work *work = context;
    struct neph_failure_point point = {.scene = NULL};
    enum neph_status status = prepare(work, worker->index > 0, diag);
    for (int next; !status && (next = neph_worker_next(worker)) < work->pieces.count;)
        status = run_piece(work, worker, &work->pieces.list[next], &point, diag);
    close_point(&point);
    neph_progress_end(&work->bench.progress);
    if (worker->index > 0)
        neph_shared_device_close(work->bench.params->device);
    return status;
}

static enum neph_status hear(const char *text, void *context, struct neph_diag *diag)
{
    struct work *work = context;
    enum neph_status status = prepare(work, false, diag);
    if (!status && text)
        status = read(&work->bench, text, diag);
    return status ? status : show(work, NEPH_FAILURE_RUNNING, diag);
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
        neph_shared_device_close(params->device); /* other processes open their own */
    if (!status)
        status = neph_pool_run(params->jobs, run_pieces, hear, &work, diag);
    json_decref(work.bench.expectations);
    free(work.pieces.list);
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
