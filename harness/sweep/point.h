/* SPDX-License-Identifier: MIT
 *
 * Measures one point of a sweep: its error against the ground truth and, for sequences, flicker and
 * lag. Also measures the times of all points in rounds. A round times a few frames of every point,
 * so that other load on the machine affects all points alike.
 */
#ifndef NEPH_HARNESS_SWEEP_POINT_H
#define NEPH_HARNESS_SWEEP_POINT_H

#include "harness/progress.h"
#include "harness/run/times.h"
#include "harness/study/reference.h"
#include "harness/sweep/truth.h"

/* State that all points share. The references belong to the latest point; consecutive points with
 * the same steps and lighting share them. */
struct neph_sweep_context {
    const struct neph_sweep_plan *plan;
    const struct neph_sweep_truth *truth;
    struct neph_store *store;
    struct neph_progress *progress;
    struct neph_times *times;                               /* borrowed */
    bool remeasures_times;                                  /* time again what was timed before */
    bool with_floors;                                       /* as in struct neph_sweep_params */
    struct neph_scene *steps[NEPH_SCATTERING_MULTIPLE + 1]; /* the scene with a step of the sun, by
                                                               scattering; made on demand; owned */
    struct neph_reference still, stepped;                   /* references of the current point;
                                                               owned */
    uint64_t seed;
    int frame_count, frame; /* as in struct neph_sweep */
    const char *mask;       /* mask of the flicker, once one was measured */
};

void neph_sweep_context_finish(struct neph_sweep_context *bench);

/* Whether the point is rendered as a sequence; its error is the last frame's. */
bool neph_sweep_is_sequence(const struct neph_sweep_point *point);

/* Measures a point, except for times. point->missing is the reason when it cannot be rendered.
 * Errors: NEPH_ERR_INTERRUPTED, and errors of the store. */
enum neph_status neph_sweep_point_measure(struct neph_sweep_context *bench,
                                          struct neph_sweep_point *point, struct neph_diag *diag);

/* The density evaluations of a job's frame; NaN: not counted. */
double neph_sweep_evaluations(const struct neph_job *job, const struct neph_image *frame);

/* Sets the point's evaluations per pixel and its frame_key from a frame's file. */
enum neph_status neph_sweep_point_count(const char *frame_path, struct neph_sweep_point *point,
                                        struct neph_diag *diag);

/* Renders a single frame of the point with the seed of a round, through the store: `*error` is its
 * error, `*cost` its cost at the time it was rendered. */
enum neph_status neph_sweep_point_render(const struct neph_sweep_context *bench,
                                         struct neph_sweep_point *point, int round,
                                         struct neph_sweep_value *error, struct neph_cost *cost,
                                         struct neph_diag *diag);

/* --- times, in rounds ------------------------------------------------------------------------ */

/* Seconds for the frames in flight of a point in a round, within the limits below. */
#define NEPH_SWEEP_ROUND_S 0.3
/* A frame that takes longer is timed in one round only; one that takes longer including its
 * program's start in two. */
#define NEPH_SWEEP_LONG_S 5.0
#define NEPH_SWEEP_LONG_START_S 10.0
enum { NEPH_SWEEP_ROUND_LEAST = 4, NEPH_SWEEP_ROUND_MOST = 100 };

/* Processes that waited for the machine in the last minute (load average); NaN: not known. */
double neph_sweep_load(void);

/* Times the points that can be rendered and are not in bench->times, and adds them there. For
 * engines without frames in flight a round is a single frame with its own seed, whose error counts
 * as well. The first use of kernels and histories is not timed. Errors as of
 * neph_sweep_point_measure(). */
enum neph_status neph_sweep_time(struct neph_sweep_context *bench, struct neph_sweep_point *points,
                                 int count, struct neph_diag *diag);

#endif
