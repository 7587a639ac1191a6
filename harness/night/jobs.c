/* SPDX-License-Identifier: MIT */
#include "harness/night/jobs.h"

#include "base/files.h"
#include "base/path.h"
#include "base/scratch.h"
#include "harness/json_file.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const char night_format[] = "neph-night-jobs-1", step_format[] = "neph-step-1";
const char neph_night_job_not_run[] = "not run";
static const size_t limit_bytes = 64 << 20;

#define JOBS(member) NEPH_RECORD_FIELD(struct neph_night_jobs, member)
#define WHO(member)                                                                                \
    {                                                                                              \
        .name = #member, NEPH_RECORD_MEMBER(struct neph_night_jobs, run_identity.member)           \
    }
static const struct neph_record_form night_form = {sizeof(struct neph_night_jobs),
                                                   {JOBS(format), JOBS(name), JOBS(night),
                                                    JOBS(started_utc), WHO(plan), WHO(revision),
                                                    WHO(program), WHO(host)}};

/* The result file of a step. */
#define STEP(member) NEPH_RECORD_FIELD(struct neph_history_step, member)
static const struct neph_record_form step_form = {
    sizeof(struct neph_history_step),
    {{.name = "step", NEPH_RECORD_MEMBER(struct neph_history_step, name)},
     STEP(outcome),
     STEP(reason),
     STEP(size),
     STEP(wall_s),
     NEPH_RECORD_OPTIONAL(struct neph_history_step, calibration_s)}};

#define MEASURED(member) NEPH_RECORD_FIELD(struct neph_measurement, member)
#define MAYBE_MEASURED(member) NEPH_RECORD_OPTIONAL(struct neph_measurement, member)
static const struct neph_record_form measurement_form = {
    sizeof(struct neph_measurement),
    {MEASURED(series), MEASURED(kind), MAYBE_MEASURED(value), MAYBE_MEASURED(standard_error),
     MEASURED(environment), MEASURED(frame)}};

/* ---- files ----------------------------------------------------------------------------------- */

static const char *format_jobs_folder(struct neph_arena *arena, const char *output)
{
    return neph_arena_format(arena, "%s/nightly/jobs", output);
}

/* Read a JSON file. `*document` is NULL without an error when the file is missing or has another
 * format. */
static enum neph_status read_json(const char *path, const char *format, json_t **document,
                                  struct neph_diag *diag)
{
    json_t *read = NULL;
    const enum neph_status status = neph_json_read(path, limit_bytes, &read, diag);
    *document = strcmp(neph_json_text(read, "format"), format) == 0 ? json_incref(read) : NULL;
    json_decref(read);
    return status == NEPH_ERR_NOT_FOUND ? NEPH_OK : status;
}

/* Write a JSON file; takes ownership of the document. */
static enum neph_status write_json(const char *path, json_t *document, struct neph_diag *diag)
{
    const enum neph_status status = neph_json_write(document, JSON_INDENT(1), path, diag);
    json_decref(document);
    return status;
}

/* ---- a run ----------------------------------------------------------------------------------- */

enum neph_status neph_night_jobs_read(const char *output, struct neph_arena *arena,
                                      struct neph_night_jobs *jobs, bool *found,
                                      struct neph_diag *diag)
{
    json_t *d = NULL;
    const char *folder = format_jobs_folder(arena, output);
    const enum neph_status status = read_json(neph_path_in(folder, "night.json").text, night_format,
                                              &d, diag);
    if (status)
        return status;
    *found = d != NULL;
    *jobs = (struct neph_night_jobs){
        .arena = arena, .folder = folder, .steps = json_incref(json_object_get(d, "steps"))};
    neph_record_read(&night_form, d, arena, jobs);
    json_decref(d);
    return neph_arena_check(arena, diag);
}

