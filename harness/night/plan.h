/* SPDX-License-Identifier: MIT
 *
 * What belongs to a night: steps, each a command line of neph that ends by itself and prints JSON;
 * and the order in which they are worth their time.
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

/* The first word of its steps and series. */
const char *neph_night_suite_name(enum neph_night_suite suite);

/* Whether a step has the text of an --only in its name. "stress NAME" is step "failure NAME". */
bool neph_night_is_named(const char *step, const char *text);

struct neph_night_step {
    enum neph_night_suite suite;
    const char *name;                   /* "catalog voxel_grid": the same every night */
    const char *scene;                  /* its name; NULL: the step has none of the catalogue */
    const char *words[NEPH_STEP_WORDS]; /* after "neph", NULL-terminated; without -o */
    double guess_s;                     /* what it costs, before a night has told */
    int guess_series;                   /* numbers that it gives, before a night has told */
};

struct neph_night_plan_params {
    const char *tier;        /* "quick" or "full" */
    const char *const *only; /* steps whose name contains one of these; only_count 0: all */
    int only_count;
    const char *const *engines; /* beside those of the plan, for the scenes of the catalogue */
    int engine_count;
    bool only_engines; /* only scenes of the catalogue, with these and the scene's reference */
    const char *const *settings; /* "ENGINE:KEY=VALUE", for the scenes of the catalogue */
    int setting_count;
    int seed;                /* of the catalogue, `neph validate --seed`; 0: 1 */
    int width_px, height_px; /* of the catalogue and of sweeps; 0: of the plan */
};

/* Texts are of the arena. `identity` tells plans apart that have other steps or sizes. */
struct neph_night_plan {
    struct neph_night_step *steps;
    int count;
    const char *identity;
};

/* Errors: NEPH_ERR_USAGE: no such tier, no step is left, or more than there is room for; else as of
 * the scenes' files. */
enum neph_status neph_night_plan_make(const struct neph_night_plan_params *params,
                                      struct neph_arena *arena, struct neph_night_plan *plan,
                                      struct neph_diag *diag);

/* The step of a name; NULL: there is none. */
const struct neph_night_step *neph_night_plan_find(const struct neph_night_plan *plan,
                                                   const char *name);

/* The name of a step as that of a file. */
enum { NEPH_STEP_LOG_SIZE = 128 };
void neph_night_step_log(const struct neph_night_step *step, char name[NEPH_STEP_LOG_SIZE]);

/* What history knows of a step. */
struct neph_step_history {
    double cost_s; /* what it will cost; NaN: nobody knows */
    int series;    /* numbers that it gave last; 0: nobody knows */
    int nights;    /* since it was last done; a large number when it never was */
};

/* The step to do next: the most numbers per second, times the nights that they were not looked at;
 * of those that fit into `left_s`, unless `first`: a night does at least one. `done` are not asked
 * again. -1: none is left that fits. */
int neph_night_plan_next(const struct neph_night_plan *plan,
                         const struct neph_step_history *history, const bool *done, double left_s,
                         bool first);

/* The guess or what history says. */
double neph_night_step_cost(const struct neph_night_step *step,
                            const struct neph_step_history *history);

#endif
