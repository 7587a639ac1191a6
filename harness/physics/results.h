/* SPDX-License-Identifier: MIT
 *
 * What a run of the physics suite found: the checks, what each participant made of them, and the
 * verdicts. Filled while it runs; whoever prints it or writes it as JSON only reads.
 */
#ifndef NEPH_HARNESS_PHYSICS_RESULTS_H
#define NEPH_HARNESS_PHYSICS_RESULTS_H

#include "base/arena.h"
#include "harness/engines/bakes.h"
#include "harness/physics/participants.h"
#include "harness/physics/phases.h"
#include "harness/run/job.h"
#include "harness/study/study.h"

#include <stdio.h>

/* The probability that a run in which every engine is right still calls one of them off. */
#define NEPH_PHYSICS_FAMILY_ALPHA 0.01

/* Which way a check looks, and what is true there. Texts are of the arena, here as below. */
struct neph_physics_view {
    char what[160];
    int width_px, height_px;
    double exposure_ev, difference_scale; /* of all pictures of this view */
    const double *truth_w_per_m2_sr;      /* pixel by pixel; of the arena */
    const char *picture;                  /* inside the report; NULL: none (yet) */
};

struct neph_physics_check {
    const char *name, *rung, *what;
    int view_count;
    struct neph_physics_view views[NEPH_CHECK_VIEWS_MAX];
};

enum neph_physics_verdict {
    NEPH_PHYSICS_NOT_MEASURED,
    NEPH_PHYSICS_AGREES,
    NEPH_PHYSICS_OFF,
    NEPH_PHYSICS_VERDICT_COUNT,
};

/* One participant in one check. Numbers are NaN where there are none. */
struct neph_physics_row {
    const struct neph_physics_check *check;
    const struct neph_participant *participant;
    const struct neph_engine *engine;
    enum neph_outcome outcome;
    const char *reason, *settings;
    bool lowered;          /* it was given single scattering from the sun alone */
    double deviation;      /* of the check's sum over pixels, relative to the truth */
    double standard_error; /* of stochastic engines */
    double step_bound;     /* of deterministic ones */
    double z;              /* deviation / standard_error */
    double pixel_z_mean, pixel_z_variance;
    const char *cause; /* why it is known to be off, in words that follow "because"; or NULL */
    double wall_s;
    const char *paths[NEPH_CHECK_VIEWS_MAX];    /* of its frames in the store; NULL: not rendered */
    const char *pictures[NEPH_CHECK_VIEWS_MAX]; /* inside the report; NULL: none (yet) */
    const char *differences[NEPH_CHECK_VIEWS_MAX];
    const struct neph_bakes_summary *bakes; /* of the grids that it saw; NULL: none */
    const struct neph_study *study;         /* that chose its step; NULL: none */
    enum neph_physics_verdict verdict;
    const char *sentence;
    double low, high; /* interval of the deviation at the family's level */
};

/* Start from {0}; free with neph_physics_finish(). */
struct neph_physics {
    struct neph_arena arena;
    int expected;      /* rows that there ought to be */
    int tests;         /* of them, measured */
    double critical_z; /* what the family's level leaves for each, in standard errors */
    bool passes;       /* nobody who claims to be the truth is off, and nothing broke */
    double seconds;
    struct neph_phase_finding phases[NEPH_PHASES_MAX];
    int phase_count, check_count, row_count;
    struct neph_physics_check *checks;
    struct neph_physics_row *rows;
};

void neph_physics_finish(struct neph_physics *physics);

/* The "physics" of scripts/report/README.md; NULL when memory is short. */
json_t *neph_physics_json(const struct neph_physics *physics);

/* A table and sentences for a terminal. */
void neph_physics_print(const struct neph_physics *physics, FILE *out);

#endif
