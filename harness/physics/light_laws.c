/* SPDX-License-Identifier: MIT */
#include "harness/physics/light_laws.h"

#include "base/exr.h"
#include "base/written.h"
#include "harness/document/table.h"
#include "harness/run/job.h"
#include "scenes/media.h"
#include "truth/slab.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Compiles only when this file handles every kind. */
_Static_assert(NEPH_CHECK_WEIGHT_COUNT == 2, "a new kind");
_Static_assert(NEPH_LIGHT_LAW_COUNT == 5, "a new kind");

/* Number of suns around the ball, by the cosine to the view. The rule is exact for Legendre orders
 * below 24; higher orders contain 2e-4 of a Henyey-Greenstein function of g = 0.7. */
enum { SUNS = 12 };

const struct neph_light_law_case neph_light_law_cases[NEPH_LIGHT_LAWS] = {
    {NEPH_LAW_FURNACE, 1.0, 0.7, 1.0},       {NEPH_LAW_FURNACE, 8.0, 0.0, 1.0},
    {NEPH_LAW_FURNACE, 8.0, 0.7, 1.0},       {NEPH_LAW_FURNACE, 64.0, 0.7, 1.0},
    {NEPH_LAW_REFLECTED, 4.0, 0.7, 1.0},     {NEPH_LAW_TRANSMITTED, 4.0, 0.7, 1.0},
    {NEPH_LAW_BALANCE, 4.0, 0.7, 1.0},       {NEPH_LAW_REFLECTED, 16.0, 0.7, 1.0},
    {NEPH_LAW_TRANSMITTED, 16.0, 0.7, 1.0},  {NEPH_LAW_BALANCE, 16.0, 0.7, 1.0},
    {NEPH_LAW_REFLECTED, 16.0, 0.7, 0.95},   {NEPH_LAW_TRANSMITTED, 16.0, 0.7, 0.95},
    {NEPH_LAW_BALANCE, 16.0, 0.7, 0.95},     {NEPH_LAW_RECIPROCITY, 4.0, 0.7, 1.0},
    {NEPH_LAW_RECIPROCITY, 16.0, 0.7, 0.95},
};
static const double sun_cosine = 0.7, other_cosine = 0.35;

static const char *find_law_name(enum neph_light_law law)
{
    static const char *const names[] = {[NEPH_LAW_FURNACE] = "white furnace, ball",
                                        [NEPH_LAW_REFLECTED] = "reflected, slab",
                                        [NEPH_LAW_TRANSMITTED] = "transmitted, slab",
                                        [NEPH_LAW_BALANCE] = "R + T + A, slab",
                                        [NEPH_LAW_RECIPROCITY] = "reciprocity, slab"};
    return names[law];
}

/* ---- views ----------------------------------------------------------------------------------- */

static struct neph_stage_params make_law_stage(const struct neph_light_law_case *of,
                                               const char *name)
{
    return (struct neph_stage_params){
        .name = name,
        .medium = of->law == NEPH_LAW_FURNACE ? NEPH_STAGE_GAUSSIAN : NEPH_STAGE_SLAB,
        .truth = NEPH_STAGE_TRUTH_HALF_SPACE, /* all orders, and no reference to solve */
        .optical_depth = of->optical_depth,
        .albedo = of->albedo,
        .phase = {NEPH_PHASE_HENYEY_GREENSTEIN, of->g},
        .sun_cosine = sun_cosine,
        .vertical_fov_rad = 40.0 * NEPH_RAD_PER_DEG,
        .aspect = 1.0,
    };
}

/* Half of the 12-point Gauss-Legendre rule on -1..1. */
static const struct {
    double cosine, weight;
} rule[SUNS / 2] = {
    {0.1252334085114689, 0.2491470458134028}, {0.3678314989981802, 0.2334925365383548},
    {0.5873179542866175, 0.2031674267230659}, {0.7699026741943047, 0.1600783285433462},
    {0.9041172563704749, 0.1069393259953184}, {0.9815606342467192, 0.0471753363865118}};

