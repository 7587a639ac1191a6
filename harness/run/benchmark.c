/* SPDX-License-Identifier: MIT
 *
 * The benchmark of engines with noise: reference, sample levels, statistics, JSON.
 */
#include "harness/run/benchmark.h"

#include "base/threads.h"
#include "harness/progress.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { SEEDS = NEPH_NOISE_SEEDS, REFERENCE_SEED = 1001 };

/* The 97.5 % quantile of Student's distribution, NEPH_BENCHMARK_LEVELS - 1 degrees of freedom. */
static const double student_95 = 3.182;
_Static_assert(NEPH_BENCHMARK_LEVELS == 4, "student_95");

bool neph_benchmark_applies(const struct neph_engine *engine, char *reason, size_t reason_size)
{
    const char *cannot = NULL;
    if (!engine->stochastic)
        cannot = "is deterministic: more time does not improve it";
    else if (neph_engine_samples(engine) < 0)
        cannot = "has no number of samples to vary";
    if (cannot)
        snprintf(reason, reason_size, "%s", cannot);
    return !cannot;
}

/* --- the reference ------------------------------------------------------------------------ */

struct reference {
    struct neph_noisy_frame frames[SEEDS];
    double square, mean; /* of the radiance; the noise is removed from the square */
};

static enum neph_status render_reference(struct neph_benchmark *benchmark, int samples,
                                         struct reference *reference, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int s = 0; s < SEEDS && !status; s++)
        status = neph_noisy_render(&benchmark->reference, samples, (uint64_t)(REFERENCE_SEED + s),
                                   &reference->frames[s], diag);
    if (status)
        return status;
    const struct neph_noisy_frame *r = &reference->frames[0], *s = &reference->frames[1];
    reference->square = neph_noisy_cross(r, NULL, s, NULL);
    reference->mean = 0.5 * (neph_noisy_compute_mean(r) + neph_noisy_compute_mean(s));
    if (!(reference->square > 0.0))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "the scene is black: there is no noise");
    benchmark->reference_samples = samples;
    benchmark->reference_noise = sqrt(0.5 * neph_noisy_compute_noise2(reference->frames) /
                                      reference->square);
    return NEPH_OK;
}

/* --- the sample levels -------------------------------------------------------------------- */

struct level_series {
    struct neph_sample_levels ladder;
    double start_s;
    double least_s[NEPH_BENCHMARK_LEVELS];       /* of a whole render */
    double means[NEPH_BENCHMARK_LEVELS * SEEDS]; /* relative to the reference's mean */
};

static enum neph_status measure_level(const struct neph_job *job, int rung,
                                      const struct reference *reference,
                                      struct level_series *level_series,
                                      struct neph_rmse_level *result, struct neph_diag *diag)
{
    struct neph_noisy_frame frames[SEEDS] = {{.image = NULL}};
    enum neph_status status = NEPH_OK;
    *result = (struct neph_rmse_level){.samples = level_series->ladder.samples[rung]};
    level_series->least_s[rung] = INFINITY;
    for (int s = 0; s < SEEDS && !status; s++) {
        status = neph_noisy_render(job, result->samples, (uint64_t)(2 + rung * SEEDS + s),
                                   &frames[s], diag);
        if (status)
            break;
        result->render_s += frames[s].render_s /
                            SEEDS; /* minus the start time: subtract_start_time()
                                                           */
        level_series->least_s[rung] = fmin(level_series->least_s[rung], frames[s].render_s);
        result->error2 += neph_noisy_cross(&frames[s], &reference->frames[0], &frames[s],
                                           &reference->frames[1]) /
                          (reference->square * SEEDS);
        level_series->means[rung * SEEDS + s] =
            neph_noisy_compute_mean(&frames[s]) / reference->mean - 1.0;
    }
    if (!status) {
        result->noise2 = neph_noisy_compute_noise2(frames) / reference->square;
        result->bias2 = neph_noisy_cross(&frames[0], &reference->frames[0], &frames[1],
                                         &reference->frames[1]) /
                        reference->square;
        neph_sample_levels_refine(job, rung, result->noise2, &level_series->ladder);
    }
    for (int s = 0; s < SEEDS; s++)
        neph_noisy_finish(&frames[s]);
    return status;
}

