/* SPDX-License-Identifier: MIT */
#include "harness/run/benchmark.h"

#include "base/threads.h"
#include "harness/progress.h"
#include "metrics/statistics.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SEEDS = 2, FIRST_SAMPLES = 8, REFERENCE_SEED = 1001 };

/* The 97.5 % quantile of Student's distribution, NEPH_BENCHMARK_RUNGS - 1 degrees of freedom. */
static const double student_95 = 3.182;
_Static_assert(NEPH_BENCHMARK_RUNGS == 4, "student_95");

bool neph_benchmark_applies(const struct neph_engine *engine, char *reason, size_t reason_size)
{
    const char *cannot = NULL;
    if (!engine->stochastic)
        cannot = "knows no chance: more time does not make it better";
    else if (neph_engine_samples(engine) < 0)
        cannot = "has no number of samples to vary";
    if (cannot)
        snprintf(reason, reason_size, "%s", cannot);
    return !cannot;
}

/* --- frames ------------------------------------------------------------------------------- */

struct frame {
    struct neph_image *image;
    const float *planes[3];
    double render_s;
};

static enum neph_status render(const struct neph_job *of, int samples, uint64_t seed,
                               struct frame *frame, struct neph_diag *diag)
{
    struct neph_job job = *of;
    struct neph_cost cost;
    float *planes[3];
    job.shot.settings.values[neph_engine_samples(job.engine)] = samples;
    job.shot.seed = seed;
    const enum neph_status status = neph_job_render(&job, &frame->image, &cost, diag);
    if (status)
        return status;
    frame->render_s = cost.render_s;
    if (!neph_image_rgb(frame->image, NULL, planes))
        return neph_fail(diag, NEPH_ERR_INTERNAL, "%s gave no radiance", job.engine->name);
    for (int c = 0; c < 3; c++)
        frame->planes[c] = planes[c];
    return NEPH_OK;
}

static double value_of(const struct frame *frame, int channel, size_t pixel)
{
    return frame ? (double)frame->planes[channel][pixel] : 0.0;
}

/* Mean over pixels and channels of (a - r) (b - s); frames of NULL are black, but for a and b. */
static double mean_cross(const struct frame *a, const struct frame *r, const struct frame *b,
                         const struct frame *s)
{
    struct neph_sum sum = {0.0, 0.0};
    const size_t count = neph_image_pixel_count(a->image);
    for (int k = 0; k < 3; k++)
        for (size_t p = 0; p < count; p++)
            neph_sum_add(&sum, (value_of(a, k, p) - value_of(r, k, p)) *
                                   (value_of(b, k, p) - value_of(s, k, p)));
    return neph_sum_value(&sum) / (3.0 * (double)count);
}

static double mean_product(const struct frame *a, const struct frame *b, const struct frame *c)
{
    return mean_cross(a, b, a, c);
}

static double mean_radiance(const struct frame *frame)
{
    struct neph_sum sum = {0.0, 0.0};
    const size_t count = neph_image_pixel_count(frame->image);
    for (int k = 0; k < 3; k++)
        for (size_t p = 0; p < count; p++)
            neph_sum_add(&sum, (double)frame->planes[k][p]);
    return neph_sum_value(&sum) / (3.0 * (double)count);
}

/* --- the reference ------------------------------------------------------------------------ */

struct reference {
    struct frame frames[SEEDS];
    double square, mean; /* of the radiance, without the noise's part */
};

static enum neph_status render_reference(struct neph_benchmark *benchmark, int samples,
                                         struct reference *reference, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int s = 0; s < SEEDS && !status; s++)
        status = render(&benchmark->reference, samples, (uint64_t)(REFERENCE_SEED + s),
                        &reference->frames[s], diag);
    if (status)
        return status;
    const struct frame *r = &reference->frames[0], *s = &reference->frames[1];
    const double difference = mean_product(r, s, s);
    reference->square = 0.5 *
                        (mean_product(r, NULL, NULL) + mean_product(s, NULL, NULL) - difference);
    reference->mean = 0.5 * (mean_radiance(r) + mean_radiance(s));
    if (!(reference->square > 0.0))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "the scene is black: there is no noise");
    benchmark->reference_samples = samples;
    benchmark->reference_noise = 0.5 * sqrt(difference / reference->square);
    return NEPH_OK;
}

