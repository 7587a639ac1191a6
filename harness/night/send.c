/* SPDX-License-Identifier: MIT */
#include "harness/night/send.h"

#include "base/clock.h"
#include "base/files.h"
#include "base/interrupt.h"
#include "base/path.h"
#include "harness/run/index.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* Polling intervals for Slurm's job states. They start short, so that a short run ends soon. */
static const double first_wait_s = 1.0, longest_wait_s = 15.0, growth = 1.2;

struct sending {
    struct neph_night_work *work;
    const struct neph_slurm_settings *settings;
    const char *output; /* absolute path, valid on every host */
    const char *said;   /* this command as a shell line */
    struct neph_slurm_task *tasks;
    int task_count;
    bool is_there; /* jobs of an earlier call are still queued or running */
};

/* ---- hosts ----------------------------------------------------------------------------------- */

/* True when NEPH_VULKAN_DEVICE names a device other than the CPU driver; then all steps need a
 * GPU. */
static bool wants_gpu(void)
{
    static const char processor[] = "llvmpipe"; /* the user may give a part of this name, or a
                                                   longer one */
    const char *device = getenv("NEPH_VULKAN_DEVICE");
    return device && device[0] && !strcasestr(processor, device) && !strcasestr(device, processor);
}

/* Runs before anything is written. */
static enum neph_status check(const struct neph_slurm_settings *settings, struct neph_diag *diag)
{
    const char *index = getenv("NEPH_STORE_INDEX");
    if (neph_index_place() != NEPH_INDEX_ON_HOST || index[0] != '/') {
        neph_fail(
            diag, NEPH_ERR_USAGE,
            "several hosts would share one database of the store, which SQLite does not support");
        neph_hint(diag, "export NEPH_STORE_INDEX=/var/tmp/neph: a folder on each host's own disk, "
                        "where it makes its database from the store's files");
        return NEPH_ERR_USAGE;
    }
    if (wants_gpu() && !settings->gpu) {
        neph_fail(diag, NEPH_ERR_USAGE,
                  "NEPH_VULKAN_DEVICE names a GPU, and the Slurm feature of hosts with that GPU is "
                  "not given");
        neph_hint(diag, "--slurm gpu=FEATURE, as in `sinfo -o '%%n %%f'`");
        return NEPH_ERR_USAGE;
    }
    return NEPH_OK;
}

/* ---- the run to continue --------------------------------------------------------------------- */

static enum neph_status forget(struct sending *sending, struct neph_diag *diag)
{
    neph_night_jobs_finish(&sending->work->jobs);
    sending->work->jobs = (struct neph_night_jobs){.night = 0};
    return neph_night_jobs_forget(sending->work->params->output, diag);
}

/* Opens the folder first: a network file system caches the absence of a file, and opening the
 * folder refreshes that cache. */
static bool is_over(const struct sending *sending)
{
    const struct neph_night_work *work = sending->work;
    DIR *opened = opendir(neph_path_in(neph_store_folder(work->store), "history").text);
    const bool over = neph_history_is_over(neph_store_folder(work->store), work->jobs.night);
    if (opened)
        closedir(opened);
    return over;
}

/* Find a submitted run to continue: one of the same plan and program that is not over. The files of
 * any other run are removed when its jobs have ended; jobs still in progress are an error. */
static enum neph_status find_night(struct sending *sending, struct neph_diag *diag)
{
    struct neph_night_work *work = sending->work;
    const struct neph_history_night run_identity = neph_night_identity(work->night);
    bool found = false;
    int left = 0;
    neph_night_jobs_finish(&work->jobs);
    enum neph_status status = neph_night_jobs_read(work->params->output, &work->night->arena,
                                                   &work->jobs, &found, diag);
    if (!status && found)
        status = neph_slurm_count(work->jobs.name, work->logs, &left, diag);
    if (status)
        return status;
    sending->is_there = left > 0;
    if (found && neph_night_jobs_match(&work->jobs, &run_identity) &&
        (left > 0 || !is_over(sending)))
        return NEPH_OK;
    if (left == 0)
        return forget(sending, diag);
    neph_fail(diag, NEPH_ERR_UNAVAILABLE, "%d jobs of another nightly run are working in '%s'",
              left, work->params->output);
    neph_hint(diag, "wait for them, or scancel --name=%s", work->jobs.name);
    return NEPH_ERR_UNAVAILABLE;
}

