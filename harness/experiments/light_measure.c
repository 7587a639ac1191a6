/* SPDX-License-Identifier: MIT */
#include "harness/experiments/light.h"

#include "base/sort.h"
#include "harness/data.h"
#include "harness/engines/engines.h"
#include "harness/run/noise.h"
#include "harness/run/seed.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Compiles only when this file handles every part. */
_Static_assert(NEPH_LIGHT_PARTS == 2, "a new kind");

/* Estimate for two cores, until the first cell is done. */
static const double cell_typical_s = 15.0;

/* Target values of the project for lighting models. */
static const double bias_wanted = 0.05, worst_bias_wanted = 0.15, rms_wanted = 0.15;

static struct neph_shot make_cell_shot(const struct neph_light_study *study,
                                       const struct neph_scene *scene)
{
    return (struct neph_shot){.scene = scene,
                              .width_px = study->request->shared.size.width_px,
                              .height_px = study->request->shared.size.height_px,
                              .layers = NEPH_LAYERS_ALL,
                              .seed = 1,
                              .device = study->run->device};
}

/* Radiance of the media in a pixel, averaged over the channels. */
static double compute_mean_radiance(float *const volume[3], int pixel)
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

static enum neph_status measure_model(struct neph_light_study *study,
                                      const struct neph_light_cell *cell, int model,
                                      const struct neph_image *frame, struct neph_light_gap *gap,
                                      struct neph_diag *diag)
{
    float *volume[3];
    if (!neph_image_rgb(frame, "volume", volume))
        return neph_fail(diag, NEPH_ERR_ENGINE, "its frame has no radiance of media");
    for (int p = 0; p < cell->pixel_count; p++)
        add_pixel(study, model, &cell->pixels[p], compute_mean_radiance(volume, p), gap);
    return NEPH_OK;
}

/* The variants of a cell's scene: multiple scattering, single scattering, and multiple scattering
 * with a sinking sun (NULL: the sun is static). */
struct scenes {
    struct neph_scene *multiple, *single, *moving;
};

/* Render a model with multiple scattering if it supports that, else with single scattering. Only a
 * model with a warm-up has a history, and may get the sinking sun. */
static enum neph_status run_model(struct neph_light_study *study, struct neph_light_cell *cell,
                                  int index, const struct scenes *scenes, struct neph_diag *diag)
{
    const struct neph_light_model *model = &study->models[index];
    struct neph_light_gap *gap = &cell->gaps[index];
    struct neph_image *frame = NULL;
    char why[NEPH_LIGHT_WHY_SIZE];
    gap->once = !model->engine->can_render(scenes->multiple, &model->settings, gap->because,
                                           sizeof(gap->because));
    if (gap->once &&
        !model->engine->can_render(scenes->single, &model->settings, why, sizeof(why))) {
        gap->once = false;
        return NEPH_OK;
    }
    gap->because[0] = '\0';
    const bool is_moved = scenes->moving && !gap->once &&
                          neph_option_find(model->engine->options, "warm_up") >= 0;
    struct neph_shot shot = make_cell_shot(study, is_moved    ? scenes->moving
                                                  : gap->once ? scenes->single
                                                              : scenes->multiple);
    shot.frame = is_moved ? NEPH_RELIT_FRAMES - 1 : 0;
    enum neph_status status = neph_light_model_render(model, &shot, study->run->store, &frame,
                                                      &gap->render_s, diag);
    if (!status)
        status = measure_model(study, cell, index, frame, gap, diag);
    neph_image_destroy(frame);
    return status;
}

/* ---- a cell ---------------------------------------------------------------------------------- */

