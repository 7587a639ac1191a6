/* SPDX-License-Identifier: MIT
 *
 * The run of the stress tests: order of trials, worker processes, messages, page.
 */
#include "harness/stress/suite.h"

#include "base/clock.h"
#include "base/interrupt.h"
#include "harness/engines/engines.h"
#include "harness/engines/vulkan_device.h"
#include "harness/experiment/pool.h"
#include "harness/json.h"
#include "harness/stress/expectations.h"
#include "harness/stress/page.h"
#include "harness/stress/trial.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Fails to compile when a kind is added, as register_trial_progress() counts the frames of
 * references. */
_Static_assert(NEPH_FAILING_REFERENCE_COUNT == 2, "a new kind");

/* Expected seconds before the first step has finished, on two cores. */
static const double picture_typical_s = 0.2, take_typical_s = 3.0;

/* Seconds between updates of the page. */
static const double page_interval_s = 2.0;

struct work {
    struct neph_stress_context bench;
    struct neph_stress_trials trials; /* list of this process, after prepare() */
    double start_s, shown_s;
};

/* ---- trials ---------------------------------------------------------------------------------- */

static int compare_trials(const void *a, const void *b)
{
    const struct neph_stress_trial *x = a, *y = b;
    if (x->is_later != y->is_later)
        return x->is_later ? 1 : -1;
    if (x->cost != y->cost)
        return x->cost > y->cost ? -1 : 1;
    return x->row != y->row ? x->row - y->row : x->column - y->column;
}

static void list_point(const struct neph_stress_suite *suite, const struct neph_stress_point *point,
                       struct neph_stress_trials *trials)
{
    const struct neph_failing *failing = point->scene->failing;
    bool has_truth[2] = {false, false}; /* of engines, of presets */
    for (int c = 0; c < suite->column_count + suite->floor_count; c++)
        if (neph_stress_has_trial(suite, point, c)) {
            trials->list[trials->count++] = (struct neph_stress_trial){
                .row = point->first_row,
                .column = c,
                .is_later = has_truth[suite->columns[c].is_preset],
                .cost = (double)failing->frame_count * failing->width_px * failing->height_px *
                        failing->steps};
            has_truth[suite->columns[c].is_preset] = true;
        }
}

enum neph_status neph_stress_list_trials(struct neph_stress_suite *suite, bool are_spread,
                                         struct neph_stress_trials *trials, struct neph_diag *diag)
{
    const size_t most = (size_t)suite->row_count *
                        (size_t)(suite->column_count + suite->floor_count);
    *trials = (struct neph_stress_trials){
        .list = neph_arena_allocate(&suite->arena, most, sizeof(*trials->list))};
    if (!trials->list)
        return neph_fail_memory(diag);
    for (int row = 0; row < suite->row_count;) {
        const struct neph_stress_point point = neph_stress_point_at(suite, row);
        list_point(suite, &point, trials);
        row += point.row_count;
    }
    if (are_spread)
        qsort(trials->list, (size_t)trials->count, sizeof(*trials->list), compare_trials);
    return NEPH_OK;
}

/* Registers all trials in the progress, also in workers: the remaining time is the whole run's. */
static void register_trial_progress(struct neph_stress_context *bench,
                                    const struct neph_stress_trials *trials)
{
    for (int i = 0; i < trials->count; i++) {
        const struct neph_stress_trial *trial = &trials->list[i];
        const struct neph_stress_column *column = &bench->suite->columns[trial->column];
        const struct neph_scene *scene = bench->suite->rows[trial->row].scene;
        neph_progress_expect(&bench->progress, neph_stress_kind(bench->suite, trial->column), 1,
                             column->is_preset ? take_typical_s : column->engine->typical_s);
        if (column->is_preset && !trial->is_later && scene->failing->truth == NEPH_FAILING_MARCH &&
            bench->params->width_px == 0 && !bench->params->on_device)
            neph_progress_expect(&bench->progress, NEPH_STRESS_KIND_REFERENCE,
                                 neph_reference_frame_count(scene, 0, scene->failing->frame_count),
                                 picture_typical_s);
    }
}

