/* SPDX-License-Identifier: MIT */
#include "harness/night/night.h"

#include "base/clock.h"
#include "base/files.h"
#include "base/path.h"
#include "harness/night/scene_copy.h"
#include "harness/run/history.h"
#include "harness/run/history_check.h"
#include "harness/run/store_keep.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* Significance level of all tests of a run together; the backtest in tests/harness/test_backtest.c
 * uses the same value. */
static const double alpha = 0.005;

/* The share of the steps that each run repeats. */
static const double again_share = 0.02;

/* True when the numbers were measured on this version of the scene: its file may have changed while
 * the step ran. */
static bool is_measured(const struct neph_night_numbers *numbers,
                        const struct neph_history_scene *scene, struct neph_arena *arena)
{
    const char *hash = neph_arena_format(arena, "@%.8s/", scene->hash);
    for (int i = 0; i < numbers->count; i++)
        if (strstr(numbers->list[i].series, hash))
            return true;
    return false;
}

/* Store the scene of a finished step with a copy of its file. A scene that can no longer be loaded
 * is skipped; a later run then has no accepted version to render. */
static enum neph_status keep_scene(struct neph_night_work *work, struct neph_database *index,
                                   const struct neph_night_step *step,
                                   const struct neph_night_numbers *numbers, struct neph_diag *diag)
{
    struct neph_arena *arena = &work->night->arena;
    struct neph_history_scene scene = {.step = step->name};
    struct neph_diag why = {.line = 0};
    if (!step->scene)
        return NEPH_OK;
    const enum neph_status status = neph_scene_copy_keep(neph_store_folder(work->store),
                                                         step->scene, arena, &scene, &why);
    if (neph_step_ends_night(status, &why, diag))
        return status;
    if (status)
        neph_progress_warn("the store gets no copy of scene '%s': %s", step->scene, why.message);
    return status || !is_measured(numbers, &scene, arena)
               ? NEPH_OK
               : neph_history_add_scene(index, work->night->id, &scene, diag);
}

static enum neph_status keep_step(struct neph_night_work *work, int step,
                                  const struct neph_history_step *record,
                                  const struct neph_night_numbers *numbers, struct neph_diag *diag)
{
    struct neph_database *index = NULL;
    enum neph_status status = neph_store_index(work->store, &index, diag);
    if (!status)
        status = neph_history_add(index, work->night->id, record, numbers->list, numbers->count,
                                  diag);
    if (!status && strcmp(record->outcome, neph_step_done) == 0)
        status = keep_scene(work, index, &work->night->plan.steps[step], numbers, diag);
    neph_database_close(index);
    return status;
}

static enum neph_status show(struct neph_night_work *work, struct neph_diag *diag)
{
    work->night->seconds = neph_wall_s() - work->start_s;
    return work->params->show ? work->params->show(work->night, work->params->context, diag)
                              : NEPH_OK;
}

static enum neph_status run_steps(struct neph_night_work *work, struct neph_diag *diag)
{
    struct neph_night *night = work->night;
    enum neph_status status = NEPH_OK;
    while (!status) {
        const double left_s = work->params->budget_s - (neph_wall_s() - work->start_s);
        const int index = neph_night_plan_next(&night->plan, work->history, work->ran, left_s,
                                               work->ran_count == 0);
        if (index < 0)
            break;
        struct neph_history_step record;
        struct neph_night_numbers numbers;
        neph_progress_begin(&work->progress, night->plan.steps[index].name);
        status = neph_step_run(&work->place, &night->plan.steps[index], work->params->output,
                               neph_night_log(work, index, ".log"), neph_night_limit_s(work, index),
                               &record, &numbers, diag);
        if (!status)
            status = keep_step(work, index, &record, &numbers, diag);
        if (status)
            break;
        neph_night_note(work, index, record.outcome, record.reason);
        work->longest_s[index] = fmax(work->longest_s[index], record.wall_s);
        status = show(work, diag);
        neph_progress_step(&work->progress, record.name, record.outcome, record.wall_s);
    }
    return status;
}

/* ---- results of jobs ------------------------------------------------------------------------- */

/* Read the result file of a step's job. Nothing is recorded for a step without a job, or for one
 * that started too late. */
static enum neph_status collect_step(struct neph_night_work *work, int index,
                                     struct neph_diag *diag)
{
    const struct neph_night_step *step = &work->night->plan.steps[index];
    struct neph_history_step record = {
        .name = step->name,
        .outcome = "failed",
        .reason = "its job ended without a result: see nightly/logs/slurm-*",
        .size = "",
        .calibration_s = NAN};
    struct neph_night_numbers numbers = {.count = 0};
    struct neph_night_job job;
    bool found = false;
    if (!neph_night_jobs_find(&work->jobs, step->name, &job))
        return NEPH_OK;
    enum neph_status status = neph_night_jobs_load(&work->jobs, step, &found, &record, &numbers,
                                                   diag);
    if (status || strcmp(record.outcome, neph_night_job_not_run) == 0)
        return status;
    status = keep_step(work, index, &record, &numbers, diag);
    if (!status)
        neph_night_note(work, index, record.outcome, record.reason);
    return status;
}

