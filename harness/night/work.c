/* SPDX-License-Identifier: MIT */
#include "harness/night/work.h"

#include "base/build_id.h"
#include "base/files.h"
#include "base/lock.h"
#include "base/path.h"
#include "harness/host.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* A step is regarded as hanging after 20 times its expected or longest known duration, at the least
 * after 600 s. */
static const double patience = 20.0, least_limit_s = 600.0;

enum { NEVER = 1000 };

/* ---- a step ---------------------------------------------------------------------------------- */

const char *neph_night_log(struct neph_night_work *work, int index, const char *ending)
{
    return neph_step_file(&work->night->arena, work->logs, &work->night->plan.steps[index], ending);
}

/* The cost of a step that finds its frames in the store is much lower than without them; a repeated
 * step has none. So the longest duration counts as well. */
double neph_night_limit_s(const struct neph_night_work *work, int index)
{
    const struct neph_night_step *step = &work->night->plan.steps[index];
    const double cost_s = neph_night_step_cost(step, &work->history[index]);
    return fmax(patience * fmax(cost_s, work->longest_s[index]), least_limit_s);
}

/* The step may have been run by a killed process of the same nightly run. Texts are borrowed from
 * the arena. */
void neph_night_note(struct neph_night_work *work, int index, const char *outcome,
                     const char *reason)
{
    work->outcomes[index] = (struct neph_night_outcome){outcome, reason};
    work->ran[index] = true;
    work->ran_count++;
    work->night->done_count += strcmp(outcome, neph_step_done) == 0;
}

/* ---- history --------------------------------------------------------------------------------- */

static enum neph_status read_cost(struct neph_night_work *work, struct neph_database *index,
                                  int step, struct neph_diag *diag)
{
    struct neph_step_history *history = &work->history[step];
    int64_t last = 0, series = 0;
    bool same = false;
    *history = (struct neph_step_history){NAN, 0, NEVER};
    const char *name = work->night->plan.steps[step].name;
    struct neph_query *query = neph_query(
        index, diag,
        "SELECT wall_s, night, program FROM steps JOIN nights ON nights.id = night WHERE name = ? "
        "AND outcome = 'done' AND night < ? ORDER BY night DESC LIMIT 5",
        "si", name, work->night->id);
    /* The last duration when this program measured it, because the frames are then in the store;
     * otherwise the longest of the last five runs. */
    while (!same && neph_query_next(query)) {
        same = last == 0 && strcmp(neph_query_text(query, 2), work->night->program) == 0;
        last = last ? last : neph_query_integer(query, 1);
        history->cost_s = fmax(isfinite(history->cost_s) ? history->cost_s : 0.0,
                               neph_query_real(query, 0));
    }
    enum neph_status status = neph_query_end(query, NEPH_OK);
    if (!status && last > 0)
        status = neph_database_count(
            index, &series, diag, "SELECT count(*) FROM measurements WHERE night = ? AND step = ?",
            "is", last, name);
    history->series = (int)series;
    history->nights = last > 0 ? (int)(work->night->id - last) : NEVER;
    return status;
}

static enum neph_status read_longest(struct neph_night_work *work, struct neph_database *index,
                                     int step, struct neph_diag *diag)
{
    struct neph_query *query = neph_query(
        index, diag,
        "SELECT coalesce(max(wall_s), 0.0) FROM steps WHERE name = ? AND outcome = 'done'", "s",
        work->night->plan.steps[step].name);
    if (neph_query_next(query))
        work->longest_s[step] = neph_query_real(query, 0);
    return neph_query_end(query, NEPH_OK);
}

static enum neph_status read_outcome(struct neph_night_work *work, struct neph_database *index,
                                     int step, struct neph_diag *diag)
{
    struct neph_arena *arena = &work->night->arena;
    struct neph_query *query = neph_query(
        index, diag,
        "SELECT outcome, reason FROM steps WHERE night = ? AND name = ? AND outcome != 'not run'",
        "is", work->night->id, work->night->plan.steps[step].name);
    if (neph_query_next(query))
        neph_night_note(work, step, neph_arena_copy_text(arena, neph_query_text(query, 0)),
                        neph_arena_copy_text(arena, neph_query_text(query, 1)));
    return neph_query_end(query, NEPH_OK);
}

struct neph_history_night neph_night_identity(const struct neph_night *night)
{
    return (struct neph_history_night){night->plan.identity, night->revision, night->program,
                                       night->host};
}

