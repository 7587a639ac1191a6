/* SPDX-License-Identifier: MIT */
#include "harness/study/light_study.h"

#include "base/clock.h"
#include "base/exr.h"
#include "harness/data.h"
#include "harness/engines/engines.h"
#include "harness/progress.h"
#include "harness/run/noise.h"
#include "harness/run/seed.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_LIGHT_PARTS == 2, "a new kind");

/* A guess before the first is over, on two cores. */
static const double cell_typical_s = 15.0;

struct work {
    const struct neph_light_study_params *params;
    struct neph_light_study *study;
    struct neph_store *store;
    struct neph_progress progress;
    const struct neph_engine *tracer;
    struct neph_engine_info tracer_info;
    struct neph_light_model models[NEPH_LIGHT_MODELS_MAX];
};

static struct neph_job make_job(const struct work *work, const struct neph_scene *scene)
{
    return (struct neph_job){.shot = {.scene = scene,
                                      .width_px = work->params->width_px,
                                      .height_px = work->params->height_px,
                                      .layers = NEPH_LAYERS_ALL,
                                      .seed = 1,
                                      .time_limit_s = INFINITY,
                                      .device = work->params->device}};
}

/* ---- pictures -------------------------------------------------------------------------------- */

/* A picture from the store, or rendered; `*seconds` that its rendering took are added. */
static enum neph_status take_picture(const struct neph_job *job, struct neph_store *store,
                                     struct neph_image **picture, double *seconds,
                                     struct neph_diag *diag)
{
    struct neph_job_result result = {.settings = NULL};
    enum neph_status status = neph_job_run(job, store, &result, diag);
    if (!status)
        status = neph_outcome_check(result.outcome, result.reason, diag);
    if (!status)
        status = neph_exr_read(result.frame_path, picture, diag);
    if (!status)
        *seconds += result.cost.render_s;
    neph_job_result_finish(&result);
    return status;
}

static enum neph_status trace(const struct work *work, const struct neph_scene *scene, int number,
                              struct neph_image **picture, double *seconds, struct neph_diag *diag)
{
    char noise[48], samples[48];
    struct neph_job job = make_job(work, scene);
    job.engine = work->tracer;
    job.info = &work->tracer_info;
    job.shot.seed = neph_seed_of(scene, number);
    job.shot.settings = neph_settings_default(work->tracer);
    snprintf(noise, sizeof(noise), "target_error=%.17g", work->params->noise);
    snprintf(samples, sizeof(samples), "samples=%d", work->params->samples);
    enum neph_status status = neph_settings_set(job.engine, &job.shot.settings, noise, diag);
    if (!status)
        status = neph_settings_set(job.engine, &job.shot.settings, samples, diag);
    return status ? status : take_picture(&job, work->store, picture, seconds, diag);
}

/* Radiance of the media in a pixel. */
static double radiance_of(float *const volume[3], int pixel)
{
    return ((double)volume[0][pixel] + (double)volume[1][pixel] + (double)volume[2][pixel]) / 3.0;
}

/* ---- a model in a cell ----------------------------------------------------------------------- */

static void add_pixel(struct neph_light_study *study, int model,
                      const struct neph_light_pixel *pixel, double radiance,
                      struct neph_light_gap *gap)
{
    const int eye = neph_light_bin(NEPH_LIGHT_EYE, pixel->view.eye_depth);
    const int sun = neph_light_bin(NEPH_LIGHT_SUN, pixel->view.sun_depth);
    const int angle = neph_light_bin(NEPH_LIGHT_ANGLE, pixel->view.angle_rad / NEPH_RAD_PER_DEG);
    if (eye < 0)
        return;
    neph_light_sums_add(&gap->all, radiance, pixel->first, pixel->second);
    if (exp(-pixel->view.eye_depth) < NEPH_LIGHT_DENSE_TRANSMITTANCE)
        neph_light_sums_add(&gap->dense, radiance, pixel->first, pixel->second);
    if (sun >= 0)
        neph_light_sums_add(&study->eye_sun[model].bins[eye][sun], radiance, pixel->first,
                            pixel->second);
    if (angle >= 0)
        neph_light_sums_add(&study->eye_angle[model].bins[eye][angle], radiance, pixel->first,
                            pixel->second);
}

static enum neph_status measure(struct work *work, const struct neph_light_cell *cell, int model,
                                const struct neph_image *picture, struct neph_light_gap *gap,
                                struct neph_diag *diag)
{
    float *volume[3];
    if (!neph_image_rgb(picture, "volume", volume))
        return neph_fail(diag, NEPH_ERR_ENGINE, "its picture has no light of media");
    for (int p = 0; p < cell->pixel_count; p++)
        add_pixel(work->study, model, &cell->pixels[p], radiance_of(volume, p), gap);
    return NEPH_OK;
}

