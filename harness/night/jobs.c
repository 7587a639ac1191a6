/* SPDX-License-Identifier: MIT */
#include "harness/night/jobs.h"

#include "base/files.h"
#include "base/hash.h"
#include "base/scratch.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const char night_format[] = "neph-night-jobs-1", step_format[] = "neph-step-1";
const char neph_night_job_not_run[] = "not run";
static const size_t limit_bytes = 64 << 20;

/* ---- files ----------------------------------------------------------------------------------- */

static const char *folder_of(struct neph_arena *arena, const char *output)
{
    return neph_arena_format(arena, "%s/nightly/jobs", output);
}

/* NULL without an error: there is none, or it is no document of this form. */
static enum neph_status read_json(const char *path, const char *format, json_t **document,
                                  struct neph_diag *diag)
{
    char *text = NULL;
    size_t size;
    *document = NULL;
    const enum neph_status status = neph_file_read(path, limit_bytes, &text, &size, diag);
    if (status)
        return status == NEPH_ERR_NOT_FOUND ? NEPH_OK : status;
    json_t *read = json_loadb(text, size, JSON_REJECT_DUPLICATES, NULL);
    free(text);
    if (strcmp(neph_json_text(read, "format"), format) == 0)
        *document = read;
    else
        json_decref(read);
    return NEPH_OK;
}

/* Takes the document over. */
static enum neph_status write_json(const char *path, json_t *document, struct neph_diag *diag)
{
    char *text = document ? json_dumps(document, JSON_INDENT(1)) : NULL;
    const enum neph_status status = text ? neph_file_write(path, text, strlen(text), diag)
                                         : neph_fail_memory(diag);
    free(text);
    json_decref(document);
    return status;
}

/* ---- a night --------------------------------------------------------------------------------- */

enum neph_status neph_night_jobs_read(const char *output, struct neph_arena *arena,
                                      struct neph_night_jobs *jobs, bool *found,
                                      struct neph_diag *diag)
{
    json_t *d = NULL;
    const char *folder = folder_of(arena, output);
    const enum neph_status status = read_json(neph_arena_format(arena, "%s/night.json", folder),
                                              night_format, &d, diag);
    if (status)
        return status;
    *found = d != NULL;
    *jobs = (struct neph_night_jobs){
        .arena = arena,
        .folder = folder,
        .name = neph_arena_text(arena, neph_json_text(d, "name")),
        .night = json_integer_value(json_object_get(d, "night")),
        .started_utc = neph_arena_text(arena, neph_json_text(d, "started_utc")),
        .who = {neph_arena_text(arena, neph_json_text(d, "plan")),
                neph_arena_text(arena, neph_json_text(d, "revision")),
                neph_arena_text(arena, neph_json_text(d, "program")),
                neph_arena_text(arena, neph_json_text(d, "host"))},
        .steps = json_incref(json_object_get(d, "steps"))};
    json_decref(d);
    return neph_arena_check(arena, diag);
}

/* By which its jobs are found again, whoever asks: no other night has it, in this output or in
 * another. */
static enum neph_status name_jobs(struct neph_night_jobs *jobs, const char *output,
                                  struct neph_diag *diag)
{
    char digest[NEPH_HASH_HEX_SIZE];
    char *real = realpath(output, NULL);
    if (!real)
        return neph_fail(diag, NEPH_ERR_IO, "cannot find '%s': %s", output, strerror(errno));
    const char *text = neph_arena_format(jobs->arena, "%s %lld %s", real, (long long)jobs->night,
                                         jobs->started_utc);
    free(real);
    const enum neph_status status = neph_hash(text, strlen(text), digest, diag);
    if (!status)
        jobs->name = neph_arena_format(jobs->arena, "neph-%.12s", digest);
    return status;
}

enum neph_status neph_night_jobs_begin(const char *output, struct neph_arena *arena, int64_t night,
                                       const char *started_utc,
                                       const struct neph_history_night *who,
                                       struct neph_night_jobs *jobs, struct neph_diag *diag)
{
    *jobs = (struct neph_night_jobs){.arena = arena,
                                     .folder = folder_of(arena, output),
                                     .night = night,
                                     .started_utc = started_utc,
                                     .who = *who,
                                     .steps = json_object()};
    enum neph_status status = neph_dir_remove(jobs->folder, diag);
    if (!status)
        status = neph_dir_create(jobs->folder, diag);
    if (!status)
        status = name_jobs(jobs, output, diag);
    return status ? status : neph_arena_check(arena, diag);
}

enum neph_status neph_night_jobs_add(struct neph_night_jobs *jobs, const char *step,
                                     const struct neph_night_job *job, struct neph_diag *diag)
{
    return neph_json_put(jobs->steps, step,
                         json_pack("{s:f, s:o}", "limit_s", job->limit_s, "begin_by",
                                   neph_json_number(job->begin_by)),
                         diag);
}