static enum neph_status collect_steps(struct neph_night_work *work, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < work->night->plan.count && !status; i++)
        status = collect_step(work, i, diag);
    return status;
}

/* ---- repeated steps -------------------------------------------------------------------------- */

static void report_different_bits(struct neph_night_work *work, const char *series,
                                  const struct neph_night_step *step, const char *words,
                                  double value)
{
    struct neph_finding finding = neph_finding(NEPH_FOUND_BITS, series, step->name, words);
    finding.tonight = value;
    finding.example = strchr(series, '/') ? series : "";
    neph_night_add_finding(&work->night->comparison, &finding);
}

/* Compare a number of the repeated step with the stored one. */
static enum neph_status compare_number(struct neph_night_work *work, struct neph_database *index,
                                       const struct neph_night_step *step,
                                       const struct neph_measurement *m, struct neph_diag *diag)
{
    int64_t all = 0, others = 0;
    enum neph_status status = neph_database_count(
        index, &all, diag,
        "SELECT count(*) FROM measurements JOIN series ON series.id = series WHERE night = ? AND "
        "name = ?",
        "is", work->night->id, m->series);
    if (!status)
        status = neph_database_count(
            index, &others, diag,
            "SELECT count(*) FROM measurements JOIN series ON series.id = series WHERE night = ? "
            "AND name = ? AND environment = ? AND value != ?",
            "issd", work->night->id, m->series, m->environment, m->value);
    if (!status && all == 0)
        report_different_bits(
            work, m->series, step,
            "run once more in an empty folder, the same program gave a number that it "
            "had not given",
            m->value);
    if (!status && others > 0)
        report_different_bits(
            work, m->series, step,
            "run once more in an empty folder, the same program gave another number", m->value);
    return status;
}

static bool has_series(const struct neph_night_numbers *numbers, const char *series)
{
    for (int i = 0; i < numbers->count; i++)
        if (strcmp(numbers->list[i].series, series) == 0)
            return true;
    return false;
}

/* Report the numbers that the first run of a step has and the repetition lacks. */
static enum neph_status find_lost(struct neph_night_work *work, struct neph_database *index,
                                  const struct neph_night_step *step,
                                  const struct neph_night_numbers *numbers, struct neph_diag *diag)
{
    struct neph_records names;
    const enum neph_status status = neph_record_select(
        index, &work->night->comparison.arena, &neph_record_text_form, &names, diag,
        "SELECT name FROM measurements JOIN series ON series.id = series WHERE night = ? AND step "
        "= ?",
        "is", work->night->id, step->name);
    const char *const *list = names.list;
    for (int i = 0; i < names.count; i++)
        if (!has_series(numbers, list[i]))
            report_different_bits(
                work, list[i], step,
                "run once more in an empty folder, the same program did not give this "
                "number",
                NAN);
    return status;
}

static enum neph_status compare_bits(struct neph_night_work *work,
                                     const struct neph_night_step *step,
                                     const struct neph_night_numbers *numbers,
                                     struct neph_diag *diag)
{
    struct neph_database *index = NULL;
    enum neph_status status = neph_store_index(work->store, &index, diag);
    for (int i = 0; i < numbers->count && !status; i++)
        status = compare_number(work, index, step, &numbers->list[i], diag);
    if (!status)
        status = find_lost(work, index, step, numbers, diag);
    neph_database_close(index);
    return status;
}

/* Run a step again in an empty folder. `numbers` are allocated in the arena. */
static enum neph_status measure_again(struct neph_night_work *work, int index,
                                      struct neph_night_numbers *numbers, struct neph_diag *diag)
{
    const struct neph_path folder = neph_path_in(work->folder, "again");
    enum neph_status status = neph_dir_remove(folder.text, diag);
    if (!status)
        status = neph_step_measure(&work->place, &work->night->plan.steps[index], folder.text,
                                   neph_night_log(work, index, "_again.log"),
                                   neph_night_limit_s(work, index), numbers, diag);
    neph_dir_remove(folder.text, NULL);
    return status;
}

