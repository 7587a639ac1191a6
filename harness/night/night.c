/* SPDX-License-Identifier: MIT */
#include "harness/night/night.h"

#include "base/child.h"
#include "base/clock.h"
#include "base/files.h"
#include "base/hash.h"
#include "base/interrupt.h"
#include "base/lock.h"
#include "harness/host.h"
#include "harness/night/calibrate.h"
#include "harness/night/readers.h"
#include "harness/progress.h"
#include "harness/run/history.h"
#include "harness/run/store_keep.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* The family's level: what the backtest in tests/harness/test_backtest.c is made with. */
static const double alpha = 0.005;

/* The share of the steps that are run a second time each night. */
static const double again_share = 0.02;

/* The calibration before and after a step may differ by so much. */
static const double steadiness = 0.10;

/* A step that takes longer than this many times what is known of it hangs. */
static const double patience = 20.0, least_limit_s = 600.0;

/* The outcome of a step that gave its numbers. */
static const char done[] = "done";

static const size_t log_limit_bytes = 64 << 20;
enum { NEVER = 1000, WORDS_MAX = NEPH_STEP_WORDS + 5, VARIABLES_MAX = 1024 };

struct work {
    const struct neph_night_params *params;
    struct neph_store *store;
    struct neph_night *night;
    struct neph_step_history *history;
    struct neph_night_outcome *outcomes; /* of the plan's steps */
    double *longest_s;                   /* that it ever took and was done */
    bool *ran;
    int ran_count;
    const char *program_path, *folder; /* OUTPUT/nightly */
    const char *variables[VARIABLES_MAX];
    struct neph_progress progress;
    double start_s;
};

/* ---- a command ------------------------------------------------------------------------------- */

static bool is_made_anew(const char *variable)
{
    static const char *const names[] = {"PATH=", "LANG=", "HOME=", "TMPDIR="};
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++)
        if (strncmp(variable, names[i], strlen(names[i])) == 0)
            return true;
    return false;
}

/* A step sees what the user gave to the night. */
static enum neph_status list_variables(struct work *work, struct neph_diag *diag)
{
    int count = 0;
    for (char **entry = environ; entry && *entry; entry++) {
        if (is_made_anew(*entry))
            continue;
        if (count == VARIABLES_MAX - 1)
            return neph_fail(diag, NEPH_ERR_USAGE, "the environment has more than %d variables",
                             VARIABLES_MAX - 1);
        work->variables[count++] = *entry;
    }
    return NEPH_OK;
}

static const char *log_path(struct work *work, const struct neph_night_step *step,
                            const char *ending)
{
    char name[NEPH_STEP_LOG_SIZE];
    neph_night_step_log(step, name);
    return neph_arena_format(&work->night->arena, "%s/logs/%s%s.log", work->folder, name, ending);
}

/* Where a suite writes its results; NULL: it prints them, with warnings before and after. */
static const char *const result_files[] = {
    [NEPH_NIGHT_CATALOG] = "report/data.json",
    [NEPH_NIGHT_PHYSICS] = "report/data.json",
    [NEPH_NIGHT_FAILURE] = "failure.json",
    [NEPH_NIGHT_SWEEP] = "sweep.json",
    [NEPH_NIGHT_SPEED] = NULL,
};

static enum neph_status read_results(const char *path, bool is_log, json_t **document,
                                     struct neph_diag *diag)
{
    char *text = NULL;
    size_t size;
    const enum neph_status status = neph_file_read(path, log_limit_bytes, &text, &size, diag);
    if (status)
        return status;
    *document = is_log ? neph_night_find_document(text) : json_loadb(text, size, 0, NULL);
    free(text);
    return *document ? NEPH_OK
                     : neph_fail(diag, NEPH_ERR_ENGINE, "there are no results in '%s'", path);
}