/* Views straight down on the ball: the sun's elevation is its angle to the view. */
static int view_ball(const struct neph_stage_params *stage, struct neph_check_view *views)
{
    for (int i = 0; i < SUNS; i++) {
        views[i] = (struct neph_check_view){.stage = *stage,
                                            .weight = NEPH_CHECK_MEAN,
                                            .factor = 2.0 * M_PI * rule[i / 2].weight,
                                            .width_px = 16,
                                            .height_px = 16};
        views[i].stage.sun_cosine = (i % 2 ? -1.0 : 1.0) * rule[i / 2].cosine;
        views[i].stage.view_elevation_rad = -89.99 * NEPH_RAD_PER_DEG;
    }
    return SUNS;
}

/* One narrow view for each of two directions; camera and sun have one each, and exchange them. */
static int view_exchanged(const struct neph_stage_params *stage, struct neph_check_view *views)
{
    const double cosines[2] = {sun_cosine, other_cosine};
    for (int i = 0; i < 2; i++) {
        views[i] = (struct neph_check_view){.stage = *stage,
                                            .weight = NEPH_CHECK_MEAN,
                                            .factor = 1.0 / cosines[i],
                                            .width_px = 16,
                                            .height_px = 16};
        views[i].stage.sun_cosine = cosines[i];
        views[i].stage.view_azimuth_rad = 60.0 * NEPH_RAD_PER_DEG;
        views[i].stage.view_elevation_rad = -asin(cosines[1 - i]);
        views[i].stage.vertical_fov_rad = 1.0 * NEPH_RAD_PER_DEG;
    }
    return 2;
}

int neph_light_law_views(const struct neph_light_law_case *of, const char *name,
                         struct neph_check_view views[NEPH_LIGHT_LAW_VIEWS_MAX])
{
    const struct neph_stage_params stage = make_law_stage(of, name);
    switch (of->law) {
    case NEPH_LAW_FURNACE:
        return view_ball(&stage, views);
    case NEPH_LAW_RECIPROCITY:
        return view_exchanged(&stage, views);
    case NEPH_LAW_REFLECTED:
        neph_check_hemisphere(&stage, -1.0, views);
        return NEPH_CHECK_FACES;
    case NEPH_LAW_TRANSMITTED:
        neph_check_hemisphere(&stage, 1.0, views);
        return NEPH_CHECK_FACES;
    case NEPH_LAW_BALANCE:
        neph_check_hemisphere(&stage, -1.0, views);
        neph_check_hemisphere(&stage, 1.0, views + NEPH_CHECK_FACES);
        return 2 * NEPH_CHECK_FACES;
    case NEPH_LIGHT_LAW_COUNT:
        break;
    }
    return 0;
}

/* ---- values ---------------------------------------------------------------------------------- */

/* The part of uniform light of 1 W/m2/sr that the ball removes from a frame: the mean of 1 - T. */
static enum neph_status find_taken(const struct neph_check_view *view, double *taken,
                                   struct neph_diag *diag)
{
    struct neph_stage *stage = NULL;
    const int pixels = view->width_px * view->height_px;
    double sum = 0.0;
    const enum neph_status status = neph_stage_create(&view->stage, &stage, diag);
    for (int p = 0; p < pixels && !status; p++) {
        const struct neph_camera camera = neph_scene_camera(&stage->scene, 0.0);
        const struct neph_pixel_ray ray = neph_check_ray(view, &camera, p);
        sum -= expm1(
            -neph_scene_optical_depth(&stage->scene, ray.origin_m, ray.direction, 0.0, INFINITY).g);
    }
    neph_stage_destroy(stage);
    *taken = sum / pixels;
    return status;
}

static enum neph_status solve_fluxes(const struct neph_light_law_case *of,
                                     struct neph_slab_fluxes *fluxes, struct neph_diag *diag)
{
    struct neph_slab *slab = NULL;
    const struct neph_slab_params params = {.optical_depth = of->optical_depth,
                                            .albedo = of->albedo,
                                            .phase = {NEPH_PHASE_HENYEY_GREENSTEIN, of->g},
                                            .sun_cosine = sun_cosine};
    const enum neph_status status = neph_slab_create(&params, &slab, diag);
    if (!status)
        *fluxes = neph_slab_fluxes(slab);
    neph_slab_destroy(slab);
    return status;
}