/* --- the ladder --------------------------------------------------------------------------- */

struct ladder {
    int samples[NEPH_BENCHMARK_RUNGS];
    double start_s;
    double least_s[NEPH_BENCHMARK_RUNGS];       /* that a whole render took */
    double means[NEPH_BENCHMARK_RUNGS * SEEDS]; /* relative to the reference's */
};

static enum neph_status time_of(const struct neph_job *job, double samples, double *render_s,
                                struct neph_diag *diag)
{
    struct frame frame = {.image = NULL};
    const enum neph_status status = render(job, (int)samples, 1, &frame, diag);
    *render_s = frame.render_s;
    neph_image_destroy(frame.image);
    return status;
}

/* From the time that few samples take to rungs that double up to `rung_s`, or beyond, when that is
 * the fewest samples of a ladder. What the fewest samples
 * take beyond their share is the start: kernels compiled, grids read. (The very first render is
 * left out: it fills caches.) */
static enum neph_status plan(const struct neph_job *job, double rung_s, struct ladder *ladder,
                             struct neph_diag *diag)
{
    const double most = job->engine->options[neph_engine_samples(job->engine)].maximum;
    double samples = FIRST_SAMPLES, first_s, last_s, per_sample_s;
    enum neph_status status = time_of(job, samples, &first_s, diag);
    if (!status)
        status = time_of(job, samples, &first_s, diag);
    do {
        samples *= 4.0;
        if (!status)
            status = time_of(job, samples, &last_s, diag);
        if (status)
            return status;
        per_sample_s = fmax(1e-9, (last_s - first_s) / (samples - FIRST_SAMPLES));
    } while (per_sample_s * samples < rung_s / 16.0 && 4.0 * samples <= most);
    ladder->start_s = fmax(0.0, first_s - FIRST_SAMPLES * per_sample_s);
    const double last = fmin(most, rung_s / per_sample_s);
    for (int k = 0; k < NEPH_BENCHMARK_RUNGS; k++) {
        const double rung = last / (1 << (NEPH_BENCHMARK_RUNGS - 1 - k));
        const double least = FIRST_SAMPLES * (1 << k);
        ladder->samples[k] = (int)fmax(least, FIRST_SAMPLES * round(rung / FIRST_SAMPLES));
    }
    return NEPH_OK;
}

static enum neph_status climb(const struct neph_job *job, int rung,
                              const struct reference *reference, struct ladder *ladder,
                              struct neph_benchmark_rung *result, struct neph_diag *diag)
{
    struct frame frames[SEEDS] = {{.image = NULL}};
    enum neph_status status = NEPH_OK;
    *result = (struct neph_benchmark_rung){.samples = ladder->samples[rung]};
    ladder->least_s[rung] = INFINITY;
    for (int s = 0; s < SEEDS && !status; s++) {
        status = render(job, result->samples, (uint64_t)(2 + rung * SEEDS + s), &frames[s], diag);
        if (status)
            break;
        result->render_s += frames[s].render_s / SEEDS; /* less the start: leave_start_out() */
        ladder->least_s[rung] = fmin(ladder->least_s[rung], frames[s].render_s);
        result->error2 += mean_product(&frames[s], &reference->frames[0], &reference->frames[1]) /
                          (reference->square * SEEDS);
        ladder->means[rung * SEEDS + s] = mean_radiance(&frames[s]) / reference->mean - 1.0;
    }
    if (!status) {
        result->noise2 = 0.5 * mean_product(&frames[0], &frames[1], &frames[1]) / reference->square;
        result->bias2 = mean_cross(&frames[0], &reference->frames[0], &frames[1],
                                   &reference->frames[1]) /
                        reference->square;
    }
    for (int s = 0; s < SEEDS; s++)
        neph_image_destroy(frames[s].image);
    return status;
}

