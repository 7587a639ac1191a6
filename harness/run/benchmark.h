/* SPDX-License-Identifier: MIT
 *
 * How long engines take for the same noise. A Monte Carlo renderer's squared noise falls as
 * cost / time; the ratio of two engines' costs is the ratio of their times to equal noise, whatever
 * that noise is. The engines render a ladder of sample counts, turn and turn about in one run on
 * the same cores, each rung with two seeds:
 *
 *   noise^2 = mean (a - b)^2 / 2           of the two seeds a, b
 *   error^2 = mean (a - r) (a - s)         of two independent references r, s of the tracer, whose
 *                                          own noise so falls out
 *
 *   bias^2  = mean (a - r) (b - s)         none of whose noise meets itself
 *
 * all over pixels and channels and in parts of the reference's mean square. Bias is what error^2
 * has more than noise^2; time does not remove it. Seeds and references have scrambles of their own,
 * so this holds for low-discrepancy samplers, too, whose noise need not fall as 1 / time: the time
 * to a stated error is found on the ladder itself (harness/run/rmse_time.h).
 */
#ifndef NEPH_HARNESS_RUN_BENCHMARK_H
#define NEPH_HARNESS_RUN_BENCHMARK_H

#include "harness/run/job.h"
#include "harness/run/noisy_frame.h"
#include "harness/run/rmse_time.h"

/* How many samples the rungs of a ladder take: so many that the last one takes a stated time, each
 * half the one above it, or so many that the last one is a little better than a stated error, and
 * the first a little worse than three times that. */
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

/* What renders take before their first sample: kernels compiled, grids read. Of renders of `count`
 * numbers of samples, ascending, their mean times and the least of each; no render is shorter than
 * its start and the share of its samples. */
double neph_rungs_start(const int *samples, const double *mean_s, const double *least_s, int count);

enum {
    NEPH_BENCHMARK_RUNGS = NEPH_RUNGS,
    NEPH_BENCHMARK_ENGINES_MAX = 4,
    NEPH_BENCHMARK_RMSES = 2
};

/* A number with its 95 % interval. */
struct neph_benchmark_value {
    double value, low, high;
};

struct neph_benchmark_engine {
    struct neph_job job; /* its engine, settings and shot */
    const char *preset;  /* the caller's: what its settings began as (neph_settings_origin) */
    double start_s;      /* of a render whose samples take no time; starting Blender is not in it */
    struct neph_rmse_rung rungs[NEPH_BENCHMARK_RUNGS]; /* render_s: of one seed, the start left out;
                                                          mean of the two */
    struct neph_benchmark_value cost_s; /* noise2 * render_s: the time to a relative noise of 1 */
    struct neph_benchmark_value times;  /* cost over that of the first engine */
    struct neph_benchmark_value bias;   /* of the mean radiance, relative; of all rungs and seeds */
    struct neph_rmse_law law;
    struct neph_rmse_time rmse_times[NEPH_BENCHMARK_RMSES]; /* of the rmses */
};

struct neph_benchmark {
    struct neph_rungs_aim aim;          /* of each engine's ladder; the caller's */
    double rmses[NEPH_BENCHMARK_RMSES]; /* to which times are given, relative, the largest first */
    int engine_count;
    struct neph_benchmark_engine engines[NEPH_BENCHMARK_ENGINES_MAX];
    struct neph_job reference;
    int reference_samples;  /* of each of the two */
    double reference_noise; /* relative, of their mean */
};

/* False, with the reason in words, for engines without noise or without a number of samples. */
bool neph_benchmark_applies(const struct neph_engine *engine, char *reason, size_t reason_size);

/* Fill in the measurements. `benchmark` comes with its aim, `engine_count` jobs and the reference's
 * job (of the tracer), all of one scene and size, with a scratch folder that is theirs. */
enum neph_status neph_benchmark_run(struct neph_benchmark *benchmark, bool quiet,
                                    struct neph_diag *diag);

/* Samples of all pixels that a rung makes in a second. */
double neph_benchmark_paths_per_s(const struct neph_benchmark_engine *engine, int rung);

/* For the caller to free. */
json_t *neph_benchmark_json(const struct neph_benchmark *benchmark);

#endif
