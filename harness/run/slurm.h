/* SPDX-License-Identifier: MIT
 *
 * Slurm, as far as neph needs it: many command lines as arrays of jobs, one more that runs when
 * they have ended, how many are left, and an end to all. Nothing of what a job has done is asked of
 * Slurm: results lie in files, and whoever looks finds them there.
 *
 * A line of the manifest is a task: a command line that may be run any number of times, on any
 * host, and does its work once. All jobs of a batch have one name, by which they are found again.
 */
#ifndef NEPH_HARNESS_RUN_SLURM_H
#define NEPH_HARNESS_RUN_SLURM_H

#include "base/arena.h"
#include "base/status.h"

#include <stdbool.h>

/* What an operator says of the cluster. NULL: nothing. */
struct neph_slurm_settings {
    const char *timing;    /* the feature of hosts on which durations count */
    const char *gpu;       /* the feature of hosts with a GPU */
    const char *partition; /* in place of the cluster's own */
    const char *at_once;   /* so many tasks of an array run at the same time */
    const char *arguments; /* more words for each sbatch, between blanks */
};

/* Read words "KEY=VALUE", which they point into. NEPH_ERR_USAGE: no such key, or no value. */
enum neph_status neph_slurm_read_settings(const char *const *words, int count,
                                          struct neph_slurm_settings *settings,
                                          struct neph_diag *diag);

/* The help of --slurm: its keys. */
#define NEPH_SLURM_KEYS "timing, gpu, partition, at_once, arguments"

struct neph_slurm_task {
    const char *line; /* for a shell */
    bool is_timed;    /* goes to hosts with the feature `timing` alone, and has them for itself */
    bool wants_gpu;   /* goes to hosts with the feature `gpu` alone */
};

struct neph_slurm_batch {
    const char *name;     /* of all its jobs: letters, digits and dashes */
    const char *manifest; /* the file; all hosts have it at this path */
    const char *logs;     /* the folder for what Slurm and its jobs say; the same */
    const struct neph_slurm_task *tasks;
    int task_count;
    struct neph_slurm_task last; /* runs when all others have ended, however they did */
};

/* Hand all of it to Slurm; when that fails in the middle, what was handed over is cancelled.
 * NEPH_ERR_UNAVAILABLE: there is no sbatch. NEPH_ERR_USAGE: there are tasks for hosts of which
 * `settings` say nothing, or one with a line break in it. NEPH_ERR_ENGINE: Slurm refused, in its
 * own words. */
enum neph_status neph_slurm_submit(const struct neph_slurm_settings *settings,
                                   const struct neph_slurm_batch *batch, struct neph_diag *diag);

/* Tasks of that name that wait or run. Errors: Slurm does not answer. */
enum neph_status neph_slurm_count(const char *name, const char *logs, int *count,
                                  struct neph_diag *diag);

/* End all jobs of that name; none is fine. Acknowledges a Ctrl-C. */
enum neph_status neph_slurm_cancel(const char *name, const char *logs, struct neph_diag *diag);

/* Words, NULL-terminated, as a line for a shell, of the arena. */
const char *neph_slurm_line(struct neph_arena *arena, const char *const *words);

#endif
