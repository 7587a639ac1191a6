/* SPDX-License-Identifier: MIT
 *
 * The step study: levels, extrapolation, choice of a level, JSON.
 */
#include "harness/study/study.h"

#include "base/arena.h"
#include "base/exr.h"
#include "metrics/statistics.h"
#include "scenes/media.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Fails to compile when a kind is added, as the table of names needs it. */
_Static_assert(NEPH_STUDY_VERDICT_COUNT == 3, "a new kind");

bool neph_study_applies(const struct neph_engine *engine, const struct neph_scene *scene)
{
    if (!engine->step.option)
        return false;
    for (int m = 0; m < scene->medium_count; m++)
        if (!neph_medium_facts(scene->media[m].kind)->is_even)
            return true;
    return false;
}

static int option_index(const struct neph_engine *engine)
{
    return neph_option_find(engine->options, engine->step.option); /* a test checks that it exists
                                                                      */
}

/* Frames of all levels by seed, as the mean of the channels. A deterministic engine has only seed
 * 0. */
struct pictures {
    size_t pixel_count;
    int seed_count;
    double *grey[NEPH_STUDY_LEVELS_MAX][2];
    struct neph_arena arena; /* owns the frames */
};

static enum neph_status add_grey_frame(const struct neph_image *frame, struct pictures *pictures,
                                       double **grey, struct neph_diag *diag)
{
    float *planes[3];
    if (!neph_image_rgb(frame, NULL, planes))
        return neph_fail(diag, NEPH_ERR_ENGINE, "the frame of a study has no radiance");
    pictures->pixel_count = neph_image_pixel_count(frame);
    *grey = neph_arena_allocate(&pictures->arena, pictures->pixel_count, sizeof(**grey));
    if (!*grey)
        return neph_fail_memory(diag);
    for (size_t p = 0; p < pictures->pixel_count; p++)
        (*grey)[p] = ((double)planes[0][p] + (double)planes[1][p] + (double)planes[2][p]) / 3.0;
    return NEPH_OK;
}

/* A weighted sum of levels. */
struct blend {
    double weights[NEPH_STUDY_LEVELS_MAX];
};

static double blend_pixel(const struct pictures *pictures, const struct blend *blend, int seed,
                          size_t pixel)
{
    double sum = 0.0;
    for (int i = 0; i < NEPH_STUDY_LEVELS_MAX && pictures->grey[i][seed]; i++)
        sum += blend->weights[i] * pictures->grey[i][seed][pixel];
    return sum;
}

/* Mean of a blend over the frame and the seeds, and its standard error from the pixelwise
 * differences of the seeds. Levels share their seeds and most of their noise, which therefore
 * cancels in the difference of two levels. */
static double blend_mean(const struct pictures *pictures, const struct blend *blend, double *noise)
{
    struct neph_sum sum = {0.0, 0.0}, squares = {0.0, 0.0};
    const int seeds = pictures->seed_count;
    for (size_t p = 0; p < pictures->pixel_count; p++) {
        double values[2] = {0.0, 0.0};
        for (int s = 0; s < seeds; s++)
            values[s] = blend_pixel(pictures, blend, s, p);
        neph_sum_add(&sum, values[0] + values[1]);
        if (seeds == 2)
            neph_sum_add(&squares, pow(values[0] - values[1], 2.0));
    }
    const double count = (double)pictures->pixel_count;
    *noise = 0.5 * sqrt(neph_sum_value(&squares)) / count;
    return neph_sum_value(&sum) / (seeds * count);
}

bool neph_study_job(const struct neph_job *job, int index, struct neph_job *made)
{
    const struct neph_engine_step *step = &job->engine->step;
    const int seed_count = job->engine->stochastic ? 2 : 1, level = index / seed_count;
    *made = *job;
    if (level >= step->level_count || level >= NEPH_STUDY_LEVELS_MAX)
        return false;
    made->shot.settings.values[option_index(job->engine)] = step->coarsest *
                                                            pow(step->refine, level);
    made->shot.seed = job->shot.seed + (uint64_t)(index % seed_count);
    return true;
}

static enum neph_status render(const struct neph_job *job, struct neph_store *store,
                               struct pictures *pictures, double **grey,
                               struct neph_study_level *level, enum neph_outcome *outcome,
                               char reason[1600], struct neph_diag *diag)
{
    struct neph_job_result result;
    struct neph_image *frame = NULL;
    enum neph_status status = neph_job_run(job, store, &result, diag);
    *outcome = result.outcome;
    level->wall_s += result.cost.wall_s;
    memcpy(reason, result.reason, sizeof(result.reason));
    if (!status && result.frame_path)
        status = neph_exr_read(result.frame_path, &frame, diag);
    if (!status && frame)
        status = add_grey_frame(frame, pictures, grey, diag);
    neph_image_destroy(frame);
    neph_job_result_finish(&result);
    return status;
}