/* --- the result --------------------------------------------------------------------------- */

/* The mean with the interval of Student's t distribution. */
static struct neph_benchmark_value compute_mean_with_interval(const double *values, int count,
                                                              double student)
{
    double mean = 0.0, square = 0.0;
    for (int i = 0; i < count; i++)
        mean += values[i] / count;
    for (int i = 0; i < count; i++)
        square += (values[i] - mean) * (values[i] - mean);
    const double half = student * sqrt(square / ((count - 1.0) * count));
    return (struct neph_benchmark_value){mean, mean - half, mean + half};
}

static struct neph_benchmark_value exponentiate_value(struct neph_benchmark_value v)
{
    return (struct neph_benchmark_value){exp(v.value), exp(v.low), exp(v.high)};
}

static double log_cost(const struct neph_rmse_level *rung)
{
    return log(fmax(rung->noise2 * rung->render_s, 1e-300));
}

/* Subtracts the start time from the render times. The planned start time may have been measured on
 * a busy machine, so the smaller of it and the levels' own estimate is taken. */
static void subtract_start_time(struct level_series *level_series, struct neph_rmse_level *rungs)
{
    int samples[NEPH_BENCHMARK_LEVELS];
    double mean_s[NEPH_BENCHMARK_LEVELS];
    for (int k = 0; k < NEPH_BENCHMARK_LEVELS; k++) {
        samples[k] = rungs[k].samples;
        mean_s[k] = rungs[k].render_s;
    }
    level_series->start_s = fmin(
        level_series->start_s, neph_sample_levels_start_time(samples, mean_s, level_series->least_s,
                                                             NEPH_BENCHMARK_LEVELS));
    for (int k = 0; k < NEPH_BENCHMARK_LEVELS; k++)
        rungs[k].render_s -= level_series->start_s;
}

/* Engines are compared level by level: both renders of a level ran next to each other, so other
 * load on the machine slowed both. */
static void compute_results(struct neph_benchmark *benchmark,
                            struct level_series *level_series_list)
{
    const double student_95_of_seeds = 2.365; /* 2 * 4 - 1 degrees of freedom */
    for (int e = 0; e < benchmark->engine_count; e++)
        subtract_start_time(&level_series_list[e], benchmark->engines[e].rungs);
    for (int e = 0; e < benchmark->engine_count; e++) {
        struct neph_benchmark_engine *engine = &benchmark->engines[e];
        double costs[NEPH_BENCHMARK_LEVELS], times[NEPH_BENCHMARK_LEVELS];
        for (int k = 0; k < NEPH_BENCHMARK_LEVELS; k++) {
            costs[k] = log_cost(&engine->rungs[k]);
            times[k] = costs[k] - log_cost(&benchmark->engines[0].rungs[k]);
        }
        engine->start_s = level_series_list[e].start_s;
        engine->cost_s = exponentiate_value(
            compute_mean_with_interval(costs, NEPH_BENCHMARK_LEVELS, student_95));
        engine->times = exponentiate_value(
            compute_mean_with_interval(times, NEPH_BENCHMARK_LEVELS, student_95));
        engine->bias = compute_mean_with_interval(
            level_series_list[e].means, NEPH_BENCHMARK_LEVELS * SEEDS, student_95_of_seeds);
        engine->law = neph_rmse_law_fit(engine->rungs, NEPH_BENCHMARK_LEVELS);
        for (int i = 0; i < NEPH_BENCHMARK_RMSES; i++)
            engine->rmse_times[i] = neph_rmse_time_to(engine->rungs, NEPH_BENCHMARK_LEVELS,
                                                      benchmark->rmses[i]);
    }
}

/* Groups of progress steps with similar durations: 0 is the reference, then one for each engine and
 * level. */
