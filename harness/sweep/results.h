/* SPDX-License-Identifier: MIT
 *
 * The results of a sweep. Two errors are kept apart: the error against the ground truth, which
 * includes the model error; and error, flicker and lag of real-time methods against the marcher
 * with the same model (harness/study/reference.h).
 */
#ifndef NEPH_HARNESS_SWEEP_RESULTS_H
#define NEPH_HARNESS_SWEEP_RESULTS_H

#include "base/hash.h"
#include "harness/run/flight.h"
#include "harness/sweep/plan.h"

/* A value with its 95 % interval. NaN: not measured. */
struct neph_sweep_value {
    double value, low, high; /* low and high are NaN without an interval */
};

/* Values of a point. */
enum neph_sweep_number {
    NEPH_SWEEP_ERROR,     /* relative RMSE against the ground truth, mean over the rounds' seeds */
    NEPH_SWEEP_SHORTCUT,  /* relative RMSE against its own model, over all frames */
    NEPH_SWEEP_FLICKER,   /* visible flicker (seen_contrast) */
    NEPH_SWEEP_FOUR,      /* four-frame flicker (a4_p95) [1 = white] */
    NEPH_SWEEP_HALF_LIFE, /* after a step of the sun, median [frames] */
    NEPH_SWEEP_NUMBERS,
};

/* JSON name, title with unit, and metric of each value. */
struct neph_sweep_number_text {
    const char *name, *title, *metric;
};
extern const struct neph_sweep_number_text neph_sweep_number_texts[NEPH_SWEEP_NUMBERS];

struct neph_sweep_point {
    const struct neph_sweep_series *series; /* borrowed */
    int place;                              /* index within the series */
    struct neph_job job;                    /* engine, settings, size; the scene is borrowed */
    char label[NEPH_SWEEP_LABEL_SIZE];      /* "steps=32"; "" */
    char *settings;                         /* canonical text; owned */
    char missing[512];                      /* reason why the point was not measured; "" */
    struct neph_sweep_value numbers[NEPH_SWEEP_NUMBERS];
    double floors[NEPH_SWEEP_NUMBERS]; /* of a preset in a scene that moves: the floor of each value
                                          (harness/study/floor_plan.h); NaN: none */
    bool at_floor;                     /* the error is at most twice the truth's own noise */
    struct neph_spread time; /* of a frame [s]: by the device's timestamps where it has them, else
                                from frame to frame; for engines without frames in flight of single
                                frames without the start; NaN: not measured */
    int timed;               /* number of timed frames */
    double evaluations;      /* density evaluations per pixel and frame; NaN: not counted */
    struct neph_sweep_value to_finest;  /* relative RMSE against the series' point with the most
                                           steps (finest.h); NaN: not measured */
    bool on_front[NEPH_SWEEP_NUMBERS];  /* Pareto front of cost and each value */
    char frame_key[NEPH_HASH_HEX_SIZE]; /* store key of the frame that the error is measured on; ""
                                           */
};

struct neph_sweep {
    const struct neph_sweep_plan *plan; /* borrowed */
    struct neph_scene *scene;           /* owned */
    int frame_count; /* of sequences: as in the plan, or fewer where the scene's motion ends earlier
                        */
    int frame;       /* of the frames with an error: the last of a sequence; 0 for a static scene */
    struct neph_scene *rescattered[NEPH_SCATTERING_MULTIPLE + 1]; /* the scene with other
                                                                     scattering, where a series
                                                                     needs it; owned */
    /* in the order of neph_engines_with_user_engines(); owned */
    struct neph_engine_info *infos;
    struct neph_sweep_point *points; /* owned */
    int point_count;
    const char *truth;    /* name of its engine */
    double floor;         /* relative noise of the truth; 0: none */
    double truth_s;       /* of the truth's frames and of references, at the time of their rendering
                             */
    double measure_s;     /* wall-clock time of all other parts */
    const char *mask;     /* of flicker: "depth_edge", or "all" in a scene without edges */
    const char *clear_of; /* of errors against the truth: "non_edge" or "all" */
    const char *against;  /* name of the base series of comparisons (equal.h); NULL: the first
                             series with two points; borrowed */
    double load;          /* load average while times were measured */
};

void neph_sweep_finish(struct neph_sweep *sweep);

#endif
