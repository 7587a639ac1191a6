/* SPDX-License-Identifier: MIT */
#include "harness/physics/physics.h"
#include "harness/engines/engines.h"

#include "base/clock.h"
#include "harness/physics/pictures.h"
#include "harness/physics/trial.h"
#include "harness/progress.h"
#include "metrics/significance.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PARTICIPANTS_MAX = 16 };

/* ---- verdicts -------------------------------------------------------------------------------- */

static double or_zero(double value)
{
    return isfinite(value) ? value : 0.0;
}

/* What a deviation may be off by chance, step and rounding. */
static double allowed(const struct neph_physics_row *row, double critical_z)
{
    return critical_z * or_zero(row->standard_error) + or_zero(row->step_bound) +
           row->participant->rounding;
}

static void judge(struct neph_physics_row *row, double critical_z, struct neph_arena *arena)
{
    const char *who = row->participant->name;
    const double width = allowed(row, critical_z), percent = 100.0 * row->deviation;
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
        row->sentence = neph_arena_format(arena, "%s is off by %+.3g %%, %s%s", who, percent,
                                          row->cause ? "because " : "and the cause is not known",
                                          row->cause ? row->cause : "");
}

/* Engines that claim to be the truth must be right, and so must phase functions; others are only
 * reported. */
static bool truth_holds(const struct neph_physics *physics)
{
    bool holds = true;
    for (int i = 0; i < NEPH_PHASES; i++)
        holds &= physics->phases[i].agrees;
    for (int i = 0; i < physics->row_count; i++) {
        const struct neph_physics_row *row = &physics->rows[i];
        holds &= !neph_outcome_is_broken(row->outcome) &&
                 (row->verdict != NEPH_PHYSICS_OFF || row->engine->rung > NEPH_RUNG_TRACER);
    }
    return holds;
}

/* Verdicts can be given only when all checks are counted. Rows without a deviation say why; but a
 * verdict on nothing, or on less than was to be tried, is none. */
static void judge_all(struct neph_physics *physics)
{
    for (int i = 0; i < physics->row_count; i++)
        physics->tests += isfinite(physics->rows[i].deviation);
    physics->critical_z = neph_normal_critical(
        neph_sidak_alpha(NEPH_PHYSICS_FAMILY_ALPHA, physics->tests > 0 ? physics->tests : 1));
    for (int i = 0; i < physics->row_count; i++)
        judge(&physics->rows[i], physics->critical_z, &physics->arena);
    neph_phases_check(physics->phases);
    physics->passes = physics->row_count == physics->expected && physics->tests > 0 &&
                      truth_holds(physics);
}

/* ---- who and what ---------------------------------------------------------------------------- */

struct field {
    struct neph_entrant entrants[PARTICIPANTS_MAX];
    int count;
};

static enum neph_status apply(const struct neph_engine *engine, struct neph_settings *settings,
                              const char *assignment, struct neph_diag *diag)
{
    return assignment && assignment[0] ? neph_settings_set(engine, settings, assignment, diag)
                                       : NEPH_OK;
}

static enum neph_status enrol(const struct neph_physics_params *params,
                              const struct neph_participant *participant,
                              struct neph_entrant *entrant, struct neph_diag *diag)
{
    entrant->participant = participant;
    entrant->engine = neph_engine_find(participant->engine);
    neph_engine_probe(entrant->engine, params->device, &entrant->info);
    entrant->settings = neph_settings_default(entrant->engine);
    enum neph_status status = NEPH_OK;
    char paths[32];
    snprintf(paths, sizeof(paths), "samples=%d", params->samples);
    if (entrant->engine->rung == NEPH_RUNG_TRACER)
        status = apply(entrant->engine, &entrant->settings, paths, diag);
    for (int i = 0; i < NEPH_PARTICIPANT_SETTINGS_MAX && !status; i++)
        status = apply(entrant->engine, &entrant->settings, participant->settings[i], diag);
    entrant->refined = entrant->settings;
    if (!status)
        status = apply(entrant->engine, &entrant->refined, participant->refined, diag);
    return status;
}

static bool is_wanted(const struct neph_physics_params *params, const char *engine)
{
    bool wanted = params->engine_count == 0;
    for (int i = 0; i < params->engine_count; i++)
        wanted |= strcmp(params->engines[i], engine) == 0;
    return wanted;
}

static bool is_chosen(const struct neph_physics_params *params, int index)
{
    struct neph_check check;
    neph_check_get(index, &check);
    return !params->only || strstr(check.name, params->only) || strstr(check.rung, params->only);
}