/* Returns an error only when the whole run must end, as neph_step_run(). */
static enum neph_status run_again(struct neph_night_work *work, int index, struct neph_diag *diag)
{
    const struct neph_night_step *step = &work->night->plan.steps[index];
    struct neph_night_numbers numbers = {.count = 0};
    struct neph_diag why = {.line = 0};
    const enum neph_status status = measure_again(work, index, &numbers, &why);
    if (!status) {
        work->night->again_count++;
        return compare_bits(work, step, &numbers, diag);
    }
    if (neph_step_ends_night(status, &why, diag))
        return status;
    report_different_bits(
        work, step->name, step,
        neph_arena_format(&work->night->comparison.arena,
                          "it was done, and run once more in an empty folder it was "
                          "not: %s",
                          why.message),
        NAN);
    return NEPH_OK;
}

/* Repeat a part of the plan that rotates with the run's number. Durations are left out: every run
 * measures them again anyway. */
static enum neph_status run_some_again(struct neph_night_work *work, struct neph_diag *diag)
{
    const struct neph_night_plan *plan = &work->night->plan;
    const int wanted = (int)ceil(again_share * plan->count);
    int tried = 0;
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < plan->count && tried < wanted && !status; i++) {
        const int index = (int)((work->night->id * wanted + i) % plan->count);
        const bool is_done = work->ran[index] &&
                             strcmp(work->outcomes[index].outcome, neph_step_done) == 0;
        if (!is_done || plan->steps[index].suite == NEPH_NIGHT_SPEED)
            continue;
        tried++;
        status = run_again(work, index, diag);
    }
    return status;
}

/* List the keys of the frames that were used after the start of the run. */
static enum neph_status list_frames(struct neph_night_work *work, struct neph_database *index,
                                    json_t **frames, struct neph_diag *diag)
{
    struct tm began = {0};
    if (!strptime(work->night->started_utc, "%Y-%m-%dT%H:%M:%SZ", &began))
        return neph_fail(diag, NEPH_ERR_INTERNAL, "a nightly run without a start time");
    const int64_t start_s = timegm(&began);
    json_t *list = json_array();
    struct neph_query *query = neph_query(index, diag, "SELECT key FROM jobs ORDER BY key", "");
    while (neph_query_next(query))
        if (neph_store_used_s(work->store, neph_query_text(query, 0)) >= start_s)
            neph_json_add(&list, json_string(neph_query_text(query, 0)));
    enum neph_status status = neph_query_end(query, NEPH_OK);
    if (!status)
        status = neph_json_check(list, diag);
    if (status)
        json_decref(list);
    else
        *frames = list;
    return status;
}

static enum neph_status keep_judgements(struct neph_night_work *work, struct neph_database *index,
                                        struct neph_diag *diag)
{
    const struct neph_night_comparison *comparison = &work->night->comparison;
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < comparison->series_count && !status; i++) {
        const struct neph_compared *row = &comparison->series[i];
        if (row->judgement.judged == NEPH_JUDGED_WORSE ||
            row->judgement.judged == NEPH_JUDGED_BETTER)
            status = neph_history_judge(index, work->night->id, row->series,
                                        neph_judged_word(row->judgement.judged), diag);
    }
    return status;
}

/* Record the planned steps that were not run. When this run is accepted, the acceptance before it
 * remains valid for their numbers. */
static enum neph_status keep_not_run(struct neph_night_work *work, struct neph_database *index,
                                     struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < work->night->plan.count && !status; i++) {
        const struct neph_history_step record = {.name = work->night->plan.steps[i].name,
                                                 .outcome = neph_night_job_not_run,
                                                 .reason = "",
                                                 .size = "",
                                                 .calibration_s = NAN};
        if (!work->ran[i])
            status = neph_history_add(index, work->night->id, &record, NULL, 0, diag);
    }
    return status;
}

static enum neph_status end(struct neph_night_work *work, struct neph_diag *diag)
{
    struct neph_night *night = work->night;
    struct neph_database *index = NULL;
    json_t *frames = NULL;
    enum neph_status status = neph_store_index(work->store, &index, diag);
    if (!status)
        status = keep_judgements(work, index, diag);
    if (!status)
        status = keep_not_run(work, index, diag);
    if (!status)
        status = list_frames(work, index, &frames, diag);
    if (!status)
        status = neph_history_end(index, neph_store_folder(work->store), night->id,
                                  neph_night_verdict(&night->comparison).word, frames, diag);
    json_decref(frames);
    neph_database_close(index);
    return status;
}

static void report_history_fault(const struct neph_history_fault *fault, void *context)
{
    struct neph_night_work *work = context;
    struct neph_arena *arena = &work->night->comparison.arena;
    const struct neph_finding finding = neph_finding(
        NEPH_FOUND_HISTORY, neph_arena_copy_text(arena, fault->document), "",
        neph_arena_format(arena, "%s; `neph store check --repair` repairs the store where possible",
                          fault->why));
    neph_night_add_finding(&work->night->comparison, &finding);
}