/* --- the result --------------------------------------------------------------------------- */

/* The mean with Student's interval. */
static struct neph_benchmark_value mean_of(const double *values, int count, double student)
{
    double mean = 0.0, square = 0.0;
    for (int i = 0; i < count; i++)
        mean += values[i] / count;
    for (int i = 0; i < count; i++)
        square += (values[i] - mean) * (values[i] - mean);
    const double half = student * sqrt(square / ((count - 1.0) * count));
    return (struct neph_benchmark_value){mean, mean - half, mean + half};
}

static struct neph_benchmark_value exp_of(struct neph_benchmark_value v)
{
    return (struct neph_benchmark_value){exp(v.value), exp(v.low), exp(v.high)};
}

static double log_cost(const struct neph_benchmark_rung *rung)
{
    return log(fmax(rung->noise2 * rung->render_s, 1e-300));
}

const double neph_benchmark_rmses[NEPH_BENCHMARK_RMSES] = {0.03, 0.01};

static void find_rmse_times(struct neph_benchmark_engine *engine)
{
    struct neph_rmse_rung rungs[NEPH_BENCHMARK_RUNGS];
    for (int k = 0; k < NEPH_BENCHMARK_RUNGS; k++)
        rungs[k] = (struct neph_rmse_rung){engine->rungs[k].render_s, engine->rungs[k].noise2,
                                           engine->rungs[k].error2, engine->rungs[k].bias2};
    engine->law = neph_rmse_law_of(rungs, NEPH_BENCHMARK_RUNGS);
    for (int i = 0; i < NEPH_BENCHMARK_RMSES; i++)
        engine->rmse_times[i] = neph_rmse_time_to(rungs, NEPH_BENCHMARK_RUNGS,
                                                  neph_benchmark_rmses[i]);
}

/* The start was timed when the machine may have been busy, and no render is shorter than its start
 * and the share of its samples. */
static void leave_start_out(struct ladder *ladder, struct neph_benchmark_rung *rungs)
{
    const struct neph_benchmark_rung *first = &rungs[0], *last = &rungs[NEPH_BENCHMARK_RUNGS - 1];
    const double per_sample_s = fmax(1e-9, (last->render_s - first->render_s) /
                                               (last->samples - first->samples));
    for (int k = 0; k < NEPH_BENCHMARK_RUNGS; k++)
        ladder->start_s = fmin(ladder->start_s,
                               fmax(0.0, ladder->least_s[k] - rungs[k].samples * per_sample_s));
    for (int k = 0; k < NEPH_BENCHMARK_RUNGS; k++)
        rungs[k].render_s -= ladder->start_s;
}

/* Rungs pair up: what else the machine did at the time, it did to both. */
static void conclude(struct neph_benchmark *benchmark, struct ladder *ladders)
{
    const double student_95_of_seeds = 2.365; /* 2 * 4 - 1 degrees of freedom */
    for (int e = 0; e < benchmark->engine_count; e++)
        leave_start_out(&ladders[e], benchmark->engines[e].rungs);
    for (int e = 0; e < benchmark->engine_count; e++) {
        struct neph_benchmark_engine *engine = &benchmark->engines[e];
        double costs[NEPH_BENCHMARK_RUNGS], times[NEPH_BENCHMARK_RUNGS];
        for (int k = 0; k < NEPH_BENCHMARK_RUNGS; k++) {
            costs[k] = log_cost(&engine->rungs[k]);
            times[k] = costs[k] - log_cost(&benchmark->engines[0].rungs[k]);
        }
        engine->start_s = ladders[e].start_s;
        engine->cost_s = exp_of(mean_of(costs, NEPH_BENCHMARK_RUNGS, student_95));
        engine->times = exp_of(mean_of(times, NEPH_BENCHMARK_RUNGS, student_95));
        engine->bias = mean_of(ladders[e].means, NEPH_BENCHMARK_RUNGS * SEEDS, student_95_of_seeds);
        find_rmse_times(engine);
    }
}