/* Remove Slurm's log files of earlier runs. */
static void remove_old_logs(const char *logs, struct neph_arena *arena)
{
    struct neph_names names;
    neph_dir_list(logs, arena, &names, NULL);
    for (int i = 0; i < names.count; i++)
        if (strncmp(names.list[i], "slurm-", 6) == 0)
            unlink(neph_path_in(logs, names.list[i]).text);
}

/* Start or resume the run. A new run takes its number from this host's database and writes it to
 * the jobs' files. Steps that this database lists as done, from a run without jobs, are run again:
 * the report job has another database and would not find them. */
static enum neph_status begin(struct sending *sending, struct neph_diag *diag)
{
    struct neph_night_work *work = sending->work;
    const struct neph_history_night run_identity = neph_night_identity(work->night);
    const bool is_new = work->jobs.night == 0;
    enum neph_status status = neph_night_begin(work, diag);
    memset(work->ran, 0, (size_t)work->night->plan.count * sizeof(*work->ran));
    if (status || !is_new)
        return status;
    remove_old_logs(work->logs, &work->night->arena);
    return neph_night_jobs_begin(sending->output, &work->night->arena, work->night->id,
                                 work->night->started_utc, &run_identity, &work->jobs, diag);
}

/* ---- steps ----------------------------------------------------------------------------------- */

/* Record the steps that have a result file by now. */
static enum neph_status find_done_steps(struct sending *sending, struct neph_diag *diag)
{
    struct neph_night_work *work = sending->work;
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < work->night->plan.count && !status; i++) {
        struct neph_history_step record;
        struct neph_night_numbers numbers;
        bool found = false;
        if (work->ran[i])
            continue;
        status = neph_night_jobs_load(&work->jobs, &work->night->plan.steps[i], &found, &record,
                                      &numbers, diag);
        if (status || !found)
            continue;
        neph_night_note(work, i, record.outcome, record.reason);
        neph_progress_step(&work->progress, record.name, record.outcome, record.wall_s);
    }
    return status;
}

/* This command line with the options that make it a single job. */
static const char *format_job_line(const struct sending *sending, const char *option,
                                   const char *value)
{
    struct neph_arena *arena = &sending->work->night->arena;
    const char *const more[] = {"-q", "-o", sending->output, option, value, NULL};
    return neph_arena_format(arena, "%s %s", sending->said, neph_slurm_line(arena, more));
}

static enum neph_status add_step(struct sending *sending, int index, struct neph_diag *diag)
{
    struct neph_night_work *work = sending->work;
    const struct neph_night_step *step = &work->night->plan.steps[index];
    const double late_s = work->params->budget_s -
                          neph_night_step_cost(step, &work->history[index]);
    const struct neph_night_job job = {
        .limit_s = neph_night_limit_s(work, index),
        .begin_by = sending->task_count > 0 ? (double)time(NULL) + late_s : INFINITY};
    sending->tasks[sending->task_count++] = (struct neph_slurm_task){
        .line = format_job_line(sending, "--step", step->name),
        .is_timed = step->suite == NEPH_NIGHT_SPEED,
        .wants_gpu = wants_gpu()};
    return neph_night_jobs_add(&work->jobs, step->name, &job, diag);
}

/* Add a task for every unfinished step, in the order of neph_night_plan_next(). */
static enum neph_status choose_steps(struct sending *sending, struct neph_diag *diag)
{
    struct neph_night_work *work = sending->work;
    const struct neph_night_plan *plan = &work->night->plan;
    const size_t count = (size_t)plan->count;
    bool *chosen = neph_arena_copy(&work->night->arena, work->ran, count * sizeof(*chosen));
    sending->tasks = neph_arena_allocate(&work->night->arena, count, sizeof(*sending->tasks));
    enum neph_status status = neph_arena_check(&work->night->arena, diag);
    int index = 0;
    while (!status &&
           (index = neph_night_plan_next(plan, work->history, chosen, INFINITY, false)) >= 0) {
        chosen[index] = true;
        /* Durations are measured only on hosts that are marked for timing. */
        if (plan->steps[index].suite != NEPH_NIGHT_SPEED || sending->settings->timing)
            status = add_step(sending, index, diag);
        else
            neph_progress_warn("'%s' is not run: --slurm timing=FEATURE names no hosts for "
                               "durations",
                               plan->steps[index].name);
    }
    return status;
}