/* The 90th percentile of the optical depth over the pixels with media; NaN without any. */
static enum neph_status find_depth(struct neph_light_cell *cell, struct neph_diag *diag)
{
    int count = 0;
    double *depths = calloc((size_t)cell->pixel_count, sizeof(*depths));
    if (!depths)
        return neph_fail_memory(diag);
    for (int p = 0; p < cell->pixel_count; p++)
        if (neph_light_bin(NEPH_LIGHT_EYE, cell->pixels[p].view.eye_depth) >= 0)
            depths[count++] = cell->pixels[p].view.eye_depth;
    neph_sort_doubles(depths, (size_t)count);
    cell->optical_depth = count > 0 ? depths[(count - 1) * 9 / 10] : NAN;
    free(depths);
    return NEPH_OK;
}

static enum neph_status find_pixels(const struct neph_light_study *study,
                                    const struct neph_scene *scene, float *const first[3],
                                    float *const second[3], struct neph_light_cell *cell,
                                    struct neph_diag *diag)
{
    const struct neph_camera camera = neph_scene_camera(scene, 0.0);
    const struct neph_cli_size *size = &study->request->shared.size;
    const int width_px = size->width_px, height_px = size->height_px;
    cell->pixel_count = width_px * height_px;
    cell->pixels = calloc((size_t)cell->pixel_count, sizeof(*cell->pixels));
    if (!cell->pixels)
        return neph_fail_memory(diag);
    for (int p = 0; p < cell->pixel_count; p++) {
        const struct neph_pixel_ray ray = neph_camera_ray(&camera, width_px, height_px,
                                                          p % width_px, p / width_px);
        cell->pixels[p] = (struct neph_light_pixel){
            .view = neph_light_view_compute(scene, &ray, study->request->fit != NULL),
            .first = compute_mean_radiance(first, p),
            .second = compute_mean_radiance(second, p)};
    }
    return find_depth(cell, diag);
}

static enum neph_status trace_cell(const struct neph_light_study *study,
                                   const struct neph_scene *scene, struct neph_light_cell *cell,
                                   struct neph_diag *diag)
{
    struct neph_image *frames[2] = {NULL, NULL};
    float *first[3], *second[3];
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < 2 && !status; i++) {
        struct neph_shot shot = make_cell_shot(study, scene);
        shot.seed = neph_seed_for_scene(scene, i + 1);
        status = neph_light_model_render(&study->tracer, &shot, study->run->store, &frames[i],
                                         &cell->tracer_s, diag);
    }
    if (!status && !(neph_image_rgb(frames[0], "volume", first) &&
                     neph_image_rgb(frames[1], "volume", second)))
        status = neph_fail(diag, NEPH_ERR_ENGINE, "the tracer's frame has no radiance of media");
    if (!status && study->request->only_cell < 0) {
        cell->noise = neph_noise_from_two_seeds(frames[0], frames[1]);
        status = find_pixels(study, scene, first, second, cell, diag);
    }
    neph_image_destroy(frames[0]);
    neph_image_destroy(frames[1]);
    return status;
}

static enum neph_status run_cell(struct neph_light_study *study, const struct scenes *scenes,
                                 struct neph_light_cell *cell, struct neph_diag *diag)
{
    cell->light = neph_relight_from_scene(scenes->multiple);
    if (!study->tracer.engine->can_render(scenes->multiple, NULL, cell->left_out,
                                          sizeof(cell->left_out)))
        return NEPH_OK;
    cell->left_out[0] = '\0';
    enum neph_status status = trace_cell(study, scenes->multiple, cell, diag);
    for (int model = 0; model < study->request->models.count && !status; model++)
        status = run_model(study, cell, model, scenes, diag);
    if (!study->request->fit) {
        free(cell->pixels);
        cell->pixels = NULL;
    }
    return status;
}