/* Exit code 1 says that something in it failed, which is for its numbers to say. */
static enum neph_status run_child(struct work *work, const struct neph_night_step *step,
                                  const char *output, const char *log, double limit_s,
                                  double *wall_s, struct neph_diag *diag)
{
    const char *words[WORDS_MAX] = {work->program_path};
    int count = 1;
    for (int i = 0; step->words[i]; i++)
        words[count++] = step->words[i];
    const char *const rest[] = {"-q", "-o", output, result_files[step->suite] ? NULL : "--json"};
    for (int i = 0; i < 4 && rest[i] && count < WORDS_MAX - 1; i++)
        words[count++] = rest[i];
    const struct neph_child_params child = {.argv = words,
                                            .log_path = log,
                                            .home = getenv("HOME"),
                                            .environment = work->variables,
                                            .time_limit_s = limit_s};
    struct neph_child_result result = {.exit_code = -1};
    const enum neph_status status = neph_child_run(&child, &result, diag);
    *wall_s = result.wall_s;
    const bool has_failed_gates = status == NEPH_ERR_ENGINE && result.signal == 0 &&
                                  result.exit_code == 1;
    return has_failed_gates ? NEPH_OK : status;
}

/* With frames from the store it costs less than without, as when it is run once more. */
static double limit_of(const struct work *work, int index)
{
    const struct neph_night_step *step = &work->night->plan.steps[index];
    const double cost_s = neph_night_step_cost(step, &work->history[index]);
    return fmax(patience * fmax(cost_s, work->longest_s[index]), least_limit_s);
}

/* Run a step and read its results, which may not be those of an earlier run. */
static enum neph_status run_command(struct work *work, int index, const char *output,
                                    const char *log, json_t **document, double *wall_s,
                                    struct neph_diag *diag)
{
    struct neph_arena *arena = &work->night->arena;
    const struct neph_night_step *step = &work->night->plan.steps[index];
    const char *file = result_files[step->suite];
    const char *path = file ? neph_arena_format(arena, "%s/%s", output, file) : log;
    enum neph_status status = neph_arena_check(arena, diag);
    if (!status && unlink(path) != 0 && errno != ENOENT && errno != ENOTDIR)
        status = neph_fail(diag, NEPH_ERR_IO, "cannot remove '%s': %s", path, strerror(errno));
    if (!status)
        status = run_child(work, step, output, log, limit_of(work, index), wall_s, diag);
    return status ? status : read_results(path, !file, document, diag);
}

/* ---- a step ---------------------------------------------------------------------------------- */

/* Run and read. Only what ends the night is an error; else `record` has the outcome. */
static enum neph_status do_step(struct work *work, int index, struct neph_history_step *record,
                                struct neph_night_numbers *numbers, struct neph_diag *diag)
{
    const struct neph_night_step *step = &work->night->plan.steps[index];
    struct neph_arena *arena = &work->night->arena;
    const bool is_timed = step->suite == NEPH_NIGHT_SPEED;
    struct neph_diag why = {.line = 0};
    json_t *document = NULL;
    double before_s = NAN, after_s = NAN;
    *record = (struct neph_history_step){
        .name = step->name, .reason = "", .size = "", .calibration_s = NAN};
    *numbers = (struct neph_night_numbers){.count = 0, .size = ""};
    enum neph_status status = is_timed ? neph_calibrate(&before_s, &why) : NEPH_OK;
    if (!status)
        status = run_command(work, index, work->params->output, log_path(work, step, ""), &document,
                             &record->wall_s, &why);
    if (!status && is_timed)
        status = neph_calibrate(&after_s, &why);
    const bool steady = fabs(after_s / before_s - 1.0) <= steadiness;
    if (is_timed && steady)
        record->calibration_s = 0.5 * (before_s + after_s);
    if (!status)
        status = neph_night_read(step->suite, document, record->calibration_s, work->night->host,
                                 arena, numbers, &why);
    json_decref(document);
    if (status == NEPH_ERR_INTERRUPTED || status == NEPH_ERR_MEMORY) {
        if (diag)
            *diag = why;
        return status;
    }
    record->outcome = !status ? done : status == NEPH_ERR_TIMEOUT ? "timeout" : "failed";
    record->reason = status ? neph_arena_text(arena, why.message) : "";
    if (!status && is_timed && !steady)
        record->reason = neph_arena_format(arena,
                                           "the machine was busy (calibration %.3f s before, %.3f "
                                           "s after): its durations are not used",
                                           before_s, after_s);
    record->size = numbers->size;
    return NEPH_OK;
}