static enum neph_status choose_entrants(const struct neph_physics_params *params,
                                        struct field *field, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < params->engine_count; i++)
        if (!neph_engine_find(params->engines[i])) {
            neph_fail(diag, NEPH_ERR_USAGE, "there is no engine '%s'", params->engines[i]);
            neph_hint(diag, "`neph engines` lists them");
            return NEPH_ERR_USAGE;
        }
    for (int i = 0; i < neph_participant_count() && !status; i++) {
        const struct neph_participant *participant = neph_participant_at(i);
        if (is_wanted(params, participant->engine) && neph_engine_find(participant->engine))
            status = enrol(params, participant, &field->entrants[field->count++], diag);
    }
    return status;
}

static enum neph_status refuse_check(const char *text, struct neph_diag *diag)
{
    char names[256] = "";
    for (int i = 0; i < neph_check_rung_count(); i++) {
        const size_t length = strlen(names);
        snprintf(names + length, sizeof(names) - length, "%s%s", i > 0 ? ", " : "",
                 neph_check_rung_at(i)->name);
    }
    neph_fail(diag, NEPH_ERR_USAGE, "no check of the physics suite has '%s' in its name", text);
    neph_hint(diag, "the rungs are %s; a run without --check shows all names", names);
    return NEPH_ERR_USAGE;
}

/* Checks of what only transport of all orders conserves are for those that claim to do it. */
static bool takes_part(const struct neph_entrant *entrant, const struct neph_check *check)
{
    return !check->truth_only || entrant->engine->rung <= NEPH_RUNG_TRACER;
}

/* How many rows an entrant will have. */
static int count_rows(const struct neph_physics_params *params, const struct neph_entrant *entrant)
{
    int count = 0;
    for (int c = 0; c < neph_check_count(); c++) {
        struct neph_check check;
        neph_check_get(c, &check);
        count += is_chosen(params, c) && takes_part(entrant, &check);
    }
    return count;
}

/* ---- the run --------------------------------------------------------------------------------- */

struct run {
    const struct neph_physics_params *params;
    struct neph_store *store;
    struct neph_physics *made;
    struct field field;
    struct neph_progress progress;
};

/* The truth is copied: a report draws it when the scenery is gone. */
static struct neph_physics_check *add_check(struct run *run, const struct neph_scenery *scenery)
{
    struct neph_arena *arena = &run->made->arena;
    struct neph_physics_check *check = &run->made->checks[run->made->check_count++];
    *check = (struct neph_physics_check){.name = neph_arena_text(arena, scenery->check.name),
                                         .rung = scenery->check.rung,
                                         .what = neph_arena_text(arena, scenery->check.what)};
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
    const struct neph_entrant *entrant = &run->field.entrants[index];
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
        for (int i = 0; i < run->field.count && !status; i++)
            if (takes_part(&run->field.entrants[i], &scenery->check))
                status = run_entrant(run, i, scenery, check, diag);
        neph_scenery_leave(scenery);
    }
    free(scenery);
    return status;
}

/* Count what there will be, and make room for it. */
static enum neph_status prepare(struct run *run, struct neph_diag *diag)
{
    struct neph_physics *made = run->made;
    int check_count = 0;
    for (int i = 0; i < neph_check_count(); i++)
        check_count += is_chosen(run->params, i);
    if (check_count == 0)
        return refuse_check(run->params->only, diag);
    run->progress = neph_progress_start(run->params->quiet, 0);
    for (int i = 0; i < run->field.count; i++) {
        const int rows = count_rows(run->params, &run->field.entrants[i]);
        neph_progress_expect(&run->progress, i, rows, 0.0);
        made->expected += rows;
    }
    made->checks = neph_arena_zeroed(&made->arena, (size_t)check_count, sizeof(*made->checks));
    made->rows = neph_arena_zeroed(&made->arena, (size_t)made->expected, sizeof(*made->rows));
    return neph_arena_check(&made->arena, diag);
}

enum neph_status neph_physics_run(const struct neph_physics_params *params,
                                  struct neph_store *store, struct neph_physics *physics,
                                  struct neph_diag *diag)
{
    const double start_s = neph_wall_s();
    struct run run = {.params = params, .store = store, .made = physics};
    enum neph_status status = choose_entrants(params, &run.field, diag);
    if (!status)
        status = prepare(&run, diag);
    if (status)
        return status;
    for (int i = 0; i < neph_check_count() && !status; i++)
        if (is_chosen(params, i))
            status = run_check(&run, i, diag);
    neph_progress_end(&run.progress);
    if (status)
        return status;
    judge_all(physics);
    physics->seconds = neph_wall_s() - start_s;
    return neph_arena_check(&physics->arena, diag);
}
