/* SPDX-License-Identifier: MIT
 *
 * One point of a sweep, measured: its error against the truth and, of engines with a history, what
 * a sequence of it flickers and lags by. And the times of all points, in rounds: each round times
 * every point once, a few pictures of it, so that what the machine does in between hits all alike.
 */
#ifndef NEPH_HARNESS_SWEEP_POINT_H
#define NEPH_HARNESS_SWEEP_POINT_H

#include "harness/progress.h"
#include "harness/run/times.h"
#include "harness/study/reference.h"
#include "harness/sweep/truth.h"

/* What points share. References are of the last point's model: points that follow each other with
 * the same steps and light share them. */
struct neph_sweep_bench {
    const struct neph_sweep_plan *plan;
    const struct neph_sweep_truth *truth;
    struct neph_store *store;
    struct neph_progress *progress;
    struct neph_times *times; /* borrowed */
    bool retimes;             /* whatever was timed before is timed again */
    struct neph_scene *steps[NEPH_SCATTERING_MULTIPLE + 1]; /* with a step of the sun, by orders of
                                                               scattering, as they are asked for;
                                                               owned, for _bench_finish */
    struct neph_reference still, stepped;                   /* of the point at hand; owned */
    uint64_t seed;
    int frame_count, frame; /* as of struct neph_sweep */
    const char *mask;       /* that flicker was taken over, once it was */
};

void neph_sweep_bench_finish(struct neph_sweep_bench *bench);

/* Whether the point is a sequence of pictures, of which the last is what it is off by. */
bool neph_sweep_is_sequence(const struct neph_sweep_point *point);

/* The point's numbers, but for times. What cannot be rendered is said in point->missing. Errors:
 * NEPH_ERR_INTERRUPTED, and those of the store. */
enum neph_status neph_sweep_point_measure(struct neph_sweep_bench *bench,
                                          struct neph_sweep_point *point, struct neph_diag *diag);

/* The evaluations of density that a frame of a job has cost; NaN where nobody counts them. */
double neph_sweep_evaluations(const struct neph_job *job, const struct neph_image *frame);

/* Those for a pixel of the point's picture, as its file says. */
enum neph_status neph_sweep_point_count(const char *frame_path, struct neph_sweep_point *point,
                                        struct neph_diag *diag);

/* A whole picture of the point with a round's seed, as a job of the store: its error into `error`,
 * what it costs, or has cost when it was rendered, into `cost`. */
enum neph_status neph_sweep_point_render(const struct neph_sweep_bench *bench,
                                         struct neph_sweep_point *point, int round,
                                         struct neph_sweep_value *error, struct neph_cost *cost,
                                         struct neph_diag *diag);

/* --- times, in rounds ------------------------------------------------------------------------ */

/* Pictures of a point in flight in a round: as many as fit, within bounds. */
#define NEPH_SWEEP_ROUND_S 0.3
/* A whole picture that takes longer is timed in one round alone; one that takes longer with its
 * program's start, which is no time of a picture, in two. */
#define NEPH_SWEEP_LONG_S 5.0
#define NEPH_SWEEP_LONG_START_S 10.0
enum { NEPH_SWEEP_ROUND_LEAST = 4, NEPH_SWEEP_ROUND_MOST = 100 };

/* How many processes wanted the machine in the last minute; NaN: not known. */
double neph_sweep_load(void);

/* Time the points that are not missing, and that bench->times has not got, into which they go. Of
 * engines without flight a round is a picture with a seed of its own, whose error counts too. What
 * a round costs the first time, kernels and histories, is left out. Errors as of
 * neph_sweep_point_measure(). */
enum neph_status neph_sweep_time(struct neph_sweep_bench *bench, struct neph_sweep_point *points,
                                 int count, struct neph_diag *diag);

#endif