/* A cell's scene: with all orders of scattering, with one, and with all under a sun that has sunk
 * to its place; NULL where it stands still. */
struct scenes {
    struct neph_scene *multiple, *single, *moving;
};

/* The scene as the model takes it: with all orders of scattering, else with one; NULL, with the
 * reason of the first, where it takes neither. */
static const struct neph_scene *fitting(const struct work *work, int model,
                                        const struct neph_scene *multiple,
                                        const struct neph_scene *single, char *why, size_t size)
{
    char other[NEPH_LIGHT_WHY_SIZE];
    const struct neph_engine *engine = work->models[model].engine;
    const struct neph_settings *settings = &work->models[model].settings;
    if (engine->can_render(multiple, settings, why, size))
        return multiple;
    return engine->can_render(single, settings, other, sizeof(other)) ? single : NULL;
}

static bool remembers(const struct neph_light_model *model)
{
    return neph_option_find(model->engine->options, "warm_up") >= 0;
}

static enum neph_status run_model(struct work *work, struct neph_light_cell *cell, int model,
                                  const struct scenes *scenes, struct neph_diag *diag)
{
    struct neph_light_gap *gap = &cell->gaps[model];
    struct neph_image *picture = NULL;
    const struct neph_scene *scene = fitting(work, model, scenes->multiple, scenes->single,
                                             gap->because, sizeof(gap->because));
    if (!scene)
        return NEPH_OK;
    gap->because[0] = '\0';
    gap->once = scene == scenes->single;
    const bool is_moved = scenes->moving && !gap->once && remembers(&work->models[model]);
    struct neph_job job = make_job(work, is_moved ? scenes->moving : scene);
    job.shot.frame = is_moved ? NEPH_RELIT_FRAMES - 1 : 0;
    job.engine = work->models[model].engine;
    job.info = &work->models[model].info;
    job.shot.settings = work->models[model].settings;
    enum neph_status status = take_picture(&job, work->store, &picture, &gap->render_s, diag);
    if (!status)
        status = measure(work, cell, model, picture, gap, diag);
    neph_image_destroy(picture);
    return status;
}

/* ---- a cell ---------------------------------------------------------------------------------- */

static int compare_doubles(const void *a, const void *b)
{
    const double first = *(const double *)a, second = *(const double *)b;
    return (first > second) - (first < second);
}

/* What a tenth of the pixels with media have more of; NaN where none has. */
static enum neph_status find_depth(struct neph_light_cell *cell, struct neph_diag *diag)
{
    int count = 0;
    double *depths = calloc((size_t)cell->pixel_count, sizeof(*depths));
    if (!depths)
        return neph_fail_memory(diag);
    for (int p = 0; p < cell->pixel_count; p++)
        if (neph_light_bin(NEPH_LIGHT_EYE, cell->pixels[p].view.eye_depth) >= 0)
            depths[count++] = cell->pixels[p].view.eye_depth;
    qsort(depths, (size_t)count, sizeof(*depths), compare_doubles);
    cell->optical_depth = count > 0 ? depths[(count - 1) * 9 / 10] : NAN;
    free(depths);
    return NEPH_OK;
}

static enum neph_status look(const struct work *work, const struct neph_scene *scene,
                             float *const first[3], float *const second[3],
                             struct neph_light_cell *cell, struct neph_diag *diag)
{
    const struct neph_camera camera = neph_scene_camera(scene, 0.0);
    const int width_px = work->params->width_px, height_px = work->params->height_px;
    cell->pixel_count = width_px * height_px;
    cell->pixels = calloc((size_t)cell->pixel_count, sizeof(*cell->pixels));
    if (!cell->pixels)
        return neph_fail_memory(diag);
    for (int p = 0; p < cell->pixel_count; p++) {
        const struct neph_pixel_ray ray = neph_camera_ray(&camera, width_px, height_px,
                                                          p % width_px, p / width_px);
        cell->pixels[p] = (struct neph_light_pixel){
            .view = neph_light_view_of(scene, &ray, work->params->with_lit),
            .first = radiance_of(first, p),
            .second = radiance_of(second, p)};
    }
    return find_depth(cell, diag);
}

static enum neph_status trace_cell(struct work *work, const struct neph_scene *scene,
                                   struct neph_light_cell *cell, struct neph_diag *diag)
{
    struct neph_image *pictures[2] = {NULL, NULL};
    float *first[3], *second[3];
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < 2 && !status; i++)
        status = trace(work, scene, i + 1, &pictures[i], &cell->tracer_s, diag);
    if (!status && !(neph_image_rgb(pictures[0], "volume", first) &&
                     neph_image_rgb(pictures[1], "volume", second)))
        status = neph_fail(diag, NEPH_ERR_ENGINE, "the tracer's picture has no light of media");
    if (!status) {
        cell->noise = neph_noise_of_two(pictures[0], pictures[1]);
        status = look(work, scene, first, second, cell, diag);
    }
    neph_image_destroy(pictures[0]);
    neph_image_destroy(pictures[1]);
    return status;
}