/* Check that the records of accepted runs are unchanged before this run is compared with them. */
static enum neph_status check_history(struct neph_night_work *work, struct neph_database *index,
                                      struct neph_diag *diag)
{
    const char *folder = neph_store_folder(work->store);
    const enum neph_status status = neph_history_check_acceptances(
        index, folder, false, report_history_fault, work, diag);
    return status || work->params->against > 0
               ? status
               : neph_history_check_baseline(index, folder, report_history_fault, work, diag);
}

/* The names of the plan's steps, allocated in the run's arena. */
static const char *const *list_planned(struct neph_night_work *work)
{
    const struct neph_night_plan *plan = &work->night->plan;
    const char **names = neph_arena_allocate(&work->night->arena, (size_t)plan->count + 1,
                                             sizeof(*names));
    for (int i = 0; names && i < plan->count; i++)
        names[i] = plan->steps[i].name;
    return names;
}

static enum neph_status compare(struct neph_night_work *work, struct neph_diag *diag)
{
    const struct neph_night_params *params = work->params;
    const bool is_chosen = params->against > 0;
    struct neph_database *index = NULL;
    struct neph_night_scope scope = {.planned = list_planned(work),
                                     .planned_count = work->night->plan.count,
                                     .only = is_chosen ? params->plan.only : NULL,
                                     .only_count = is_chosen ? params->plan.only_count : 0};
    enum neph_status status = scope.planned ? neph_night_render_accepted(work, &scope, diag)
                                            : neph_fail_memory(diag);
    if (!status)
        status = neph_store_index(work->store, &index, diag);
    if (!status)
        status = neph_night_compare(index, work->night->id, params->against, &scope, alpha,
                                    &work->night->comparison, diag);
    if (!status && params->limits)
        neph_night_limits_apply(params->limits, &work->night->comparison);
    if (!status)
        status = check_history(work, index, diag);
    neph_database_close(index);
    return status;
}

/* ---- all ------------------------------------------------------------------------------------- */

static enum neph_status run(struct neph_night_work *work, struct neph_diag *diag)
{
    struct neph_night *night = work->night;
    enum neph_status status = neph_night_begin(work, diag);
    work->progress = neph_progress_start(work->params->quiet, night->plan.count);
    if (!status)
        status = show(work, diag);
    if (!status)
        status = work->params->reports ? collect_steps(work, diag) : run_steps(work, diag);
    if (!status)
        status = compare(work, diag);
    if (!status && !work->params->once)
        status = run_some_again(work, diag);
    if (!status)
        status = neph_arena_check(&night->comparison.arena, diag);
    if (!status)
        status = end(work, diag);
    night->is_over = !status;
    night->is_interrupted = status == NEPH_ERR_INTERRUPTED;
    if (!status)
        status = show(work, diag);
    else if (night->is_interrupted)
        show(work, NULL); /* the error to report is the interruption */
    neph_progress_end(&work->progress);
    return status;
}

/* Refuse to run while submitted jobs work on a run in the same folder; with --report read their
 * files. */
static enum neph_status read_jobs(struct neph_night_work *work, struct neph_diag *diag)
{
    bool found = false;
    const struct neph_history_night run_identity = neph_night_identity(work->night);
    const bool reports = work->params->reports;
    const enum neph_status status = neph_night_jobs_read(work->params->output, &work->night->arena,
                                                         &work->jobs, &found, diag);
    if (status || (!found && !reports))
        return status;
    if (!reports) {
        neph_fail(diag, NEPH_ERR_UNAVAILABLE, "jobs named %s are working on a nightly run in '%s'",
                  work->jobs.name, work->params->output);
        neph_hint(
            diag,
            "--executor slurm continues it; to discard it, scancel --name=%s, and remove '%s'",
            work->jobs.name, work->jobs.folder);
        return NEPH_ERR_UNAVAILABLE;
    }
    return neph_night_jobs_check(&work->jobs, &run_identity, diag);
}

enum neph_status neph_night_run(const struct neph_night_params *params, struct neph_store *store,
                                struct neph_night *night, struct neph_diag *diag)
{
    struct neph_night_work work = {
        .params = params, .store = store, .night = night, .start_s = neph_wall_s()};
    int lock = -1;
    enum neph_status status = neph_night_prepare(&work, diag);
    if (!status)
        status = neph_night_lock(&work, params->reports, &lock, diag);
    if (!status)
        status = read_jobs(&work, diag);
    if (!status)
        status = run(&work, diag);
    neph_night_jobs_finish(&work.jobs);
    if (lock >= 0)
        close(lock);
    return status;
}

void neph_night_finish(struct neph_night *night)
{
    neph_night_comparison_finish(&night->comparison);
    neph_arena_finish(&night->arena);
    *night = (struct neph_night){.id = 0};
}
