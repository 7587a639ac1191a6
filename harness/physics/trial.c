/* SPDX-License-Identifier: MIT */
#include "harness/physics/trial.h"

#include "base/doubt.h"
#include "base/exr.h"
#include "harness/run/seed.h"
#include "metrics/significance.h"

#include <math.h>
#include <string.h>

/* Compiles only when this file handles every kind. */
_Static_assert(NEPH_CHECK_WEIGHT_COUNT == 2, "a new kind");
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");

/* ---- scenery --------------------------------------------------------------------------------- */

static enum neph_status create_scenery_view(const struct neph_check_view *view,
                                            struct neph_scenery_view *seen, struct neph_diag *diag)
{
    seen->view = view;
    seen->pixel_count = view->width_px * view->height_px;
    enum neph_status status = neph_stage_create(&view->stage, &seen->stage, diag);
    if (status)
        return status;
    seen->truth_error = neph_stage_truth_error(seen->stage);
    const struct neph_camera camera = neph_scene_camera(&seen->stage->scene, 0.0);
    for (int p = 0; p < seen->pixel_count; p++) {
        const struct neph_vec3 ray = neph_check_ray(view, &camera, p).direction;
        seen->weight[p] = neph_check_pixel_weight(view, &camera, ray);
        seen->truth[p] = seen->weight[p] > 0.0 ? neph_stage_truth_w_per_m2_sr(seen->stage, ray)
                                               : 0.0;
    }
    return NEPH_OK;
}

void neph_scenery_leave(struct neph_scenery *scenery)
{
    for (int v = 0; v < scenery->check.view_count; v++) {
        neph_stage_destroy(scenery->views[v].stage);
        scenery->views[v].stage = NULL;
    }
}

enum neph_status neph_scenery_enter(int index, struct neph_scenery *scenery, struct neph_diag *diag)
{
    memset(scenery, 0, sizeof(*scenery));
    neph_check_get(index, &scenery->check);
    enum neph_status status = NEPH_OK;
    for (int v = 0; v < scenery->check.view_count && !status; v++)
        status = create_scenery_view(&scenery->check.views[v], &scenery->views[v], diag);
    if (status)
        neph_scenery_leave(scenery);
    return status;
}

/* Set the light of all views, and hash their scenes. */
static enum neph_status set_light(struct neph_scenery *scenery, enum neph_scattering scattering,
                                  bool environment_light, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int v = 0; v < scenery->check.view_count && !status; v++) {
        struct neph_scene *scene = &scenery->views[v].stage->scene;
        scene->scattering = scattering;
        scene->environment_light = environment_light;
        status = neph_scene_hash(scene, diag);
    }
    return status;
}

/* ---- one frame ------------------------------------------------------------------------------- */

/* The job of a view's frame; `study` sets the step (NULL: default). */
static struct neph_job make_view_job(const struct neph_trial *trial,
                                     const struct neph_scenery_view *seen,
                                     const struct neph_study *study)
{
    struct neph_job job = {.engine = trial->entrant->engine,
                           .info = &trial->entrant->info,
                           .shot = {.scene = &seen->stage->scene,
                                    .settings = trial->entrant->settings,
                                    .width_px = seen->view->width_px,
                                    .height_px = seen->view->height_px,
                                    .layers = NEPH_LAYER_RADIANCE,
                                    .seed = neph_seed_for_scene(&seen->stage->scene, 1),
                                    .time_limit_s = trial->time_limit_s,
                                    .device = trial->device}};
    if (study)
        neph_study_apply(study, job.engine, &job.shot.settings);
    return job;
}

/* ---- sums ------------------------------------------------------------------------------------ */

struct sums {
    double truth;        /* sum of |factor| weight reference */
    double deviation[2]; /* sum of factor weight (L - reference), for each pass */
    double variance;     /* of the mean of both passes */
    double squares;      /* of that variance's standard error; NaN: not known */
    struct neph_z_moments pixels;
};

/* Pixels with noise below this multiple of the brightest pixel's rounding have no z-score. At this
 * limit rounding changes the variance of the z-scores by 1 %. */
static const double noise_per_rounding = 10.0;

static void add_pixel_scores(const struct neph_scenery_view *seen, const struct neph_image *frame,
                             double rounding, struct sums *sums)
{
    const float *variance = neph_image_channel(frame, "variance.G");
    float truth[NEPH_SCENERY_PIXELS_MAX];
    if (!variance || seen->view->weight != NEPH_CHECK_MEAN || seen->truth_error > 0.0)
        return;
    double brightest = 0.0;
    for (int p = 0; p < seen->pixel_count; p++) {
        truth[p] = (float)seen->truth[p];
        brightest = fmax(brightest, seen->truth[p]);
    }
    const struct neph_z_moments more = neph_z_scores(neph_image_channel(frame, "G"), truth,
                                                     variance, (size_t)seen->pixel_count,
                                                     noise_per_rounding * rounding * brightest);
    sums->pixels = neph_z_merge(sums->pixels, more);
}

