/* SPDX-License-Identifier: MIT
 *
 * The cheapest configuration of a scene that is good enough, and what was left out of it: closed
 * forms first, then the ladder of pipelines, lights and steps from the cheapest up. All of it is
 * looked at in small pictures, what passes there with room to spare in larger ones, and the choice
 * is confirmed at full size (successive halving: K. Jamieson, A. Talwalkar, AISTATS 2016).
 */
#ifndef NEPH_HARNESS_SWEEP_PICK_H
#define NEPH_HARNESS_SWEEP_PICK_H

#include "harness/run/configuration.h"
#include "harness/run/store.h"
#include "harness/run/times.h"
#include "harness/sweep/ladder_filter.h"
#include "harness/sweep/results.h"

struct neph_pick_params {
    const char *scene;     /* a name of the catalogue, or a path */
    double error, flicker; /* the most they may be: rel_rmse against the truth, contrast seen over
                              threshold; NaN: any */
    double time_s;         /* of a picture at full size; NaN: not asked, and not timed */
    int width_px, height_px;
    int seed, jobs;                    /* jobs: as neph_sweep_params.jobs */
    double time_limit_s;               /* per child process */
    struct neph_shared_device *device; /* as neph_shot.device */
    bool quiet;
    struct neph_times *times; /* borrowed */
    struct neph_ladder_filter filter;
};

/* One that was looked at. */
struct neph_pick_point {
    char name[64]; /* "ours, octaves, steps=16" */
    struct neph_configuration configuration;
    double error, flicker;   /* NaN: not measured */
    double evaluations;      /* of density, for a pixel and picture; NaN: not counted */
    struct neph_spread time; /* NaN: not timed */
    bool is_closed;          /* no ray is marched */
};

enum { NEPH_PICK_LEFT_OUT_MAX = 14 };

/* Something that the choice does without, or that it has and could do without. */
struct neph_pick_left_out {
    char what[96];
    const char *because;         /* "nothing moves"; NULL: the numbers say so */
    bool is_kept;                /* the choice has it */
    struct neph_pick_point with; /* the choice with it; of what is kept, without it */
};

struct neph_pick {
    bool found;                    /* something is good enough */
    struct neph_pick_point chosen; /* at full size; where nothing is, what comes nearest */
    struct neph_pick_left_out left_out[NEPH_PICK_LEFT_OUT_MAX]; /* and what is kept */
    int left_out_count;
    int looked_at; /* configurations, and pictures or sequences of them at all sizes */
    int measured;
    const char *truth; /* its engine */
    double floor;      /* its noise at full size */
    bool is_still;     /* nothing moves in the scene */
    char device[128];
};

/* Errors as of neph_sweep_run() and of neph_ladder_filter_check(), before anything is rendered.
 * Where nothing is good enough that is no error here. */
enum neph_status neph_pick_run(const struct neph_pick_params *params, struct neph_store *store,
                               struct neph_pick *pick, struct neph_diag *diag);

#endif
