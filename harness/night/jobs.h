/* SPDX-License-Identifier: MIT
 *
 * A night whose steps are run by jobs on other hosts: what these are told, and what they leave.
 *
 *   OUTPUT/nightly/jobs/night.json    which night, and how long each step may take
 *   OUTPUT/nightly/jobs/<step>.json   what a step has measured: it is done
 *   OUTPUT/nightly/jobs/manifest      a command line a step (run/slurm.h)
 *   OUTPUT/nightly/jobs/work-...      where one is at work (base/scratch.h)
 *
 * A job opens no database: it makes frames in the store and leaves its file, whole or not at all.
 * Whether a step is done these files tell, whatever a scheduler says of its jobs; so a step may be
 * begun twice, killed and begun anew, on any host.
 */
#ifndef NEPH_HARNESS_NIGHT_JOBS_H
#define NEPH_HARNESS_NIGHT_JOBS_H

#include "harness/night/step.h"

#include <stdbool.h>
#include <stdint.h>

/* The outcome of a step that was too late to begin. */
extern const char neph_night_job_not_run[];

/* Texts are of the arena. */
struct neph_night_jobs {
    struct neph_arena *arena;
    const char *folder; /* OUTPUT/nightly/jobs */
    json_t *steps;      /* {STEP: {"limit_s", "begin_by"}} of those that there are jobs for */
    /* As in its document: */
    const char *format;
    const char *name; /* of this night's jobs, and of no other's */
    int64_t night;
    const char *started_utc;
    struct neph_history_night who;
};

/* What a job of a step is told. */
struct neph_night_job {
    double limit_s;
    double begin_by; /* later than this second since 1970 it does not begin; infinite: it may */
};

/* Look for a night in the folder of an output. */
enum neph_status neph_night_jobs_read(const char *output, struct neph_arena *arena,
                                      struct neph_night_jobs *jobs, bool *found,
                                      struct neph_diag *diag);

/* Give a night its folder and the name of its jobs; what is in the folder is of an earlier one, and
 * is removed. End it with neph_night_jobs_finish(), as one that was read. */
enum neph_status neph_night_jobs_begin(const char *output, struct neph_arena *arena, int64_t night,
                                       const char *started_utc,
                                       const struct neph_history_night *who,
                                       struct neph_night_jobs *jobs, struct neph_diag *diag);

/* A step will have a job; and write night.json. */
enum neph_status neph_night_jobs_add(struct neph_night_jobs *jobs, const char *step,
                                     const struct neph_night_job *job, struct neph_diag *diag);
enum neph_status neph_night_jobs_write(const struct neph_night_jobs *jobs, struct neph_diag *diag);

/* Free, and leave the files. */
void neph_night_jobs_finish(struct neph_night_jobs *jobs);

/* The night is over, or nobody goes on with it. */
enum neph_status neph_night_jobs_forget(const char *output, struct neph_diag *diag);

/* Whether it is this night, of the same plan, revision and program; hosts may differ. */
bool neph_night_jobs_is_of(const struct neph_night_jobs *jobs,
                           const struct neph_history_night *who);

/* NEPH_ERR_USAGE: it is another, or none. */
enum neph_status neph_night_jobs_check(const struct neph_night_jobs *jobs,
                                       const struct neph_history_night *who,
                                       struct neph_diag *diag);

/* What the job of a step was told; false: it has none. */
bool neph_night_jobs_find(const struct neph_night_jobs *jobs, const char *step,
                          struct neph_night_job *job);

/* Leave what a step has measured, and look for it. What a job of another night has left is not
 * found. */
enum neph_status neph_night_jobs_keep(const struct neph_night_jobs *jobs,
                                      const struct neph_night_step *step,
                                      const struct neph_history_step *record,
                                      const struct neph_night_numbers *numbers,
                                      struct neph_diag *diag);
enum neph_status neph_night_jobs_look(const struct neph_night_jobs *jobs,
                                      const struct neph_night_step *step, bool *found,
                                      struct neph_history_step *record,
                                      struct neph_night_numbers *numbers, struct neph_diag *diag);

/* Run the step here, unless it is done or too late, and leave what it has measured. `output` is
 * where the store is, `logs` the folder for its log. */
enum neph_status neph_night_jobs_run(const struct neph_night_jobs *jobs,
                                     const struct neph_night_step *step, const char *output,
                                     const char *logs, struct neph_step_place *place,
                                     struct neph_diag *diag);

#endif
