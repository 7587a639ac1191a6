/* SPDX-License-Identifier: MIT */
#include "harness/physics/physics.h"

#include "base/clock.h"
#include "base/doubt.h"
#include "harness/engines/engines.h"
#include "harness/engines/vulkan_device.h"
#include "harness/experiment/pool.h"
#include "harness/physics/images.h"
#include "harness/physics/trial.h"
#include "harness/progress.h"
#include "metrics/significance.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- verdicts -------------------------------------------------------------------------------- */

static double or_zero(double value)
{
    return isfinite(value) ? value : 0.0;
}

static void judge(struct neph_physics_row *row, double critical_z, struct neph_arena *arena)
{
    const char *who = row->participant->name;
    const double percent = 100.0 * row->deviation;
    const double width = critical_z * or_zero(row->standard_error) + or_zero(row->step_bound) +
                         row->participant->rounding; /* allowance for noise, step and rounding */
    row->sentence = "";
    if (!isfinite(row->deviation))
        return;
    row->low = row->deviation - width;
    row->high = row->deviation + width;
    row->verdict = fabs(row->deviation) <= width ? NEPH_PHYSICS_AGREES : NEPH_PHYSICS_OFF;
    if (row->verdict == NEPH_PHYSICS_AGREES)
        row->sentence = neph_arena_format(arena, "%s agrees: %+.3g %%, within %.2g %%", who,
                                          percent, 100.0 * width);
    else
        row->sentence = neph_arena_format(arena, "%s deviates by %+.3g %%, %s%s", who, percent,
                                          row->cause ? "because " : "and the cause is not known",
                                          row->cause ? row->cause : "");
    char doubt[NEPH_DOUBT_ROOM];
    neph_doubt_describe(row->doubt, doubt, sizeof(doubt));
    if (doubt[0])
        row->sentence = neph_arena_format(arena, "%s; %s", row->sentence, doubt);
}

/* Reference engines and phase functions must agree; other engines are only reported. */
static bool is_reference_consistent(const struct neph_physics *physics)
{
    bool holds = true;
    for (int i = 0; i < physics->phase_count; i++)
        holds &= physics->phases[i].agrees;
    for (int i = 0; i < physics->row_count; i++) {
        const struct neph_physics_row *row = &physics->rows[i];
        holds &= !neph_outcome_is_broken(row->outcome) &&
                 (row->verdict != NEPH_PHYSICS_OFF || row->engine->rung > NEPH_LEVEL_TRACER);
    }
    return holds;
}

/* Judge all rows. The significance level depends on the number of tests, so this runs last. A run
 * without tests, or with fewer rows than expected, does not pass. */
static void judge_all(struct neph_physics *physics)
{
    for (int i = 0; i < physics->row_count; i++)
        physics->tests += isfinite(physics->rows[i].deviation);
    physics->critical_z = neph_normal_critical(
        neph_sidak_alpha(NEPH_PHYSICS_FAMILY_ALPHA, physics->tests > 0 ? physics->tests : 1));
    for (int i = 0; i < physics->row_count; i++)
        judge(&physics->rows[i], physics->critical_z, &physics->arena);
    physics->phase_count = neph_phases_check(physics->phases);
    physics->passes = physics->row_count == physics->expected && physics->tests > 0 &&
                      is_reference_consistent(physics);
}

/* ---- participants and checks ----------------------------------------------------------------- */

_Static_assert(NEPH_PARTICIPANT_SETTINGS_MAX == 2, "all are set");

struct run {
    const struct neph_physics_params *params;
    struct neph_store *store;
    struct neph_physics *made;
    int *checks, check_count;                        /* indices of the selected checks */
    struct neph_entrant entrants[NEPH_PARTICIPANTS]; /* of this process */
    int entrant_count;
    struct neph_progress progress;
};

static enum neph_status enrol(const struct neph_physics_params *params,
                              const struct neph_participant *participant,
                              struct neph_entrant *entrant, struct neph_diag *diag)
{
    const struct neph_engine *engine = neph_engine_find(participant->engine);
    char paths[32] = "";
    *entrant = (struct neph_entrant){.participant = participant, .engine = engine};
    neph_engine_probe(engine, params->device, &entrant->info);
    entrant->settings = neph_settings_default(engine);
    if (engine->rung == NEPH_LEVEL_TRACER)
        snprintf(paths, sizeof(paths), "samples=%d", params->samples);
    const char *const words[] = {paths, participant->settings[0], participant->settings[1]};
    enum neph_status status = NEPH_OK;
    for (size_t i = 0; i < sizeof(words) / sizeof(words[0]) && !status; i++)
        if (words[i] && words[i][0])
            status = neph_settings_set(engine, &entrant->settings, words[i], diag);
    entrant->refined = entrant->settings;
    if (!status && participant->refined && participant->refined[0])
        status = neph_settings_set(engine, &entrant->refined, participant->refined, diag);
    return status;
}