static enum neph_status run_cell(struct work *work, const struct scenes *scenes,
                                 struct neph_light_cell *cell, struct neph_diag *diag)
{
    cell->light = neph_relight_of(scenes->multiple);
    if (!work->tracer->can_render(scenes->multiple, NULL, cell->left_out, sizeof(cell->left_out)))
        return NEPH_OK;
    cell->left_out[0] = '\0';
    enum neph_status status = trace_cell(work, scenes->multiple, cell, diag);
    for (int model = 0; model < work->params->model_count && !status; model++)
        status = run_model(work, cell, model, scenes, diag);
    if (!work->params->with_lit) {
        free(cell->pixels);
        cell->pixels = NULL;
    }
    return status;
}

static enum neph_status light_anew(const struct work *work, const struct neph_scene *scene,
                                   const struct neph_relight *light, struct scenes *scenes,
                                   struct neph_diag *diag)
{
    struct neph_relight sinking = *light;
    sinking.sun_sinks_rad = work->params->sun_speed_rad_per_s * (NEPH_RELIT_FRAMES - 1) / 60.0;
    enum neph_status status = neph_scene_relit(scene, light, NEPH_SCATTERING_MULTIPLE,
                                               &scenes->multiple, diag);
    if (!status)
        status = neph_scene_relit(scene, light, NEPH_SCATTERING_SINGLE, &scenes->single, diag);
    if (!status && sinking.sun_sinks_rad > 0.0)
        status = neph_scene_relit(scene, &sinking, NEPH_SCATTERING_MULTIPLE, &scenes->moving, diag);
    return status;
}

/* What breaks is news of one cell; what ends the run goes on. */
static enum neph_status try_cell(struct work *work, const struct neph_scene *scene,
                                 const struct neph_relight *light, struct neph_light_cell *cell,
                                 struct neph_diag *diag)
{
    char what[200];
    struct neph_diag why = {.line = 0};
    struct scenes scenes = {.multiple = NULL};
    const double start_s = neph_wall_s();
    enum neph_status status = light_anew(work, scene, light, &scenes, &why);
    snprintf(what, sizeof(what), "%s, cell %d of %d", cell->scene,
             (int)(cell - work->study->cells) + 1, work->study->cell_count);
    neph_progress_begin(&work->progress, what);
    if (!status)
        status = run_cell(work, &scenes, cell, &why);
    if (status == NEPH_ERR_ENGINE || status == NEPH_ERR_UNSUPPORTED) {
        work->study->failed_count += status == NEPH_ERR_ENGINE;
        snprintf(cell->left_out, sizeof(cell->left_out), "%.*s", NEPH_LIGHT_WHY_SIZE - 1,
                 why.message);
        status = NEPH_OK;
    }
    if (status && diag)
        *diag = why;
    if (!status)
        neph_progress_step(&work->progress, what, cell->left_out[0] ? "left out" : "measured",
                           neph_wall_s() - start_s);
    neph_scene_destroy(scenes.moving);
    neph_scene_destroy(scenes.single);
    neph_scene_destroy(scenes.multiple);
    return status;
}

/* ---- the whole ------------------------------------------------------------------------------- */

static enum neph_status prepare(struct work *work, struct neph_diag *diag)
{
    const struct neph_light_study_params *params = work->params;
    struct neph_light_study *study = work->study;
    enum neph_status status = NEPH_OK;
    work->tracer = neph_engine_find("tracer");
    neph_engine_probe(work->tracer, params->device, &work->tracer_info);
    for (int model = 0; model < params->model_count && !status; model++) {
        status = neph_light_model_parse(params->models[model], params->steps, params->device,
                                        &work->models[model], diag);
        if (!status)
            study->looks[model] = neph_light_model_is_look(&work->models[model]);
    }
    if (status)
        return status;
    snprintf(study->device, sizeof(study->device), "%s", work->tracer_info.device);
    for (int i = 0; i < params->entry_count; i++)
        study->cell_count += neph_light_entry_count(&params->entries[i]);
    neph_progress_expect(&work->progress, 0, study->cell_count, cell_typical_s);
    study->cells = calloc((size_t)study->cell_count, sizeof(*study->cells));
    return study->cells ? NEPH_OK : neph_fail_memory(diag);
}

