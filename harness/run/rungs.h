/* SPDX-License-Identifier: MIT
 *
 * How many samples the rungs of a benchmark's ladder take: so many that the last one takes a stated
 * time, each half the one above it, or so many that the last one is a little better than a stated
 * error, and the first a little worse than three times that.
 */
#ifndef NEPH_HARNESS_RUN_RUNGS_H
#define NEPH_HARNESS_RUN_RUNGS_H

#include "harness/run/noisy_frame.h"

enum { NEPH_RUNGS = 4 };

/* One of the two; the other is 0. */
struct neph_rungs_aim {
    double rung_s; /* of the last rung */
    double error;  /* relative RMSE */
};

struct neph_rungs {
    struct neph_rungs_aim aim;
    int samples[NEPH_RUNGS]; /* by an error: those ahead are guesses */
    double start_s;          /* of a render whose samples take no time */
    double per_sample_s;
};

/* Renders with few samples, to know the job's start, its speed and, by an error, its noise. */
enum neph_status neph_rungs_plan(const struct neph_job *job, struct neph_rungs_aim aim,
                                 struct neph_rungs *rungs, struct neph_diag *diag);

/* By an error: a rung had this squared noise, relative, so the rungs above it take as many samples
 * as it asks for. */
void neph_rungs_learn(const struct neph_job *job, int rung, double noise2,
                      struct neph_rungs *rungs);

#endif
