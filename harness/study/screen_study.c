/* SPDX-License-Identifier: MIT */
#include "harness/study/screen_study.h"

#include "base/clock.h"
#include "base/exr.h"
#include "harness/engines/engines.h"
#include "harness/progress.h"
#include "harness/run/seed.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double scene_typical_s = 30.0;

/* Layers of the truth and of models. */
static const struct {
    const char *layer, *on_screen, *colour;
} parts[NEPH_SCREEN_PARTS] = {
    [NEPH_SCREEN_AO] = {"ao", "ao_on_screen", NULL},
    [NEPH_SCREEN_DIFFUSE] = {"diffuse_indirect", "diffuse_on_screen", "diffuse_color"},
    [NEPH_SCREEN_GLOSSY] = {"glossy_indirect", "glossy_on_screen", "glossy_color"},
};
const char *const neph_screen_part_names[NEPH_SCREEN_PARTS] = {
    [NEPH_SCREEN_AO] = "ambient occlusion",
    [NEPH_SCREEN_DIFFUSE] = "indirect light",
    [NEPH_SCREEN_GLOSSY] = "reflections",
};

struct work {
    const struct neph_screen_study_params *params;
    struct neph_store *store;
    struct neph_progress progress;
    struct neph_light_model truth, models[NEPH_LIGHT_MODELS_MAX];
};

/* ---- pictures -------------------------------------------------------------------------------- */

/* From the store, or rendered. */
static enum neph_status take_picture(const struct work *work, const struct neph_light_model *by,
                                     const struct neph_scene *scene, struct neph_image **picture,
                                     struct neph_diag *diag)
{
    const struct neph_job job = {.engine = by->engine,
                                 .info = &by->info,
                                 .shot = {.scene = scene,
                                          .settings = by->settings,
                                          .width_px = work->params->width_px,
                                          .height_px = work->params->height_px,
                                          .layers = NEPH_LAYERS_ALL,
                                          .seed = neph_seed_of(scene, 1),
                                          .time_limit_s = INFINITY}};
    struct neph_job_result result = {.settings = NULL};
    char reason[200];
    if (!by->engine->can_render(scene, &by->settings, reason, sizeof(reason)))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "%s cannot render %s: %s", by->engine->name,
                         scene->name, reason);
    enum neph_status status = neph_job_run(&job, work->store, &result, diag);
    if (!status)
        status = neph_outcome_check(result.outcome, result.reason, diag);
    if (!status)
        status = neph_exr_read(result.frame_path, picture, diag);
    neph_job_result_finish(&result);
    return status;
}

/* ---- parts of a picture ---------------------------------------------------------------------- */

/* What a part of the truth is made of, and what a model has of it (NULL: nothing). */
struct layers {
    float *truth[3], *on_screen[3], *variance[3], *colour[3], *depth;
    float *model[3];
    bool has_colour, has_model;
};

static bool find_layers(const struct neph_image *truth, const struct neph_image *model,
                        enum neph_screen_part part, struct layers *layers)
{
    char variance[64];
    snprintf(variance, sizeof(variance), "variance.%s", parts[part].layer);
    layers->depth = neph_image_channel(truth, "Z");
    layers->has_colour = parts[part].colour &&
                         neph_image_rgb(truth, parts[part].colour, layers->colour);
    layers->has_model = model && neph_image_rgb(model, parts[part].layer, layers->model);
    return neph_image_rgb(truth, parts[part].layer, layers->truth) &&
           neph_image_rgb(truth, parts[part].on_screen, layers->on_screen) &&
           neph_image_rgb(truth, variance, layers->variance);
}

/* A pixel, its channels added as they count. */
struct sample {
    double truth, on_screen, model;
    double error, own, beyond, noise; /* absolute, channel by channel */
};