/* Sum over views. The weight of a flux includes the sun's irradiance, the weight of a mean does
 * not. */
static double sum_views(const struct neph_check_view *views, int count, const double *sums)
{
    double sum = 0.0;
    for (int i = 0; i < count; i++)
        sum += views[i].factor * sums[i];
    return views[0].weight == NEPH_CHECK_FLUX ? sum : sum / NEPH_STAGE_IRRADIANCE_W_PER_M2;
}

enum neph_status neph_light_law_value(const struct neph_light_law_case *of,
                                      const struct neph_check_view *views, const double *sums,
                                      double *value, double *truth, struct neph_diag *diag)
{
    struct neph_slab_fluxes fluxes = {.direct = 0.0};
    double taken = 1.0;
    enum neph_status status = NEPH_OK;
    if (of->law == NEPH_LAW_FURNACE)
        status = find_taken(&views[0], &taken, diag);
    else if (of->law != NEPH_LAW_RECIPROCITY)
        status = solve_fluxes(of, &fluxes, diag);
    if (status)
        return status;
    *truth = 1.0;
    switch (of->law) {
    case NEPH_LAW_FURNACE:
        *value = sum_views(views, SUNS, sums) / taken;
        break;
    case NEPH_LAW_RECIPROCITY:
        *value = sum_views(views, 1, sums) / sum_views(views + 1, 1, sums + 1);
        break;
    case NEPH_LAW_REFLECTED:
    case NEPH_LAW_TRANSMITTED:
        *truth = of->law == NEPH_LAW_REFLECTED ? fluxes.reflected : fluxes.transmitted;
        *value = sum_views(views, NEPH_CHECK_FACES, sums);
        break;
    case NEPH_LAW_BALANCE: /* measured R and T with the reference's other terms */
        *value = sum_views(views, 2 * NEPH_CHECK_FACES, sums) + 1.0 - fluxes.reflected -
                 fluxes.transmitted;
        break;
    case NEPH_LIGHT_LAW_COUNT:
        break;
    }
    return NEPH_OK;
}

/* ---- frames ---------------------------------------------------------------------------------- */

struct run {
    struct neph_light_model model;
    struct neph_job job; /* its sequence is shared by all balls, then by all slabs */
    struct neph_store *store;
    bool once; /* the model supports only single scattering */
};

static enum neph_status read_sum(const struct neph_stage *stage, const struct neph_check_view *view,
                                 const char *path, double *sum, struct neph_diag *diag)
{
    const struct neph_camera camera = neph_scene_camera(&stage->scene, 0.0);
    struct neph_image *frame = NULL;
    float *volume[3];
    double weighted = 0.0;
    enum neph_status status = neph_exr_read(path, &frame, diag);
    if (!status && !neph_image_rgb(frame, "volume", volume))
        status = neph_fail(diag, NEPH_ERR_ENGINE, "a frame has no radiance of media");
    for (int p = 0; p < view->width_px * view->height_px && !status; p++)
        weighted += neph_check_pixel_weight(view, &camera,
                                            neph_check_ray(view, &camera, p).direction) *
                    (double)volume[1][p];
    neph_image_destroy(frame);
    if (!status)
        *sum = weighted;
    return status;
}

/* Read the frame from the store, or render it. Engines with a history or with samples start a new
 * sequence for each frame, because the sun differs from the frame before. */