/* Make a job name from the output folder, the run's number and its start time, so that it is unique
 * across folders and runs. */
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
                                       const struct neph_history_night *run_identity,
                                       struct neph_night_jobs *jobs, struct neph_diag *diag)
{
    *jobs = (struct neph_night_jobs){.arena = arena,
                                     .folder = format_jobs_folder(arena, output),
                                     .format = night_format,
                                     .night = night,
                                     .started_utc = started_utc,
                                     .run_identity = *run_identity,
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
    json_t *document = neph_record_json(&night_form, jobs);
    neph_json_set(&document, "steps", json_incref(jobs->steps));
    return write_json(neph_path_in(jobs->folder, "night.json").text, document, diag);
}

void neph_night_jobs_finish(struct neph_night_jobs *jobs)
{
    json_decref(jobs->steps);
    jobs->steps = NULL;
}

/* Removes night.json first: without that file there is no run to resume. */
enum neph_status neph_night_jobs_forget(const char *output, struct neph_diag *diag)
{
    const struct neph_path folder = neph_path_in(output, "nightly/jobs"),
                           night = neph_path_in(folder.text, "night.json");
    if (unlink(night.text) != 0 && errno != ENOENT)
        return neph_fail(diag, NEPH_ERR_IO, "cannot remove '%s': %s", night.text, strerror(errno));
    return neph_dir_remove(folder.text, diag);
}

bool neph_night_jobs_match(const struct neph_night_jobs *jobs,
                           const struct neph_history_night *run_identity)
{
    return strcmp(jobs->run_identity.plan, run_identity->plan) == 0 &&
           strcmp(jobs->run_identity.revision, run_identity->revision) == 0 &&
           strcmp(jobs->run_identity.program, run_identity->program) == 0;
}

enum neph_status neph_night_jobs_check(const struct neph_night_jobs *jobs,
                                       const struct neph_history_night *run_identity,
                                       struct neph_diag *diag)
{
    return neph_night_jobs_match(jobs, run_identity)
               ? NEPH_OK
               : neph_fail(diag, NEPH_ERR_USAGE,
                           "'%s' has no jobs of this nightly run and this program", jobs->folder);
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

/* ---- result files ---------------------------------------------------------------------------- */

static const char *record_path(const struct neph_night_jobs *jobs,
                               const struct neph_night_step *step)
{
    return neph_step_file(jobs->arena, jobs->folder, step, ".json");
}

enum neph_status neph_night_jobs_store(const struct neph_night_jobs *jobs,
                                       const struct neph_night_step *step,
                                       const struct neph_history_step *record,
                                       const struct neph_night_numbers *numbers,
                                       struct neph_diag *diag)
{
    json_t *list = json_array();
    for (int i = 0; i < numbers->count; i++)
        neph_json_add(&list, neph_record_json(&measurement_form, &numbers->list[i]));
    json_t *document = neph_record_json(&step_form, record);
    neph_json_set(&document, "format", json_string(step_format));
    neph_json_set(&document, "jobs", json_string(jobs->name));
    neph_json_set(&document, "measurements", list);
    return write_json(record_path(jobs, step), document, diag);
}

static void read_measurements(struct neph_arena *arena, const json_t *list,
                              struct neph_night_numbers *numbers)
{
    const size_t count = json_array_size(list);
    struct neph_measurement *read = neph_arena_allocate(arena, count + 1, sizeof(*read));
    for (size_t i = 0; read && i < count; i++)
        neph_record_read(&measurement_form, json_array_get(list, i), arena, &read[i]);
    *numbers = (struct neph_night_numbers){.list = read, .count = (int)count};
}

enum neph_status neph_night_jobs_load(const struct neph_night_jobs *jobs,
                                      const struct neph_night_step *step, bool *found,
                                      struct neph_history_step *record,
                                      struct neph_night_numbers *numbers, struct neph_diag *diag)
{
    struct neph_arena *arena = jobs->arena;
    json_t *d = NULL;
    const enum neph_status status = read_json(record_path(jobs, step), step_format, &d, diag);
    *found = !status && strcmp(neph_json_text(d, "jobs"), jobs->name) == 0;
    if (*found) {
        neph_record_read(&step_form, d, arena, record);
        read_measurements(arena, json_object_get(d, "measurements"), numbers);
        numbers->size = record->size;
    }
    json_decref(d);
    return status ? status : neph_arena_check(arena, diag);
}

/* ---- running a step -------------------------------------------------------------------------- */

/* Link the shared store into the step's own working folder. */
static enum neph_status link_store(const char *output, const char *work, struct neph_diag *diag)
{
    char *store = realpath(neph_path_in(output, "store").text, NULL);
    const struct neph_path link = neph_path_in(work, "store");
    const enum neph_status status = store && symlink(store, link.text) == 0
                                        ? NEPH_OK
                                        : neph_fail(diag, NEPH_ERR_IO,
                                                    "cannot link '%s' to the store of '%s': %s",
                                                    link.text, output, strerror(errno));
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
    return status ? status : neph_night_jobs_store(jobs, step, &record, &numbers, diag);
}

static enum neph_status run(const struct neph_night_jobs *jobs, const struct neph_night_step *step,
                            const char *output, const char *logs, struct neph_step_place *place,
                            const struct neph_night_job *job, struct neph_diag *diag)
{
    struct neph_scratch *scratch = NULL;
    enum neph_status status = neph_scratch_create(jobs->folder, "work-", &scratch, diag);
    if (!status)
        status = link_store(output, neph_scratch_path(scratch), diag);
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
        return neph_fail(diag, NEPH_ERR_USAGE, "this nightly run has no job for step '%s'",
                         step->name);
    enum neph_status status = neph_night_jobs_load(jobs, step, &done, &record, &numbers, diag);
    if (status || done)
        return status;
    return (double)time(NULL) > job.begin_by
               ? neph_night_jobs_store(jobs, step, &record, &numbers, diag)
               : run(jobs, step, output, logs, place, &job, diag);
}
