/* SPDX-License-Identifier: MIT
 *
 * Jobs with a time budget: fewer samples, and a small pilot frame when nothing fits.
 */
#include "harness/run/budget.h"

#include "base/exr.h"
#include "harness/run/noise.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SAMPLE_REDUCTIONS = 3, RUNG_FACTOR = 8, PILOT_SIDE = 4 };

/* Time limit of the pilot, in seconds: enough on a machine that is busy with ten other jobs, so
 * that a pilot beyond it counts as a hang. */
static const double pilot_limit_s = 300.0;

/* Lists the settings to try, most samples first; returns their number. */
static int list_sample_reductions(const struct neph_job *job,
                                  struct neph_settings rungs[SAMPLE_REDUCTIONS])
{
    const int index = neph_engine_samples(job->engine);
    int count = 0;
    double samples = index < 0 ? 1.0 : job->shot.settings.values[index];
    for (; count < SAMPLE_REDUCTIONS && samples >= 1.0; samples = floor(samples / RUNG_FACTOR)) {
        rungs[count] = job->shot.settings;
        if (index >= 0)
            rungs[count].values[index] = samples;
        count++;
        if (index < 0)
            break;
    }
    return count;
}

/* Notes the reduced samples. The noise of a Monte Carlo mean falls with the square root of the
 * number of samples. */
static void write_note(const struct neph_job *job, const struct neph_settings *asked,
                       double budget_s, char note[NEPH_JOB_NOTE_SIZE])
{
    const int index = neph_engine_samples(job->engine);
    if (index < 0 || asked->values[index] == job->shot.settings.values[index])
        return;
    const double most = asked->values[index], samples = job->shot.settings.values[index];
    snprintf(note, NEPH_JOB_NOTE_SIZE,
             "%g samples per pixel did not fit into %g s: rendered with %g, whose noise is %.1f "
             "times as large",
             most, budget_s, samples, sqrt(most / samples));
}

struct pilot {
    struct neph_job job;
    struct neph_job_result results[2]; /* of two seeds; only the first where the engine is
                                          deterministic */
    double noise;                      /* NaN: not known */
};

/* Renders a frame of a quarter of the side with the fewest samples, with two seeds where the engine
 * draws random numbers. */
static enum neph_status run_pilot(const struct neph_job *job, double budget_s,
                                  struct neph_store *store, struct pilot *pilot,
                                  struct neph_diag *diag)
{
    *pilot = (struct pilot){.job = *job, .noise = NAN};
    struct neph_shot *shot = &pilot->job.shot;
    shot->width_px = (shot->width_px + PILOT_SIDE - 1) / PILOT_SIDE;
    shot->height_px = (shot->height_px + PILOT_SIDE - 1) / PILOT_SIDE;
    shot->time_limit_s = fmax(budget_s, pilot_limit_s);
    struct neph_image *frames[2] = {NULL, NULL};
    enum neph_status status = neph_job_run(&pilot->job, store, &pilot->results[0], diag);
    const bool again = job->engine->stochastic && pilot->results[0].frame_path;
    shot->seed++;
    if (!status && again)
        status = neph_job_run(&pilot->job, store, &pilot->results[1], diag);
    if (!status && pilot->results[1].frame_path)
        status = neph_exr_read(pilot->results[0].frame_path, &frames[0], diag);
    if (!status && frames[0])
        status = neph_exr_read(pilot->results[1].frame_path, &frames[1], diag);
    if (!status && frames[1])
        pilot->noise = neph_noise_from_two_seeds(frames[0], frames[1]);
    neph_image_destroy(frames[0]);
    neph_image_destroy(frames[1]);
    return status;
}

/* Writes the reason of an OVER_BUDGET result: time and noise extrapolated from the pilot to the
 * settings `asked`. */
static void write_budget_reason(const struct pilot *pilot, const struct neph_settings *asked,
                                double budget_s, struct neph_job_result *result)
{
    const struct neph_engine *engine = pilot->job.engine;
    const int index = neph_engine_samples(engine);
    const double factor = index < 0 ? 1.0
                                    : asked->values[index] / pilot->job.shot.settings.values[index];
    const struct neph_cost *cost = &pilot->results[0].cost;
    const double least_s = cost->wall_s + cost->render_s * (PILOT_SIDE * PILOT_SIDE * factor - 1.0);
    char noise[96] = "";
    if (isfinite(pilot->noise))
        snprintf(noise, sizeof(noise), ", and its noise would be about %.2g %% of the rms radiance",
                 100.0 * pilot->noise / sqrt(factor));
    result->outcome = NEPH_OUTCOME_OVER_BUDGET;
    snprintf(result->reason, sizeof(result->reason),
             "did not fit into %g s: by a frame of %dx%d px its radiance would take %.0f s%s; "
             "raise the limit with --budget",
             budget_s, pilot->job.shot.width_px, pilot->job.shot.height_px, least_s, noise);
}

/* Looks in the store for a frame, most samples first. */
static enum neph_status find_stored_frame(struct neph_job *job, double budget_s,
                                          const struct neph_settings *rungs, int rung_count,
                                          struct neph_store *store, struct neph_job_result *result,
                                          bool *found, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    *found = false;
    *result = (struct neph_job_result){.outcome = NEPH_OUTCOME_FAILED};
    job->shot.time_limit_s = budget_s;
    for (int i = 0; i < rung_count && !status && !*found; i++) {
        neph_job_result_finish(result);
        job->shot.settings = rungs[i];
        status = neph_job_reuse(job, store, result, found, diag);
    }
    return status;
}

enum neph_status neph_budget_try(struct neph_job *job, double budget_s, struct neph_store *store,
                                 struct neph_job_result *result, struct neph_diag *diag)
{
    const struct neph_settings asked = job->shot.settings;
    struct neph_settings rungs[SAMPLE_REDUCTIONS];
    bool found;
    const enum neph_status status = find_stored_frame(
        job, budget_s, rungs, list_sample_reductions(job, rungs), store, result, &found, diag);
    if (status || found)
        return status;
    neph_job_result_finish(result);
    job->shot.settings = asked;
    return neph_job_run(job, store, result, diag);
}

enum neph_status neph_budget_run(struct neph_job *job, double budget_s, struct neph_store *store,
                                 struct neph_job_result *result, struct neph_diag *diag)
{
    const struct neph_settings asked = job->shot.settings;
    struct neph_settings rungs[SAMPLE_REDUCTIONS];
    const int rung_count = list_sample_reductions(job, rungs);
    bool found;
    enum neph_status status = find_stored_frame(job, budget_s, rungs, rung_count, store, result,
                                                &found, diag);
    if (!found)
        result->outcome = NEPH_OUTCOME_TIMEOUT;
    for (int i = 0; i < rung_count && !status && result->outcome == NEPH_OUTCOME_TIMEOUT; i++) {
        neph_job_result_finish(result);
        job->shot.settings = rungs[i];
        status = neph_job_run(job, store, result, diag);
    }
    if (!status && result->outcome == NEPH_OUTCOME_TIMEOUT) {
        struct pilot pilot;
        status = run_pilot(job, budget_s, store, &pilot, diag);
        if (!status && pilot.results[0].frame_path)
            write_budget_reason(&pilot, &asked, budget_s, result);
        neph_job_result_finish(&pilot.results[0]);
        neph_job_result_finish(&pilot.results[1]);
    }
    if (!status && result->outcome == NEPH_OUTCOME_RENDERED)
        write_note(job, &asked, budget_s, result->note);
    return status;
}