static enum neph_status climb_all(struct neph_benchmark *benchmark,
                                  const struct reference *reference, struct ladder *ladders,
                                  struct neph_progress *progress, struct neph_diag *diag)
{
    for (int k = 0; k < NEPH_BENCHMARK_RUNGS; k++)
        for (int e = 0; e < benchmark->engine_count; e++) {
            struct neph_benchmark_engine *engine = &benchmark->engines[e];
            char what[128];
            snprintf(what, sizeof(what), "%s, %d samples", engine->job.engine->name,
                     ladders[e].samples[k]);
            neph_progress_begin(progress, what);
            const enum neph_status status = climb(&engine->job, k, reference, &ladders[e],
                                                  &engine->rungs[k], diag);
            if (status)
                return status;
            neph_progress_step(progress, what, "rendered", engine->rungs[k].render_s);
        }
    return NEPH_OK;
}

/* A reference of four times the samples of the tracer's last rung, so that its noise is small
 * beside any rung's (none of it is left in the means anyway). */
static enum neph_status prepare(struct neph_benchmark *benchmark, double rung_s,
                                struct ladder *ladders, struct reference *reference,
                                struct neph_diag *diag)
{
    struct ladder of_reference;
    enum neph_status status = plan(&benchmark->reference, 4.0 * rung_s, &of_reference, diag);
    for (int e = 0; e < benchmark->engine_count && !status; e++)
        status = plan(&benchmark->engines[e].job, rung_s, &ladders[e], diag);
    if (!status)
        status = render_reference(benchmark, of_reference.samples[NEPH_BENCHMARK_RUNGS - 1],
                                  reference, diag);
    return status;
}

enum neph_status neph_benchmark_run(struct neph_benchmark *benchmark, double rung_s, bool quiet,
                                    struct neph_diag *diag)
{
    struct ladder ladders[NEPH_BENCHMARK_ENGINES_MAX];
    struct reference reference = {.square = 0.0};
    struct neph_progress progress = neph_progress_start(quiet, 1 + NEPH_BENCHMARK_RUNGS *
                                                                       benchmark->engine_count);
    neph_progress_begin(&progress, "reference");
    enum neph_status status = prepare(benchmark, rung_s, ladders, &reference, diag);
    if (!status) {
        neph_progress_step(&progress, "reference", "rendered", reference.frames[0].render_s);
        status = climb_all(benchmark, &reference, ladders, &progress, diag);
    }
    neph_progress_end(&progress);
    for (int s = 0; s < SEEDS; s++)
        neph_image_destroy(reference.frames[s].image);
    if (!status)
        conclude(benchmark, ladders);
    return status;
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

static json_t *law_json(const struct neph_rmse_law *law)
{
    const struct neph_benchmark_value bias2 = {law->bias2, law->bias2_low, law->bias2_high};
    return json_pack("{s:o, s:o}", "slope", neph_json_number(law->slope), "bias2",
                     value_json(bias2));
}

static json_t *engine_json(const struct neph_benchmark_engine *engine)
{
    json_t *rungs = json_array();
    for (int k = 0; k < NEPH_BENCHMARK_RUNGS; k++) {
        const struct neph_benchmark_rung *rung = &engine->rungs[k];
        neph_json_add(&rungs, json_pack("{s:i, s:f, s:f, s:f, s:f}", "samples", rung->samples,
                                        "render_s", rung->render_s, "noise2", rung->noise2,
                                        "error2", rung->error2, "bias2", rung->bias2));
    }
    char *settings = neph_settings_text(engine->job.engine, &engine->job.shot.settings);
    json_t *json = json_pack("{s:s, s:s, s:s, s:s, s:f, s:o, s:o, s:o, s:o, s:o, s:o}", "engine",
                             engine->job.engine->name, "version", engine->job.info->version,
                             "device", engine->job.info->device, "settings",
                             settings ? settings : "", "start_s", engine->start_s, "rungs", rungs,
                             "cost_s", value_json(engine->cost_s), "times",
                             value_json(engine->times), "bias", value_json(engine->bias), "law",
                             law_json(&engine->law), "rmse_times", rmse_times_json(engine));
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
