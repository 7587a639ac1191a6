/* SPDX-License-Identifier: MIT */
#include "harness/study/sky_study.h"

#include "base/clock.h"
#include "base/exr.h"
#include "harness/engines/engines.h"
#include "harness/progress.h"
#include "harness/run/seed.h"
#include "scenes/skyward.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Towards the sun and away from it; from -35 to 75 degrees in the middle of a picture, in its
 * corners to the zenith. */
enum { VIEWS = 2 };
static const double view_azimuths_deg[VIEWS] = {0.0, 180.0};
static const double view_pitch_deg = 20.0, view_fov_deg = 110.0;
static const double cell_typical_s = 20.0;

struct work {
    const struct neph_sky_study_params *params;
    struct neph_sky_study *study;
    struct neph_store *store;
    struct neph_progress progress;
    struct neph_light_model truth; /* of any rung */
    struct neph_light_model models[NEPH_LIGHT_MODELS_MAX];
};

/* A cell at work: the scenes of its views, and the truth of two seeds in each. */
struct sight {
    struct neph_scene *scenes[VIEWS];
    struct neph_image *truths[VIEWS][2];
};

/* ---- pictures -------------------------------------------------------------------------------- */

/* A picture from the store, or rendered; `*seconds` that its rendering took are added. */
static enum neph_status take_picture(const struct work *work, const struct neph_engine *engine,
                                     const struct neph_engine_info *info,
                                     const struct neph_settings *settings,
                                     const struct neph_scene *scene, int seed,
                                     struct neph_image **picture, double *seconds,
                                     struct neph_diag *diag)
{
    const struct neph_job job = {.engine = engine,
                                 .info = info,
                                 .shot = {.scene = scene,
                                          .settings = *settings,
                                          .width_px = work->params->width_px,
                                          .height_px = work->params->height_px,
                                          .layers = NEPH_LAYER_RADIANCE,
                                          .seed = neph_seed_of(scene, seed),
                                          .time_limit_s = INFINITY,
                                          .device = work->params->device}};
    struct neph_job_result result = {.settings = NULL};
    enum neph_status status = neph_job_run(&job, work->store, &result, diag);
    if (!status)
        status = neph_outcome_check(result.outcome, result.reason, diag);
    if (!status)
        status = neph_exr_read(result.frame_path, picture, diag);
    if (!status)
        *seconds += isnan(result.cost.render_s) ? result.cost.wall_s : result.cost.render_s;
    neph_job_result_finish(&result);
    return status;
}

/* A truth without chance is its own second. */
static enum neph_status trace(const struct work *work, struct sight *sight,
                              struct neph_sky_cell *cell, struct neph_diag *diag)
{
    const struct neph_light_model *truth = &work->truth;
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < 2 * VIEWS && !status; i++)
        status = take_picture(work, truth->engine, &truth->info, &truth->settings,
                              sight->scenes[i / 2], truth->engine->stochastic ? i % 2 + 1 : 1,
                              &sight->truths[i / 2][i % 2], &cell->truth_s, diag);
    return status;
}

/* ---- directions ------------------------------------------------------------------------------ */

struct tile {
    double light[3];
    double solid_angle; /* in units of its own */
    struct neph_vec3 direction;
};

/* The mean of a tile's pixels. */
static struct tile tile_of(const struct work *work, const struct neph_scene *scene,
                           const struct neph_image *picture, int column, int row)
{
    const struct neph_sky_study_params *params = work->params;
    const struct neph_camera camera = neph_scene_camera(scene, 0.0);
    const int side = params->tile_px;
    float *rgb[3];
    struct tile tile = {.light = {0, 0, 0}};
    if (!neph_image_rgb(picture, NULL, rgb))
        return tile;
    for (int i = 0; i < side * side; i++) {
        const size_t x = (size_t)(column * side + i % side), y = (size_t)(row * side + i / side);
        for (int c = 0; c < 3; c++)
            tile.light[c] += (double)rgb[c][y * (size_t)params->width_px + x] / (side * side);
    }
    const double middle = 0.5 * (side - 1);
    const struct neph_pixel_ray ray = neph_camera_ray(&camera, params->width_px, params->height_px,
                                                      column * side + middle, row * side + middle);
    tile.direction = ray.direction;
    tile.solid_angle = pow(neph_vec3_dot(ray.direction, camera.forward), 3.0);
    return tile;
}

/* Sum over channels of |a - b|, and of a. */
static double distance_of(const double a[3], const double b[3])
{
    return fabs(a[0] - b[0]) + fabs(a[1] - b[1]) + fabs(a[2] - b[2]);
}

