/* SPDX-License-Identifier: MIT
 *
 * Measured times in one file, by the store keys of their jobs. Decisions based on times are then
 * repeatable, and each job is timed once.
 */
#ifndef NEPH_HARNESS_RUN_TIMES_H
#define NEPH_HARNESS_RUN_TIMES_H

#include "harness/json.h"
#include "harness/run/flight.h"

/* Initialise with {NULL}. */
struct neph_times {
    char *path;   /* owned */
    json_t *list; /* {"format": ..., "times": {KEY: {"median", "low", "high", "pictures",
                     "start_s", "device", "load"}}}; owned */
};

/* Reads `path`, or starts empty when the file does not exist. NEPH_ERR_INPUT: the file has another
 * format. */
enum neph_status neph_times_open(const char *path, struct neph_times *times,
                                 struct neph_diag *diag);
/* Like neph_times_open(), for FOLDER/times.json. */
enum neph_status neph_times_open_in(const char *folder, struct neph_times *times,
                                    struct neph_diag *diag);
void neph_times_close(struct neph_times *times);

/* False: no time of this job on this device and driver. `*start_s` is the start-up before the first
 * of the frames, NaN when it was not measured; `start_s` may be NULL. */
bool neph_times_find(const struct neph_times *times, const struct neph_job *job,
                     struct neph_spread *time, int *pictures, double *start_s);

/* Stores a time, or replaces it; neph_times_save() writes the file. Errors: NEPH_ERR_MEMORY. */
enum neph_status neph_times_put(struct neph_times *times, const struct neph_job *job,
                                struct neph_spread time, int pictures, double start_s, double load,
                                struct neph_diag *diag);
enum neph_status neph_times_save(const struct neph_times *times, struct neph_diag *diag);

#endif