static enum neph_status make_relit_scenes(const struct neph_light_study *study,
                                          const struct neph_scene *scene,
                                          const struct neph_relight *light, struct scenes *scenes,
                                          struct neph_diag *diag)
{
    struct neph_relight sinking = *light;
    sinking.sun_sinks_rad = study->request->sun_speed_deg_per_s * NEPH_RAD_PER_DEG *
                            (NEPH_RELIT_FRAMES - 1) / 60.0;
    enum neph_status status = neph_scene_relit(scene, light, NEPH_SCATTERING_MULTIPLE,
                                               &scenes->multiple, diag);
    if (!status)
        status = neph_scene_relit(scene, light, NEPH_SCATTERING_SINGLE, &scenes->single, diag);
    if (!status && sinking.sun_sinks_rad > 0.0)
        status = neph_scene_relit(scene, &sinking, NEPH_SCATTERING_MULTIPLE, &scenes->moving, diag);
    return status;
}

/* Measure a cell. An engine failure is recorded in the cell; errors that end the run are
 * returned. */
static enum neph_status try_cell(struct neph_light_study *study, const struct neph_scene *scene,
                                 const struct neph_relight *light, struct neph_light_cell *cell,
                                 struct neph_diag *diag)
{
    char what[200];
    struct neph_diag why = {.line = 0};
    struct scenes scenes = {.multiple = NULL};
    snprintf(what, sizeof(what), "%s, cell %d of %d", cell->scene, (int)(cell - study->cells) + 1,
             study->cell_count);
    neph_progress_begin(&study->progress, what);
    enum neph_status status = make_relit_scenes(study, scene, light, &scenes, &why);
    if (!status)
        status = run_cell(study, &scenes, cell, &why);
    if (status == NEPH_ERR_ENGINE || status == NEPH_ERR_UNSUPPORTED) {
        study->failed_count += status == NEPH_ERR_ENGINE;
        snprintf(cell->left_out, sizeof(cell->left_out), "%.*s", NEPH_LIGHT_WHY_SIZE - 1,
                 why.message);
        status = NEPH_OK;
    }
    if (status && diag)
        *diag = why;
    if (!status)
        neph_progress_over(&study->progress, what, cell->left_out[0] ? "left out" : "measured");
    neph_scene_destroy(scenes.moving);
    neph_scene_destroy(scenes.single);
    neph_scene_destroy(scenes.multiple);
    return status;
}

/* ---- the study ------------------------------------------------------------------------------- */

int neph_light_cell_count(const struct neph_light_request *request)
{
    int count = 0;
    for (int i = 0; i < request->entry_count; i++)
        count += neph_light_entry_count(&request->entries[i]);
    return count;
}

static enum neph_status prepare(struct neph_light_study *study, struct neph_diag *diag)
{
    const struct neph_light_request *request = study->request;
    struct neph_shared_device *device = study->run->device;
    study->tracer = neph_light_model_default(neph_engine_find("tracer"), device);
    enum neph_status status = neph_light_model_set(&study->tracer, "target_error", request->noise,
                                                   diag);
    if (!status)
        status = neph_light_model_set(&study->tracer, "samples", request->samples, diag);
    for (int model = 0; model < request->models.count && !status; model++)
        status = neph_light_model_parse(request->models.words[model], request->steps, device,
                                        &study->models[model], diag);
    if (status)
        return status;
    study->cell_count = neph_light_cell_count(request);
    neph_progress_expect(&study->progress, 0, study->cell_count, cell_typical_s);
    study->cells = calloc((size_t)study->cell_count, sizeof(*study->cells));
    return study->cells ? NEPH_OK : neph_fail_memory(diag);
}

static enum neph_status run_cells(struct neph_light_study *study,
                                  const struct neph_light_entry *entry,
                                  const struct neph_scene *scene, const char *absent,
                                  struct neph_light_cell *cells, struct neph_diag *diag)
{
    const int only = study->request->only_cell;
    char *name = neph_scene_name_from_path(scene ? scene->path : entry->scene);
    const char *kept = neph_arena_copy_text(&study->arena, name);
    enum neph_status status = name ? neph_arena_check(&study->arena, diag) : neph_fail_memory(diag);
    free(name);
    for (int i = 0; i < neph_light_entry_count(entry) && !status; i++) {
        struct neph_light_cell *cell = &cells[i];
        const struct neph_relight light = neph_light_entry_at(entry, i);
        if (only >= 0 && cell - study->cells != only)
            continue;
        cell->scene = kept;
        cell->light = light;
        cell->optical_depth = NAN;
        if (scene)
            status = try_cell(study, scene, &light, cell, diag);
        else
            snprintf(cell->left_out, sizeof(cell->left_out), "%.*s", NEPH_LIGHT_WHY_SIZE - 1,
                     absent);
    }
    return status;
}