static double sum_of(const double a[3])
{
    return a[0] + a[1] + a[2];
}

struct sums {
    double weight, off, noise, model, truth;
};

/* `model` NULL: the truth's own noise alone. */
static void add_tile(const struct tile *first, const struct tile *second, const struct tile *model,
                     struct sums *sums, struct neph_sky_gap *gap)
{
    double truth[3];
    for (int c = 0; c < 3; c++)
        truth[c] = 0.5 * (first->light[c] + second->light[c]);
    const double light = sum_of(truth);
    if (!(light > 0.0))
        return;
    const double noise = 0.5 * distance_of(first->light, second->light) / light;
    sums->weight += first->solid_angle;
    sums->noise += first->solid_angle * noise;
    if (!model)
        return;
    const double off = distance_of(model->light, truth) / light;
    sums->off += first->solid_angle * off;
    sums->truth += first->solid_angle * light;
    sums->model += first->solid_angle * sum_of(model->light);
    if (off <= gap->worst)
        return;
    gap->worst = off;
    gap->worst_noise = noise;
    gap->worst_elevation_deg = asin(first->direction.y) / NEPH_RAD_PER_DEG;
    gap->worst_azimuth_deg = fabs(atan2(first->direction.x, -first->direction.z)) /
                             NEPH_RAD_PER_DEG;
}

/* `picture` NULL: the truth's own noise alone. */
static int add_view(const struct work *work, const struct sight *sight, int view,
                    const struct neph_image *picture, struct sums *sums, struct neph_sky_gap *gap)
{
    const int columns = work->params->width_px / work->params->tile_px;
    const int rows = work->params->height_px / work->params->tile_px;
    const struct neph_scene *scene = sight->scenes[view];
    for (int i = 0; i < columns * rows; i++) {
        const int x = i % columns, y = i / columns;
        const struct tile first = tile_of(work, scene, sight->truths[view][0], x, y);
        const struct tile second = tile_of(work, scene, sight->truths[view][1], x, y);
        const struct tile model = picture ? tile_of(work, scene, picture, x, y) : first;
        add_tile(&first, &second, picture ? &model : NULL, sums, gap);
    }
    return columns * rows;
}

/* ---- a cell ---------------------------------------------------------------------------------- */

static enum neph_status run_model(struct work *work, const struct sight *sight, int model,
                                  struct neph_sky_gap *gap, struct neph_diag *diag)
{
    struct sums sums = {0};
    enum neph_status status = NEPH_OK;
    const struct neph_light_model *of = &work->models[model];
    if (!of->engine->can_render(sight->scenes[0], &of->settings, gap->because,
                                sizeof(gap->because)))
        return NEPH_OK;
    gap->because[0] = '\0';
    for (int view = 0; view < VIEWS && !status; view++) {
        struct neph_image *picture = NULL;
        status = take_picture(work, of->engine, &of->info, &of->settings, sight->scenes[view], 1,
                              &picture, &gap->render_s, diag);
        if (!status)
            add_view(work, sight, view, picture, &sums, gap);
        neph_image_destroy(picture);
    }
    gap->mean = sums.off / sums.weight;
    gap->bias = sums.model / sums.truth - 1.0;
    return status;
}

static enum neph_status see(const struct work *work, const struct neph_sky_cell *cell,
                            struct sight *sight, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int view = 0; view < VIEWS && !status; view++) {
        const struct neph_skyward skyward = {
            .sun_elevation_rad = cell->sun_deg * NEPH_RAD_PER_DEG,
            .altitude_m = cell->altitude_m,
            .azimuth_rad = view_azimuths_deg[view] * NEPH_RAD_PER_DEG,
            .pitch_rad = view_pitch_deg * NEPH_RAD_PER_DEG,
            .vertical_fov_rad = view_fov_deg * NEPH_RAD_PER_DEG,
        };
        status = neph_scene_skyward(work->params->scene, &skyward, &sight->scenes[view], diag);
    }
    return status;
}