/* ---- publishing ------------------------------------------------------------------------------ */

static enum neph_status update_page(struct work *work, enum neph_stress_state state,
                                    struct neph_diag *diag)
{
    const struct neph_stress_params *params = work->bench.params;
    struct neph_stress_suite *suite = work->bench.suite;
    const double now_s = neph_wall_s();
    const bool is_due = state != NEPH_STRESS_RUNNING || now_s - work->shown_s >= page_interval_s;
    suite->state = state;
    suite->seconds = now_s - work->start_s;
    suite->left_s = neph_progress_left_s(&work->bench.progress);
    neph_progress_count(&work->bench.progress, &suite->steps_done, &suite->steps_total);
    neph_stress_count(suite);
    if (!params->page || !is_due)
        return NEPH_OK;
    const enum neph_status status = neph_stress_page_publish(suite, params->page, diag);
    work->shown_s = neph_wall_s();
    return status;
}

/* Publishes the final page of an interrupted run, so that it does not stay in the state "running".
 */
static void publish_interrupted_page(struct work *work)
{
    struct neph_diag why = {.line = 0};
    if (update_page(work, NEPH_STRESS_INTERRUPTED, &why))
        neph_progress_warn("%s", why.message);
}

/* ---- messages -------------------------------------------------------------------------------- */

char *neph_stress_write_message(const struct neph_stress_message *message,
                                const struct neph_stress_suite *suite)
{
    json_t *cells = json_array();
    for (int r = 0; r < message->row_count; r++) {
        const struct neph_stress_row *row = &suite->rows[message->first_row + r];
        const struct neph_stress_cell *cell = &row->cells[message->column];
        neph_json_add(&cells,
                      json_pack("{s:o, s:b, s:i, s:o, s:s?, s:s?}", "value",
                                neph_json_number(cell->value), "infinite", isinf(cell->value) != 0,
                                "verdict", (int)cell->verdict, "why", neph_json_cleaned(cell->why),
                                "evidence", cell->evidence, "frame_key", cell->frame_key));
    }
    json_t *json = json_pack("{s:i, s:i, s:i, s:f, s:i, s:f, s:o}", "row", message->first_row,
                             "column", message->column, "frames", message->frame_count, "seconds",
                             message->seconds, "references", message->reference_count,
                             "reference_s", message->reference_s, "cells", cells);
    char *text = json_dumps(json, JSON_COMPACT);
    json_decref(json);
    return text;
}

static bool read_cell(json_t *json, struct neph_stress_suite *suite, struct neph_stress_cell *cell)
{
    const char *why;
    int verdict, is_infinite;
    if (json_unpack(json, "{s:b, s:i, s:s}", "infinite", &is_infinite, "verdict", &verdict, "why",
                    &why) != 0 ||
        verdict < 0 || verdict >= NEPH_STRESS_VERDICTS)
        return false;
    *cell = (struct neph_stress_cell){
        .value = is_infinite ? INFINITY : neph_json_real(json, "value"),
        .verdict = (enum neph_stress_verdict)verdict,
        .why = neph_arena_copy_text(&suite->arena, why),
        .evidence = neph_arena_copy_text(&suite->arena,
                                         json_string_value(json_object_get(json, "evidence"))),
        .frame_key = neph_arena_copy_text(&suite->arena,
                                          json_string_value(json_object_get(json, "frame_key"))),
    };
    return true;
}

static bool read_message(json_t *json, struct neph_stress_suite *suite,
                         struct neph_stress_message *message)
{
    json_t *cells;
    if (json_unpack(json, "{s:i, s:i, s:i, s:F, s:i, s:F, s:o}", "row", &message->first_row,
                    "column", &message->column, "frames", &message->frame_count, "seconds",
                    &message->seconds, "references", &message->reference_count, "reference_s",
                    &message->reference_s, "cells", &cells) != 0)
        return false;
    message->row_count = (int)json_array_size(cells);
    bool is_read = message->row_count > 0 && message->first_row >= 0 && message->column >= 0 &&
                   message->column < suite->column_count + suite->floor_count &&
                   message->first_row + message->row_count <= suite->row_count;
    for (int r = 0; r < message->row_count && is_read; r++)
        is_read = read_cell(json_array_get(cells, (size_t)r), suite,
                            &suite->rows[message->first_row + r].cells[message->column]);
    return is_read;
}

