/* SPDX-License-Identifier: MIT */
#include "harness/study/screen_study.h"

#include "base/clock.h"
#include "base/exr.h"
#include "harness/engines/engines.h"
#include "harness/engines/vulkan_device.h"
#include "harness/progress.h"
#include "harness/run/seed.h"
#include "harness/study/screen_flicker.h"
#include "metrics/display.h"
#include "scenes/motion.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_SCREEN_PARTS == 3, "a new kind");

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
    struct neph_light_model truth, witness, models[NEPH_LIGHT_MODELS_MAX];
    struct neph_open_device *device; /* of the display that flicker is seen on */
};

/* ---- pictures -------------------------------------------------------------------------------- */

static struct neph_job job_of(const struct work *work, const struct neph_light_model *by,
                              const struct neph_scene *scene, int frame)
{
    return (struct neph_job){.engine = by->engine,
                             .info = &by->info,
                             .shot = {.scene = scene,
                                      .settings = by->settings,
                                      .width_px = work->params->width_px,
                                      .height_px = work->params->height_px,
                                      .frame = frame,
                                      .layers = NEPH_LAYERS_ALL,
                                      .seed = neph_seed_of(scene, 1),
                                      .time_limit_s = INFINITY,
                                      .device = work->params->device}};
}

/* From the store, or rendered. */
static enum neph_status take_picture(const struct work *work, const struct neph_light_model *by,
                                     const struct neph_scene *scene, int frame,
                                     struct neph_image **picture, struct neph_diag *diag)
{
    const struct neph_job job = job_of(work, by, scene, frame);
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

/* What is held against what: a model, or nobody yet, against the truth, or against what a witness
 * says in its place. */
struct pictures {
    const struct neph_image *truth, *said, *model;
};

/* What a part of the truth is made of, and what a model has of it (NULL: nothing). */
struct layers {
    float *truth[3], *on_screen[3], *variance[3], *colour[3], *depth;
    float *model[3], *said_colour[3], *model_colour[3];
    bool has_colour, has_model;
};

/* A witness's colours are those of its own pixels, a screen's those of the truth. */
static void find_colours(const struct neph_image *image, const char *layer, float *const truth[3],
                         float *colours[3])
{
    if (!image || !neph_image_rgb(image, layer, colours))
        memcpy(colours, truth, 3 * sizeof(*colours));
}

static bool find_layers(const struct pictures *pictures, enum neph_screen_part part,
                        struct layers *layers)
{
    const struct neph_image *truth = pictures->truth, *model = pictures->model;
    char variance[64];
    snprintf(variance, sizeof(variance), "variance.%s", parts[part].layer);
    layers->depth = neph_image_channel(truth, "Z");
    layers->has_colour = parts[part].colour &&
                         neph_image_rgb(truth, parts[part].colour, layers->colour);
    if (layers->has_colour) {
        find_colours(pictures->said, parts[part].colour, layers->colour, layers->said_colour);
        find_colours(model, parts[part].colour, layers->colour, layers->model_colour);
    }
    layers->has_model = model && neph_image_rgb(model, parts[part].layer, layers->model);
    return neph_image_rgb(pictures->said ? pictures->said : truth, parts[part].layer,
                          layers->truth) &&
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
        const double said = layers->has_colour ? layers->said_colour[c][pixel] : colour;
        const double own = layers->has_colour ? layers->model_colour[c][pixel] : colour;
        const double truth = said * layers->truth[c][pixel];
        const double on_screen = colour * layers->on_screen[c][pixel];
        const double model = layers->has_model ? own * layers->model[c][pixel] : 0.0;
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

static bool sum_up(const struct pictures *pictures, enum neph_screen_part part, struct sums *sums)
{
    struct layers layers;
    *sums = (struct sums){0};
    if (!find_layers(pictures, part, &layers))
        return false;
    for (size_t p = 0; p < neph_image_pixel_count(pictures->truth); p++) {
        struct sample sample;
        if (sample_of(&layers, p, &sample))
            add(part, &sample, sums);
    }
    return !pictures->model || layers.has_model;
}

static struct neph_screen_truth truth_of(const struct sums *sums)
{
    return (struct neph_screen_truth){.pixels = sums->pixels,
                                      .lost = sums->lost,
                                      .noise = sums->noise / sums->all,
                                      .beyond = sums->beyond / sums->all};
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

static int reason_of(const double shares[NEPH_SCREEN_LOSSES])
{
    int reason = NEPH_SCREEN_LOSSES;
    double most = 0.0;
    for (int i = 0; i < NEPH_SCREEN_LOSSES; i++)
        if (shares[i] > most) {
            most = shares[i];
            reason = i;
        }
    return reason;
}

/* A picture, and its parts as far as it has them. */
struct parted {
    const float *depth;
    struct layers layers[NEPH_SCREEN_PARTS];
    bool has[NEPH_SCREEN_PARTS];
};

/* Why a pixel is lost, and that it is. */
static void look_from(const struct work *work, const struct neph_scene *scene,
                      const struct neph_camera *camera, const struct parted *truth, int p,
                      double shares[NEPH_SCREEN_PARTS][NEPH_SCREEN_LOSSES],
                      struct neph_screen_scene *result)
{
    const struct neph_screen_study_params *params = work->params;
    const int column = p % params->width_px, row = p / params->width_px;
    neph_screen_lost(scene, camera, params->width_px, params->height_px, column, row,
                     params->radius_m, params->rays, shares[NEPH_SCREEN_AO]);
    neph_screen_lost(scene, camera, params->width_px, params->height_px, column, row, INFINITY,
                     params->rays, shares[NEPH_SCREEN_DIFFUSE]);
    neph_screen_lost_mirrored(scene, camera, params->width_px, params->height_px, column, row,
                              shares[NEPH_SCREEN_GLOSSY]);
    for (int part = 0; part < NEPH_SCREEN_PARTS; part++) {
        struct sample sample;
        if (!truth->has[part] || !sample_of(&truth->layers[part], (size_t)p, &sample) ||
            !is_lost((enum neph_screen_part)part, &sample))
            continue;
        const int reason = reason_of(shares[part]);
        result->truths[part].lost_by[reason]++;
        result->marks[part][p] = (uint8_t)(1 + reason);
    }
}

/* Shares are means over surfaces. */
static void look_around(const struct work *work, const struct neph_scene *scene,
                        const struct neph_image *picture, struct neph_screen_scene *result)
{
    const struct neph_camera camera = neph_scene_camera(scene, 0.0);
    const int count = work->params->width_px * work->params->height_px;
    struct parted truth = {.depth = neph_image_channel(picture, "Z")};
    int surfaces = 0;
    for (int part = 0; part < NEPH_SCREEN_PARTS; part++)
        truth.has[part] = find_layers(&(struct pictures){.truth = picture},
                                      (enum neph_screen_part)part, &truth.layers[part]);
    for (int p = 0; p < count; p++)
        surfaces += isfinite(truth.depth[p]);
    for (int p = 0; p < count; p++) {
        double shares[NEPH_SCREEN_PARTS][NEPH_SCREEN_LOSSES];
        look_from(work, scene, &camera, &truth, p, shares, result);
        for (int i = 0; i < NEPH_SCREEN_LOSSES; i++) {
            result->near[i] += shares[NEPH_SCREEN_AO][i] / surfaces;
            result->far[i] += shares[NEPH_SCREEN_DIFFUSE][i] / surfaces;
        }
    }
}

/* Solids lie as the first frame has them. */
static enum neph_status look_at_first(const struct work *work, const struct neph_scene *scene,
                                      const struct neph_image *picture,
                                      struct neph_screen_scene *result, struct neph_diag *diag)
{
    struct neph_scene *still = NULL;
    const enum neph_status status = neph_scene_at(scene, 0.0, &still, diag);
    if (status)
        return status;
    look_around(work, still, picture, result);
    neph_scene_destroy(still);
    return NEPH_OK;
}

/* The picture under the marks: half as bright as it is, and lighter. */
static enum neph_status show(const struct neph_scene *scene, const struct neph_image *picture,
                             uint8_t *grey, struct neph_diag *diag)
{
    const size_t count = neph_image_pixel_count(picture);
    float *planes[3];
    uint8_t *rgb = malloc(3 * count);
    if (!rgb)
        return neph_fail_memory(diag);
    enum neph_status status = neph_image_rgb(picture, NULL, planes)
                                  ? NEPH_OK
                                  : neph_fail(diag, NEPH_ERR_INTERNAL, "a truth without radiance");
    const float *const constant[3] = {planes[0], planes[1], planes[2]};
    if (!status)
        status = neph_display_encode(constant, count, scene->exposure_ev, rgb, diag);
    for (size_t p = 0; p < count && !status; p++)
        grey[p] = (uint8_t)(80 + (2 * rgb[3 * p] + 5 * rgb[3 * p + 1] + rgb[3 * p + 2]) / 16);
    free(rgb);
    return status;
}

static enum neph_status make_marks(const struct work *work, struct neph_screen_scene *result,
                                   struct neph_diag *diag)
{
    const size_t count = (size_t)work->params->width_px * (size_t)work->params->height_px;
    bool has_memory = (result->seen = calloc(count, 1)) != NULL;
    for (int part = 0; part < NEPH_SCREEN_PARTS; part++)
        has_memory &= (result->marks[part] = calloc(count, 1)) != NULL;
    return has_memory ? NEPH_OK : neph_fail_memory(diag);
}

void neph_screen_study_finish(struct neph_screen_study *study)
{
    for (int s = 0; s < NEPH_SCREEN_SCENES_MAX; s++) {
        free(study->scenes[s].seen);
        for (int part = 0; part < NEPH_SCREEN_PARTS; part++)
            free(study->scenes[s].marks[part]);
    }
}

static void hold_against(const struct pictures *pictures,
                         struct neph_screen_gap gaps[NEPH_SCREEN_PARTS])
{
    for (int part = 0; part < NEPH_SCREEN_PARTS; part++) {
        struct sums sums;
        const bool is_there = sum_up(pictures, (enum neph_screen_part)part, &sums);
        gaps[part] = gap_of(&sums, is_there && sums.pixels > 0);
    }
}

/* What is true of a scene, and what Cycles says, where it was asked and can. */
struct known {
    struct neph_image *truth, *witness; /* owned */
    struct neph_screen_truths sequence;
};

static enum neph_status run_model(const struct work *work, int model,
                                  const struct neph_scene *scene, const struct known *known,
                                  struct neph_screen_scene *result, struct neph_diag *diag)
{
    struct neph_image *picture = NULL;
    enum neph_status status = take_picture(work, &work->models[model], scene, 0, &picture, diag);
    if (!status)
        hold_against(&(struct pictures){known->truth, NULL, picture}, result->gaps[model]);
    if (!status && known->witness)
        hold_against(&(struct pictures){known->truth, known->witness, picture},
                     result->against_witness[model]);
    neph_image_destroy(picture);
    if (status || !known->sequence.frames)
        return status;
    struct neph_job job = job_of(work, &work->models[model], scene, 0);
    return neph_screen_flicker(work->device->vulkan, &job, &known->sequence,
                               &result->flicker[model], diag);
}

/* Cycles finds no light that a mirror throws; where it cannot, the scene has no witness. */
static enum neph_status ask_witness(const struct work *work, const struct neph_scene *scene,
                                    struct known *known, struct neph_screen_scene *result,
                                    struct neph_diag *diag)
{
    const struct neph_light_model *witness = &work->witness;
    for (int part = 0; part < NEPH_SCREEN_PARTS; part++) {
        result->witness[part] = gap_of(&(struct sums){0}, false);
        for (int model = 0; model < work->params->model_count; model++)
            result->against_witness[model][part] = result->witness[part];
    }
    if (work->params->witness_samples == 0 ||
        !witness->engine->can_render(scene, &witness->settings, result->witness_cannot,
                                     sizeof(result->witness_cannot)))
        return NEPH_OK;
    const enum neph_status status = take_picture(work, witness, scene, 0, &known->witness, diag);
    if (!status)
        hold_against(&(struct pictures){known->truth, NULL, known->witness}, result->witness);
    return status;
}

static enum neph_status take_sequence(const struct work *work, const struct neph_scene *scene,
                                      struct known *known, struct neph_diag *diag)
{
    struct neph_screen_truths *truths = &known->sequence;
    enum neph_status status = NEPH_OK;
    if (work->params->frame_count == 0)
        return NEPH_OK;
    neph_screen_frames(scene, work->params->frame_count, truths);
    truths->frames = calloc((size_t)truths->frame_count, sizeof(*truths->frames));
    if (!truths->frames)
        return neph_fail_memory(diag);
    for (int i = 0; i < truths->frame_count && !status; i++)
        status = take_picture(work, &work->truth, scene, i, &truths->frames[i], diag);
    return status;
}

static void finish(struct known *known)
{
    neph_screen_truths_finish(&known->sequence);
    neph_image_destroy(known->witness);
    neph_image_destroy(known->truth);
}

static enum neph_status run_scene(struct work *work, const struct neph_scene *scene,
                                  struct neph_screen_scene *result, struct neph_diag *diag)
{
    struct known known = {NULL};
    const double start_s = neph_wall_s();
    *result = (struct neph_screen_scene){0};
    neph_progress_begin(&work->progress, scene->name);
    enum neph_status status = take_picture(work, &work->truth, scene, 0, &known.truth, diag);
    for (int part = 0; part < NEPH_SCREEN_PARTS && !status; part++) {
        struct sums sums;
        if (sum_up(&(struct pictures){.truth = known.truth}, (enum neph_screen_part)part, &sums))
            result->truths[part] = truth_of(&sums);
    }
    if (!status)
        status = make_marks(work, result, diag);
    if (!status)
        status = show(scene, known.truth, result->seen, diag);
    if (!status)
        status = look_at_first(work, scene, known.truth, result, diag);
    if (!status)
        status = ask_witness(work, scene, &known, result, diag);
    if (!status)
        status = take_sequence(work, scene, &known, diag);
    result->frame_count = known.sequence.count;
    for (int model = 0; model < work->params->model_count && !status; model++)
        status = run_model(work, model, scene, &known, result, diag);
    if (!status)
        neph_progress_step(&work->progress, scene->name, "measured", neph_wall_s() - start_s);
    finish(&known);
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

static enum neph_status prepare_witness(struct work *work, struct neph_diag *diag)
{
    struct neph_light_model *witness = &work->witness;
    if (work->params->witness_samples == 0)
        return NEPH_OK;
    witness->engine = neph_engine_find("cycles");
    witness->settings = neph_settings_default(witness->engine);
    neph_engine_probe(witness->engine, work->params->device, &witness->info);
    if (!witness->info.available)
        return neph_fail(diag, NEPH_ERR_UNAVAILABLE, "cycles: %s", witness->info.missing);
    enum neph_status status = set_number(witness, "samples", work->params->witness_samples, diag);
    if (!status)
        status = set_number(witness, "ao_distance_m", work->params->radius_m, diag);
    return status
               ? status
               : neph_settings_set(witness->engine, &witness->settings, "surface_layers=on", diag);
}

static enum neph_status prepare(struct work *work, struct neph_diag *diag)
{
    const struct neph_screen_study_params *params = work->params;
    struct neph_light_model *truth = &work->truth;
    truth->engine = &neph_engine_surfaces;
    truth->settings = neph_settings_default(truth->engine);
    neph_engine_probe(truth->engine, work->params->device, &truth->info);
    enum neph_status status = set_number(truth, "samples", params->samples, diag);
    if (!status)
        status = set_number(truth, "ao_distance_m", params->radius_m, diag);
    for (int i = 0; i < params->model_count && !status; i++) {
        status = neph_light_model_parse(params->models[i], 1, params->device, &work->models[i],
                                        diag);
        if (!status && work->models[i].engine != &neph_engine_screen)
            status = neph_fail(diag, NEPH_ERR_USAGE,
                               "'%s' is no screen: models are screen, with "
                               "settings as in screen+ao=ssao",
                               params->models[i]);
        if (!status)
            status = set_number(&work->models[i], "ao_radius_m", params->radius_m, diag);
    }
    neph_progress_expect(&work->progress, 0, params->scene_count, scene_typical_s);
    if (!status)
        status = prepare_witness(work, diag);
    return status || params->frame_count == 0
               ? status
               : neph_device_acquire(params->device, &work->device, diag);
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
    neph_device_release(work.device);
    if (status == NEPH_ERR_INTERRUPTED)
        neph_hint(diag, "what is finished is in the store: the same command goes on from there");
    return status;
}