static enum neph_status submit(struct sending *sending, struct neph_diag *diag)
{
    struct neph_night_work *work = sending->work;
    struct neph_arena *arena = &work->night->arena;
    enum neph_status status = choose_steps(sending, diag);
    if (!status)
        status = neph_night_jobs_write(&work->jobs, diag);
    const struct neph_slurm_batch batch = {
        .name = work->jobs.name,
        .manifest = neph_arena_format(arena, "%s/nightly/jobs/manifest", sending->output),
        .logs = neph_arena_format(arena, "%s/nightly/logs", sending->output),
        .tasks = sending->tasks,
        .task_count = sending->task_count,
        .last = {.line = format_job_line(sending, "--report", NULL), .wants_gpu = wants_gpu()}};
    if (!status)
        status = neph_arena_check(arena, diag);
    return status ? status : neph_slurm_submit(sending->settings, &batch, diag);
}

/* ---- waiting --------------------------------------------------------------------------------- */

/* Wait. False after Ctrl-C. */
static bool wait_seconds(double seconds)
{
    struct pollfd signal = {.fd = neph_interrupt_fd(), .events = POLLIN};
    return poll(&signal, signal.fd < 0 ? 0 : 1, (int)(1000.0 * seconds)) == 0 &&
           !neph_interrupted();
}

/* True while jobs are queued or running, and while Slurm does not answer. */
static bool has_jobs(struct sending *sending, bool *told)
{
    struct neph_diag why = {.line = 0};
    int left = 0;
    const enum neph_status status = neph_slurm_count(sending->work->jobs.name, sending->work->logs,
                                                     &left, &why);
    if (status && status != NEPH_ERR_INTERRUPTED && !*told) {
        neph_progress_warn("Slurm does not answer; neph tries again: %s", why.message);
        *told = true;
    }
    return status || left > 0;
}

static enum neph_status wait_for_jobs(struct sending *sending, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    bool told = false;
    double wait_s = first_wait_s;
    while (!status && has_jobs(sending, &told)) {
        if (!wait_seconds(wait_s))
            return neph_fail(diag, NEPH_ERR_INTERRUPTED, "interrupted");
        status = find_done_steps(sending, diag);
        wait_s = fmin(wait_s * growth, longest_wait_s);
    }
    return status;
}

static enum neph_status check_report(struct sending *sending, struct neph_diag *diag)
{
    const struct neph_night_work *work = sending->work;
    if (is_over(sending))
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_ENGINE, "the jobs of nightly run %lld ended without a report",
              (long long)work->jobs.night);
    neph_hint(diag, "see '%s/slurm-*' for the reason; the same command continues the run",
              work->logs);
    return NEPH_ERR_ENGINE;
}

/* After Ctrl-C: cancel the jobs. The run has no report then, so the same command resumes it. */
static enum neph_status cancel(struct sending *sending, struct neph_diag *diag)
{
    const struct neph_night_work *work = sending->work;
    struct neph_diag why = {.line = 0};
    if (neph_slurm_cancel(work->jobs.name, work->logs, &why))
        neph_progress_warn("the jobs could not be cancelled: %s; scancel --name=%s", why.message,
                           work->jobs.name);
    return neph_fail(diag, NEPH_ERR_INTERRUPTED,
                     "interrupted; the jobs are cancelled, and the same command continues the run");
}

/* ---- all ------------------------------------------------------------------------------------- */