/* A run of submitted jobs has its number from the submitting host. */
static enum neph_status begin_history(struct neph_night_work *work, struct neph_database *index,
                                      struct neph_diag *diag)
{
    struct neph_night *night = work->night;
    const struct neph_history_night run_identity = neph_night_identity(night);
    const char *folder = neph_store_folder(work->store);
    if (work->jobs.night == 0)
        return neph_history_begin(index, folder, &run_identity, &night->id, &night->resumed, diag);
    night->id = work->jobs.night;
    night->host = work->jobs.run_identity.host;
    return neph_history_adopt(index, folder, &work->jobs.run_identity, night->id,
                              work->jobs.started_utc, diag);
}

enum neph_status neph_night_begin(struct neph_night_work *work, struct neph_diag *diag)
{
    struct neph_night *night = work->night;
    struct neph_database *index = NULL;
    enum neph_status status = neph_store_index(work->store, &index, diag);
    if (!status)
        status = begin_history(work, index, diag);
    for (int i = 0; i < night->plan.count && !status; i++) {
        status = read_cost(work, index, i, diag);
        if (!status)
            status = read_longest(work, index, i, diag);
        if (!status)
            status = read_outcome(work, index, i, diag);
    }
    if (!status)
        status = neph_record_text(index, &night->arena, &night->started_utc, diag,
                                  "SELECT started_utc FROM nights WHERE id = ?", "i", night->id);
    neph_database_close(index);
    return status;
}

/* ---- identity and folders -------------------------------------------------------------------- */

enum neph_status neph_night_lock(const struct neph_night_work *work, bool waits, int *lock,
                                 struct neph_diag *diag)
{
    const struct neph_path path = neph_path_in(work->folder, ".lock");
    const int made = open(path.text, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (made < 0)
        return neph_fail(diag, NEPH_ERR_IO, "cannot make '%s': %s", path.text, strerror(errno));
    close(made);
    if (waits)
        return neph_lock_wait(path.text, lock, diag);
    *lock = neph_lock_take_over(path.text);
    if (*lock >= 0)
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_UNAVAILABLE, "another nightly run is working in '%s'",
              work->params->output);
    neph_hint(diag, "wait for it, or name another folder with -o");
    return NEPH_ERR_UNAVAILABLE;
}

static enum neph_status identify(struct neph_night_work *work, struct neph_diag *diag)
{
    char host[NEPH_HOST_CLASS_SIZE], build[NEPH_BUILD_ID_SIZE], path[4096];
    struct neph_night *night = work->night;
    const ssize_t length = readlink("/proc/self/exe", path, sizeof(path) - 1);
    if (length <= 0)
        return neph_fail(diag, NEPH_ERR_IO, "cannot find the path of the neph program: %s",
                         strerror(errno));
    path[length] = '\0';
    const enum neph_status status = neph_build_id(build, diag);
    if (status)
        return status;
    neph_host_class(host);
    work->place.program_path = neph_arena_copy_text(&night->arena, path);
    night->program = neph_arena_copy_text(&night->arena, build);
    night->host = work->place.host = neph_arena_copy_text(&night->arena, host);
    night->revision = neph_arena_copy_text(&night->arena, work->params->revision);
    return neph_arena_check(&night->arena, diag);
}

static enum neph_status make_plan(struct neph_night_work *work, struct neph_diag *diag)
{
    struct neph_night *night = work->night;
    work->folder = neph_arena_format(&night->arena, "%s/nightly", work->params->output);
    work->logs = neph_arena_format(&night->arena, "%s/logs", work->folder);
    work->place.arena = &night->arena;
    enum neph_status status = neph_dir_create(work->logs, diag);
    if (!status)
        status = neph_night_plan_make(&work->params->plan, &night->arena, &night->plan, diag);
    if (status)
        return status;
    const size_t count = (size_t)night->plan.count;
    work->history = neph_arena_allocate(&night->arena, count, sizeof(*work->history));
    work->outcomes = neph_arena_allocate(&night->arena, count, sizeof(*work->outcomes));
    work->longest_s = neph_arena_allocate(&night->arena, count, sizeof(*work->longest_s));
    work->ran = neph_arena_allocate(&night->arena, count, sizeof(*work->ran));
    night->outcomes = work->outcomes;
    status = neph_step_place_settle(&work->place, true, diag);
    return status ? status : neph_arena_check(&night->arena, diag);
}

enum neph_status neph_night_prepare(struct neph_night_work *work, struct neph_diag *diag)
{
    const enum neph_status status = make_plan(work, diag);
    return status ? status : identify(work, diag);
}