/* It was run, tonight or by a run of this night that was killed. Texts are of the arena. */
static void note_outcome(struct work *work, int index, const char *outcome, const char *reason)
{
    work->outcomes[index] = (struct neph_night_outcome){outcome, reason};
    work->ran[index] = true;
    work->ran_count++;
    work->night->done_count += strcmp(outcome, done) == 0;
}

static enum neph_status keep_step(struct work *work, const struct neph_history_step *record,
                                  const struct neph_night_numbers *numbers, struct neph_diag *diag)
{
    struct neph_database *index = NULL;
    enum neph_status status = neph_store_index(work->store, &index, diag);
    if (!status)
        status = neph_history_add(index, work->night->id, record, numbers->list, numbers->count,
                                  diag);
    neph_database_close(index);
    return status;
}

static enum neph_status show(struct work *work, struct neph_diag *diag)
{
    work->night->seconds = neph_wall_s() - work->start_s;
    return work->params->show ? work->params->show(work->night, work->params->context, diag)
                              : NEPH_OK;
}

static enum neph_status run_steps(struct work *work, struct neph_diag *diag)
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
        status = do_step(work, index, &record, &numbers, diag);
        if (!status)
            status = keep_step(work, &record, &numbers, diag);
        if (status)
            break;
        note_outcome(work, index, record.outcome, record.reason);
        work->longest_s[index] = fmax(work->longest_s[index], record.wall_s);
        status = show(work, diag);
        neph_progress_step(&work->progress, record.name, record.outcome, record.wall_s);
    }
    return status;
}

/* ---- once more ------------------------------------------------------------------------------- */

static void find_otherwise(struct work *work, const char *series,
                           const struct neph_night_step *step, const char *words, double value)
{
    const struct neph_finding finding = {.found = NEPH_FOUND_BITS,
                                         .series = series,
                                         .step = step->name,
                                         .words = words,
                                         .tonight = value,
                                         .baseline = NAN,
                                         .change = NAN,
                                         .p = NAN,
                                         .floor = NAN,
                                         .standard_error = NAN,
                                         .example = strchr(series, '/') ? series : ""};
    neph_night_add_finding(&work->night->comparison, &finding);
}

/* A number of the second run against that of the first. */
static enum neph_status compare_number(struct work *work, struct neph_database *index,
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
        find_otherwise(work, m->series, step,
                       "run once more in an empty folder, the same program gave a number that it "
                       "had not given",
                       m->value);
    if (!status && others > 0)
        find_otherwise(work, m->series, step,
                       "run once more in an empty folder, the same program gave another number",
                       m->value);
    return status;
}

static bool has_series(const struct neph_night_numbers *numbers, const char *series)
{
    for (int i = 0; i < numbers->count; i++)
        if (strcmp(numbers->list[i].series, series) == 0)
            return true;
    return false;
}

/* What the first run gave and the second did not. */
static enum neph_status find_lost(struct work *work, struct neph_database *index,
                                  const struct neph_night_step *step,
                                  const struct neph_night_numbers *numbers, struct neph_diag *diag)
{
    struct neph_query *query = NULL;
    enum neph_status status = neph_query_begin(
        index, &query, diag,
        "SELECT name FROM measurements JOIN series ON series.id = series WHERE night = ? AND step "
        "= ?",
        "is", work->night->id, step->name);
    while (!status && neph_query_next(query, &status, diag))
        if (!has_series(numbers, neph_query_text(query, 0)))
            find_otherwise(
                work, neph_arena_text(&work->night->comparison.arena, neph_query_text(query, 0)),
                step,
                "run once more in an empty folder, the same program did not give this "
                "number",
                NAN);
    neph_query_end(query);
    return status;
}