static void add_view(const struct neph_scenery_view *seen, struct neph_image *const frames[2],
                     const struct neph_participant *participant, struct sums *sums)
{
    const float *a = neph_image_channel(frames[0], "G"), *b = neph_image_channel(frames[1], "G");
    const float *va = neph_image_channel(frames[0], "variance.G");
    const float *vb = neph_image_channel(frames[1], "variance.G");
    const double factor = seen->view->factor;
    const bool stochastic = !participant->refined;
    double truth = 0.0, variances[2] = {0.0, 0.0};
    for (int p = 0; p < seen->pixel_count; p++) {
        const double weight = factor * seen->weight[p];
        if (weight == 0.0)
            continue;
        variances[0] += va ? 0.25 * weight * weight * (double)va[p] : 0.0;
        variances[1] += vb ? 0.25 * weight * weight * (double)vb[p] : 0.0;
        truth += fabs(weight) * seen->truth[p];
        sums->deviation[0] += weight * ((double)a[p] - seen->truth[p]);
        sums->deviation[1] += weight * ((double)b[p] - seen->truth[p]);
        const double difference = (double)a[p] - (double)b[p];
        const double variance = va && vb ? 0.25 * ((double)va[p] + (double)vb[p])
                                         : 0.25 * difference * difference;
        sums->variance += stochastic ? weight * weight * variance : 0.0;
    }
    sums->truth += truth;
    sums->variance += stochastic ? pow(truth * seen->truth_error, 2.0) : 0.0;
    for (int pass = 0; pass < 2; pass++)
        sums->squares += neph_doubt_read(frames[pass]) * variances[pass] * variances[pass];
    add_pixel_scores(seen, frames[0], participant->rounding, sums);
}

/* Safety factor of Roache's grid convergence index (P. J. Roache, J. Fluids Eng. 116, 1994): an
 * extrapolated error is itself an estimate, and half of all errors would exceed a bound without a
 * margin. */
static const double step_safety = 1.25;

static void conclude(const struct neph_participant *participant, const struct sums *sums,
                     struct neph_physics_row *row)
{
    if (participant->refined) {
        /* Richardson: halving the step leaves 2^-order of the error. */
        const double change = fabs(sums->deviation[1] - sums->deviation[0]) / sums->truth;
        const double kept = exp2(-participant->order);
        row->deviation = sums->deviation[0] / sums->truth;
        row->step_bound = participant->order ? step_safety * change / (1.0 - kept) : 0.0;
    } else {
        row->deviation = 0.5 * (sums->deviation[0] + sums->deviation[1]) / sums->truth;
        row->standard_error = sqrt(sums->variance) / sums->truth;
    }
    if (row->standard_error > 0.0)
        row->doubt = sums->squares / (sums->variance * sums->variance);
    if (row->standard_error > 0.0)
        row->z = row->deviation / row->standard_error;
    if (sums->pixels.count > 0) {
        row->pixel_z_mean = sums->pixels.mean;
        row->pixel_z_variance = sums->pixels.variance;
    }
}

/* ---- one participant ------------------------------------------------------------------------- */

/* Render a pass of a view. The second pass has another seed, or the refined setting. `*frame` stays
 * NULL when the engine renders nothing; the row has the outcome. */
static enum neph_status render_pass(const struct neph_trial *trial,
                                    const struct neph_scenery_view *seen, int view, int pass,
                                    struct neph_image **frame, struct neph_physics_row *row,
                                    struct neph_diag *diag)
{
    struct neph_job job = make_view_job(trial, seen, row->study);
    struct neph_job_result result = {.outcome = NEPH_OUTCOME_FAILED};
    struct neph_bakes_summary bakes;
    if (pass == 1 && trial->entrant->participant->refined)
        job.shot.settings = trial->entrant->refined;
    else if (pass == 1)
        job.shot.seed = neph_seed_for_scene(&seen->stage->scene, 2);
    enum neph_status status = neph_job_run(&job, trial->store, &result, diag);
    row->outcome = result.outcome;
    row->reason = neph_arena_copy_text(trial->arena, result.reason);
    row->settings = neph_arena_copy_text(trial->arena, result.settings ? result.settings : "");
    row->wall_s += result.cost.wall_s;
    if (!status && result.frame_path)
        status = neph_exr_read(result.frame_path, frame, diag);
    if (!status && *frame && !row->bakes && neph_bakes_from_frame(*frame, &bakes))
        row->bakes = neph_arena_copy(trial->arena, &bakes, sizeof(bakes));
    if (!status && *frame && pass == 0)
        row->paths[view] = neph_arena_copy_text(trial->arena, result.frame_path);
    neph_job_result_finish(&result);
    return status;
}

/* Render and add up all views; one pass suffices for an engine without steps and noise. Stops when
 * a view is not rendered: `sums` is complete only if the row's outcome is "rendered". */