static enum neph_status run_cell(struct work *work, struct neph_sky_cell *cell,
                                 struct neph_diag *diag)
{
    char what[120];
    struct sight sight = {0};
    struct sums noise = {0};
    const double start_s = neph_wall_s();
    snprintf(what, sizeof(what), "sun at %g degrees, %g m up", cell->sun_deg, cell->altitude_m);
    neph_progress_begin(&work->progress, what);
    enum neph_status status = see(work, cell, &sight, diag);
    if (!status)
        status = trace(work, &sight, cell, diag);
    for (int view = 0; view < VIEWS && !status; view++)
        cell->direction_count += add_view(work, &sight, view, NULL, &noise, NULL);
    cell->noise = noise.noise / noise.weight;
    for (int model = 0; model < work->params->model_count && !status; model++)
        status = run_model(work, &sight, model, &cell->gaps[model], diag);
    if (!status)
        neph_progress_step(&work->progress, what, "measured", neph_wall_s() - start_s);
    for (int i = 0; i < VIEWS; i++) {
        neph_image_destroy(sight.truths[i][0]);
        neph_image_destroy(sight.truths[i][1]);
        neph_scene_destroy(sight.scenes[i]);
    }
    return status;
}

/* ---- the whole ------------------------------------------------------------------------------- */

static enum neph_status describe(struct work *work, int model, struct neph_diag *diag)
{
    const struct neph_light_model *of = &work->models[model];
    char *text = neph_settings_text(of->engine, &of->settings);
    if (!text)
        return neph_fail_memory(diag);
    snprintf(work->study->settings[model], sizeof(work->study->settings[model]), "%s", text);
    free(text);
    return NEPH_OK;
}

static enum neph_status parse_truth(struct work *work, struct neph_diag *diag)
{
    char samples[48], *copy = strdup(work->params->truth), *rest = copy;
    struct neph_light_model *truth = &work->truth;
    enum neph_status status = copy ? NEPH_OK : neph_fail_memory(diag);
    const char *name = copy ? strsep(&rest, "+") : "";
    truth->engine = neph_engine_find(name);
    const bool is_truth = truth->engine && (truth->engine->rung <= NEPH_RUNG_TRACER || rest);
    if (!status && !is_truth)
        status = neph_fail(diag, NEPH_ERR_USAGE,
                           "'%s' is no truth: exact, oracle and tracer are, or a model with finer "
                           "settings",
                           work->params->truth);
    if (!status)
        truth->settings = neph_settings_default(truth->engine);
    snprintf(samples, sizeof(samples), "samples=%d", work->params->samples);
    if (!status && neph_engine_samples(truth->engine) >= 0)
        status = neph_settings_set(truth->engine, &truth->settings, samples, diag);
    while (rest && !status)
        status = neph_settings_set(truth->engine, &truth->settings, strsep(&rest, "+"), diag);
    free(copy);
    return status;
}

static enum neph_status prepare(struct work *work, struct neph_diag *diag)
{
    const struct neph_sky_study_params *params = work->params;
    enum neph_status status = parse_truth(work, diag);
    if (status)
        return status;
    neph_engine_probe(work->truth.engine, params->device, &work->truth.info);
    snprintf(work->study->device, sizeof(work->study->device), "%s", work->truth.info.device);
    for (int model = 0; model < params->model_count && !status; model++) {
        status = neph_light_model_parse(params->models[model], params->steps, params->device,
                                        &work->models[model], diag);
        if (!status)
            status = describe(work, model, diag);
    }
    if (status)
        return status;
    work->study->cell_count = params->sun_count * params->altitude_count;
    work->study->cells = calloc((size_t)work->study->cell_count, sizeof(*work->study->cells));
    neph_progress_expect(&work->progress, 0, work->study->cell_count, cell_typical_s);
    return work->study->cells ? NEPH_OK : neph_fail_memory(diag);
}

enum neph_status neph_sky_study_run(const struct neph_sky_study_params *params,
                                    struct neph_store *store, struct neph_sky_study *study,
                                    struct neph_diag *diag)
{
    struct work work = {.params = params,
                        .study = study,
                        .store = store,
                        .progress = neph_progress_start(params->quiet, 0)};
    *study = (struct neph_sky_study){.params = params};
    enum neph_status status = prepare(&work, diag);
    for (int i = 0; i < study->cell_count && !status; i++) {
        struct neph_sky_cell *cell = &study->cells[i];
        cell->sun_deg = params->suns_deg[i / params->altitude_count];
        cell->altitude_m = params->altitudes_m[i % params->altitude_count];
        status = run_cell(&work, cell, diag);
    }
    neph_progress_end(&work.progress);
    if (status == NEPH_ERR_INTERRUPTED)
        neph_hint(diag, "what is finished is in the store: the same command goes on from there");
    return status;
}

void neph_sky_study_finish(struct neph_sky_study *study)
{
    free(study->cells);
    *study = (struct neph_sky_study){.params = NULL};
}