static enum neph_status compare_bits(struct work *work, const struct neph_night_step *step,
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

/* In an empty folder; `numbers` are of the arena. */
static enum neph_status measure_again(struct work *work, int index,
                                      struct neph_night_numbers *numbers, struct neph_diag *diag)
{
    const struct neph_night_step *step = &work->night->plan.steps[index];
    json_t *document = NULL;
    double wall_s = 0.0;
    char *folder = neph_path_join(work->folder, "again");
    enum neph_status status = folder ? neph_dir_remove(folder, diag) : neph_fail_memory(diag);
    if (!status)
        status = run_command(work, index, folder, log_path(work, step, "_again"), &document,
                             &wall_s, diag);
    if (!status)
        status = neph_night_read(step->suite, document, NAN, work->night->host, &work->night->arena,
                                 numbers, diag);
    if (folder)
        neph_dir_remove(folder, NULL);
    json_decref(document);
    free(folder);
    return status;
}

/* As in do_step(), only what ends the night is an error. */
static enum neph_status run_again(struct work *work, int index, struct neph_diag *diag)
{
    const struct neph_night_step *step = &work->night->plan.steps[index];
    struct neph_night_numbers numbers = {.count = 0};
    struct neph_diag why = {.line = 0};
    const enum neph_status status = measure_again(work, index, &numbers, &why);
    if (!status) {
        work->night->again_count++;
        return compare_bits(work, step, &numbers, diag);
    }
    if (status == NEPH_ERR_INTERRUPTED || status == NEPH_ERR_MEMORY) {
        if (diag)
            *diag = why;
        return status;
    }
    find_otherwise(work, step->name, step,
                   neph_arena_format(&work->night->comparison.arena,
                                     "it was done, and run once more in an empty folder it was "
                                     "not: %s",
                                     why.message),
                   NAN);
    return NEPH_OK;
}

static bool is_done(const struct work *work, int index)
{
    return work->ran[index] && strcmp(work->outcomes[index].outcome, done) == 0;
}

/* In turn: another part of the plan each night. Durations are measured anew in any case. */
static enum neph_status run_some_again(struct work *work, struct neph_diag *diag)
{
    const struct neph_night_plan *plan = &work->night->plan;
    const int wanted = (int)ceil(again_share * plan->count);
    int tried = 0;
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < plan->count && tried < wanted && !status; i++) {
        const int index = (int)((work->night->id * wanted + i) % plan->count);
        if (!is_done(work, index) || plan->steps[index].suite == NEPH_NIGHT_SPEED)
            continue;
        tried++;
        status = run_again(work, index, diag);
    }
    return status;
}

/* ---- history --------------------------------------------------------------------------------- */

static enum neph_status read_cost(struct work *work, struct neph_database *index, int step,
                                  struct neph_diag *diag)
{
    struct neph_step_history *history = &work->history[step];
    struct neph_query *query = NULL;
    int64_t last = 0, series = 0;
    bool same = false;
    *history = (struct neph_step_history){NAN, 0, NEVER};
    const char *name = work->night->plan.steps[step].name;
    enum neph_status status = neph_query_begin(
        index, &query, diag,
        "SELECT wall_s, night, program FROM steps JOIN nights ON nights.id = night WHERE name = ? "
        "AND outcome = 'done' AND night < ? ORDER BY night DESC LIMIT 5",
        "si", name, work->night->id);
    /* The last time, when the program is the same and has its frames; else the worst of five. */
    while (!status && !same && neph_query_next(query, &status, diag)) {
        same = last == 0 && strcmp(neph_query_text(query, 2), work->night->program) == 0;
        last = last ? last : neph_query_integer(query, 1);
        history->cost_s = fmax(isfinite(history->cost_s) ? history->cost_s : 0.0,
                               neph_query_real(query, 0));
    }
    neph_query_end(query);
    if (!status && last > 0)
        status = neph_database_count(
            index, &series, diag, "SELECT count(*) FROM measurements WHERE night = ? AND step = ?",
            "is", last, name);
    history->series = (int)series;
    history->nights = last > 0 ? (int)(work->night->id - last) : NEVER;
    return status;
}

static enum neph_status read_longest(struct work *work, struct neph_database *index, int step,
                                     struct neph_diag *diag)
{
    struct neph_query *query = NULL;
    enum neph_status status = neph_query_begin(
        index, &query, diag,
        "SELECT coalesce(max(wall_s), 0.0) FROM steps WHERE name = ? AND outcome = 'done'", "s",
        work->night->plan.steps[step].name);
    if (!status && neph_query_next(query, &status, diag))
        work->longest_s[step] = neph_query_real(query, 0);
    neph_query_end(query);
    return status;
}