/* All cells of an entry have one scene; data that is not here is news of them all. */
static enum neph_status run_entry(struct work *work, const struct neph_light_entry *entry,
                                  struct neph_light_cell *cells, struct neph_diag *diag)
{
    struct neph_scene *scene = NULL;
    struct neph_diag why = {.line = 0};
    enum neph_status status = neph_data_load_scene(entry->scene, &scene, &why);
    const bool is_absent = status == NEPH_ERR_NOT_FOUND && entry->may_be_absent;
    if (status && !is_absent && diag)
        *diag = why;
    if (is_absent)
        status = NEPH_OK;
    for (int i = 0; i < neph_light_entry_count(entry) && !status; i++) {
        const struct neph_relight light = neph_light_entry_at(entry, i);
        cells[i].scene = neph_scene_name_of(scene ? scene->path : entry->scene);
        cells[i].light = light;
        cells[i].optical_depth = NAN;
        if (!cells[i].scene)
            status = neph_fail_memory(diag);
        else if (is_absent)
            snprintf(cells[i].left_out, sizeof(cells[i].left_out), "%.*s", NEPH_LIGHT_WHY_SIZE - 1,
                     why.message);
        else
            status = try_cell(work, scene, &light, &cells[i], diag);
    }
    neph_scene_destroy(scene);
    return status;
}

enum neph_status neph_light_study_run(const struct neph_light_study_params *params,
                                      struct neph_store *store, struct neph_light_study *study,
                                      struct neph_diag *diag)
{
    struct work work = {.params = params,
                        .study = study,
                        .store = store,
                        .progress = neph_progress_start(params->quiet, 0)};
    *study = (struct neph_light_study){.params = params};
    enum neph_status status = prepare(&work, diag);
    struct neph_light_cell *cells = study->cells;
    for (int i = 0; i < params->entry_count && !status; i++) {
        status = run_entry(&work, &params->entries[i], cells, diag);
        cells += neph_light_entry_count(&params->entries[i]);
    }
    neph_progress_end(&work.progress);
    if (status == NEPH_ERR_INTERRUPTED)
        neph_hint(diag, "what is finished is in the store: the same command goes on from there");
    return status;
}

void neph_light_study_finish(struct neph_light_study *study)
{
    for (int i = 0; i < study->cell_count && study->cells; i++) {
        free(study->cells[i].scene);
        free(study->cells[i].pixels);
    }
    free(study->cells);
    *study = (struct neph_light_study){.params = NULL};
}

/* ---- verdicts -------------------------------------------------------------------------------- */

const char *neph_light_part_name(enum neph_light_part part)
{
    static const char *const names[NEPH_LIGHT_PARTS] = {"dense parts", "whole picture"};
    return names[part];
}

const struct neph_light_sums *neph_light_part_of(const struct neph_light_gap *gap,
                                                 enum neph_light_part part)
{
    return part == NEPH_LIGHT_DENSE ? &gap->dense : &gap->all;
}

bool neph_light_counts(const struct neph_light_sums *sums)
{
    return sums->count >= NEPH_LIGHT_PIXELS_MIN && !isnan(neph_light_bias(sums));
}

void neph_light_verdict_add(struct neph_light_verdict *verdict, const struct neph_light_sums *sums)
{
    const double bias = fabs(neph_light_bias(sums)), rms = neph_light_rms(sums);
    verdict->cell_count++;
    verdict->mean_bias += bias;
    verdict->worst_bias = fmax(verdict->worst_bias, bias);
    verdict->mean_rms += rms;
    verdict->share_within += bias <= NEPH_LIGHT_BIAS_WANTED;
    verdict->share_near += bias <= NEPH_LIGHT_BIAS_WORST_WANTED;
    verdict->share_smooth += rms <= NEPH_LIGHT_RMS_WANTED;
}

void neph_light_verdict_end(struct neph_light_verdict *verdict)
{
    const double count = verdict->cell_count; /* 0 makes NaN of all but the worst */
    verdict->mean_bias /= count;
    verdict->mean_rms /= count;
    verdict->share_within /= count;
    verdict->share_near /= count;
    verdict->share_smooth /= count;
    if (verdict->cell_count == 0)
        verdict->worst_bias = NAN;
}

struct neph_light_verdict
neph_light_verdict_of(const struct neph_light_study *study, int model, enum neph_light_part part,
                      bool (*counts)(const struct neph_light_cell *cell, const void *context),
                      const void *context)
{
    struct neph_light_verdict verdict = {.cell_count = 0};
    for (int i = 0; i < study->cell_count; i++) {
        const struct neph_light_cell *cell = &study->cells[i];
        const struct neph_light_sums *sums = neph_light_part_of(&cell->gaps[model], part);
        if (neph_light_counts(sums) && (!counts || counts(cell, context)))
            neph_light_verdict_add(&verdict, sums);
    }
    neph_light_verdict_end(&verdict);
    return verdict;
}