enum neph_status neph_night_jobs_write(const struct neph_night_jobs *jobs, struct neph_diag *diag)
{
    return write_json(neph_arena_format(jobs->arena, "%s/night.json", jobs->folder),
                      json_pack("{s:s, s:s, s:I, s:s, s:s, s:s, s:s, s:s, s:O}", "format",
                                night_format, "name", jobs->name, "night", (json_int_t)jobs->night,
                                "started_utc", jobs->started_utc, "plan", jobs->who.plan,
                                "revision", jobs->who.revision, "program", jobs->who.program,
                                "host", jobs->who.host, "steps", jobs->steps),
                      diag);
}

void neph_night_jobs_finish(struct neph_night_jobs *jobs)
{
    json_decref(jobs->steps);
    jobs->steps = NULL;
}

/* First the file that makes it a night. */
enum neph_status neph_night_jobs_forget(const char *output, struct neph_diag *diag)
{
    struct neph_arena arena = {NULL};
    const char *folder = folder_of(&arena, output);
    const char *night = neph_arena_format(&arena, "%s/night.json", folder);
    enum neph_status status = neph_arena_check(&arena, diag);
    if (!status && unlink(night) != 0 && errno != ENOENT)
        status = neph_fail(diag, NEPH_ERR_IO, "cannot remove '%s': %s", night, strerror(errno));
    if (!status)
        status = neph_dir_remove(folder, diag);
    neph_arena_finish(&arena);
    return status;
}

bool neph_night_jobs_is_of(const struct neph_night_jobs *jobs, const struct neph_history_night *who)
{
    return strcmp(jobs->who.plan, who->plan) == 0 &&
           strcmp(jobs->who.revision, who->revision) == 0 &&
           strcmp(jobs->who.program, who->program) == 0;
}

enum neph_status neph_night_jobs_check(const struct neph_night_jobs *jobs,
                                       const struct neph_history_night *who, struct neph_diag *diag)
{
    return neph_night_jobs_is_of(jobs, who)
               ? NEPH_OK
               : neph_fail(diag, NEPH_ERR_USAGE,
                           "no jobs were sent for this night, by this program, from '%s'",
                           jobs->folder);
}

bool neph_night_jobs_find(const struct neph_night_jobs *jobs, const char *step,
                          struct neph_night_job *job)
{
    const json_t *told = json_object_get(jobs->steps, step);
    const double begin_by = neph_json_real(told, "begin_by");
    *job = (struct neph_night_job){.limit_s = neph_json_real(told, "limit_s"),
                                   .begin_by = isnan(begin_by) ? INFINITY : begin_by};
    return told != NULL;
}

/* ---- what a step has measured ---------------------------------------------------------------- */

static const char *record_path(const struct neph_night_jobs *jobs,
                               const struct neph_night_step *step)
{
    return neph_step_file(jobs->arena, jobs->folder, step, ".json");
}

static json_t *measurement_json(const struct neph_measurement *m)
{
    return json_pack("{s:s, s:s, s:o, s:o, s:s, s:s}", "series", m->series, "kind", m->kind,
                     "value", neph_json_number(m->value), "standard_error",
                     neph_json_number(m->standard_error), "environment", m->environment, "frame",
                     m->frame);
}

enum neph_status neph_night_jobs_keep(const struct neph_night_jobs *jobs,
                                      const struct neph_night_step *step,
                                      const struct neph_history_step *record,
                                      const struct neph_night_numbers *numbers,
                                      struct neph_diag *diag)
{
    json_t *list = json_array();
    for (int i = 0; i < numbers->count; i++)
        neph_json_add(&list, measurement_json(&numbers->list[i]));
    return write_json(record_path(jobs, step),
                      json_pack("{s:s, s:s, s:s, s:s, s:s, s:s, s:f, s:o, s:o}", "format",
                                step_format, "jobs", jobs->name, "step", record->name, "outcome",
                                record->outcome, "reason", record->reason, "size", record->size,
                                "wall_s", record->wall_s, "calibration_s",
                                neph_json_number(record->calibration_s), "measurements", list),
                      diag);
}

static void read_measurements(struct neph_arena *arena, const json_t *list,
                              struct neph_night_numbers *numbers)
{
    const size_t count = json_array_size(list);
    struct neph_measurement *read = neph_arena_zeroed(arena, count + 1, sizeof(*read));
    for (size_t i = 0; read && i < count; i++) {
        const json_t *m = json_array_get(list, i);
        read[i] = (struct neph_measurement){
            .series = neph_arena_text(arena, neph_json_text(m, "series")),
            .kind = neph_arena_text(arena, neph_json_text(m, "kind")),
            .value = neph_json_real(m, "value"),
            .standard_error = neph_json_real(m, "standard_error"),
            .environment = neph_arena_text(arena, neph_json_text(m, "environment")),
            .frame = neph_arena_text(arena, neph_json_text(m, "frame"))};
    }
    *numbers = (struct neph_night_numbers){.list = read, .count = (int)count};
}