static enum neph_status read_outcome(struct work *work, struct neph_database *index, int step,
                                     struct neph_diag *diag)
{
    struct neph_arena *arena = &work->night->arena;
    struct neph_query *query = NULL;
    enum neph_status status = neph_query_begin(
        index, &query, diag, "SELECT outcome, reason FROM steps WHERE night = ? AND name = ?", "is",
        work->night->id, work->night->plan.steps[step].name);
    if (!status && neph_query_next(query, &status, diag))
        note_outcome(work, step, neph_arena_text(arena, neph_query_text(query, 0)),
                     neph_arena_text(arena, neph_query_text(query, 1)));
    neph_query_end(query);
    return status;
}

static enum neph_status begin(struct work *work, struct neph_diag *diag)
{
    struct neph_night *night = work->night;
    const struct neph_history_night who = {night->plan.identity, night->revision, night->program,
                                           night->host};
    struct neph_database *index = NULL;
    struct neph_query *query = NULL;
    enum neph_status status = neph_store_index(work->store, &index, diag);
    if (!status)
        status = neph_history_begin(index, neph_store_folder(work->store), &who, &night->id,
                                    &night->resumed, diag);
    for (int i = 0; i < night->plan.count && !status; i++) {
        status = read_cost(work, index, i, diag);
        if (!status)
            status = read_longest(work, index, i, diag);
        if (!status)
            status = read_outcome(work, index, i, diag);
    }
    if (!status)
        status = neph_query_begin(index, &query, diag,
                                  "SELECT started_utc FROM nights WHERE id = ?", "i", night->id);
    if (!status && neph_query_next(query, &status, diag))
        night->started_utc = neph_arena_text(&night->arena, neph_query_text(query, 0));
    neph_query_end(query);
    neph_database_close(index);
    return status;
}

/* The frames that were used since the night began. */
static enum neph_status list_frames(struct work *work, struct neph_database *index, json_t **frames,
                                    struct neph_diag *diag)
{
    struct tm began = {0};
    struct neph_query *query = NULL;
    if (!work->night->started_utc ||
        !strptime(work->night->started_utc, "%Y-%m-%dT%H:%M:%SZ", &began))
        return neph_fail(diag, NEPH_ERR_INTERNAL, "a night without a beginning");
    const int64_t start_s = timegm(&began);
    json_t *list = json_array();
    enum neph_status status = neph_query_begin(index, &query, diag,
                                               "SELECT key FROM jobs ORDER BY key", "");
    while (!status && neph_query_next(query, &status, diag))
        if (neph_store_used_s(work->store, neph_query_text(query, 0)) >= start_s)
            neph_json_add(&list, json_string(neph_query_text(query, 0)));
    neph_query_end(query);
    if (!status)
        status = neph_json_check(list, diag);
    if (status)
        json_decref(list);
    else
        *frames = list;
    return status;
}

static enum neph_status keep_judgements(struct work *work, struct neph_database *index,
                                        struct neph_diag *diag)
{
    const struct neph_night_comparison *comparison = &work->night->comparison;
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < comparison->series_count && !status; i++) {
        const struct neph_compared *row = &comparison->series[i];
        if (row->judged == NEPH_JUDGED_WORSE || row->judged == NEPH_JUDGED_BETTER)
            status = neph_history_judge(index, work->night->id, row->series,
                                        neph_judged_word(row->judged), diag);
    }
    return status;
}

static enum neph_status end(struct work *work, struct neph_diag *diag)
{
    struct neph_night *night = work->night;
    struct neph_database *index = NULL;
    json_t *frames = NULL;
    enum neph_status status = neph_store_index(work->store, &index, diag);
    if (!status)
        status = keep_judgements(work, index, diag);
    if (!status)
        status = list_frames(work, index, &frames, diag);
    if (!status)
        status = neph_history_end(index, neph_store_folder(work->store), night->id,
                                  neph_night_verdict(&night->comparison).word, frames, diag);
    json_decref(frames);
    neph_database_close(index);
    return status;
}