enum neph_status neph_stress_read_message(const char *text, struct neph_stress_suite *suite,
                                          struct neph_stress_message *message,
                                          struct neph_diag *diag)
{
    json_t *json = json_loads(text, 0, NULL);
    const bool is_read = json && read_message(json, suite, message);
    json_decref(json);
    return is_read
               ? NEPH_OK
               : neph_fail(diag, NEPH_ERR_INTERNAL, "a worker sent no valid result: %.60s", text);
}

/* Sends the results of a finished trial. `before` and `frame_count` are the values before it. The
 * frames of a reference are reported once. */
static enum neph_status
send_trial_result(const struct neph_stress_context *bench, const struct neph_worker *worker,
                  const struct neph_stress_point *point, const struct neph_stress_trial *trial,
                  const struct neph_progress *before, int frame_count, struct neph_diag *diag)
{
    const struct neph_progress *now = &bench->progress;
    const int reference = NEPH_STRESS_KIND_REFERENCE;
    const int reference_count = now->kinds[reference].done - before->kinds[reference].done;
    const struct neph_stress_message message = {
        .first_row = point->first_row,
        .row_count = point->row_count,
        .column = trial->column,
        .frame_count = bench->suite->frame_count - frame_count,
        .seconds = now->kinds[now->kind].spent_s - before->kinds[now->kind].spent_s,
        .reference_count = trial->is_later ? 0 : reference_count,
        .reference_s = trial->is_later
                           ? 0.0
                           : now->kinds[reference].spent_s - before->kinds[reference].spent_s,
    };
    char *text = neph_stress_write_message(&message, bench->suite);
    if (!text)
        return neph_fail_memory(diag);
    neph_worker_send_message(worker, text);
    free(text);
    return NEPH_OK;
}

/* Adds the results of another process. */
static enum neph_status add_worker_result(struct neph_stress_context *bench, const char *text,
                                          struct neph_diag *diag)
{
    struct neph_stress_message message;
    char what[NEPH_STRESS_NAME_SIZE];
    enum neph_status status = neph_stress_read_message(text, bench->suite, &message, diag);
    if (status)
        return status;
    const struct neph_stress_point point = neph_stress_point_at(bench->suite, message.first_row);
    neph_stress_name(bench->suite, &point, message.column, what);
    bench->suite->frame_count += message.frame_count;
    neph_progress_credit(&bench->progress, NEPH_STRESS_KIND_REFERENCE, message.reference_count,
                         message.reference_s);
    bench->progress.kind = neph_stress_kind(bench->suite, message.column);
    neph_progress_step(&bench->progress, what, "measured", message.seconds);
    neph_progress_begin(&bench->progress, "several at a time");
    return NEPH_OK;
}

/* ---- the whole run --------------------------------------------------------------------------- */

static bool is_left(const struct neph_stress_suite *suite, const struct neph_stress_trial *trial)
{
    const int row_count = neph_stress_point_at(suite, trial->row).row_count;
    bool is_left = false;
    for (int r = trial->row; r < trial->row + row_count; r++)
        is_left |= suite->rows[r].cells[trial->column].verdict == NEPH_STRESS_NOT_YET;
    return is_left;
}

static void close_point(struct neph_stress_point *point)
{
    neph_reference_finish(&point->presets);
    neph_reference_finish(&point->engines);
    neph_scene_destroy(point->at);
    *point = (struct neph_stress_point){.scene = NULL};
}

