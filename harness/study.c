/* SPDX-License-Identifier: MIT */
#include "harness/study.h"

#include "base/exr.h"
#include "metrics/statistics.h"

#include <math.h>
#include <string.h>

bool neph_study_applies(const struct neph_engine *engine, const struct neph_scene *scene)
{
    if (!engine->step.option)
        return false;
    for (int m = 0; m < scene->medium_count; m++)
        if (scene->media[m].kind != NEPH_MEDIUM_HOMOGENEOUS)
            return true;
    return false;
}

static int option_index(const struct neph_engine *engine, const char *name)
{
    for (int i = 0; engine->options[i].name; i++)
        if (strcmp(engine->options[i].name, name) == 0)
            return i;
    return -1; /* a test holds every engine to naming an option of its own */
}

static double mean_radiance(const struct neph_image *frame)
{
    float *planes[3];
    struct neph_sum sum = {0.0, 0.0};
    const size_t count = neph_image_pixel_count(frame);
    if (!neph_image_rgb(frame, NULL, planes))
        return NAN;
    for (int c = 0; c < 3; c++)
        for (size_t p = 0; p < count; p++)
            neph_sum_add(&sum, (double)planes[c][p]);
    return neph_sum_value(&sum) / (3.0 * (double)count);
}

/* Standard error of the mean of two frames, from the differences of their pixels. */
static double mean_noise(const struct neph_image *a, const struct neph_image *b)
{
    float *x[3], *y[3];
    struct neph_sum sum = {0.0, 0.0};
    const size_t count = neph_image_pixel_count(a);
    if (!neph_image_rgb(a, NULL, x) || !neph_image_rgb(b, NULL, y))
        return NAN;
    for (size_t p = 0; p < count; p++) {
        /* The channels of a pixel share their paths: one difference per pixel. */
        double difference = 0.0;
        for (int c = 0; c < 3; c++)
            difference += ((double)x[c][p] - (double)y[c][p]) / 3.0;
        neph_sum_add(&sum, difference * difference);
    }
    return 0.5 * sqrt(neph_sum_value(&sum)) / (double)count;
}

static enum neph_status render_level(const struct neph_job *job, struct neph_store *store,
                                     struct neph_study_level *level, enum neph_outcome *outcome,
                                     char reason[1600], struct neph_diag *diag)
{
    struct neph_image *frames[2] = {NULL, NULL};
    struct neph_job placed = *job;
    const int seeds = job->engine->stochastic ? 2 : 1;
    enum neph_status status = NEPH_OK;
    *outcome = NEPH_OUTCOME_RENDERED;
    for (int s = 0; s < seeds && !status && *outcome == NEPH_OUTCOME_RENDERED; s++) {
        struct neph_job_result result;
        placed.shot.seed = job->shot.seed + (uint64_t)s;
        status = neph_job_run(&placed, store, &result, diag);
        *outcome = result.outcome;
        level->wall_s += result.cost.wall_s;
        memcpy(reason, result.reason, sizeof(result.reason));
        if (!status && result.frame_path)
            status = neph_exr_read(result.frame_path, &frames[s], diag);
        neph_job_result_finish(&result);
    }
    if (!status && *outcome == NEPH_OUTCOME_RENDERED) {
        level->radiance = mean_radiance(frames[0]);
        if (seeds == 2) {
            level->radiance = 0.5 * (level->radiance + mean_radiance(frames[1]));
            level->noise = mean_noise(frames[0], frames[1]);
        }
    }
    neph_image_destroy(frames[0]);
    neph_image_destroy(frames[1]);
    return status;
}

/* The coarsest level from which on all are good: certain to be within the tolerance, or, where the
 * noise allows no such certainty at any level, not to be told from the limit. */