static bool is_wanted(const struct neph_physics_params *params, const char *engine)
{
    bool wanted = params->engine_count == 0;
    for (int i = 0; i < params->engine_count; i++)
        wanted |= strcmp(params->engines[i], engine) == 0;
    return wanted;
}

static bool has_check(const struct neph_check *check, const char *text)
{
    return strstr(check->name, text) || strstr(check->rung, text);
}

/* The first text of --only that no check contains; NULL: none. */
static const char *find_unmatched_text(const struct neph_physics_params *params)
{
    for (int t = 0; t < params->only_count; t++) {
        bool is_there = false;
        for (int i = 0; i < neph_check_count() && !is_there; i++) {
            struct neph_check check;
            neph_check_get(i, &check);
            is_there = has_check(&check, params->only[t]);
        }
        if (!is_there)
            return params->only[t];
    }
    return NULL;
}

static enum neph_status refuse_check(const char *text, struct neph_diag *diag)
{
    char names[256] = "";
    for (int i = 0; i < NEPH_CHECK_RUNGS; i++) {
        const size_t length = strlen(names);
        snprintf(names + length, sizeof(names) - length, "%s%s", i > 0 ? ", " : "",
                 neph_check_rungs[i].name);
    }
    neph_fail(diag, NEPH_ERR_USAGE, "no check of the physics suite has '%s' in its name", text);
    neph_hint(diag, "the groups are %s; a run without --only shows all names", names);
    return NEPH_ERR_USAGE;
}

static enum neph_status choose(struct run *run, struct neph_diag *diag)
{
    const struct neph_physics_params *params = run->params;
    const char *unknown = find_unmatched_text(params);
    if (unknown)
        return refuse_check(unknown, diag);
    run->checks = neph_arena_allocate(&run->made->arena, (size_t)neph_check_count(), sizeof(int));
    if (!run->checks)
        return neph_fail_memory(diag);
    for (int i = 0; i < neph_check_count(); i++) {
        struct neph_check check;
        neph_check_get(i, &check);
        bool is_chosen = params->only_count == 0;
        for (int t = 0; t < params->only_count && !is_chosen; t++)
            is_chosen = has_check(&check, params->only[t]);
        if (is_chosen)
            run->checks[run->check_count++] = i;
    }
    return NEPH_OK;
}

/* Checks that only transport of all orders can pass are limited to the engines that compute it. */
static bool takes_part(const struct neph_entrant *entrant, const struct neph_check *check)
{
    return !check->truth_only || entrant->engine->rung <= NEPH_LEVEL_TRACER;
}

/* ---- the run --------------------------------------------------------------------------------- */

/* Add a check to the results. The reference is copied, because the report draws it after the
 * scenery is freed. */
static struct neph_physics_check *add_check(struct run *run, const struct neph_scenery *scenery)
{
    struct neph_arena *arena = &run->made->arena;
    struct neph_physics_check *check = &run->made->checks[run->made->check_count++];
    *check = (struct neph_physics_check){.name = neph_arena_copy_text(arena, scenery->check.name),
                                         .rung = scenery->check.rung,
                                         .what = neph_arena_copy_text(arena, scenery->check.what)};
    for (int v = 0; v < scenery->check.view_count; v++) {
        const struct neph_scenery_view *seen = &scenery->views[v];
        const double *truth = neph_arena_copy(arena, seen->truth, sizeof(seen->truth));
        if (truth)
            neph_physics_view_describe(seen->view, truth, &check->views[check->view_count++]);
    }
    return check;
}

static enum neph_status run_entrant(struct run *run, int index, struct neph_scenery *scenery,
                                    const struct neph_physics_check *check, struct neph_diag *diag)
{
    const struct neph_entrant *entrant = &run->entrants[index];
    const struct neph_trial trial = {.entrant = entrant,
                                     .time_limit_s = run->params->time_limit_s,
                                     .device = run->params->device,
                                     .store = run->store,
                                     .arena = &run->made->arena};
    struct neph_physics_row *row = &run->made->rows[run->made->row_count];
    char what[160];
    snprintf(what, sizeof(what), "%s with %s", check->name, entrant->participant->name);
    run->progress.kind = index;
    neph_progress_begin(&run->progress, what);
    const double start_s = neph_wall_s();
    row->check = check;
    const enum neph_status status = neph_trial_run(&trial, scenery, row, diag);
    if (status)
        return status;
    run->made->row_count++;
    neph_progress_step(&run->progress, what, neph_outcome_name(row->outcome),
                       neph_wall_s() - start_s);
    return NEPH_OK;
}