/* Runs a trial. `point` is the previous trial's point, and becomes this trial's point. */
static enum neph_status run_trial(struct work *work, const struct neph_worker *worker,
                                  const struct neph_stress_trial *trial,
                                  struct neph_stress_point *point, struct neph_diag *diag)
{
    struct neph_stress_context *bench = &work->bench;
    const struct neph_progress before = bench->progress;
    const int frame_count = bench->suite->frame_count;
    enum neph_status status = NEPH_OK;
    if (!is_left(bench->suite, trial))
        return NEPH_OK;
    if (!point->at || point->first_row != trial->row) {
        close_point(point);
        *point = neph_stress_point_at(bench->suite, trial->row);
        status = neph_scene_load_point(point->scene, bench->suite->rows[trial->row].point_index,
                                       &point->at, diag);
    }
    if (!status)
        status = neph_stress_try(bench, point, trial->column, diag);
    if (status)
        return status;
    return worker->index > 0
               ? send_trial_result(bench, worker, point, trial, &before, frame_count, diag)
               : update_page(work, NEPH_STRESS_RUNNING, diag);
}

/* Probes each engine; presets share the one of `realtime`. */
static void probe(struct neph_stress_context *bench)
{
    struct neph_stress_suite *suite = bench->suite;
    const struct neph_engine *realtime = neph_engine_find("realtime");
    struct neph_engine_info info;
    neph_engine_probe(realtime, bench->params->device, &info);
    snprintf(suite->device, sizeof(suite->device), "%s", info.device);
    for (int c = 0; c < suite->column_count + suite->floor_count; c++)
        if (suite->columns[c].engine == realtime)
            bench->infos[c] = info;
        else
            neph_engine_probe(suite->columns[c].engine, bench->params->device, &bench->infos[c]);
}

/* Probes the engines and registers the trials, once in each process. */
static enum neph_status prepare(struct work *work, bool is_worker, struct neph_diag *diag)
{
    struct neph_stress_context *bench = &work->bench;
    if (work->trials.list)
        return NEPH_OK;
    bench->progress = neph_progress_start(bench->params->quiet || is_worker, 0);
    bench->progress.workers = bench->params->jobs;
    probe(bench);
    const enum neph_status status = neph_stress_list_trials(bench->suite, is_worker, &work->trials,
                                                            diag);
    if (!status)
        register_trial_progress(bench, &work->trials);
    return status;
}

/* Runs a worker's trials. */
static enum neph_status run_trials(struct neph_worker *worker, void *context,
                                   struct neph_diag *diag)
{
    struct work *work = context;
    struct neph_stress_point point = {.scene = NULL};
    enum neph_status status = prepare(work, worker->index > 0, diag);
    for (int next; !status && (next = neph_worker_take_job(worker)) < work->trials.count;)
        status = run_trial(work, worker, &work->trials.list[next], &point, diag);
    close_point(&point);
    neph_progress_end(&work->bench.progress);
    return status;
}

static enum neph_status handle_worker_message(const char *text, void *context,
                                              struct neph_diag *diag)
{
    struct work *work = context;
    enum neph_status status = prepare(work, false, diag);
    if (!status && text)
        status = add_worker_result(&work->bench, text, diag);
    return status ? status : update_page(work, NEPH_STRESS_RUNNING, diag);
}

enum neph_status neph_stress_run(const struct neph_stress_params *params, struct neph_store *store,
                                 struct neph_stress_suite *suite, struct neph_diag *diag)
{
    struct work work = {.bench = {.params = params, .suite = suite, .store = store},
                        .start_s = neph_wall_s()};
    enum neph_status status = neph_stress_plan(params, suite, diag);
    if (!status)
        status = neph_stress_expectations_load(NULL, &work.bench.expectations, diag);
    if (!status)
        status = neph_pool_run(params->jobs, params->device, run_trials, handle_worker_message,
                               &work, diag);
    json_decref(work.bench.expectations);
    if (!status)
        status = neph_arena_check(&suite->arena, diag);
    if (status == NEPH_ERR_INTERRUPTED) {
        neph_hint(diag, "finished frames are in the store: the same command continues from there");
        neph_interrupt_acknowledge();
    }
    if (!status)
        return update_page(&work, NEPH_STRESS_FINISHED, diag);
    if (status == NEPH_ERR_INTERRUPTED || work.shown_s > 0.0)
        publish_interrupted_page(&work);
    return status;
}