static void choose(struct neph_study *study)
{
    const int last = study->level_count - 1;
    const struct neph_study_level *finest = &study->levels[last];
    study->within_tolerance = fabs(finest->bias) + 2.0 * finest->bias_noise <= NEPH_STUDY_TOLERANCE;
    study->chosen = last;
    for (int i = last; i >= 0; i--) {
        const double bias = fabs(study->levels[i].bias);
        const double noise = 2.0 * study->levels[i].bias_noise;
        const bool good = study->within_tolerance ? bias + noise <= NEPH_STUDY_TOLERANCE
                                                  : bias <= noise;
        if (!good)
            return;
        study->chosen = i;
    }
}

/* From the last two levels, by the known order. */
static void extrapolate(struct neph_study *study, double factor)
{
    struct neph_study_level *levels = study->levels;
    const int last = study->level_count - 1;
    const double gain = last > 0 ? 1.0 / (pow(factor, study->order) - 1.0) : 0.0;
    const double step = last > 0 ? levels[last].radiance - levels[last - 1].radiance : 0.0;
    study->limit = levels[last].radiance + gain * step;
    const double limit_noise = last > 0 ? hypot((1.0 + gain) * levels[last].noise,
                                                gain * levels[last - 1].noise)
                                        : levels[last].noise;
    for (int i = 0; i <= last; i++) {
        levels[i].bias = levels[i].radiance / study->limit - 1.0;
        levels[i].bias_noise = hypot(levels[i].noise, limit_noise) / fabs(study->limit);
    }
    choose(study);
    study->observed_order = NAN;
    if (last >= 2) {
        const double before = levels[last - 1].radiance - levels[last - 2].radiance;
        const double noise = hypot(levels[last].noise, levels[last - 1].noise);
        if (fabs(step) > 4.0 * noise && fabs(step) > 1e-7 * fabs(study->limit) &&
            before / step > 0.0)
            study->observed_order = log(before / step) / log(factor);
    }
}

enum neph_status neph_study_run(const struct neph_job *job, struct neph_store *store,
                                struct neph_study *study, enum neph_outcome *outcome,
                                char reason[1600], struct neph_diag *diag)
{
    const struct neph_engine_step *step = &job->engine->step;
    const int index = option_index(job->engine, step->option);
    struct neph_job placed = *job;
    *study = (struct neph_study){.option = step->option, .order = step->order};
    for (int i = 0; i < step->level_count && i < NEPH_STUDY_LEVELS_MAX; i++) {
        struct neph_study_level *level = &study->levels[i];
        level->setting = step->coarsest * pow(step->refine, i);
        placed.shot.settings.values[index] = level->setting;
        enum neph_status status = render_level(&placed, store, level, outcome, reason, diag);
        if (status || *outcome != NEPH_OUTCOME_RENDERED)
            return status;
        study->level_count++;
    }
    extrapolate(study, fmax(step->refine, 1.0 / step->refine));
    return NEPH_OK;
}

json_t *neph_study_json(const struct neph_study *study)
{
    json_t *levels = json_array();
    for (int i = 0; i < study->level_count; i++) {
        const struct neph_study_level *level = &study->levels[i];
        json_array_append_new(levels,
                              json_pack("{s:f, s:f, s:f, s:f, s:f, s:f}", "setting", level->setting,
                                        "radiance", level->radiance, "noise", level->noise, "bias",
                                        level->bias, "bias_noise", level->bias_noise, "wall_s",
                                        level->wall_s));
    }
    json_t *observed = isfinite(study->observed_order) ? json_real(study->observed_order)
                                                       : json_null();
    return json_pack("{s:s, s:f, s:o, s:f, s:o, s:i, s:b, s:f}", "option", study->option, "order",
                     study->order, "observed_order", observed, "limit", study->limit, "levels",
                     levels, "chosen", study->chosen, "within_tolerance", study->within_tolerance,
                     "tolerance", NEPH_STUDY_TOLERANCE);
}

void neph_study_apply(const struct neph_study *study, const struct neph_engine *engine,
                      struct neph_settings *settings)
{
    settings->values[option_index(engine, study->option)] = study->levels[study->chosen].setting;
}
