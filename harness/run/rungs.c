/* SPDX-License-Identifier: MIT
 *
 * The sample counts of a benchmark's levels (harness/run/benchmark.h).
 */
#include "harness/run/benchmark.h"

#include <math.h>

enum { FIRST_SAMPLES = 8, PROBE_SEED = 501 };

/* By error: time of the last level of the counts from which the noise is estimated. */
static const double probe_rung_s = 2.0;

/* Target errors of the levels, relative to the given error. The error itself and three times the
 * error each lie between two levels, with margin for the uncertainty of a noise measured with two
 * seeds. */
static const double error_parts[NEPH_SAMPLE_LEVELS] = {3.6, 2.2, 1.35, 0.85};

static double find_sample_limit(const struct neph_job *job)
{
    return job->engine->options[neph_engine_samples(job->engine)].maximum;
}

static enum neph_status measure_render_time(const struct neph_job *job, double samples,
                                            double *render_s, struct neph_diag *diag)
{
    struct neph_noisy_frame frame;
    const enum neph_status status = neph_noisy_render(job, (int)samples, 1, &frame, diag);
    *render_s = frame.render_s;
    neph_noisy_finish(&frame);
    return status;
}

/* Fits a line through two sample counts: the offset is the start time (compiling kernels, reading
 * grids), the slope the time per sample. The first render is not used, as it fills caches. */
static enum neph_status time_samples(const struct neph_job *job, double rung_s,
                                     struct neph_sample_levels *rungs, struct neph_diag *diag)
{
    double samples = FIRST_SAMPLES, first_s, last_s;
    enum neph_status status = measure_render_time(job, samples, &first_s, diag);
    if (!status)
        status = measure_render_time(job, samples, &first_s, diag);
    do {
        samples *= 4.0;
        if (!status)
            status = measure_render_time(job, samples, &last_s, diag);
        if (status)
            return status;
        rungs->per_sample_s = fmax(1e-9, (last_s - first_s) / (samples - FIRST_SAMPLES));
    } while (rungs->per_sample_s * samples < rung_s / 16.0 &&
             4.0 * samples <= find_sample_limit(job));
    rungs->start_s = fmax(0.0, first_s - FIRST_SAMPLES * rungs->per_sample_s);
    return NEPH_OK;
}

/* Counts that double up to `rung_s`. The smallest possible counts may take longer than `rung_s`. */
static void choose_counts_by_time(const struct neph_job *job, double rung_s,
                                  struct neph_sample_levels *rungs)
{
    const double last = fmin(find_sample_limit(job), rung_s / rungs->per_sample_s);
    for (int k = 0; k < NEPH_SAMPLE_LEVELS; k++) {
        const double rung = last / (1 << (NEPH_SAMPLE_LEVELS - 1 - k));
        const double least = FIRST_SAMPLES * (1 << k);
        rungs->samples[k] = (int)fmax(least, FIRST_SAMPLES * round(rung / FIRST_SAMPLES));
    }
}

/* Counts for the levels from `from` on. `samples` gave the squared noise `noise2`, which falls as 1
 * / samples. Each level has at least twice the samples of the one before. */
static void choose_counts_by_error(const struct neph_job *job, int from, double samples,
                                   double noise2, struct neph_sample_levels *rungs)
{
    for (int k = from; k < NEPH_SAMPLE_LEVELS; k++) {
        const double wanted = error_parts[k] * rungs->aim.error;
        const double most = find_sample_limit(job) / (1 << (NEPH_SAMPLE_LEVELS - 1 - k));
        const double needed = fmin(most, samples * noise2 / (wanted * wanted));
        const int least = k == 0 ? FIRST_SAMPLES : 2 * rungs->samples[k - 1];
        const int rounded = FIRST_SAMPLES * (int)round(needed / FIRST_SAMPLES);
        rungs->samples[k] = rounded > least ? rounded : least;
    }
}

static enum neph_status probe_noise(const struct neph_job *job, int samples, double *noise2,
                                    struct neph_diag *diag)
{
    struct neph_noisy_frame frames[NEPH_NOISE_SEEDS] = {{.image = NULL}};
    enum neph_status status = NEPH_OK;
    for (int s = 0; s < NEPH_NOISE_SEEDS && !status; s++)
        status = neph_noisy_render(job, samples, (uint64_t)(PROBE_SEED + s), &frames[s], diag);
    if (!status) {
        const double square = neph_noisy_cross(&frames[0], NULL, &frames[1], NULL);
        *noise2 = square > 0.0 ? neph_noisy_compute_noise2(frames) / square : 0.0;
    }
    for (int s = 0; s < NEPH_NOISE_SEEDS; s++)
        neph_noisy_finish(&frames[s]);
    return status;
}

enum neph_status neph_sample_levels_plan(const struct neph_job *job,
                                         struct neph_sample_levels_target aim,
                                         struct neph_sample_levels *rungs, struct neph_diag *diag)
{
    const double rung_s = aim.error > 0.0 ? probe_rung_s : aim.rung_s;
    *rungs = (struct neph_sample_levels){.aim = aim};
    enum neph_status status = time_samples(job, rung_s, rungs, diag);
    if (status)
        return status;
    choose_counts_by_time(job, rung_s, rungs);
    if (aim.error > 0.0) {
        const int samples = rungs->samples[0];
        double noise2 = 0.0;
        status = probe_noise(job, samples, &noise2, diag);
        if (!status)
            choose_counts_by_error(job, 0, samples, noise2, rungs);
    }
    return status;
}

void neph_sample_levels_refine(const struct neph_job *job, int rung, double noise2,
                               struct neph_sample_levels *rungs)
{
    if (rungs->aim.error > 0.0)
        choose_counts_by_error(job, rung + 1, rungs->samples[rung], noise2, rungs);
}

double neph_sample_levels_start_time(const int *samples, const double *mean_s,
                                     const double *least_s, int count)
{
    const int last = count - 1;
    const double per_sample_s = fmax(1e-9,
                                     (mean_s[last] - mean_s[0]) / (samples[last] - samples[0]));
    double start_s = INFINITY;
    for (int k = 0; k < count; k++)
        start_s = fmin(start_s, fmax(0.0, least_s[k] - samples[k] * per_sample_s));
    return start_s;
}