static enum neph_status prepare_and_submit(struct sending *sending, struct neph_diag *diag)
{
    enum neph_status status = find_night(sending, diag);
    if (!status && (sending->work->night->id == 0 || sending->work->jobs.night == 0))
        status = begin(sending, diag);
    if (!status)
        status = find_done_steps(sending, diag);
    if (!status && !sending->is_there)
        status = submit(sending, diag);
    return status;
}

/* The lock is released before waiting, because the report job needs it. */
static enum neph_status prepare_and_submit_locked(struct sending *sending, struct neph_diag *diag)
{
    int lock = -1;
    enum neph_status status = neph_night_lock(sending->work, false, &lock, diag);
    if (!status) {
        status = prepare_and_submit(sending, diag);
        close(lock);
    }
    return status;
}

/* When jobs of an earlier call end without a report they were cancelled: submit the steps again. */
static enum neph_status send(struct sending *sending, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    do {
        status = prepare_and_submit_locked(sending, diag);
        if (!status)
            status = wait_for_jobs(sending, diag);
    } while (!status && sending->is_there && !is_over(sending));
    if (status == NEPH_ERR_INTERRUPTED && sending->work->jobs.night > 0)
        return cancel(sending, diag);
    return status ? status : check_report(sending, diag);
}

/* Make absolute paths, because jobs start in another working directory. */
static enum neph_status name_places(struct sending *sending, const char *const *words,
                                    struct neph_diag *diag)
{
    struct neph_arena *arena = &sending->work->night->arena;
    char *real = realpath(sending->work->params->output, NULL);
    if (!real)
        return neph_fail(diag, NEPH_ERR_IO, "cannot find '%s': %s", sending->work->params->output,
                         strerror(errno));
    const char *const program[] = {sending->work->place.program_path, NULL};
    sending->output = neph_arena_copy_text(arena, real);
    sending->said = neph_arena_format(arena, "%s nightly %s", neph_slurm_line(arena, program),
                                      neph_slurm_line(arena, words));
    free(real);
    return neph_arena_check(arena, diag);
}

enum neph_status neph_night_send(const struct neph_night_params *params,
                                 const struct neph_slurm_settings *settings,
                                 const char *const *words, struct neph_store *store, int64_t *id,
                                 struct neph_diag *diag)
{
    struct neph_night night = {.id = 0};
    struct neph_night_work work = {
        .params = params, .store = store, .night = &night, .start_s = neph_wall_s()};
    struct sending sending = {.work = &work, .settings = settings};
    enum neph_status status = check(settings, diag);
    if (!status)
        status = neph_night_prepare(&work, diag);
    if (!status)
        status = name_places(&sending, words, diag);
    work.progress = neph_progress_start(params->quiet, night.plan.count);
    if (!status)
        status = send(&sending, diag);
    neph_progress_end(&work.progress);
    if (!status)
        *id = work.jobs.night;
    neph_night_jobs_finish(&work.jobs);
    neph_arena_finish(&night.arena);
    return status;
}

/* ---- a job ----------------------------------------------------------------------------------- */

static enum neph_status run_step(struct neph_night_work *work, const char *name,
                                 struct neph_diag *diag)
{
    const struct neph_history_night run_identity = neph_night_identity(work->night);
    const struct neph_night_step *step = neph_night_plan_find(&work->night->plan, name);
    bool found = false;
    if (!step)
        return neph_fail(diag, NEPH_ERR_USAGE, "there is no step '%s'", name);
    enum neph_status status = neph_night_jobs_read(work->params->output, &work->night->arena,
                                                   &work->jobs, &found, diag);
    if (!status)
        status = neph_night_jobs_check(&work->jobs, &run_identity, diag);
    return status ? status
                  : neph_night_jobs_run(&work->jobs, step, work->params->output, work->logs,
                                        &work->place, diag);
}

enum neph_status neph_night_run_step(const struct neph_night_params *params, const char *step,
                                     struct neph_diag *diag)
{
    struct neph_night night = {.id = 0};
    struct neph_night_work work = {.params = params, .night = &night};
    enum neph_status status = neph_night_prepare(&work, diag);
    if (!status)
        status = run_step(&work, step, diag);
    neph_night_jobs_finish(&work.jobs);
    neph_arena_finish(&night.arena);
    return status;
}
