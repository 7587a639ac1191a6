/* SPDX-License-Identifier: MIT
 *
 * What a sweep has measured. Two gaps are never mixed: the error against the truth, which has all
 * that is wrong with a model; and, of shortcuts, the error, flicker and lag against the march of
 * their own model (harness/study/reference.h).
 */
#ifndef NEPH_HARNESS_SWEEP_RESULTS_H
#define NEPH_HARNESS_SWEEP_RESULTS_H

#include "base/hash.h"
#include "harness/run/flight.h"
#include "harness/sweep/plan.h"

/* A number with its 95 % interval. NaN: not measured. */
struct neph_sweep_value {
    double value, low, high; /* the last two NaN without an interval */
};

/* What of a point is drawn against what. */
enum neph_sweep_number {
    NEPH_SWEEP_ERROR,     /* rel_rmse against the truth, mean of the rounds' seeds */
    NEPH_SWEEP_SHORTCUT,  /* rel_rmse against its own model, over all frames */
    NEPH_SWEEP_FLICKER,   /* seen_contrast */
    NEPH_SWEEP_FOUR,      /* a4_p95: what repeats every four frames [1 of white] */
    NEPH_SWEEP_HALF_LIFE, /* after a step of the sun, median [frame] */
    NEPH_SWEEP_NUMBERS,
};

/* Names in JSON, titles with units, and the metric behind each. */
struct neph_sweep_number_text {
    const char *name, *title, *metric;
};
extern const struct neph_sweep_number_text neph_sweep_number_texts[NEPH_SWEEP_NUMBERS];

struct neph_sweep_point {
    const struct neph_sweep_series *series; /* borrowed */
    int place;                              /* in the series */
    struct neph_job job;                    /* its engine, settings, size; the scene is borrowed */
    char label[NEPH_SWEEP_LABEL_SIZE];      /* "steps=32"; "" */
    char *settings;                         /* canonical; owned */
    char missing[512];                      /* why there is nothing of it; "" */
    struct neph_sweep_value numbers[NEPH_SWEEP_NUMBERS];
    bool at_floor;           /* the error is no more than twice that of the truth's own noise */
    struct neph_spread time; /* a picture [s]: on the device where that has a clock, else from one
                                to the next; of engines without flight one at a time, their start
                                left out; NaN: not measured */
    int timed;               /* pictures in it */
    double evaluations;      /* of density, for each pixel and picture; NaN: not counted */
    struct neph_sweep_value to_finest;  /* relative RMSE against the point of its series with the
                                          most steps (finest.h); NaN: not measured */
    bool on_front[NEPH_SWEEP_NUMBERS];  /* of time against each number */
    char frame_key[NEPH_HASH_HEX_SIZE]; /* in the store, of the picture that the error is of; "" */
};

struct neph_sweep {
    const struct neph_sweep_plan *plan; /* borrowed */
    struct neph_scene *scene;           /* owned */
    int frame_count; /* of sequences: those of the plan, or as many as a scene has that moves */
    int frame;       /* of the pictures that errors are of: the last of a sequence; 0 where nothing
                        moves */
    struct neph_scene *rescattered[NEPH_SCATTERING_MULTIPLE + 1]; /* with these orders, where a
                                                                     series has them; owned */
    struct neph_engine_info *infos;                               /* by neph_engines; owned */
    struct neph_sweep_point *points;                              /* owned */
    int point_count;
    const char *truth;    /* the name of its engine */
    double floor;         /* relative noise of the truth; 0: it has none */
    double truth_s;       /* of the truth's pictures and of references, when they were rendered */
    double measure_s;     /* of the rest of the run, on the wall */
    const char *mask;     /* of flicker: "depth_edge", or "all" where there are no edges */
    const char *clear_of; /* of errors against the truth: "non_edge" or "all" */
    const char *against;  /* the series that others are held against (equal.h); NULL: the first
                             that has two points; borrowed */
    double load;          /* other processes that wanted the machine while times were taken */
};

void neph_sweep_finish(struct neph_sweep *sweep);

#endif
