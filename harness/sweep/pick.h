/* SPDX-License-Identifier: MIT
 *
 * Finds the cheapest configuration for a scene that is good enough, and measures its variants.
 *
 * Closed forms are tried first, then pipelines, lighting models and steps, cheapest first. All
 * candidates are measured in small frames. Those that pass with a margin are measured in larger
 * frames, and the choice is confirmed at full size (successive halving: K. Jamieson, A. Talwalkar,
 * AISTATS 2016).
 */
#ifndef NEPH_HARNESS_SWEEP_PICK_H
#define NEPH_HARNESS_SWEEP_PICK_H

#include "harness/run/configuration.h"
#include "harness/run/store.h"
#include "harness/run/times.h"
#include "harness/sweep/candidate_filter.h"
#include "harness/sweep/results.h"

struct neph_pick_params {
    const char *scene;     /* a name of the catalogue, or a path */
    double error, flicker; /* limits: relative RMSE against the ground truth, visible contrast over
                              threshold; NaN: no limit */
    double time_s;         /* limit of a frame at full size; NaN: no limit, frames are not timed */
    int width_px, height_px;
    int seed, jobs;                    /* jobs: like neph_sweep_params.jobs */
    double time_limit_s;               /* per child process */
    struct neph_shared_device *device; /* like neph_shot.device */
    bool quiet;
    struct neph_times *times; /* borrowed */
    struct neph_candidate_filter filter;
};

/* A measured candidate. */
struct neph_pick_point {
    char name[64]; /* "ours, octaves, steps=16" */
    struct neph_configuration configuration;
    double error, flicker;             /* NaN: not measured */
    double error_floor, flicker_floor; /* of the choice in a scene that moves; NaN: none */
    double evaluations;      /* density evaluations per pixel and frame; NaN: not counted */
    struct neph_spread time; /* NaN: not timed */
    bool is_closed;          /* a closed form, without a marched ray */
};

enum { NEPH_PICK_VARIANTS_MAX = 14 };

/* A variant of the choice: with a part that the choice does not have, or without one of its parts.
 */
struct neph_pick_variant {
    char what[96];
    const char *because;         /* reason such as "nothing moves"; NULL: decided by the
                                    measurements */
    bool is_kept;                /* the choice has the part */
    struct neph_pick_point with; /* the measured variant */
};

struct neph_pick {
    bool found;                    /* a candidate is within the limits */
    struct neph_pick_point chosen; /* at full size; without a candidate within the limits, the
                                      nearest one */
    struct neph_pick_variant left_out[NEPH_PICK_VARIANTS_MAX]; /* parts that the choice does not
                                                                   have, and parts that it keeps */
    int left_out_count;
    int candidate_total;
    int measured;      /* frames or sequences of candidates, at all sizes */
    const char *truth; /* name of its engine */
    double floor;      /* its noise at full size */
    bool is_still;     /* the scene is static */
    char device[128];
};

/* Errors as of neph_sweep_run() and, before any rendering, of neph_candidate_filter_check() and
 * neph_engine_check_size(). It is no error when no candidate is within the limits. */
enum neph_status neph_pick_run(const struct neph_pick_params *params, struct neph_store *store,
                               struct neph_pick *pick, struct neph_diag *diag);

#endif
