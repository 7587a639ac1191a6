/* SPDX-License-Identifier: MIT
 *
 * Files through which a nightly run and its jobs on other hosts communicate.
 *
 *   OUTPUT/nightly/jobs/night.json    number of the run; time limit of each step
 *   OUTPUT/nightly/jobs/<step>.json   the numbers of a step; the step is done
 *   OUTPUT/nightly/jobs/manifest      one command line for each step (run/slurm.h)
 *   OUTPUT/nightly/jobs/work-...      working folder of a step in progress (base/scratch.h)
 *
 * A job opens no database. It renders frames into the store and writes its result file atomically.
 * Only these files decide whether a step is done, not the job states of the scheduler. So a step
 * may be started twice, or killed and restarted, on any host.
 */
#ifndef NEPH_HARNESS_NIGHT_JOBS_H
#define NEPH_HARNESS_NIGHT_JOBS_H

#include "harness/night/step.h"

#include <stdbool.h>
#include <stdint.h>

/* The outcome of a step with a job that started after `begin_by`. */
extern const char neph_night_job_not_run[];

/* The contents of night.json. Texts are allocated in the arena. */
struct neph_night_jobs {
    struct neph_arena *arena;
    const char *folder; /* OUTPUT/nightly/jobs */
    json_t *steps;      /* {STEP: {"limit_s", "begin_by"}}, the steps that have jobs */
    /* fields of night.json */
    const char *format;
    const char *name; /* name of this run's jobs, unique to it */
    int64_t night;
    const char *started_utc;
    struct neph_history_night run_identity;
};

/* Limits of a step's job. */
struct neph_night_job {
    double limit_s;
    double begin_by; /* latest start, in seconds since 1970; infinite: no limit */
};

/* Read the night.json of an output folder; `*found` is false when there is none. */
enum neph_status neph_night_jobs_read(const char *output, struct neph_arena *arena,
                                      struct neph_night_jobs *jobs, bool *found,
                                      struct neph_diag *diag);

/* Create the folder and the job name of a run. Files of an earlier run are removed. Free with
 * neph_night_jobs_finish(), as after neph_night_jobs_read(). */
enum neph_status neph_night_jobs_begin(const char *output, struct neph_arena *arena, int64_t night,
                                       const char *started_utc,
                                       const struct neph_history_night *run_identity,
                                       struct neph_night_jobs *jobs, struct neph_diag *diag);

/* Add a step that gets a job; and write night.json. */
enum neph_status neph_night_jobs_add(struct neph_night_jobs *jobs, const char *step,
                                     const struct neph_night_job *job, struct neph_diag *diag);
enum neph_status neph_night_jobs_write(const struct neph_night_jobs *jobs, struct neph_diag *diag);

/* Free the memory; the files stay. */
void neph_night_jobs_finish(struct neph_night_jobs *jobs);

/* Remove the files: the run is over or abandoned. */
enum neph_status neph_night_jobs_forget(const char *output, struct neph_diag *diag);

/* True when the jobs belong to a run of the same plan, revision and program; hosts may differ. */
bool neph_night_jobs_match(const struct neph_night_jobs *jobs,
                           const struct neph_history_night *run_identity);

/* NEPH_ERR_USAGE unless the jobs belong to this run. */
enum neph_status neph_night_jobs_check(const struct neph_night_jobs *jobs,
                                       const struct neph_history_night *run_identity,
                                       struct neph_diag *diag);

/* The limits of a step's job; false: the step has no job. */
bool neph_night_jobs_find(const struct neph_night_jobs *jobs, const char *step,
                          struct neph_night_job *job);

/* Write and read the result file of a step. Files of another run's jobs are ignored. */
enum neph_status neph_night_jobs_store(const struct neph_night_jobs *jobs,
                                       const struct neph_night_step *step,
                                       const struct neph_history_step *record,
                                       const struct neph_night_numbers *numbers,
                                       struct neph_diag *diag);
enum neph_status neph_night_jobs_load(const struct neph_night_jobs *jobs,
                                      const struct neph_night_step *step, bool *found,
                                      struct neph_history_step *record,
                                      struct neph_night_numbers *numbers, struct neph_diag *diag);

/* Run the step in this process and write its result file, unless the step is done or `begin_by` has
 * passed. `output` is the folder with the store, `logs` the folder for the step's log. */
enum neph_status neph_night_jobs_run(const struct neph_night_jobs *jobs,
                                     const struct neph_night_step *step, const char *output,
                                     const char *logs, struct neph_step_place *place,
                                     struct neph_diag *diag);

#endif
