/* SPDX-License-Identifier: MIT
 *
 * One step of a night: its command run as a child, and what it has measured.
 */
#ifndef NEPH_HARNESS_NIGHT_STEP_H
#define NEPH_HARNESS_NIGHT_STEP_H

#include "harness/night/plan.h"
#include "harness/night/readers.h"
#include "harness/run/history.h"

enum { NEPH_STEP_VARIABLES = 1024 };

/* The outcome of a step that gave its numbers. */
extern const char neph_step_done[];

/* Where steps are run. Texts, and what is returned, are of the arena. */
struct neph_step_place {
    struct neph_arena *arena;
    const char *program_path;                   /* of neph */
    const char *host;                           /* the class of this machine */
    const char *variables[NEPH_STEP_VARIABLES]; /* of the environment, NULL-terminated */
};

/* Fill the variables: a step sees what the user gave to the night; without `has_database` it
 * opens no database of its store (run/index.h).
 * NEPH_ERR_USAGE: there are too many. */
enum neph_status neph_step_place_settle(struct neph_step_place *place, bool has_database,
                                        struct neph_diag *diag);

/* "LOGS/<the step's name, made fit for a file><ending>". */
const char *neph_step_file(struct neph_arena *arena, const char *folder,
                           const struct neph_night_step *step, const char *ending);

/* Whether a failure within a night ends the night; then `diag` is told `why`. */
bool neph_step_ends_night(enum neph_status status, const struct neph_diag *why,
                          struct neph_diag *diag);

/* Run a step in the folder `output` and read its results, which may not be those of an earlier
 * run. Durations are left out. */
enum neph_status neph_step_measure(const struct neph_step_place *place,
                                   const struct neph_night_step *step, const char *output,
                                   const char *log, double limit_s,
                                   struct neph_night_numbers *numbers, struct neph_diag *diag);

/* Measure a step, with a calibration before and after where something is timed. What ends the night
 * is an error (NEPH_ERR_INTERRUPTED, NEPH_ERR_MEMORY); else `record` has the outcome. */
enum neph_status neph_step_run(const struct neph_step_place *place,
                               const struct neph_night_step *step, const char *output,
                               const char *log, double limit_s, struct neph_history_step *record,
                               struct neph_night_numbers *numbers, struct neph_diag *diag);

#endif