static enum neph_status try_views(const struct neph_trial *trial, struct neph_scenery *scenery,
                                  struct sums *sums, struct neph_physics_row *row,
                                  struct neph_diag *diag)
{
    const struct neph_participant *participant = trial->entrant->participant;
    const int pass_count = participant->refined && participant->order == 0 ? 1 : 2;
    enum neph_status status = NEPH_OK;
    *sums = (struct sums){.truth = 0.0, .pixels = {0, NAN, NAN}};
    memset(row->paths, 0, sizeof(row->paths));
    row->outcome = NEPH_OUTCOME_RENDERED;
    for (int v = 0; v < scenery->check.view_count; v++) {
        const struct neph_scenery_view *seen = &scenery->views[v];
        struct neph_image *frames[2] = {NULL, NULL};
        for (int pass = 0; pass < pass_count && !status && row->outcome == NEPH_OUTCOME_RENDERED;
             pass++)
            status = render_pass(trial, seen, v, pass, &frames[pass], row, diag);
        if (!status && row->outcome == NEPH_OUTCOME_RENDERED)
            add_view(seen, (struct neph_image *const[2]){frames[0], frames[pass_count - 1]},
                     participant, sums);
        neph_image_destroy(frames[0]);
        neph_image_destroy(frames[1]);
    }
    return status;
}

/* Choose Cycles' step by a step study for each check with an uneven medium. Engines without noise
 * run with two steps anyway. */
static enum neph_status choose_step(const struct neph_trial *trial,
                                    const struct neph_scenery *scenery,
                                    struct neph_physics_row *row, struct neph_diag *diag)
{
    const struct neph_engine *engine = trial->entrant->engine;
    const struct neph_scenery_view *seen = &scenery->views[0];
    struct neph_study made;
    enum neph_outcome outcome;
    char reason[1600];
    if (engine->rung != NEPH_LEVEL_EXTERNAL || !engine->stochastic || !scenery->check.uneven ||
        !trial->entrant->info.available || !neph_study_applies(engine, &seen->stage->scene))
        return NEPH_OK;
    const struct neph_job job = make_view_job(trial, seen, NULL);
    if (!neph_engine_has_steps(engine, job.info, &job.shot.settings))
        return NEPH_OK;
    const enum neph_status status = neph_study_run(&job, trial->store, &made, &outcome, reason,
                                                   diag);
    if (!status && outcome == NEPH_OUTCOME_RENDERED) /* otherwise the frame reports the reason */
        row->study = neph_arena_copy(trial->arena, &made, sizeof(made));
    return status;
}

/* Try all views. An engine that cannot render multiple scattering gets the scene with single
 * scattering, and its row is marked as lowered. */
static enum neph_status try_all(const struct neph_trial *trial, struct neph_scenery *scenery,
                                struct sums *sums, struct neph_physics_row *row,
                                struct neph_diag *diag)
{
    const struct neph_engine *engine = trial->entrant->engine;
    enum neph_status status = choose_step(trial, scenery, row, diag);
    if (!status)
        status = try_views(trial, scenery, sums, row, diag);
    const struct neph_scene *scene = &scenery->views[0].stage->scene;
    const bool is_whole = engine->rung <= NEPH_LEVEL_TRACER || engine->look ||
                          scene->scattering != NEPH_SCATTERING_MULTIPLE;
    if (status || row->outcome != NEPH_OUTCOME_CANNOT || is_whole)
        return status;
    const bool environment_light = scene->environment_light;
    row->lowered = true;
    status = set_light(scenery, NEPH_SCATTERING_SINGLE, false, diag);
    if (!status)
        status = try_views(trial, scenery, sums, row, diag);
    const enum neph_status restored = set_light(scenery, NEPH_SCATTERING_MULTIPLE,
                                                environment_light, diag);
    return status ? status : restored;
}

/* A deviation up to three times the known step error is attributed to the steps. */
static bool is_within_step_error(const struct neph_physics_row *row)
{
    double steps = isnan(row->step_bound) ? 0.0 : row->step_bound;
    if (row->study) {
        const struct neph_study_level *chosen = &row->study->levels[row->study->chosen];
        steps = fabs(chosen->bias) + 2.0 * chosen->bias_noise;
    }
    return row->outcome != NEPH_OUTCOME_RENDERED || fabs(row->deviation) <= 3.0 * steps;
}

enum neph_status neph_trial_run(const struct neph_trial *trial, struct neph_scenery *scenery,
                                struct neph_physics_row *row, struct neph_diag *diag)
{
    const struct neph_participant *participant = trial->entrant->participant;
    struct sums sums;
    row->participant = participant;
    row->engine = trial->entrant->engine;
    row->deviation = row->standard_error = row->doubt = row->step_bound = row->z = NAN;
    row->pixel_z_mean = row->pixel_z_variance = NAN;
    const enum neph_status status = try_all(trial, scenery, &sums, row, diag);
    if (status)
        return status;
    if (row->outcome == NEPH_OUTCOME_RENDERED)
        conclude(participant, &sums, row);
    const struct neph_participation part = {
        .lowered = row->lowered,
        .baked = row->bakes && row->bakes->worst.transmittance_max > 0.0,
        .stepped = is_within_step_error(row),
    };
    row->cause = neph_participant_cause(participant, &scenery->check, &part);
    return neph_arena_check(trial->arena, diag);
}