static enum neph_status run_check(struct run *run, int index, struct neph_diag *diag)
{
    struct neph_scenery *scenery = calloc(1, sizeof(*scenery));
    if (!scenery)
        return neph_fail_memory(diag);
    enum neph_status status = neph_scenery_enter(index, scenery, diag);
    if (!status) {
        const struct neph_physics_check *check = add_check(run, scenery);
        for (int i = 0; i < run->entrant_count && !status; i++)
            if (takes_part(&run->entrants[i], &scenery->check))
                status = run_entrant(run, i, scenery, check, diag);
        neph_scenery_leave(scenery);
    }
    free(scenery);
    return status;
}

/* Each process probes the engines, counts the expected rows, and allocates them. */
static enum neph_status prepare(struct run *run, bool is_worker, struct neph_diag *diag)
{
    struct neph_physics *made = run->made;
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < NEPH_PARTICIPANTS && !status; i++) {
        const struct neph_participant *participant = &neph_participants[i];
        if (is_wanted(run->params, participant->engine) && neph_engine_find(participant->engine))
            status = enrol(run->params, participant, &run->entrants[run->entrant_count++], diag);
    }
    run->progress = neph_progress_start(run->params->quiet || is_worker, 0);
    for (int i = 0; i < run->entrant_count && !status; i++) {
        int rows = 0;
        for (int c = 0; c < run->check_count; c++) {
            struct neph_check check;
            neph_check_get(run->checks[c], &check);
            rows += takes_part(&run->entrants[i], &check);
        }
        neph_progress_expect(&run->progress, i, rows, 0.0);
        made->expected += rows;
    }
    made->checks = neph_arena_allocate(&made->arena, (size_t)run->check_count,
                                       sizeof(*made->checks));
    made->rows = neph_arena_allocate(&made->arena, (size_t)made->expected, sizeof(*made->rows));
    return status ? status : neph_arena_check(&made->arena, diag);
}

/* Workers only fill the store, starting with the checks of the most views. The main process then
 * reads all frames from the store. */
static enum neph_status run_checks(struct neph_worker *worker, void *context,
                                   struct neph_diag *diag)
{
    struct run *run = context;
    const bool is_worker = worker->index > 0;
    enum neph_status status = prepare(run, is_worker, diag);
    for (int next; !status && (next = neph_worker_take_job(worker)) < run->check_count;) {
        char message[32];
        const double start_s = neph_wall_s();
        const int number = is_worker ? run->check_count - 1 - next : next;
        status = run_check(run, run->checks[number], diag);
        snprintf(message, sizeof(message), "%d %.3f", run->checks[number], neph_wall_s() - start_s);
        if (!status)
            neph_worker_send_message(worker, message);
    }
    neph_progress_end(&run->progress);
    return status;
}

static enum neph_status hear(const char *text, void *context, struct neph_diag *diag)
{
    struct run *run = context;
    struct neph_check check;
    int index;
    double seconds;
    (void)diag;
    if (!text || sscanf(text, "%d %lf", &index, &seconds) != 2)
        return NEPH_OK;
    neph_check_get(index, &check);
    neph_progress_step(&run->progress, check.name, "done", seconds);
    return NEPH_OK;
}

enum neph_status neph_physics_run(const struct neph_physics_params *params,
                                  struct neph_store *store, struct neph_physics *physics,
                                  struct neph_diag *diag)
{
    const double start_s = neph_wall_s();
    struct run run = {.params = params, .store = store, .made = physics};
    enum neph_status status = choose(&run, diag);
    if (status)
        return status;
    const int jobs = params->jobs < run.check_count ? params->jobs : run.check_count;
    run.progress = neph_progress_start(params->quiet, run.check_count);
    run.progress.workers = jobs;
    status = neph_pool_run(jobs, params->device, run_checks, hear, &run, diag);
    if (status)
        return status;
    judge_all(physics);
    physics->seconds = neph_wall_s() - start_s;
    return neph_arena_check(&physics->arena, diag);
}