/* False where the picture has no such part. */
static bool sample_of(const struct layers *layers, size_t pixel, struct sample *sample)
{
    double colours = 0.0;
    *sample = (struct sample){0};
    for (int c = 0; c < 3; c++) {
        const double colour = layers->has_colour ? layers->colour[c][pixel] : 1.0 / 3.0;
        const double truth = colour * layers->truth[c][pixel];
        const double on_screen = colour * layers->on_screen[c][pixel];
        const double model = layers->has_model ? colour * layers->model[c][pixel] : 0.0;
        colours += colour;
        sample->truth += truth;
        sample->on_screen += on_screen;
        sample->model += model;
        sample->error += fabs(model - truth);
        sample->own += fabs(model - on_screen);
        sample->beyond += fabs(on_screen - truth);
        sample->noise += colour * sqrt(layers->variance[c][pixel]) * sqrt(2.0 / M_PI);
    }
    return colours > 0.0 && isfinite(layers->depth[pixel]);
}

static bool is_lost(enum neph_screen_part part, const struct sample *sample)
{
    return sample->beyond > NEPH_SCREEN_LOST * (part == NEPH_SCREEN_AO ? 0.5 : sample->truth);
}

/* Sums over pixels; light relative to all of it, occlusion to the number of pixels. */
struct sums {
    int pixels, lost;
    double all, known, gone; /* what errors are relative to: of all pixels, known, lost */
    double error, bias, own, known_error, lost_error, noise, beyond;
};

static void add(enum neph_screen_part part, const struct sample *sample, struct sums *sums)
{
    const double weight = part == NEPH_SCREEN_AO ? 1.0 : sample->truth;
    const bool lost = is_lost(part, sample);
    sums->pixels++;
    sums->lost += lost;
    sums->all += weight;
    sums->known += lost ? 0.0 : weight;
    sums->gone += lost ? weight : 0.0;
    sums->error += sample->error;
    sums->bias += sample->model - sample->truth;
    sums->own += sample->own;
    sums->known_error += lost ? 0.0 : sample->error;
    sums->lost_error += lost ? sample->error : 0.0;
    sums->noise += sample->noise;
    sums->beyond += sample->beyond;
}

static bool sum_up(const struct neph_image *truth, const struct neph_image *model,
                   enum neph_screen_part part, struct sums *sums)
{
    struct layers layers;
    *sums = (struct sums){0};
    if (!find_layers(truth, model, part, &layers))
        return false;
    for (size_t p = 0; p < neph_image_pixel_count(truth); p++) {
        struct sample sample;
        if (sample_of(&layers, p, &sample))
            add(part, &sample, sums);
    }
    return !model || layers.has_model;
}

static struct neph_screen_truth truth_of(const struct sums *sums)
{
    return (struct neph_screen_truth){sums->pixels, sums->lost, sums->noise / sums->all,
                                      sums->beyond / sums->all};
}

static struct neph_screen_gap gap_of(const struct sums *sums, bool is_there)
{
    if (!is_there)
        return (struct neph_screen_gap){NAN, NAN, NAN, NAN, NAN};
    return (struct neph_screen_gap){sums->error / sums->all, sums->bias / sums->all,
                                    sums->own / sums->all, sums->known_error / sums->known,
                                    sums->lost_error / sums->gone};
}

/* ---- a scene --------------------------------------------------------------------------------- */

/* Why it is lost, on the mean over surfaces. */
static void look_around(const struct work *work, const struct neph_scene *scene,
                        const struct neph_image *truth, struct neph_screen_scene *result)
{
    const struct neph_screen_study_params *params = work->params;
    const struct neph_camera camera = neph_scene_camera(scene, 0.0);
    const float *depth = neph_image_channel(truth, "Z");
    const int count = params->width_px * params->height_px;
    int surfaces = 0;
    for (int p = 0; p < count; p++)
        surfaces += isfinite(depth[p]);
    for (int p = 0; p < count; p++) {
        double near[NEPH_SCREEN_LOSSES], far[NEPH_SCREEN_LOSSES];
        const int column = p % params->width_px, row = p / params->width_px;
        neph_screen_lost(scene, &camera, params->width_px, params->height_px, column, row,
                         params->radius_m, params->rays, near);
        neph_screen_lost(scene, &camera, params->width_px, params->height_px, column, row, INFINITY,
                         params->rays, far);
        for (int i = 0; i < NEPH_SCREEN_LOSSES; i++) {
            result->near[i] += near[i] / surfaces;
            result->far[i] += far[i] / surfaces;
        }
    }
}

