/* SPDX-License-Identifier: MIT
 *
 * The times of a sweep's points, in rounds: each round times every point once, a few pictures of
 * it, so that what the machine does in between hits all points alike.
 */
#ifndef NEPH_HARNESS_SWEEP_TIMING_H
#define NEPH_HARNESS_SWEEP_TIMING_H

#include "harness/sweep/point.h"

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