/* The bias of the finest level. Where the error does not fall with the known order, the
 * extrapolated limit is uncertain by the last change (as for first order), which is then the bias.
 */
static double worst_bias(const struct neph_study *study)
{
    const struct neph_study_level *finest = &study->levels[study->level_count - 1];
    const bool doubtful = fabs(study->observed_order - study->order) > NEPH_STUDY_ORDER_SLACK;
    /* a NaN order is not doubtful */
    return doubtful ? fabs(finest->bias - finest[-1].bias) : fabs(finest->bias);
}

static enum neph_study_verdict judge(const struct neph_study *study)
{
    const double bias = worst_bias(study);
    const double noise = 2.0 * study->levels[study->level_count - 1].bias_noise;
    return bias + noise <= NEPH_STUDY_TOLERANCE ? NEPH_STUDY_WITHIN
           : bias <= noise                      ? NEPH_STUDY_NOISE
                                                : NEPH_STUDY_OFF;
}

static bool is_good(const struct neph_study_level *level, enum neph_study_verdict verdict)
{
    const double bias = fabs(level->bias), noise = 2.0 * level->bias_noise;
    return verdict == NEPH_STUDY_WITHIN ? bias + noise <= NEPH_STUDY_TOLERANCE : bias <= noise;
}

/* Chooses the coarsest level from which on all levels are good. */
static void choose(struct neph_study *study)
{
    study->verdict = judge(study);
    study->chosen = study->level_count - 1;
    while (study->verdict != NEPH_STUDY_OFF && study->chosen > 0 &&
           is_good(&study->levels[study->chosen - 1], study->verdict))
        study->chosen--;
}

/* Richardson extrapolation from the last two levels with the known order. */
static struct blend make_limit_blend(const struct neph_study *study, double factor)
{
    const int last = study->level_count - 1;
    const double gain = last > 0 ? 1.0 / (pow(factor, study->order) - 1.0) : 0.0;
    struct blend limit = {{0.0}};
    limit.weights[last] = 1.0 + gain;
    if (last > 0)
        limit.weights[last - 1] = -gain;
    return limit;
}

/* Log of the ratio of the last two changes over log of the refinement; NaN where noise or rounding
 * dominates. */
static double observe_order(const struct pictures *pictures, const struct neph_study *study,
                            double factor)
{
    const int last = study->level_count - 1;
    if (last < 2)
        return NAN;
    struct blend last_change = {{0.0}}, change_before = {{0.0}};
    last_change.weights[last] = change_before.weights[last - 1] = 1.0;
    last_change.weights[last - 1] = change_before.weights[last - 2] = -1.0;
    double noise, noise_before;
    const double step = blend_mean(pictures, &last_change, &noise);
    const double before = blend_mean(pictures, &change_before, &noise_before);
    const bool is_clear = fabs(step) > 4.0 * noise && fabs(before) > 4.0 * noise_before &&
                          fabs(step) > 1e-7 * fabs(study->limit) && before / step > 0.0;
    return is_clear ? log(before / step) / log(factor) : NAN;
}

static void extrapolate(const struct pictures *pictures, struct neph_study *study, double factor)
{
    const struct blend limit = make_limit_blend(study, factor);
    double noise;
    study->limit = blend_mean(pictures, &limit, &noise);
    if (study->limit == 0.0)
        return;
    for (int i = 0; i < study->level_count; i++) {
        struct neph_study_level *level = &study->levels[i];
        struct blend alone = {{0.0}}, difference = limit;
        alone.weights[i] = 1.0;
        for (int k = 0; k < study->level_count; k++)
            difference.weights[k] = alone.weights[k] - limit.weights[k];
        level->radiance = blend_mean(pictures, &alone, &level->noise);
        level->bias = blend_mean(pictures, &difference, &level->bias_noise) / study->limit;
        level->bias_noise /= fabs(study->limit);
    }
    study->observed_order = observe_order(pictures, study, factor);
    choose(study);
}

enum neph_status neph_study_run(const struct neph_job *job, struct neph_store *store,
                                struct neph_study *study, enum neph_outcome *outcome,
                                char reason[1600], struct neph_diag *diag)
{
    const struct neph_engine_step *step = &job->engine->step;
    struct neph_job placed;
    struct pictures pictures = {.seed_count = job->engine->stochastic ? 2 : 1};
    enum neph_status status = NEPH_OK;
    *outcome = NEPH_OUTCOME_RENDERED;
    *study = (struct neph_study){
        .option = step->option, .order = step->order, .tolerance = NEPH_STUDY_TOLERANCE};
    for (int i = 0; !status && *outcome == NEPH_OUTCOME_RENDERED && neph_study_job(job, i, &placed);
         i++) {
        const int index = i / pictures.seed_count;
        struct neph_study_level *level = &study->levels[index];
        study->level_count = index + 1;
        level->setting = placed.shot.settings.values[option_index(job->engine)];
        status = render(&placed, store, &pictures, &pictures.grey[index][i % pictures.seed_count],
                        level, outcome, reason, diag);
    }
    if (!status && *outcome == NEPH_OUTCOME_RENDERED)
        extrapolate(&pictures, study, fmax(step->refine, 1.0 / step->refine));
    if (!status && *outcome == NEPH_OUTCOME_RENDERED && study->limit == 0.0) {
        *outcome = NEPH_OUTCOME_CANNOT;
        snprintf(reason, 1600, "the frame is black: a relative bias is undefined");
    }
    neph_arena_finish(&pictures.arena);
    return status;
}