static int progress_kind_for_level(int engine, int rung)
{
    return 1 + engine * NEPH_BENCHMARK_LEVELS + rung;
}

/* Updates the expected durations from the samples of each level and the last known time per sample.
 */
static void expect_level_times(int engine, int from, const struct neph_sample_levels *ladder,
                               struct neph_progress *progress)
{
    for (int k = from; k < NEPH_BENCHMARK_LEVELS; k++)
        progress->kinds[progress_kind_for_level(engine, k)].guess_s =
            SEEDS * (ladder->start_s + ladder->samples[k] * ladder->per_sample_s);
}

static enum neph_status measure_all_levels(struct neph_benchmark *benchmark,
                                           const struct reference *reference,
                                           struct level_series *level_series_list,
                                           struct neph_progress *progress, struct neph_diag *diag)
{
    for (int k = 0; k < NEPH_BENCHMARK_LEVELS; k++)
        for (int e = 0; e < benchmark->engine_count; e++) {
            struct neph_benchmark_engine *engine = &benchmark->engines[e];
            char what[128];
            snprintf(what, sizeof(what), "%s, %d samples", engine->job.engine->name,
                     level_series_list[e].ladder.samples[k]);
            progress->kind = progress_kind_for_level(e, k);
            neph_progress_begin(progress, what);
            const enum neph_status status = measure_level(
                &engine->job, k, reference, &level_series_list[e], &engine->rungs[k], diag);
            if (status)
                return status;
            expect_level_times(e, k + 1, &level_series_list[e].ladder, progress);
            neph_progress_step(progress, what, "rendered", SEEDS * engine->rungs[k].render_s);
        }
    return NEPH_OK;
}

/* The reference has four times the samples of the tracer's last level, so its noise is small beside
 * the noise of every level. The product estimators remove the rest of it. */
static enum neph_status prepare_benchmark(struct neph_benchmark *benchmark,
                                          struct level_series *level_series_list,
                                          struct reference *reference,
                                          struct neph_progress *progress, struct neph_diag *diag)
{
    const struct neph_sample_levels_target aim = benchmark->aim;
    const struct neph_sample_levels_target of_reference = {4.0 * aim.rung_s, 0.5 * aim.error};
    struct neph_sample_levels ladder;
    enum neph_status status = neph_sample_levels_plan(&benchmark->reference, of_reference, &ladder,
                                                      diag);
    const int samples = ladder.samples[NEPH_BENCHMARK_LEVELS - 1];
    for (int e = 0; e < benchmark->engine_count && !status; e++) {
        status = neph_sample_levels_plan(&benchmark->engines[e].job, aim,
                                         &level_series_list[e].ladder, diag);
        level_series_list[e].start_s = level_series_list[e].ladder.start_s;
        expect_level_times(e, 0, &level_series_list[e].ladder, progress);
    }
    return status ? status : render_reference(benchmark, samples, reference, diag);
}

enum neph_status neph_benchmark_run(struct neph_benchmark *benchmark, bool quiet,
                                    struct neph_diag *diag)
{
    struct level_series level_series_list[NEPH_BENCHMARK_ENGINES_MAX];
    struct reference reference = {.square = 0.0};
    struct neph_progress progress = neph_progress_start(quiet, 1);
    for (int e = 0; e < benchmark->engine_count; e++)
        for (int k = 0; k < NEPH_BENCHMARK_LEVELS; k++)
            neph_progress_expect(&progress, progress_kind_for_level(e, k), 1, 0.0);
    benchmark->rmses[1] = benchmark->aim.error > 0.0 ? benchmark->aim.error : 0.01;
    benchmark->rmses[0] = 3.0 * benchmark->rmses[1];
    neph_progress_begin(&progress, "reference");
    enum neph_status status = prepare_benchmark(benchmark, level_series_list, &reference, &progress,
                                                diag);
    if (!status) {
        neph_progress_step(&progress, "reference", "rendered",
                           SEEDS * reference.frames[0].render_s);
        status = measure_all_levels(benchmark, &reference, level_series_list, &progress, diag);
    }
    neph_progress_end(&progress);
    for (int s = 0; s < SEEDS; s++)
        neph_noisy_finish(&reference.frames[s]);
    if (!status)
        compute_results(benchmark, level_series_list);
    return status;
}