static enum neph_status render(struct run *run, const struct neph_stage *stage,
                               const struct neph_check_view *view, double *sum,
                               struct neph_diag *diag)
{
    struct neph_job_result result = {.settings = NULL};
    bool found = false;
    run->job.shot.scene = &stage->scene;
    run->job.shot.width_px = view->width_px;
    run->job.shot.height_px = view->height_px;
    enum neph_status status = neph_job_reuse(&run->job, run->store, &result, &found, diag);
    if (!status && !found) {
        neph_job_result_finish(&result);
        const struct neph_engine *engine = run->model.engine;
        if (!run->job.sequence && !engine->has_frame_history && !engine->stochastic)
            status = neph_job_open(&run->job, diag);
        if (!status)
            status = neph_job_run(&run->job, run->store, &result, diag);
    }
    if (!status)
        status = neph_outcome_check(result.outcome, result.reason, diag);
    if (!status)
        status = read_sum(stage, view, result.frame_path, sum, diag);
    neph_job_result_finish(&result);
    return status;
}

/* Fall back to single scattering if the model does not support all orders. NEPH_ERR_UNSUPPORTED: it
 * supports neither. */
static enum neph_status choose_orders(struct run *run, struct neph_stage *stage,
                                      struct neph_diag *diag)
{
    char why[256];
    const struct neph_engine *engine = run->model.engine;
    if (engine->can_render(&stage->scene, &run->model.settings, why, sizeof(why)))
        return NEPH_OK;
    stage->scene.scattering = NEPH_SCATTERING_SINGLE;
    const enum neph_status status = neph_scene_hash(&stage->scene, diag);
    if (status)
        return status;
    run->once = engine->can_render(&stage->scene, &run->model.settings, why, sizeof(why));
    return run->once ? NEPH_OK : neph_fail(diag, NEPH_ERR_UNSUPPORTED, "%s", why);
}

static enum neph_status see(struct run *run, const struct neph_check_view *view, double *sum,
                            struct neph_diag *diag)
{
    struct neph_stage *stage = NULL;
    enum neph_status status = neph_stage_create(&view->stage, &stage, diag);
    if (!status)
        status = choose_orders(run, stage, diag);
    if (!status)
        status = render(run, stage, view, sum, diag);
    neph_stage_destroy(stage);
    return status;
}

static enum neph_status run_case(struct run *run, const struct neph_light_law_case *of,
                                 double *value, double *truth, struct neph_diag *diag)
{
    struct neph_check_view views[NEPH_LIGHT_LAW_VIEWS_MAX];
    double sums[NEPH_LIGHT_LAW_VIEWS_MAX] = {0.0};
    const int count = neph_light_law_views(of, "light_law", views);
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < count && !status; i++)
        status = see(run, &views[i], &sums[i], diag);
    if (!status)
        status = neph_light_law_value(of, views, sums, value, truth, diag);
    return status;
}

/* An open march is compiled for the kind of its media, so it is closed when the kind changes. */
static void close_at_new_medium(struct run *run, int i)
{
    if (i > 0 && (neph_light_law_cases[i].law == NEPH_LAW_FURNACE) !=
                     (neph_light_law_cases[i - 1].law == NEPH_LAW_FURNACE))
        neph_job_close(&run->job);
}

static enum neph_status run_model(const char *words, int steps, int model,
                                  struct neph_shared_device *device, struct neph_store *store,
                                  struct neph_light_laws *laws, struct neph_diag *diag)
{
    struct run run = {.store = store};
    struct neph_diag why = {.line = 0};
    enum neph_status status = neph_light_model_parse(words, steps, device, &run.model, diag);
    if (status)
        return status;
    run.job = (struct neph_job){.engine = run.model.engine,
                                .info = &run.model.info,
                                .shot = {.settings = run.model.settings,
                                         .layers = NEPH_LAYERS_ALL,
                                         .seed = 1,
                                         .time_limit_s = INFINITY,
                                         .device = device}};
    for (int i = 0; i < NEPH_LIGHT_LAWS && !status; i++) {
        close_at_new_medium(&run, i);
        status = run_case(&run, &neph_light_law_cases[i], &laws->values[i][model], &laws->truths[i],
                          &why);
        if (status == NEPH_ERR_UNSUPPORTED)
            status = NEPH_OK; /* the value stays NaN */
    }
    neph_job_close(&run.job);
    if (status && diag)
        *diag = why;
    laws->looks[model] = neph_light_model_is_non_physical(&run.model);
    laws->once[model] = run.once;
    return status;
}

