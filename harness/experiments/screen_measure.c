/* SPDX-License-Identifier: MIT */
#include "harness/experiments/screen.h"

#include "harness/engines/engines.h"
#include "harness/run/flight.h"
#include "harness/run/seed.h"
#include "metrics/display.h"
#include "scenes/display.h"
#include "scenes/motion.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Compiles only when this file handles every part. */
_Static_assert(NEPH_SCREEN_PARTS == 3, "a new kind");

static const double scene_typical_s = 30.0;

/* Layers of the reference and of models. */
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

/* ---- frames ---------------------------------------------------------------------------------- */

static struct neph_shot make_frame_shot(const struct neph_screen_study *study,
                                        const struct neph_scene *scene, int frame)
{
    return (struct neph_shot){.scene = scene,
                              .width_px = study->request->shared.size.width_px,
                              .height_px = study->request->shared.size.height_px,
                              .frame = frame,
                              .layers = NEPH_LAYERS_ALL,
                              .seed = neph_seed_for_scene(scene, 1),
                              .device = study->run->device};
}

static enum neph_status render(const struct neph_screen_study *study,
                               const struct neph_light_model *by, const struct neph_scene *scene,
                               int frame, struct neph_image **image, struct neph_diag *diag)
{
    const struct neph_shot shot = make_frame_shot(study, scene, frame);
    double seconds = 0.0;
    char reason[200];
    if (!by->engine->can_render(scene, &by->settings, reason, sizeof(reason)))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "%s cannot render %s: %s", by->engine->name,
                         scene->name, reason);
    return neph_light_model_render(by, &shot, study->run->store, image, &seconds, diag);
}

/* ---- parts of a frame ------------------------------------------------------------------------ */

/* A model (NULL: none yet), compared with the reference, or with a second reference instead. */
struct compared {
    const struct neph_image *truth, *second, *model;
};

/* The layers of a part in the reference and in a model (NULL: missing). */
struct layers {
    float *truth[3], *on_screen[3], *variance[3], *colour[3], *depth;
    float *model[3], *second_colour[3], *model_colour[3];
    bool has_colour, has_model;
};

/* A second reference has colours of its own; a screen-space model uses the reference's. */
static void find_colours(const struct neph_image *image, const char *layer, float *const truth[3],
                         float *colours[3])
{
    if (!image || !neph_image_rgb(image, layer, colours))
        memcpy(colours, truth, 3 * sizeof(*colours));
}

static bool find_layers(const struct compared *compared, enum neph_screen_part part,
                        struct layers *layers)
{
    const struct neph_image *truth = compared->truth, *model = compared->model;
    char variance[64];
    snprintf(variance, sizeof(variance), "variance.%s", parts[part].layer);
    layers->depth = neph_image_channel(truth, "Z");
    layers->has_colour = parts[part].colour &&
                         neph_image_rgb(truth, parts[part].colour, layers->colour);
    if (layers->has_colour) {
        find_colours(compared->second, parts[part].colour, layers->colour, layers->second_colour);
        find_colours(model, parts[part].colour, layers->colour, layers->model_colour);
    }
    layers->has_model = model && neph_image_rgb(model, parts[part].layer, layers->model);
    return neph_image_rgb(compared->second ? compared->second : truth, parts[part].layer,
                          layers->truth) &&
           neph_image_rgb(truth, parts[part].on_screen, layers->on_screen) &&
           neph_image_rgb(truth, variance, layers->variance);
}

/* A pixel, as weighted sums over its channels. */
struct sample {
    double truth, on_screen, model;
    double error, own, beyond, noise; /* absolute differences, summed over channels */
};