double neph_benchmark_paths_per_s(const struct neph_benchmark_engine *engine, int rung)
{
    const struct neph_shot *shot = &engine->job.shot;
    return (double)engine->rungs[rung].samples * shot->width_px * shot->height_px /
           engine->rungs[rung].render_s;
}

/* --- JSON --------------------------------------------------------------------------------- */

static json_t *value_json(struct neph_benchmark_value v)
{
    return json_pack("{s:f, s:f, s:f}", "value", v.value, "low", v.low, "high", v.high);
}

static json_t *rmse_times_json(const struct neph_benchmark_engine *engine)
{
    json_t *times = json_array();
    for (int i = 0; i < NEPH_BENCHMARK_RMSES; i++) {
        const struct neph_rmse_time *time = &engine->rmse_times[i];
        neph_json_add(&times, json_pack("{s:f, s:o, s:s}", "rmse", time->rmse, "render_s",
                                        neph_json_number(time->render_s), "found",
                                        neph_rmse_found_name(time->found)));
    }
    return times;
}

static json_t *engine_json(const struct neph_benchmark_engine *engine)
{
    json_t *rungs = json_array();
    for (int k = 0; k < NEPH_BENCHMARK_LEVELS; k++) {
        const struct neph_rmse_level *rung = &engine->rungs[k];
        neph_json_add(&rungs,
                      json_pack("{s:i, s:f, s:o, s:f, s:f, s:f}", "samples", rung->samples,
                                "render_s", rung->render_s, "paths_per_s",
                                neph_json_number(neph_benchmark_paths_per_s(engine, k)), "noise2",
                                rung->noise2, "error2", rung->error2, "bias2", rung->bias2));
    }
    const struct neph_rmse_law *law = &engine->law;
    const struct neph_benchmark_value bias2 = {law->bias2, law->bias2_low, law->bias2_high};
    char *settings = neph_settings_text(engine->job.engine, &engine->job.shot.settings);
    char *changes = neph_settings_changes(engine->job.engine, &engine->job.shot.settings,
                                          engine->preset);
    json_t *json = json_pack(
        "{s:s, s:s, s:s, s:s, s:s?, s:s, s:f, s:o, s:o, s:o, s:o, s:{s:o, s:o}, s:o}", "engine",
        engine->job.engine->name, "version", engine->job.info->version, "device",
        engine->job.info->device, "settings", settings ? settings : "", "preset", engine->preset,
        "changes", changes ? changes : "", "start_s", engine->start_s, "rungs", rungs, "cost_s",
        value_json(engine->cost_s), "times", value_json(engine->times), "bias",
        value_json(engine->bias), "law", "slope", neph_json_number(law->slope), "bias2",
        value_json(bias2), "rmse_times", rmse_times_json(engine));
    free(changes);
    free(settings);
    return json;
}

json_t *neph_benchmark_json(const struct neph_benchmark *benchmark)
{
    const struct neph_shot *shot = &benchmark->reference.shot;
    json_t *engines = json_array();
    for (int e = 0; e < benchmark->engine_count; e++)
        neph_json_add(&engines, engine_json(&benchmark->engines[e]));
    return json_pack("{s:s, s:s, s:s, s:[i,i], s:i, s:{s:s, s:i, s:f}, s:o}", "format",
                     "neph-benchmark-1", "scene", shot->scene->name, "scene_hash",
                     shot->scene->hash, "size_px", shot->width_px, shot->height_px, "cores",
                     neph_processor_count(), "reference", "engine",
                     benchmark->reference.engine->name, "samples", benchmark->reference_samples,
                     "noise", benchmark->reference_noise, "engines", engines);
}
