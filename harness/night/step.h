/* SPDX-License-Identifier: MIT
 *
 * One step of a nightly run: its command, run as a child process, and the numbers that it measured.
 */
#ifndef NEPH_HARNESS_NIGHT_STEP_H
#define NEPH_HARNESS_NIGHT_STEP_H

#include "harness/night/plan.h"
#include "harness/night/readers.h"
#include "harness/run/history.h"

enum { NEPH_STEP_VARIABLES = 1024 };

/* The outcome of a step that measured its numbers. */
extern const char neph_step_done[];

/* The environment in which steps run. Its texts, and the texts of results, are allocated in the
 * arena. */
struct neph_step_place {
    struct neph_arena *arena;
    const char *program_path;                   /* path of the neph program */
    const char *host;                           /* the class of this machine */
    const char *variables[NEPH_STEP_VARIABLES]; /* of the environment, NULL-terminated */
};

/* Fill `variables` with the environment of this process. Without `has_database` a step opens no
 * database of its store (run/index.h). NEPH_ERR_USAGE: there are too many variables. */
enum neph_status neph_step_place_settle(struct neph_step_place *place, bool has_database,
                                        struct neph_diag *diag);

/* The path "FOLDER/<the step's name as a file name><ending>". */
const char *neph_step_file(struct neph_arena *arena, const char *folder,
                           const struct neph_night_step *step, const char *ending);

/* True when a failure of a step must end the whole run (interrupted, out of memory); then `diag`
 * gets a copy of `why`. */
bool neph_step_ends_night(enum neph_status status, const struct neph_diag *why,
                          struct neph_diag *diag);

/* Run a step in the folder `output` and read its results. Result files of an earlier run are
 * removed first. Durations are left out. */
enum neph_status neph_step_measure(const struct neph_step_place *place,
                                   const struct neph_night_step *step, const char *output,
                                   const char *log, double limit_s,
                                   struct neph_night_numbers *numbers, struct neph_diag *diag);

/* Run a step and read its results. A step that measures durations is preceded and followed by a
 * calibration. Returns an error only when the whole run must end (NEPH_ERR_INTERRUPTED,
 * NEPH_ERR_MEMORY); otherwise `record` has the outcome. */
enum neph_status neph_step_run(const struct neph_step_place *place,
                               const struct neph_night_step *step, const char *output,
                               const char *log, double limit_s, struct neph_history_step *record,
                               struct neph_night_numbers *numbers, struct neph_diag *diag);

#endif
