/* SPDX-License-Identifier: MIT
 *
 * Benchmark of engines with noise: the render time that each engine needs for the same noise.
 *
 * The squared noise of a Monte Carlo renderer falls as cost / time. The ratio of two engines' costs
 * is therefore the ratio of their render times at equal noise, at any noise level. All engines
 * render NEPH_SAMPLE_LEVELS sample counts in one run on the same cores, in turns, each count with
 * two seeds a and b. With r and s, two independent reference frames of the tracer:
 *
 *   noise^2 = mean (a - b)^2 / 2
 *   error^2 = mean (a - r) (a - s)     free of the references' noise, as r and s are independent
 *   bias^2  = mean (a - r) (b - s)     free of all noise, as all four frames are independent
 *
 * The means are over pixels and channels, relative to the reference's mean square. error^2 -
 * noise^2 is the squared bias, which more time does not reduce. Each seed and each reference has
 * its own scramble, so the equations are valid for low-discrepancy samplers as well. The noise of
 * such a sampler can fall faster than 1 / time. The time to a given error is therefore read from
 * the measured sample counts (harness/run/rmse_time.h).
 */
#ifndef NEPH_HARNESS_RUN_BENCHMARK_H
#define NEPH_HARNESS_RUN_BENCHMARK_H

#include "harness/run/job.h"
#include "harness/run/noisy_frame.h"
#include "harness/run/rmse_time.h"

/* The sample counts of a benchmark, one for each level, ascending. Two ways to choose the counts:
 *
 * - by time: the last level takes a given time, and each level has half the samples of the next
 *   one;
 * - by error: the last level has a slightly smaller error than a given one, and the first level
 *   slightly more than three times the given error. */
enum { NEPH_SAMPLE_LEVELS = 4 };

/* One of the two values is set, the other is 0. */
struct neph_sample_levels_target {
    double rung_s; /* time of the last level */
    double error;  /* relative RMSE */
};

struct neph_sample_levels {
    struct neph_sample_levels_target aim;
    int samples[NEPH_SAMPLE_LEVELS]; /* by error: the levels ahead are estimates */
    double start_s;                  /* of a render, without the time of its samples */
    double per_sample_s;
};

/* Chooses the sample counts. Renders with few samples to measure the job's start time, its time per
 * sample and, by error, its noise. */
enum neph_status neph_sample_levels_plan(const struct neph_job *job,
                                         struct neph_sample_levels_target aim,
                                         struct neph_sample_levels *rungs, struct neph_diag *diag);

/* By error: corrects the sample counts of the levels after `rung` with the squared relative noise
 * that `rung` had. By time: does nothing. */
void neph_sample_levels_refine(const struct neph_job *job, int rung, double noise2,
                               struct neph_sample_levels *rungs);

/* The start time of a render: compiling kernels, reading grids. Computed from `count` ascending
 * sample counts with their mean and least render times: a render takes at least the start time plus
 * the time of its samples. */
double neph_sample_levels_start_time(const int *samples, const double *mean_s,
                                     const double *least_s, int count);

enum {
    NEPH_BENCHMARK_LEVELS = NEPH_SAMPLE_LEVELS,
    NEPH_BENCHMARK_ENGINES_MAX = 4,
    NEPH_BENCHMARK_RMSES = 2
};

/* A number with its 95 % interval. */
struct neph_benchmark_value {
    double value, low, high;
};

struct neph_benchmark_engine {
    struct neph_job job; /* its engine, settings and shot */
    const char *preset;  /* the settings' origin (neph_settings_origin), from the caller */
    double start_s;      /* start time of a render; the start of Blender is not included */
    struct neph_rmse_level rungs[NEPH_BENCHMARK_LEVELS]; /* render_s: mean of the two seeds, without
                                                          the start time */
    struct neph_benchmark_value cost_s; /* noise2 * render_s: the time to a relative noise of 1 */
    struct neph_benchmark_value times;  /* cost relative to the first engine's cost */
    struct neph_benchmark_value bias;   /* of the mean radiance, relative; over all levels and seeds
                                           */
    struct neph_rmse_law law;
    struct neph_rmse_time rmse_times[NEPH_BENCHMARK_RMSES]; /* times to `rmses` */
};

struct neph_benchmark {
    struct neph_sample_levels_target aim; /* of each engine's sample counts; from the caller */
    double rmses[NEPH_BENCHMARK_RMSES];   /* relative errors to which times are given, descending */
    int engine_count;
    struct neph_benchmark_engine engines[NEPH_BENCHMARK_ENGINES_MAX];
    struct neph_job reference;
    int reference_samples;  /* of each of the two references */
    double reference_noise; /* relative, of the mean of the two */
};

/* False, with the reason in words, for engines without noise or without a number of samples. */
bool neph_benchmark_applies(const struct neph_engine *engine, char *reason, size_t reason_size);

/* Fills in the measurements. `benchmark` comes with its aim, `engine_count` jobs and the
 * reference's job (of the tracer). All jobs have one scene and one size and share a scratch folder
 * that no other job uses. */
enum neph_status neph_benchmark_run(struct neph_benchmark *benchmark, bool quiet,
                                    struct neph_diag *diag);

/* Paths per second of a level: its samples of all pixels over its render time. */
double neph_benchmark_paths_per_s(const struct neph_benchmark_engine *engine, int rung);

/* The caller frees the result. */
json_t *neph_benchmark_json(const struct neph_benchmark *benchmark);

#endif