/* False when the frame has no such part in this pixel. */
static bool read_sample(const struct layers *layers, size_t pixel, struct sample *sample)
{
    double colours = 0.0;
    *sample = (struct sample){0};
    for (int c = 0; c < 3; c++) {
        const double colour = layers->has_colour ? layers->colour[c][pixel] : 1.0 / 3.0;
        const double second = layers->has_colour ? layers->second_colour[c][pixel] : colour;
        const double own = layers->has_colour ? layers->model_colour[c][pixel] : colour;
        const double truth = second * layers->truth[c][pixel];
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

/* Sums over pixels. Light is later divided by all light, occlusion by the number of pixels. */
struct sums {
    int pixels, lost;
    double all, known, gone; /* denominators: all pixels, known, lost */
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

static bool sum_up(const struct compared *compared, enum neph_screen_part part, struct sums *sums)
{
    struct layers layers;
    *sums = (struct sums){0};
    if (!find_layers(compared, part, &layers))
        return false;
    for (size_t p = 0; p < neph_image_pixel_count(compared->truth); p++) {
        struct sample sample;
        if (read_sample(&layers, p, &sample))
            add(part, &sample, sums);
    }
    return !compared->model || layers.has_model;
}

static struct neph_screen_truth summarize_reference(const struct sums *sums)
{
    return (struct neph_screen_truth){.pixels = sums->pixels,
                                      .lost = sums->lost,
                                      .noise = sums->noise / sums->all,
                                      .beyond = sums->beyond / sums->all};
}

static struct neph_screen_gap summarize_gap(const struct sums *sums, bool is_there)
{
    if (!is_there)
        return (struct neph_screen_gap){NAN, NAN, NAN, NAN, NAN};
    return (struct neph_screen_gap){sums->error / sums->all, sums->bias / sums->all,
                                    sums->own / sums->all, sums->known_error / sums->known,
                                    sums->lost_error / sums->gone};
}

/* ---- lost pixels ----------------------------------------------------------------------------- */

static int find_main_loss(const double shares[NEPH_SCREEN_LOSSES])
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

/* A frame with the layers of the parts that it has. */
struct parted {
    const float *depth;
    struct layers layers[NEPH_SCREEN_PARTS];
    bool has[NEPH_SCREEN_PARTS];
};

/* Find the reasons for a pixel's losses, and mark it if it is lost. */
static void mark_pixel(const struct neph_screen_study *study, const struct neph_scene *scene,
                       const struct neph_camera *camera, const struct parted *truth, int p,
                       double shares[NEPH_SCREEN_PARTS][NEPH_SCREEN_LOSSES],
                       struct neph_screen_scene *result)
{
    const struct neph_screen_request *request = study->request;
    const int width_px = request->shared.size.width_px, height_px = request->shared.size.height_px;
    const int column = p % width_px, row = p / width_px;
    for (int part = 0; part < NEPH_SCREEN_PARTS; part++) {
        struct sample sample;
        neph_screen_compute_lost_shares(
            scene, camera, width_px, height_px, column, row,
            part == NEPH_SCREEN_AO ? request->radius_m : INFINITY,
            part == NEPH_SCREEN_GLOSSY ? NEPH_SCREEN_MIRROR : request->rays, shares[part]);
        if (!truth->has[part] || !read_sample(&truth->layers[part], (size_t)p, &sample) ||
            !is_lost((enum neph_screen_part)part, &sample))
            continue;
        const int reason = find_main_loss(shares[part]);
        result->truths[part].lost_by[reason]++;
        result->marks[part][p] = (uint8_t)(1 + reason);
    }
}

/* Mark all lost pixels. The shares are means over surfaces; solids are where the first frame has
 * them. */
static enum neph_status find_lost_pixels(const struct neph_screen_study *study,
                                         const struct neph_scene *scene,
                                         const struct neph_image *frame,
                                         struct neph_screen_scene *result, struct neph_diag *diag)
{
    const int count = (int)neph_image_pixel_count(frame);
    struct parted truth = {.depth = neph_image_channel(frame, "Z")};
    struct neph_scene *first = NULL;
    int surfaces = 0;
    const enum neph_status status = neph_scene_at(scene, 0.0, &first, diag);
    if (status)
        return status;
    const struct neph_camera camera = neph_scene_camera(first, 0.0);
    for (int part = 0; part < NEPH_SCREEN_PARTS; part++)
        truth.has[part] = find_layers(&(struct compared){.truth = frame},
                                      (enum neph_screen_part)part, &truth.layers[part]);
    for (int p = 0; p < count; p++)
        surfaces += isfinite(truth.depth[p]);
    for (int p = 0; p < count; p++) {
        double shares[NEPH_SCREEN_PARTS][NEPH_SCREEN_LOSSES];
        mark_pixel(study, first, &camera, &truth, p, shares, result);
        for (int i = 0; i < NEPH_SCREEN_LOSSES; i++) {
            result->near[i] += shares[NEPH_SCREEN_AO][i] / surfaces;
            result->far[i] += shares[NEPH_SCREEN_DIFFUSE][i] / surfaces;
        }
    }
    neph_scene_destroy(first);
    return NEPH_OK;
}

/* The grey image under the marks: half the brightness, plus an offset. */
static enum neph_status show(const struct neph_scene *scene, const struct neph_image *frame,
                             uint8_t *grey, struct neph_diag *diag)
{
    const size_t count = neph_image_pixel_count(frame);
    float *planes[3];
    uint8_t *rgb = malloc(3 * count);
    if (!rgb)
        return neph_fail_memory(diag);
    enum neph_status status = neph_image_rgb(frame, NULL, planes)
                                  ? NEPH_OK
                                  : neph_fail(diag, NEPH_ERR_INTERNAL, "a truth without radiance");
    const float *const constant[3] = {planes[0], planes[1], planes[2]};
    if (!status)
        status = neph_display_encode(constant, count, neph_scene_display(scene)->exposure_ev, rgb,
                                     diag);
    for (size_t p = 0; p < count && !status; p++)
        grey[p] = (uint8_t)(80 + (2 * rgb[3 * p] + 5 * rgb[3 * p + 1] + rgb[3 * p + 2]) / 16);
    free(rgb);
    return status;
}

static void measure_gaps(const struct compared *compared,
                         struct neph_screen_gap gaps[NEPH_SCREEN_PARTS])
{
    for (int part = 0; part < NEPH_SCREEN_PARTS; part++) {
        struct sums sums;
        const bool is_there = sum_up(compared, (enum neph_screen_part)part, &sums);
        gaps[part] = summarize_gap(&sums, is_there && sums.pixels > 0);
    }
}

/* The references of a scene: each frame, and Cycles if requested and supported. */
struct known {
    struct neph_image *truth, *cycles; /* owned */
    struct neph_image **frames;        /* owned; a single frame for a static scene */
    int count, frame_count;            /* frames of the sequence; elements of `frames` */
};

/* ---- flicker --------------------------------------------------------------------------------- */

/* Set the number of frames that the scene has, and the number of distinct ones. A solid with a
 * single, constant rotation counts as motion, too. */
static void count_frames(const struct neph_scene *scene, int wanted, struct known *known)
{
    const bool moves = scene->frame_count > 1 &&
                       (neph_scene_moves(scene) || scene->camera_key_count > 1);
    known->count = moves && wanted > scene->frame_count ? scene->frame_count : wanted;
    known->frame_count = moves ? known->count : 1;
}

static enum neph_status render_truths(const struct neph_screen_study *study,
                                      const struct neph_scene *scene, struct known *known,
                                      struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    if (study->request->frame_count == 0)
        return NEPH_OK;
    count_frames(scene, study->request->frame_count, known);
    known->frames = calloc((size_t)known->frame_count, sizeof(*known->frames));
    if (!known->frames)
        return neph_fail_memory(diag);
    for (int i = 0; i < known->frame_count && !status; i++)
        status = render(study, &study->truth, scene, i, &known->frames[i], diag);
    return status;
}

static void free_frames(struct neph_image **frames, int count)
{
    for (int i = 0; i < count && frames; i++)
        neph_image_destroy(frames[i]);
    free(frames);
}

/* Render a model's sequence; `*ms` is the median time of the device for a frame. */
static enum neph_status render_sequence(const struct neph_screen_study *study, int model,
                                        const struct neph_scene *scene, struct neph_image **frames,
                                        int count, double *ms, struct neph_diag *diag)
{
    const struct neph_shot shot = make_frame_shot(study, scene, 0);
    struct neph_job job = neph_light_model_job(&study->models[model], &shot);
    double *seconds = calloc((size_t)count, sizeof(*seconds));
    enum neph_status status = seconds ? neph_job_open(&job, diag) : neph_fail_memory(diag);
    for (int i = 0; i < count && !status; i++) {
        struct neph_cost cost;
        job.shot.frame = i;
        status = neph_job_render(&job, &frames[i], &cost, diag);
        seconds[i] = cost.render_s;
    }
    if (!status)
        *ms = 1e3 * neph_spread_compute(seconds, count).median;
    neph_job_close(&job);
    free(seconds);
    return status;
}

/* Measure display errors with Unreal's tone curve, at the automatic exposure of the reference. */
static enum neph_status measure_frames(const struct neph_screen_study *study,
                                       const struct neph_scene *scene, const struct known *known,
                                       struct neph_image *const *frames,
                                       struct neph_post_numbers *numbers, struct neph_diag *diag)
{
    const struct neph_post_sequence_pair film = {
        .tests = (const struct neph_image *const *)frames,
        .references = (const struct neph_image *const *)known->frames,
        .count = known->count,
        .reference_count = known->frame_count,
        .frame_rate_hz = scene->frame_rate_hz,
    };
    struct neph_settings settings = neph_options_default(neph_post_options);
    settings.values[POST_TONE] = 1.0;
    const enum neph_status status = neph_post_meter(study->device->vulkan, known->frames[0],
                                                    &settings.values[POST_EXPOSURE_EV], diag);
    return status ? status
                  : neph_post_measure(study->device->vulkan, &film, &settings, numbers, diag);
}

static enum neph_status measure_flicker(const struct neph_screen_study *study, int model,
                                        const struct neph_scene *scene, const struct known *known,
                                        struct neph_post_numbers *numbers, struct neph_diag *diag)
{
    struct neph_image **frames = calloc((size_t)known->count, sizeof(*frames));
    double ms = NAN;
    enum neph_status status = frames ? render_sequence(study, model, scene, frames, known->count,
                                                       &ms, diag)
                                     : neph_fail_memory(diag);
    if (!status)
        status = measure_frames(study, scene, known, frames, numbers, diag);
    if (!status)
        numbers->ms = ms;
    free_frames(frames, known->count);
    return status;
}

/* ---- models ---------------------------------------------------------------------------------- */

static enum neph_status run_model(struct neph_screen_study *study, int model, int s,
                                  const struct known *known, struct neph_diag *diag)
{
    const struct neph_scene *scene = study->request->scenes[s];
    struct neph_screen_scene *result = &study->scenes[s];
    struct neph_image *frame = NULL;
    enum neph_status status = render(study, &study->models[model], scene, 0, &frame, diag);
    if (!status)
        measure_gaps(&(struct compared){known->truth, NULL, frame}, result->gaps[model]);
    if (!status && known->cycles)
        measure_gaps(&(struct compared){known->truth, known->cycles, frame},
                     result->against_cycles[model]);
    neph_image_destroy(frame);
    return status || !known->frames || study->request->is_part
               ? status
               : measure_flicker(study, model, scene, known, &study->flicker[s][model], diag);
}

/* Render the second reference. Cycles does not find light that a mirror reflects onto surfaces;
 * scenes that it cannot render have no second reference. */
static enum neph_status run_cycles(const struct neph_screen_study *study,
                                   const struct neph_scene *scene, struct known *known,
                                   struct neph_screen_scene *result, struct neph_diag *diag)
{
    const struct neph_light_model *cycles = &study->cycles;
    for (int part = 0; part < NEPH_SCREEN_PARTS; part++) {
        result->cycles[part] = summarize_gap(&(struct sums){0}, false);
        for (int model = 0; model < study->request->models.count; model++)
            result->against_cycles[model][part] = result->cycles[part];
    }
    if (study->request->cycles_samples == 0 ||
        !cycles->engine->can_render(scene, &cycles->settings, result->cycles_cannot,
                                    sizeof(result->cycles_cannot)))
        return NEPH_OK;
    const enum neph_status status = render(study, cycles, scene, 0, &known->cycles, diag);
    if (!status)
        measure_gaps(&(struct compared){known->truth, NULL, known->cycles}, result->cycles);
    return status;
}

/* ---- scenes ---------------------------------------------------------------------------------- */

/* Measure the lost parts of the reference, which need no model. */
static enum neph_status measure_truth(struct neph_screen_study *study,
                                      const struct neph_scene *scene,
                                      const struct neph_image *truth,
                                      struct neph_screen_scene *result, struct neph_diag *diag)
{
    const size_t count = neph_image_pixel_count(truth);
    for (int part = 0; part < NEPH_SCREEN_PARTS; part++) {
        struct sums sums;
        if (sum_up(&(struct compared){.truth = truth}, (enum neph_screen_part)part, &sums))
            result->truths[part] = summarize_reference(&sums);
        result->marks[part] = neph_arena_allocate(&study->arena, count, 1);
    }
    result->seen = neph_arena_allocate(&study->arena, count, 1);
    enum neph_status status = neph_arena_check(&study->arena, diag);
    if (!status)
        status = show(scene, truth, result->seen, diag);
    return status ? status : find_lost_pixels(study, scene, truth, result, diag);
}

static enum neph_status run_scene(struct neph_screen_study *study, int s, struct neph_diag *diag)
{
    const struct neph_scene *scene = study->request->scenes[s];
    struct neph_screen_scene *result = &study->scenes[s];
    struct known known = {NULL};
    neph_progress_begin(&study->progress, scene->name);
    enum neph_status status = render(study, &study->truth, scene, 0, &known.truth, diag);
    if (!status && !study->request->is_part)
        status = measure_truth(study, scene, known.truth, result, diag);
    if (!status)
        status = run_cycles(study, scene, &known, result, diag);
    if (!status)
        status = render_truths(study, scene, &known, diag);
    result->frame_count = known.count;
    for (int model = 0; model < study->request->models.count && !status; model++)
        status = run_model(study, model, s, &known, diag);
    if (!status)
        neph_progress_over(&study->progress, scene->name, "measured");
    free_frames(known.frames, known.frame_count);
    neph_image_destroy(known.cycles);
    neph_image_destroy(known.truth);
    return status;
}

/* ---- the study ------------------------------------------------------------------------------- */

static enum neph_status prepare_truth(const struct neph_screen_study *study,
                                      const struct neph_engine *engine, int samples,
                                      struct neph_light_model *truth, struct neph_diag *diag)
{
    *truth = neph_light_model_default(engine, study->run->device);
    if (!truth->info.available)
        return neph_fail(diag, NEPH_ERR_UNAVAILABLE, "%s: %s", engine->name, truth->info.missing);
    const enum neph_status status = neph_light_model_set(truth, "samples", samples, diag);
    return status ? status
                  : neph_light_model_set(truth, "ao_distance_m", study->request->radius_m, diag);
}

static enum neph_status prepare_model(struct neph_screen_study *study, int index,
                                      struct neph_diag *diag)
{
    const char *words = study->request->models.words[index];
    struct neph_light_model *model = &study->models[index];
    enum neph_status status = neph_light_model_parse(words, 1, study->run->device, model, diag);
    if (!status && model->engine != &neph_engine_screen)
        status = neph_fail(diag, NEPH_ERR_USAGE,
                           "'%s' is no screen: models are screen, with settings as in "
                           "screen+ao=ssao",
                           words);
    return status ? status
                  : neph_light_model_set(model, "ao_radius_m", study->request->radius_m, diag);
}

static enum neph_status prepare(struct neph_screen_study *study, struct neph_diag *diag)
{
    const struct neph_screen_request *request = study->request;
    struct neph_light_model *cycles = &study->cycles;
    enum neph_status status = prepare_truth(study, &neph_engine_surfaces, request->samples,
                                            &study->truth, diag);
    for (int i = 0; i < request->models.count && !status; i++)
        status = prepare_model(study, i, diag);
    if (!status && request->cycles_samples > 0)
        status = prepare_truth(study, neph_engine_find("cycles"), request->cycles_samples, cycles,
                               diag);
    if (!status && request->cycles_samples > 0)
        status = neph_settings_set(cycles->engine, &cycles->settings, "surface_layers=on", diag);
    return status || request->frame_count == 0 || request->is_part
               ? status
               : neph_device_acquire(study->run->device, &study->device, diag);
}

enum neph_status neph_screen_measure(struct neph_screen_study *study, struct neph_diag *diag)
{
    study->progress = neph_progress_start(study->run->quiet, 0);
    neph_progress_expect(&study->progress, 0, study->request->scene_count, scene_typical_s);
    enum neph_status status = prepare(study, diag);
    for (int s = 0; s < study->request->scene_count && !status; s++)
        status = run_scene(study, s, diag);
    neph_progress_end(&study->progress);
    neph_device_release(study->device);
    if (status == NEPH_ERR_INTERRUPTED)
        neph_hint(diag, "finished frames are in the store: the same command continues from there");
    return status;
}
