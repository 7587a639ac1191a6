/* SPDX-License-Identifier: MIT
 *
 * Times that were measured, kept under the key of their job in one file: what is decided by times
 * is then decided alike the next time, and nothing is timed twice.
 */
#ifndef NEPH_HARNESS_RUN_TIMES_H
#define NEPH_HARNESS_RUN_TIMES_H

#include "harness/json.h"
#include "harness/run/flight.h"

/* Start from {NULL}. */
struct neph_times {
    char *path;   /* owned */
    json_t *list; /* {"format": ..., "times": {KEY: {"median", "low", "high", "pictures",
                     "start_s", "device", "load"}}}; owned */
};

/* Read `path`, which need not be there. NEPH_ERR_INPUT: it is something else. */
enum neph_status neph_times_open(const char *path, struct neph_times *times,
                                 struct neph_diag *diag);
/* Open FOLDER/times.json as neph_times_open() does. */
enum neph_status neph_times_open_in(const char *folder, struct neph_times *times,
                                    struct neph_diag *diag);
void neph_times_close(struct neph_times *times);

/* False: there is none of this job on this device and driver. `*start_s`, of the start-up before
 * the first of these pictures, may be NaN: it was not measured. NULL is fine. */
bool neph_times_find(const struct neph_times *times, const struct neph_job *job,
                     struct neph_spread *time, int *pictures, double *start_s);

/* In place of an older one; written by neph_times_save(). Errors: NEPH_ERR_MEMORY. */
enum neph_status neph_times_put(struct neph_times *times, const struct neph_job *job,
                                struct neph_spread time, int pictures, double start_s, double load,
                                struct neph_diag *diag);
enum neph_status neph_times_save(const struct neph_times *times, struct neph_diag *diag);

#endif