enum neph_status neph_light_laws_run(const char *const *models, int model_count, int steps,
                                     struct neph_shared_device *device, struct neph_store *store,
                                     struct neph_light_laws *laws, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    *laws = (struct neph_light_laws){.models = models, .model_count = model_count};
    for (int i = 0; i < NEPH_LIGHT_LAWS; i++) {
        laws->truths[i] = NAN;
        for (int model = 0; model < NEPH_LIGHT_MODELS_MAX; model++)
            laws->values[i][model] = NAN;
    }
    for (int model = 0; model < model_count && !status; model++)
        status = run_model(models[model], steps, model, device, store, laws, diag);
    return status;
}

/* ---- results --------------------------------------------------------------------------------- */

/* Fill the table for text, and for the JSON members other than the models. */
static void fill(const struct neph_light_laws *laws, struct neph_table *table)
{
    const struct neph_column columns[] = {
        {.key = "law", .title = "law"},       {"optical_depth", "optical depth", .format = "%g"},
        {"g", "g", .format = "%g"},           {"albedo", "albedo", .format = "%g"},
        {"truth", "truth", .format = "%.4f"},
    };
    neph_table_columns(table, columns, sizeof(columns) / sizeof(columns[0]));
    for (int model = 0; model < laws->model_count; model++) {
        const char *title = neph_arena_format(&table->arena, "%s%s", laws->models[model],
                                              laws->looks[model]  ? ", a look"
                                              : laws->once[model] ? ", scattered once"
                                                                  : "");
        neph_table_column(table, (struct neph_column){.title = title, .format = "%.4f"});
    }
    for (int i = 0; i < NEPH_LIGHT_LAWS; i++) {
        neph_table_word(table, find_law_name(neph_light_law_cases[i].law));
        neph_table_number(table, neph_light_law_cases[i].optical_depth);
        neph_table_number(table, neph_light_law_cases[i].g);
        neph_table_number(table, neph_light_law_cases[i].albedo);
        neph_table_number(table, laws->truths[i]);
        for (int model = 0; model < laws->model_count; model++) {
            const double value = laws->values[i][model];
            neph_table_number(table, value);
            if (!isnan(value))
                neph_table_shown(table, "%.4f (%+.1f)", value,
                                 100.0 * (value / laws->truths[i] - 1.0));
        }
    }
}

static void print(const void *laws, FILE *out)
{
    struct neph_table table = {.cells = NULL};
    fill(laws, &table);
    fprintf(out, "\n"
                 "**Laws: the value of a model, and its error in %%**\n"
                 "\n"
                 "The furnace is a white ball with suns all around it: the light scattered to the "
                 "camera over the light removed from the view, which is also the light leaving the "
                 "ball over the light removed from a sun. Fluxes are relative to the sun's flux; A "
                 "is from the reference of the slab. Reciprocity: with camera and sun exchanged.\n"
                 "\n");
    neph_table_print(&table, out);
    neph_table_finish(&table);
}

enum neph_status neph_light_laws_text(const struct neph_light_laws *laws, char **text,
                                      struct neph_diag *diag)
{
    return neph_write_to_text(print, laws, text, diag);
}

json_t *neph_light_laws_json(const struct neph_light_laws *laws)
{
    struct neph_table table = {.cells = NULL};
    fill(laws, &table);
    json_t *list = neph_table_json(&table);
    neph_table_finish(&table);
    for (int i = 0; i < NEPH_LIGHT_LAWS && list; i++) {
        json_t *models = json_array();
        for (int model = 0; model < laws->model_count; model++)
            neph_json_add(&models,
                          json_pack("{s:s, s:b, s:b, s:o}", "model", laws->models[model], "look",
                                    laws->looks[model], "scattered_once", laws->once[model],
                                    "value", neph_json_number(laws->values[i][model])));
        if (json_object_set_new(json_array_get(list, (size_t)i), "models", models) < 0) {
            json_decref(list);
            list = NULL;
        }
    }
    return list;
}