static enum neph_status compare(struct work *work, struct neph_diag *diag)
{
    struct neph_database *index = NULL;
    enum neph_status status = neph_store_index(work->store, &index, diag);
    if (!status)
        status = neph_night_compare(index, work->night->id, work->params->against, alpha,
                                    &work->night->comparison, diag);
    neph_database_close(index);
    return status;
}

/* ---- all ------------------------------------------------------------------------------------- */

static enum neph_status take_lock(struct work *work, int *lock, struct neph_diag *diag)
{
    char *path = neph_path_join(work->folder, ".lock");
    enum neph_status status = path ? NEPH_OK : neph_fail_memory(diag);
    if (!status) {
        const int made = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
        if (made < 0)
            status = neph_fail(diag, NEPH_ERR_IO, "cannot make '%s': %s", path, strerror(errno));
        else
            close(made);
    }
    if (!status && (*lock = neph_lock_take_over(path)) < 0) {
        status = neph_fail(diag, NEPH_ERR_UNAVAILABLE, "another night is at work in '%s'",
                           work->params->output);
        neph_hint(diag, "wait for it, or name another folder with -o");
    }
    free(path);
    return status;
}

static enum neph_status identify(struct work *work, struct neph_diag *diag)
{
    char host[NEPH_HOST_CLASS_SIZE], digest[NEPH_HASH_HEX_SIZE], path[4096];
    struct neph_night *night = work->night;
    const ssize_t length = readlink("/proc/self/exe", path, sizeof(path) - 1);
    if (length <= 0)
        return neph_fail(diag, NEPH_ERR_IO, "cannot tell where neph itself lies: %s",
                         strerror(errno));
    path[length] = '\0';
    const enum neph_status status = neph_hash_file("/proc/self/exe", digest, diag);
    if (status)
        return status;
    neph_host_class(host);
    work->program_path = neph_arena_text(&night->arena, path);
    night->program = neph_arena_format(&night->arena, "%.16s", digest);
    night->host = neph_arena_text(&night->arena, host);
    night->revision = neph_arena_text(&night->arena, work->params->revision);
    return neph_arena_check(&night->arena, diag);
}

static enum neph_status prepare(struct work *work, struct neph_diag *diag)
{
    struct neph_night *night = work->night;
    work->folder = neph_arena_format(&night->arena, "%s/nightly", work->params->output);
    const char *logs = neph_arena_format(&night->arena, "%s/logs", work->folder);
    enum neph_status status = neph_dir_create(logs, diag);
    if (!status)
        status = neph_night_plan_make(&work->params->plan, &night->arena, &night->plan, diag);
    if (status)
        return status;
    const size_t count = (size_t)night->plan.count;
    work->history = neph_arena_zeroed(&night->arena, count, sizeof(*work->history));
    work->outcomes = neph_arena_zeroed(&night->arena, count, sizeof(*work->outcomes));
    work->longest_s = neph_arena_zeroed(&night->arena, count, sizeof(*work->longest_s));
    work->ran = neph_arena_zeroed(&night->arena, count, sizeof(*work->ran));
    night->outcomes = work->outcomes;
    status = list_variables(work, diag);
    return status ? status : neph_arena_check(&night->arena, diag);
}

static enum neph_status run(struct work *work, struct neph_diag *diag)
{
    struct neph_night *night = work->night;
    enum neph_status status = begin(work, diag);
    work->progress = neph_progress_start(work->params->quiet, night->plan.count);
    if (!status)
        status = show(work, diag);
    if (!status)
        status = run_steps(work, diag);
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
        show(work, NULL); /* that it was is what is to be told */
    neph_progress_end(&work->progress);
    return status;
}

enum neph_status neph_night_run(const struct neph_night_params *params, struct neph_store *store,
                                struct neph_night *night, struct neph_diag *diag)
{
    struct work work = {.params = params, .store = store, .night = night, .start_s = neph_wall_s()};
    int lock = -1;
    enum neph_status status = prepare(&work, diag);
    if (!status)
        status = take_lock(&work, &lock, diag);
    if (!status)
        status = identify(&work, diag);
    if (!status)
        status = run(&work, diag);
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