enum neph_status neph_night_jobs_look(const struct neph_night_jobs *jobs,
                                      const struct neph_night_step *step, bool *found,
                                      struct neph_history_step *record,
                                      struct neph_night_numbers *numbers, struct neph_diag *diag)
{
    struct neph_arena *arena = jobs->arena;
    json_t *d = NULL;
    const enum neph_status status = read_json(record_path(jobs, step), step_format, &d, diag);
    *found = !status && strcmp(neph_json_text(d, "jobs"), jobs->name) == 0;
    if (*found) {
        *record = (struct neph_history_step){
            .name = step->name,
            .outcome = neph_arena_text(arena, neph_json_text(d, "outcome")),
            .reason = neph_arena_text(arena, neph_json_text(d, "reason")),
            .size = neph_arena_text(arena, neph_json_text(d, "size")),
            .wall_s = neph_json_real(d, "wall_s"),
            .calibration_s = neph_json_real(d, "calibration_s")};
        read_measurements(arena, json_object_get(d, "measurements"), numbers);
        numbers->size = record->size;
    }
    json_decref(d);
    return status ? status : neph_arena_check(arena, diag);
}

/* ---- running one ----------------------------------------------------------------------------- */

/* A folder of its own for what the step writes, in which the store is that of all. */
static enum neph_status link_store(struct neph_arena *arena, const char *output, const char *work,
                                   struct neph_diag *diag)
{
    char *store = realpath(neph_arena_format(arena, "%s/store", output), NULL);
    const char *link = neph_arena_format(arena, "%s/store", work);
    enum neph_status status = neph_arena_check(arena, diag);
    if (!status && (!store || symlink(store, link) != 0))
        status = neph_fail(diag, NEPH_ERR_IO, "cannot link '%s' to the store of '%s': %s", link,
                           output, strerror(errno));
    free(store);
    return status;
}

static enum neph_status run_in(const struct neph_night_jobs *jobs,
                               const struct neph_night_step *step, const char *work,
                               const char *logs, const struct neph_step_place *place,
                               const struct neph_night_job *job, struct neph_diag *diag)
{
    struct neph_history_step record;
    struct neph_night_numbers numbers;
    const char *log = neph_arena_format(jobs->arena, "%s/step.log", work);
    const enum neph_status status = neph_step_run(place, step, work, log, job->limit_s, &record,
                                                  &numbers, diag);
    if (neph_path_exists(log))
        neph_file_copy(log, neph_step_file(jobs->arena, logs, step, ".log"), NULL);
    return status ? status : neph_night_jobs_keep(jobs, step, &record, &numbers, diag);
}

static enum neph_status run(const struct neph_night_jobs *jobs, const struct neph_night_step *step,
                            const char *output, const char *logs, struct neph_step_place *place,
                            const struct neph_night_job *job, struct neph_diag *diag)
{
    struct neph_scratch *scratch = NULL;
    enum neph_status status = neph_scratch_create(jobs->folder, "work-", &scratch, diag);
    if (!status)
        status = link_store(jobs->arena, output, neph_scratch_path(scratch), diag);
    if (!status)
        status = neph_step_place_settle(place, false, diag);
    if (!status)
        status = run_in(jobs, step, neph_scratch_path(scratch), logs, place, job, diag);
    neph_scratch_destroy(scratch);
    return status;
}

enum neph_status neph_night_jobs_run(const struct neph_night_jobs *jobs,
                                     const struct neph_night_step *step, const char *output,
                                     const char *logs, struct neph_step_place *place,
                                     struct neph_diag *diag)
{
    struct neph_history_step record = {.name = step->name,
                                       .outcome = neph_night_job_not_run,
                                       .reason = "",
                                       .size = "",
                                       .calibration_s = NAN};
    struct neph_night_numbers numbers = {.count = 0};
    struct neph_night_job job;
    bool done = false;
    if (!neph_night_jobs_find(jobs, step->name, &job))
        return neph_fail(diag, NEPH_ERR_USAGE, "tonight there is no job for step '%s'", step->name);
    enum neph_status status = neph_night_jobs_look(jobs, step, &done, &record, &numbers, diag);
    if (status || done)
        return status;
    return (double)time(NULL) > job.begin_by
               ? neph_night_jobs_keep(jobs, step, &record, &numbers, diag)
               : run(jobs, step, output, logs, place, &job, diag);
}