void neph_study_apply(const struct neph_study *study, const struct neph_engine *engine,
                      struct neph_settings *settings)
{
    settings->values[option_index(engine)] = study->levels[study->chosen].setting;
}

/* ---- as JSON --------------------------------------------------------------------------------- */

static const char *const verdict_names[] = {
    [NEPH_STUDY_WITHIN] = "within", [NEPH_STUDY_NOISE] = "noise", [NEPH_STUDY_OFF] = "off"};

const char *neph_study_verdict_name(enum neph_study_verdict verdict)
{
    return verdict_names[verdict];
}

static json_t *level_json(const struct neph_study_level *level)
{
    return json_pack("{s:f, s:f, s:f, s:f, s:f, s:f}", "setting", level->setting, "radiance",
                     level->radiance, "noise", level->noise, "bias", level->bias, "bias_noise",
                     level->bias_noise, "wall_s", level->wall_s);
}

json_t *neph_study_json(const struct neph_study *study)
{
    json_t *levels = json_array();
    for (int i = 0; i < study->level_count; i++)
        neph_json_add(&levels, level_json(&study->levels[i]));
    json_t *json = json_pack(
        "{s:s, s:f, s:o, s:f, s:o, s:i, s:s, s:f}", "option", study->option, "order", study->order,
        "observed_order", neph_json_number(study->observed_order), "limit", study->limit, "levels",
        levels, "chosen", study->chosen, "verdict", neph_study_verdict_name(study->verdict),
        "tolerance", study->tolerance);
    if (study->width_px > 0)
        neph_json_set(&json, "size_px", json_pack("[i,i]", study->width_px, study->height_px));
    if (study->is_shipped)
        neph_json_set(&json, "shipped", json_true());
    return json;
}

static bool read_levels(json_t *list, struct neph_study *study)
{
    study->level_count = (int)json_array_size(list);
    if (study->chosen < 0 || study->chosen >= study->level_count ||
        study->level_count > NEPH_STUDY_LEVELS_MAX)
        return false;
    for (int i = 0; i < study->level_count; i++) {
        struct neph_study_level *level = &study->levels[i];
        if (json_unpack(json_array_get(list, (size_t)i), "{s:F, s:F, s:F, s:F, s:F, s:F}",
                        "setting", &level->setting, "radiance", &level->radiance, "noise",
                        &level->noise, "bias", &level->bias, "bias_noise", &level->bias_noise,
                        "wall_s", &level->wall_s) != 0)
            return false;
    }
    return true;
}

static bool read_verdict(const char *name, struct neph_study *study)
{
    for (int v = NEPH_STUDY_WITHIN; v <= NEPH_STUDY_OFF; v++)
        if (strcmp(name, verdict_names[v]) == 0) {
            study->verdict = (enum neph_study_verdict)v;
            return true;
        }
    return false;
}

/* Whether the study is of the engine's step option and its chosen setting is in the option's range.
 */
static bool is_valid_setting(const char *name, const struct neph_study *study,
                             const struct neph_engine *engine)
{
    if (!study->option || strcmp(name, study->option) != 0)
        return false;
    const struct neph_option *option = &engine->options[option_index(engine)];
    const double setting = study->levels[study->chosen].setting;
    return setting >= option->minimum && setting <= option->maximum;
}

enum neph_status neph_study_read(json_t *json, const struct neph_engine *engine,
                                 struct neph_study *study, struct neph_diag *diag)
{
    struct neph_study made = {.option = engine->step.option};
    const char *option, *verdict;
    json_t *observed, *levels;
    const bool has_form =
        json_unpack(json, "{s:s, s:F, s:o, s:F, s:o, s:i, s:s, s:F, s?[i,i]}", "option", &option,
                    "order", &made.order, "observed_order", &observed, "limit", &made.limit,
                    "levels", &levels, "chosen", &made.chosen, "verdict", &verdict, "tolerance",
                    &made.tolerance, "size_px", &made.width_px, &made.height_px) == 0;
    if (!has_form || !read_levels(levels, &made) || !read_verdict(verdict, &made) ||
        !is_valid_setting(option, &made, engine))
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "a step study of %s chooses a setting outside of its range", engine->name);
    made.observed_order = json_is_number(observed) ? json_number_value(observed) : NAN;
    *study = made;
    return NEPH_OK;
}
