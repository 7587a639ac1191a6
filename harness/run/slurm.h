/* SPDX-License-Identifier: MIT
 *
 * The Slurm functions that neph uses: submit many command lines as job arrays, run one more when
 * they have ended, count the remaining jobs, cancel all. Results are in files; Slurm is not queried
 * for them.
 *
 * A line of the manifest is a task: a command line that can run any number of times, on any host,
 * and does its work once. All jobs of a batch share one name, by which they are found again.
 */
#ifndef NEPH_HARNESS_RUN_SLURM_H
#define NEPH_HARNESS_RUN_SLURM_H

#include "base/arena.h"
#include "base/status.h"

#include <stdbool.h>

/* Settings of the cluster. NULL: not set. */
struct neph_slurm_settings {
    const char *timing;    /* feature of hosts for time measurements */
    const char *gpu;       /* feature of hosts with a GPU */
    const char *partition; /* replaces the cluster's default */
    const char *at_once;   /* limit of tasks of an array that run at the same time */
    const char *arguments; /* further arguments of each sbatch, separated by spaces */
};

/* Reads words "KEY=VALUE"; the settings point into the words. NEPH_ERR_USAGE: unknown key or no
 * value. */
enum neph_status neph_slurm_read_settings(const char *const *words, int count,
                                          struct neph_slurm_settings *settings,
                                          struct neph_diag *diag);

/* The keys of --slurm, for its help. */
#define NEPH_SLURM_KEYS "timing, gpu, partition, at_once, arguments"

struct neph_slurm_task {
    const char *line; /* command line for a shell */
    bool is_timed;    /* needs a host with the feature `timing`, exclusively */
    bool wants_gpu;   /* needs a host with the feature `gpu` */
};

struct neph_slurm_batch {
    const char *name;     /* name of all jobs: letters, digits and dashes */
    const char *manifest; /* file; visible to all hosts at this path */
    const char *logs;     /* folder for the output of Slurm and its jobs; visible to all hosts */
    const struct neph_slurm_task *tasks;
    int task_count;
    struct neph_slurm_task last; /* runs when all tasks have ended, successful or not */
};

/* Submits a batch; an error in the middle cancels the part already submitted. NEPH_ERR_UNAVAILABLE:
 * there is no sbatch. NEPH_ERR_USAGE: a task needs a feature that `settings` do not name, or its
 * line has a line break. NEPH_ERR_ENGINE: Slurm refused; the message is Slurm's. */
enum neph_status neph_slurm_submit(const struct neph_slurm_settings *settings,
                                   const struct neph_slurm_batch *batch, struct neph_diag *diag);

/* Counts the waiting and running tasks of a name. Fails when Slurm does not answer. */
enum neph_status neph_slurm_count(const char *name, const char *logs, int *count,
                                  struct neph_diag *diag);

/* Cancels all jobs of a name, if there are any. Acknowledges a Ctrl-C. */
enum neph_status neph_slurm_cancel(const char *name, const char *logs, struct neph_diag *diag);

/* Words (NULL-terminated) as one quoted command line for a shell, in the arena. */
const char *neph_slurm_line(struct neph_arena *arena, const char *const *words);

#endif
