/* SPDX-License-Identifier: MIT
 *
 * The plan of a nightly run: steps, each a neph command line that ends by itself and prints JSON;
 * and the order in which the steps run when time is limited.
 */
#ifndef NEPH_HARNESS_NIGHT_PLAN_H
#define NEPH_HARNESS_NIGHT_PLAN_H

#include "base/arena.h"
#include "base/status.h"

#include <stdbool.h>

enum { NEPH_STEP_WORDS = 48 };

enum neph_night_suite {
    NEPH_NIGHT_CATALOG,
    NEPH_NIGHT_PHYSICS,
    NEPH_NIGHT_STRESS,
    NEPH_NIGHT_SWEEP,
    NEPH_NIGHT_SPEED,
    NEPH_NIGHT_SUITES,
};

/* The first word in the names of the suite's steps and series. */
const char *neph_night_suite_name(enum neph_night_suite suite);

/* True when a step's name contains the text of an --only option. "stress NAME" selects the step
 * "failure NAME". */
bool neph_night_is_named(const char *step, const char *text);

struct neph_night_step {
    enum neph_night_suite suite;
    const char *name;                   /* "catalog voxel_grid": the same in every run */
    const char *scene;                  /* scene of the catalogue; NULL: none */
    const char *words[NEPH_STEP_WORDS]; /* arguments of neph, NULL-terminated; without -o */
    double guess_s;                     /* estimated duration, until a run has measured it */
    int guess_series;                   /* estimated number of series, likewise */
};

struct neph_night_plan_params {
    const char *tier;        /* "quick" or "full" */
    const char *const *only; /* texts, one of which a step's name must contain; only_count 0: all */
    int only_count;
    const char *const *engines; /* additional engines for the scenes of the catalogue */
    int engine_count;
    bool only_engines;           /* only catalogue scenes, with these engines and the reference */
    const char *const *settings; /* "ENGINE:KEY=VALUE", for the scenes of the catalogue */
    int setting_count;
    int seed;                /* for the catalogue, `neph validate --seed`; 0: 1 */
    int width_px, height_px; /* for the catalogue and the sweeps; 0: the plan's sizes */
};

/* Texts are allocated in the arena. `identity` differs between plans with different steps or
 * sizes. */
struct neph_night_plan {
    struct neph_night_step *steps;
    int count;
    const char *identity;
};

/* Make the plan of a tier. NEPH_ERR_USAGE: the tier is unknown, no step is selected, or there are
 * too many steps or words. Other errors: as for loading scene files. */
enum neph_status neph_night_plan_make(const struct neph_night_plan_params *params,
                                      struct neph_arena *arena, struct neph_night_plan *plan,
                                      struct neph_diag *diag);

/* The step with this name; NULL: there is none. */
const struct neph_night_step *neph_night_plan_find(const struct neph_night_plan *plan,
                                                   const char *name);

/* The step's name as a file name: all characters but letters and digits become '_'. */
enum { NEPH_STEP_LOG_SIZE = 128 };
void neph_night_step_log(const struct neph_night_step *step, char name[NEPH_STEP_LOG_SIZE]);

/* Earlier measurements of a step. */
struct neph_step_history {
    double cost_s; /* expected duration; NaN: unknown */
    int series;    /* number of series in its last run; 0: unknown */
    int nights;    /* number of runs since it was last done; large: never done */
};

/* The index of the next step: of the unfinished steps (`done` false) with a cost of at most
 * `left_s`, the one with the largest number of series per second times the number of runs since it
 * was last done. `first` ignores the cost, so that every run executes at least one step. -1: no
 * step fits. */
int neph_night_plan_next(const struct neph_night_plan *plan,
                         const struct neph_step_history *history, const bool *done, double left_s,
                         bool first);

/* The expected duration of a step: from its history, else the estimate. */
double neph_night_step_cost(const struct neph_night_step *step,
                            const struct neph_step_history *history);

#endif