static enum neph_status run_model(const struct work *work, int model,
                                  const struct neph_scene *scene, const struct neph_image *truth,
                                  struct neph_screen_scene *result, struct neph_diag *diag)
{
    struct neph_image *picture = NULL;
    const enum neph_status status = take_picture(work, &work->models[model], scene, &picture, diag);
    for (int part = 0; part < NEPH_SCREEN_PARTS && !status; part++) {
        struct sums sums;
        const bool is_there = sum_up(truth, picture, (enum neph_screen_part)part, &sums);
        result->gaps[model][part] = gap_of(&sums, is_there);
    }
    neph_image_destroy(picture);
    return status;
}

static enum neph_status run_scene(struct work *work, const struct neph_scene *scene,
                                  struct neph_screen_scene *result, struct neph_diag *diag)
{
    struct neph_image *truth = NULL;
    const double start_s = neph_wall_s();
    *result = (struct neph_screen_scene){0};
    neph_progress_begin(&work->progress, scene->name);
    enum neph_status status = take_picture(work, &work->truth, scene, &truth, diag);
    for (int part = 0; part < NEPH_SCREEN_PARTS && !status; part++) {
        struct sums sums;
        if (sum_up(truth, NULL, (enum neph_screen_part)part, &sums))
            result->truths[part] = truth_of(&sums);
    }
    if (!status)
        look_around(work, scene, truth, result);
    for (int model = 0; model < work->params->model_count && !status; model++)
        status = run_model(work, model, scene, truth, result, diag);
    if (!status)
        neph_progress_step(&work->progress, scene->name, "measured", neph_wall_s() - start_s);
    neph_image_destroy(truth);
    return status;
}

/* ---- the whole ------------------------------------------------------------------------------- */

static enum neph_status set_number(struct neph_light_model *model, const char *name, double value,
                                   struct neph_diag *diag)
{
    char assignment[64];
    snprintf(assignment, sizeof(assignment), "%s=%.17g", name, value);
    return neph_settings_set(model->engine, &model->settings, assignment, diag);
}

static enum neph_status prepare(struct work *work, struct neph_diag *diag)
{
    const struct neph_screen_study_params *params = work->params;
    struct neph_light_model *truth = &work->truth;
    truth->engine = &neph_engine_surfaces;
    truth->settings = neph_settings_default(truth->engine);
    neph_engine_probe(truth->engine, &truth->info);
    enum neph_status status = set_number(truth, "samples", params->samples, diag);
    if (!status)
        status = set_number(truth, "ao_distance_m", params->radius_m, diag);
    for (int i = 0; i < params->model_count && !status; i++) {
        status = neph_light_model_parse(params->models[i], 1, &work->models[i], diag);
        if (!status && work->models[i].engine != &neph_engine_screen)
            status = neph_fail(diag, NEPH_ERR_USAGE,
                               "'%s' is no screen: models are screen, with "
                               "settings as in screen+ao=ssao",
                               params->models[i]);
        if (!status)
            status = set_number(&work->models[i], "ao_radius_m", params->radius_m, diag);
    }
    neph_progress_expect(&work->progress, 0, params->scene_count, scene_typical_s);
    return status;
}

enum neph_status neph_screen_study_run(const struct neph_screen_study_params *params,
                                       struct neph_store *store, struct neph_screen_study *study,
                                       struct neph_diag *diag)
{
    struct work work = {
        .params = params, .store = store, .progress = neph_progress_start(params->quiet, 0)};
    *study = (struct neph_screen_study){.params = params};
    enum neph_status status = prepare(&work, diag);
    for (int i = 0; i < params->scene_count && !status; i++)
        status = run_scene(&work, params->scenes[i], &study->scenes[i], diag);
    neph_progress_end(&work.progress);
    if (status == NEPH_ERR_INTERRUPTED)
        neph_hint(diag, "what is finished is in the store: the same command goes on from there");
    return status;
}
