/* SPDX-License-Identifier: MIT
 *
 * The results of a run of the physics suite: checks, one row for each participant and check, and
 * verdicts. Filled while the run proceeds; the writers of text and JSON only read it.
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

/* The probability of at least one false deviation in a run in which every engine is correct. */
#define NEPH_PHYSICS_FAMILY_ALPHA 0.01

/* A view of a check, and its reference. Texts of this file's structs are allocated in the arena. */
struct neph_physics_view {
    char what[160];
    int width_px, height_px;
    double exposure_ev, difference_scale; /* of all images of this view */
    const double *truth_w_per_m2_sr;      /* pixel by pixel; allocated in the arena */
    const char *picture;                  /* path inside the report; NULL: none, or not yet */
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

/* One participant in one check. Missing numbers are NaN. */
struct neph_physics_row {
    const struct neph_physics_check *check;
    const struct neph_participant *participant;
    const struct neph_engine *engine;
    enum neph_outcome outcome;
    const char *reason, *settings;
    bool lowered;          /* rendered single scattering of the sun only */
    double deviation;      /* of the check's sum over pixels, relative to the reference */
    double standard_error; /* of a stochastic engine */
    double step_bound;     /* of a deterministic engine */
    double z;              /* deviation / standard_error */
    double doubt;          /* of the standard error (base/doubt.h) */
    double pixel_z_mean, pixel_z_variance;
    const char *cause; /* known cause of a deviation, text after "because"; or NULL */
    double wall_s;
    const char *paths[NEPH_CHECK_VIEWS_MAX];    /* its frames in the store; NULL: not rendered */
    const char *pictures[NEPH_CHECK_VIEWS_MAX]; /* paths inside the report; NULL: none, or not
                                                   yet */
    const char *differences[NEPH_CHECK_VIEWS_MAX];
    const struct neph_bakes_summary *bakes; /* of its voxel grids; NULL: none */
    const struct neph_study *study;         /* the step study that chose its step; NULL: none */
    enum neph_physics_verdict verdict;
    const char *sentence;
    double low, high; /* confidence interval of the deviation at the corrected level */
};

/* Start from {0}; free with neph_physics_finish(). */
struct neph_physics {
    struct neph_arena arena;
    int expected;      /* number of rows of a complete run */
    int tests;         /* rows with a deviation */
    double critical_z; /* corrected critical value of each test, in standard errors */
    bool passes;       /* no reference engine deviates, and no engine failed */
    double seconds;
    struct neph_phase_finding phases[NEPH_PHASES_MAX];
    int phase_count, check_count, row_count;
    struct neph_physics_check *checks;
    struct neph_physics_row *rows;
};

void neph_physics_finish(struct neph_physics *physics);

/* The "physics" of scripts/report/README.md; NULL when memory is short. */
json_t *neph_physics_json(const struct neph_physics *physics);

/* Print a table and sentences for a terminal. */
void neph_physics_print(const struct neph_physics *physics, FILE *out);

#endif