/* All cells of an entry share one scene, so missing data affects all of them. */
static enum neph_status run_entry(struct neph_light_study *study,
                                  const struct neph_light_entry *entry,
                                  struct neph_light_cell *cells, struct neph_diag *diag)
{
    struct neph_scene *scene = NULL;
    struct neph_diag why = {.line = 0};
    enum neph_status status = neph_data_load_scene(entry->scene, &scene, &why);
    if (status == NEPH_ERR_NOT_FOUND && entry->may_be_absent)
        status = NEPH_OK;
    if (status && diag)
        *diag = why;
    if (!status)
        status = run_cells(study, entry, scene, why.message, cells, diag);
    neph_scene_destroy(scene);
    return status;
}

enum neph_status neph_light_measure(struct neph_light_study *study, struct neph_diag *diag)
{
    const struct neph_light_request *request = study->request;
    study->progress = neph_progress_start(study->run->quiet, 0);
    enum neph_status status = prepare(study, diag);
    int first = 0; /* first cell of the entry */
    for (int i = 0; i < request->entry_count && !status; i++) {
        const int end = first + neph_light_entry_count(&request->entries[i]);
        if (request->only_cell < 0 || (request->only_cell >= first && request->only_cell < end))
            status = run_entry(study, &request->entries[i], study->cells + first, diag);
        first = end;
    }
    neph_progress_end(&study->progress);
    if (status == NEPH_ERR_INTERRUPTED)
        neph_hint(diag, "finished frames are in the store: the same command continues from there");
    return status;
}

void neph_light_study_finish(struct neph_light_study *study)
{
    for (int i = 0; i < study->cell_count && study->cells; i++)
        free(study->cells[i].pixels);
    free(study->cells);
    neph_arena_finish(&study->arena);
}

/* ---- verdicts -------------------------------------------------------------------------------- */

const struct neph_light_sums *neph_light_part_sums(const struct neph_light_gap *gap,
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
    verdict->mean_signed_bias += neph_light_bias(sums);
    verdict->worst_bias = fmax(verdict->worst_bias, bias);
    verdict->mean_rms += rms;
    verdict->share_within += bias <= bias_wanted;
    verdict->share_near += bias <= worst_bias_wanted;
    verdict->share_smooth += rms <= rms_wanted;
}

void neph_light_verdict_end(struct neph_light_verdict *verdict)
{
    const double count = verdict->cell_count; /* 0 gives NaN */
    verdict->mean_bias /= count;
    verdict->mean_signed_bias /= count;
    verdict->mean_rms /= count;
    verdict->share_within /= count;
    verdict->share_near /= count;
    verdict->share_smooth /= count;
    if (verdict->cell_count == 0)
        verdict->worst_bias = NAN;
}

struct neph_light_verdict
neph_light_find_verdict(const struct neph_light_study *study, int model, enum neph_light_part part,
                        bool (*counts)(const struct neph_light_cell *cell, const void *context),
                        const void *context)
{
    struct neph_light_verdict verdict = {.cell_count = 0};
    for (int i = 0; i < study->cell_count; i++) {
        const struct neph_light_cell *cell = &study->cells[i];
        const struct neph_light_sums *sums = neph_light_part_sums(&cell->gaps[model], part);
        if (neph_light_counts(sums) && (!counts || counts(cell, context)))
            neph_light_verdict_add(&verdict, sums);
    }
    neph_light_verdict_end(&verdict);
    return verdict;
}
