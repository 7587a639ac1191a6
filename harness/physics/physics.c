/* SPDX-License-Identifier: MIT */
#include "harness/physics/physics.h"

#include "base/clock.h"
#include "base/exr.h"
#include "harness/engines/bakes.h"
#include "harness/engines/engines.h"
#include "harness/physics/checks.h"
#include "harness/physics/participants.h"
#include "harness/physics/phases.h"
#include "harness/physics/pictures.h"
#include "harness/progress.h"
#include "harness/run/job.h"
#include "harness/run/seed.h"
#include "harness/study/study.h"
#include "metrics/significance.h"
#include "scenes/media.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PARTICIPANTS_MAX = 16, PIXELS_MAX = 1024 };

/* One view of a check with the truth of its pixels. */
struct seen {
    const struct neph_check_view *view;
    struct neph_stage *stage;
    int pixel_count;
    double truth[PIXELS_MAX], weight[PIXELS_MAX];
    double truth_error; /* relative, of the mean; 0: exact */
};

struct scenery {
    struct neph_check check;
    struct seen views[NEPH_CHECK_VIEWS_MAX];
};

/* What one participant makes of one check. */
struct finding {
    struct neph_job_result result; /* of the first frame that is not rendered, else of the first */
    bool rendered, lowered;
    json_t *exr;         /* the first pass of every view */
    json_t *bake;        /* of the first frame; NULL: there is none */
    json_t *study;       /* that chose the step; NULL: there was none */
    double studied_bias; /* of the chosen step, noise included */
    double deviation;
    bool stochastic;
    double standard_error; /* stochastic: of the deviation */
    double step_bound;     /* deterministic */
    struct neph_z_moments pixels;
    double wall_s;
};

static enum neph_status see(const struct neph_check_view *view, struct seen *seen,
                            struct neph_diag *diag)
{
    seen->view = view;
    seen->pixel_count = view->width_px * view->height_px;
    enum neph_status status = neph_stage_create(&view->stage, &seen->stage, diag);
    if (status)
        return status;
    seen->truth_error = neph_stage_truth_error(seen->stage);
    const struct neph_camera camera = neph_scene_camera(&seen->stage->scene, 0.0);
    for (int p = 0; p < seen->pixel_count; p++) {
        const struct neph_vec3 ray = neph_camera_ray(&camera, view->width_px, view->height_px,
                                                     p % view->width_px, p / view->width_px);
        seen->weight[p] = neph_check_pixel_weight(view, &camera, ray);
        seen->truth[p] = seen->weight[p] > 0.0 ? neph_stage_truth_w_per_m2_sr(seen->stage, ray)
                                               : 0.0;
    }
    return NEPH_OK;
}

static void leave(struct scenery *scenery)
{
    for (int v = 0; v < scenery->check.view_count; v++) {
        neph_stage_destroy(scenery->views[v].stage);
        scenery->views[v].stage = NULL;
    }
}

static enum neph_status enter(int index, struct scenery *scenery, struct neph_diag *diag)
{
    memset(scenery, 0, sizeof(*scenery));
    neph_check_get(index, &scenery->check);
    enum neph_status status = NEPH_OK;
    for (int v = 0; v < scenery->check.view_count && !status; v++)
        status = see(&scenery->check.views[v], &scenery->views[v], diag);
    if (status)
        leave(scenery);
    return status;
}

/* --- one frame ----------------------------------------------------------------------------- */

struct entrant {
    const struct neph_participant *participant;
    const struct neph_engine *engine;
    struct neph_engine_info info;
    struct neph_settings settings, refined;
};

static enum neph_status render(const struct entrant *entrant, const struct seen *seen, int pass,
                               double time_limit_s, struct neph_store *store,
                               struct neph_job_result *result, struct neph_diag *diag)
{
    const bool refined = pass == 1 && entrant->participant->refined;
    const struct neph_job job = {
        .engine = entrant->engine,
        .info = &entrant->info,
        .shot = {.scene = &seen->stage->scene,
                 .settings = refined ? entrant->refined : entrant->settings,
                 .width_px = seen->view->width_px,
                 .height_px = seen->view->height_px,
                 .layers = NEPH_LAYER_RADIANCE,
                 .seed = neph_seed_of(&seen->stage->scene,
                                      entrant->participant->refined ? 1 : pass + 1),
                 .time_limit_s = time_limit_s},
    };
    return neph_job_run(&job, store, result, diag);
}

/* What a renderer without higher orders is given instead; false when it is that already. */
static bool lower(struct scenery *scenery, struct neph_diag *diag)
{
    bool changed = false;
    for (int v = 0; v < scenery->check.view_count; v++) {
        struct neph_scene *scene = &scenery->views[v].stage->scene;
        changed |= scene->scattering == NEPH_SCATTERING_MULTIPLE;
        scene->scattering = NEPH_SCATTERING_SINGLE;
        scene->environment_light = false;
        if (neph_scene_hash(scene, diag))
            return false;
    }
    return changed;
}

static void restore(struct scenery *scenery, enum neph_scattering scattering, bool environment,
                    struct neph_diag *diag)
{
    for (int v = 0; v < scenery->check.view_count; v++) {
        struct neph_scene *scene = &scenery->views[v].stage->scene;
        scene->scattering = scattering;
        scene->environment_light = environment;
        neph_scene_hash(scene, diag);
    }
}

/* --- sums ---------------------------------------------------------------------------------- */

struct sums {
    double truth;        /* sum of |factor| weight truth */
    double deviation[2]; /* sum of factor weight (L - truth), per pass */
    double variance;     /* of the mean of both passes */
    struct neph_z_moments pixels;
};

/* Noise this many times the rounding of the brightest pixel: z-scores' variance off by 1 %. */
static const double noise_per_rounding = 10.0;

static void add_pixel_scores(const struct seen *seen, const struct neph_image *frame,
                             double rounding, struct sums *sums)
{
    const float *variance = neph_image_channel(frame, "variance.G");
    float truth[PIXELS_MAX];
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

static void add_view(const struct seen *seen, struct neph_image *const frames[2],
                     const struct neph_participant *participant, struct sums *sums)
{
    const float *a = neph_image_channel(frames[0], "G"), *b = neph_image_channel(frames[1], "G");
    const float *va = neph_image_channel(frames[0], "variance.G");
    const float *vb = neph_image_channel(frames[1], "variance.G");
    const double factor = seen->view->factor;
    const bool stochastic = !participant->refined;
    double truth = 0.0;
    for (int p = 0; p < seen->pixel_count; p++) {
        const double weight = factor * seen->weight[p];
        if (weight == 0.0)
            continue;
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
    add_pixel_scores(seen, frames[0], participant->rounding, sums);
}

/* Roache's grid convergence index (P. J. Roache, J. Fluids Eng. 116, 1994): an extrapolated error
 * is itself an estimate, and a bound of just its size would be met by chance. */
static const double step_safety = 1.25;

static void conclude(const struct entrant *entrant, const struct sums *sums,
                     struct finding *finding)
{
    finding->stochastic = !entrant->participant->refined;
    finding->pixels = sums->pixels;
    if (finding->stochastic) {
        finding->deviation = 0.5 * (sums->deviation[0] + sums->deviation[1]) / sums->truth;
        finding->standard_error = sqrt(sums->variance) / sums->truth;
        return;
    }
    finding->deviation = sums->deviation[0] / sums->truth;
    /* Richardson: halving the step leaves 2^-order of the error. */
    const double change = fabs(sums->deviation[1] - sums->deviation[0]) / sums->truth;
    const double kept = exp2(-entrant->participant->order);
    finding->step_bound = entrant->participant->order ? step_safety * change / (1.0 - kept) : 0.0;
}

/* Render and add up all views; finding->rendered says whether there is a deviation. */
static enum neph_status try_views(const struct entrant *entrant, const struct scenery *scenery,
                                  double time_limit_s, struct neph_store *store,
                                  struct finding *finding, struct neph_diag *diag)
{
    struct sums sums = {.truth = 0.0, .pixels = {0, NAN, NAN}};
    const bool one_pass = entrant->participant->refined && entrant->participant->order == 0;
    json_array_clear(finding->exr);
    for (int v = 0; v < scenery->check.view_count; v++) {
        const struct seen *seen = &scenery->views[v];
        struct neph_image *frames[2] = {NULL, NULL};
        enum neph_status status = NEPH_OK;
        for (int pass = 0; pass < (one_pass ? 1 : 2) && !status; pass++) {
            neph_job_result_finish(&finding->result);
            status = render(entrant, seen, pass, time_limit_s, store, &finding->result, diag);
            finding->wall_s += finding->result.cost.wall_s;
            if (status || finding->result.outcome != NEPH_OUTCOME_RENDERED)
                break;
            status = neph_exr_read(finding->result.frame_path, &frames[pass], diag);
            if (!status && pass == 0)
                status = neph_json_append(finding->exr, json_string(finding->result.frame_path),
                                          diag);
            if (!status && !finding->bake)
                finding->bake = neph_bakes_of_frame(frames[pass]);
        }
        if (!status && frames[0] && (one_pass || frames[1]))
            add_view(seen, (struct neph_image *const[2]){frames[0], frames[!one_pass]},
                     entrant->participant, &sums);
        neph_image_destroy(frames[0]);
        neph_image_destroy(frames[1]);
        if (status || finding->result.outcome != NEPH_OUTCOME_RENDERED)
            return status;
    }
    finding->rendered = true;
    conclude(entrant, &sums, finding);
    return NEPH_OK;
}

/* Cycles marches in steps of our choice: a study chooses them for each check with an uneven medium.
 * Engines without noise are run with two steps anyway. */
static enum neph_status choose_step(const struct entrant *entrant, const struct scenery *scenery,
                                    double time_limit_s, struct neph_store *store,
                                    struct neph_settings *settings, struct finding *finding,
                                    struct neph_diag *diag)
{
    const struct seen *seen = &scenery->views[0];
    const struct neph_engine *engine = entrant->engine;
    struct neph_study study;
    enum neph_outcome outcome;
    char reason[1600];
    if (engine->rung != NEPH_RUNG_WITNESS || !engine->stochastic || !scenery->check.uneven ||
        !entrant->info.available || !neph_study_applies(engine, &seen->stage->scene))
        return NEPH_OK;
    const struct neph_job job = {.engine = engine,
                                 .info = &entrant->info,
                                 .shot = {.scene = &seen->stage->scene,
                                          .settings = *settings,
                                          .width_px = seen->view->width_px,
                                          .height_px = seen->view->height_px,
                                          .layers = NEPH_LAYER_RADIANCE,
                                          .seed = neph_seed_of(&seen->stage->scene, 1),
                                          .time_limit_s = time_limit_s}};
    const enum neph_status status = neph_study_run(&job, store, &study, &outcome, reason, diag);
    if (status || outcome != NEPH_OUTCOME_RENDERED)
        return status; /* the frame itself will say why */
    neph_study_apply(&study, engine, settings);
    const struct neph_study_level *chosen = &study.levels[study.chosen];
    finding->study = neph_study_json(&study);
    if (!finding->study)
        return neph_json_check(NULL, diag);
    finding->studied_bias = fabs(chosen->bias) + 2.0 * chosen->bias_noise;
    return NEPH_OK;
}

/* An engine that cannot do all orders is shown with what it can do, and marked as lowered. */
static enum neph_status find(const struct entrant *entrant, struct scenery *scenery,
                             double time_limit_s, struct neph_store *store, struct finding *finding,
                             struct neph_diag *diag)
{
    struct entrant placed = *entrant;
    enum neph_status status = choose_step(entrant, scenery, time_limit_s, store, &placed.settings,
                                          finding, diag);
    entrant = &placed;
    if (!status)
        status = try_views(entrant, scenery, time_limit_s, store, finding, diag);
    const bool whole = entrant->engine->rung <= NEPH_RUNG_TRACER || entrant->engine->look;
    if (status || finding->result.outcome != NEPH_OUTCOME_CANNOT || whole)
        return status;
    const struct neph_scene before = scenery->views[0].stage->scene;
    if (lower(scenery, diag)) {
        finding->lowered = true;
        status = try_views(entrant, scenery, time_limit_s, store, finding, diag);
    }
    restore(scenery, before.scattering, before.environment_light, diag);
    return status;
}

/* --- the document -------------------------------------------------------------------------- */

static json_t *number_or_null(bool there, double value)
{
    return there && isfinite(value) ? json_real(value) : json_null();
}

static json_t *finding_json(const struct entrant *entrant, const struct scenery *scenery,
                            const struct finding *finding)
{
    const struct neph_check *check = &scenery->check;
    const bool there = finding->rendered;
    const double error = finding->standard_error;
    /* A deviation of up to thrice what steps are known to do is theirs. */
    const double steps = finding->stochastic ? finding->studied_bias : finding->step_bound;
    const json_t *lost = json_object_get(finding->bake, "transmittance_max");
    const struct neph_participation part = {
        .lowered = finding->lowered,
        .baked = json_number_value(lost) > 0.0,
        .stepped = fabs(finding->deviation) <= 3.0 * steps,
    };
    const char *cause = neph_participant_cause(entrant->participant, check, &part);
    return json_pack(
        "{s:s, s:s, s:s, s:s, s:s, s:s, s:s, s:b, s:b, s:o, s:o, s:o, s:o, s:o, s:o, s:s?, s:f, "
        "s:f, s:O, s:[], s:[], s:O?, s:O?}",
        "check", check->name, "rung", check->rung, "participant", entrant->participant->name,
        "engine", entrant->engine->name, "status", neph_outcome_name(finding->result.outcome),
        "reason", finding->result.reason, "settings",
        finding->result.settings ? finding->result.settings : "", "lowered", finding->lowered,
        "look", entrant->engine->look, "deviation", number_or_null(there, finding->deviation),
        "standard_error", number_or_null(there && finding->stochastic, error), "step_bound",
        number_or_null(there && !finding->stochastic, finding->step_bound), "z",
        number_or_null(there && finding->stochastic && error > 0.0, finding->deviation / error),
        "pixel_z_mean", number_or_null(there && finding->pixels.count > 0, finding->pixels.mean),
        "pixel_z_variance",
        number_or_null(there && finding->pixels.count > 0, finding->pixels.variance), "cause",
        cause, "rounding", entrant->participant->rounding, "wall_s", finding->wall_s, "exr",
        finding->exr, "pictures", "differences", "bake", finding->bake, "study", finding->study);
}

static json_t *check_json(const struct scenery *scenery)
{
    const struct neph_check *check = &scenery->check;
    json_t *views = json_array();
    for (int v = 0; v < check->view_count; v++)
        neph_json_add(&views, neph_physics_view_json(&check->views[v], scenery->views[v].truth));
    return json_pack("{s:s, s:s, s:s, s:o}", "name", check->name, "rung", check->rung, "what",
                     check->what, "views", views);
}

/* What a deviation may be off by chance, step and rounding. */
static double allowed(const json_t *row, double critical_z)
{
    const double error = json_number_value(json_object_get(row, "standard_error"));
    const double bound = json_number_value(json_object_get(row, "step_bound"));
    return critical_z * error + bound + json_number_value(json_object_get(row, "rounding"));
}

static char *sentence(const json_t *row, double critical_z, bool agrees)
{
    char text[700];
    const char *who = json_string_value(json_object_get(row, "participant"));
    const char *cause = json_string_value(json_object_get(row, "cause"));
    const double percent = 100.0 * json_number_value(json_object_get(row, "deviation"));
    if (agrees)
        snprintf(text, sizeof(text), "%s agrees: %+.3g %%, within %.2g %%", who, percent,
                 100.0 * allowed(row, critical_z));
    else
        snprintf(text, sizeof(text), "%s is off by %+.3g %%, %s%s", who, percent,
                 cause ? "because " : "and the cause is not known", cause ? cause : "");
    return strdup(text);
}

static enum neph_status judge(json_t *row, double critical_z, struct neph_diag *diag)
{
    const json_t *deviation = json_object_get(row, "deviation");
    if (!json_is_number(deviation)) {
        json_t *none = json_pack("{s:s, s:s, s:n}", "verdict", "not_measured", "sentence", "",
                                 "interval");
        return neph_json_merge(row, none, diag);
    }
    const double value = json_number_value(deviation), width = allowed(row, critical_z);
    const bool agrees = fabs(value) <= width;
    char *text = sentence(row, critical_z, agrees);
    json_t *verdict = json_pack("{s:s, s:s, s:[f,f]}", "verdict", agrees ? "agrees" : "off",
                                "sentence", text ? text : "", "interval", value - width,
                                value + width);
    free(text);
    return neph_json_merge(row, verdict, diag);
}

/* Verdicts can be given only when all checks are counted. */
static enum neph_status judge_all(json_t *rows, double critical_z, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (size_t i = 0; i < json_array_size(rows) && !status; i++)
        status = judge(json_array_get(rows, i), critical_z, diag);
    return status;
}

/* Engines that claim to be the truth must be right, and so must phase functions; others are only
 * reported. */
static bool truth_holds(const json_t *rows, const json_t *phases)
{
    for (size_t i = 0; i < json_array_size(phases); i++) {
        const json_t *phase = json_array_get(phases, i);
        if (strcmp(json_string_value(json_object_get(phase, "verdict")), "off") == 0)
            return false;
    }
    for (size_t i = 0; i < json_array_size(rows); i++) {
        const json_t *row = json_array_get(rows, i);
        const struct neph_engine *engine = neph_engine_find(
            json_string_value(json_object_get(row, "engine")));
        const char *status = json_string_value(json_object_get(row, "status"));
        const bool off = strcmp(json_string_value(json_object_get(row, "verdict")), "off") == 0;
        const bool broke = strcmp(status, neph_outcome_name(NEPH_OUTCOME_FAILED)) == 0 ||
                           strcmp(status, neph_outcome_name(NEPH_OUTCOME_TIMEOUT)) == 0;
        if (broke || (off && engine->rung <= NEPH_RUNG_TRACER))
            return false;
    }
    return true;
}

static json_t *rungs_json(void)
{
    json_t *list = json_array();
    const char *last = "";
    for (int i = 0; i < neph_check_count(); i++) {
        struct neph_check check;
        neph_check_get(i, &check);
        if (strcmp(check.rung, last) != 0)
            neph_json_add(&list, json_pack("{s:s, s:s}", "name", check.rung, "title", check.title));
        last = check.rung;
    }
    return list;
}

/* Rows without a deviation say why; but a verdict on nothing, or on less than was to be tried, is
 * none. */
static const char *verdict_of(const json_t *rows, const json_t *phases, int expected, int tests)
{
    const bool whole = json_array_size(rows) == (size_t)expected && tests > 0;
    return whole && truth_holds(rows, phases) ? "pass" : "fail";
}

static enum neph_status document_of(json_t *checks, json_t *rows, int expected, double seconds,
                                    json_t **document, struct neph_diag *diag)
{
    int tests = 0;
    for (size_t i = 0; i < json_array_size(rows); i++)
        tests += json_is_number(json_object_get(json_array_get(rows, i), "deviation"));
    const double alpha = neph_sidak_alpha(NEPH_PHYSICS_FAMILY_ALPHA, tests > 0 ? tests : 1);
    const double critical_z = neph_normal_critical(alpha);
    const enum neph_status status = judge_all(rows, critical_z, diag);
    if (status)
        return status;
    json_t *phases = neph_phases_json();
    *document = json_pack("{s:f, s:i, s:f, s:s, s:{s:i, s:i, s:i}, s:f, s:o, s:o, s:O, s:O}",
                          "family_alpha", NEPH_PHYSICS_FAMILY_ALPHA, "tests", tests, "critical_z",
                          critical_z, "verdict", verdict_of(rows, phases, expected, tests),
                          "counts", "expected", expected, "reported", (int)json_array_size(rows),
                          "compared", tests, "seconds", seconds, "rungs", rungs_json(),
                          "phase_functions", phases, "checks", checks, "rows", rows);
    return neph_json_check(*document, diag);
}

/* --- the run ------------------------------------------------------------------------------- */

static enum neph_status apply(const struct neph_engine *engine, struct neph_settings *settings,
                              const char *assignment, struct neph_diag *diag)
{
    return assignment && assignment[0] ? neph_settings_set(engine, settings, assignment, diag)
                                       : NEPH_OK;
}

static enum neph_status enrol(const struct neph_participant *participant, int samples,
                              struct entrant *entrant, struct neph_diag *diag)
{
    entrant->participant = participant;
    entrant->engine = neph_engine_find(participant->engine);
    neph_engine_probe(entrant->engine, &entrant->info);
    entrant->settings = neph_settings_default(entrant->engine);
    enum neph_status status = NEPH_OK;
    char paths[32];
    snprintf(paths, sizeof(paths), "samples=%d", samples);
    if (entrant->engine->rung == NEPH_RUNG_TRACER)
        status = apply(entrant->engine, &entrant->settings, paths, diag);
    for (int i = 0; i < NEPH_PARTICIPANT_SETTINGS_MAX && !status; i++)
        status = apply(entrant->engine, &entrant->settings, participant->settings[i], diag);
    entrant->refined = entrant->settings;
    if (!status)
        status = apply(entrant->engine, &entrant->refined, participant->refined, diag);
    return status;
}

static bool is_wanted(const struct neph_physics_params *params, const char *engine)
{
    bool wanted = params->engine_count == 0;
    for (int i = 0; i < params->engine_count; i++)
        wanted |= strcmp(params->engines[i], engine) == 0;
    return wanted;
}

static bool is_chosen(const struct neph_physics_params *params, int index)
{
    struct neph_check check;
    neph_check_get(index, &check);
    return !params->only || strstr(check.name, params->only) || strstr(check.rung, params->only);
}

static enum neph_status refuse_check(const char *text, struct neph_diag *diag)
{
    char names[256] = "";
    json_t *rungs = rungs_json();
    for (size_t i = 0; i < json_array_size(rungs); i++) {
        const size_t length = strlen(names);
        snprintf(names + length, sizeof(names) - length, "%s%s", i > 0 ? ", " : "",
                 json_string_value(json_object_get(json_array_get(rungs, i), "name")));
    }
    json_decref(rungs);
    neph_fail(diag, NEPH_ERR_USAGE, "no check of the physics suite has '%s' in its name", text);
    neph_hint(diag, "the rungs are %s; a run without --check shows all names", names);
    return NEPH_ERR_USAGE;
}

/* Checks of what only transport of all orders conserves are for those that claim to do it. */
static bool takes_part(const struct entrant *entrant, const struct neph_check *check)
{
    return !check->truth_only || entrant->engine->rung <= NEPH_RUNG_TRACER;
}

/* How many rows there will be. */
static int count_rows(const struct neph_physics_params *params, const struct entrant *entrants,
                      int entrant_count)
{
    int count = 0;
    for (int c = 0; c < neph_check_count(); c++) {
        struct neph_check check;
        neph_check_get(c, &check);
        for (int i = 0; i < entrant_count; i++)
            count += is_chosen(params, c) && takes_part(&entrants[i], &check);
    }
    return count;
}

static enum neph_status run_check(const struct neph_physics_params *params, int index,
                                  const struct entrant *entrants, int entrant_count,
                                  struct neph_store *store, struct neph_progress *progress,
                                  json_t *checks, json_t *rows, struct neph_diag *diag)
{
    struct scenery *scenery = calloc(1, sizeof(*scenery));
    if (!scenery)
        return neph_fail_memory(diag);
    enum neph_status status = enter(index, scenery, diag);
    if (!status)
        status = neph_json_append(checks, check_json(scenery), diag);
    for (int i = 0; i < entrant_count && !status; i++) {
        const struct entrant *entrant = &entrants[i];
        char what[160];
        snprintf(what, sizeof(what), "%s with %s", scenery->check.name, entrant->participant->name);
        if (!takes_part(entrant, &scenery->check))
            continue;
        progress->kind = i;
        neph_progress_begin(progress, what);
        struct finding finding = {.rendered = false, .exr = json_array()};
        const double start_s = neph_wall_s();
        status = find(entrant, scenery, params->time_limit_s, store, &finding, diag);
        if (!status)
            status = neph_json_append(rows, finding_json(entrant, scenery, &finding), diag);
        if (!status)
            neph_progress_step(progress, what, neph_outcome_name(finding.result.outcome),
                               neph_wall_s() - start_s);
        neph_job_result_finish(&finding.result);
        json_decref(finding.exr);
        json_decref(finding.bake);
        json_decref(finding.study);
    }
    leave(scenery);
    free(scenery);
    return status;
}

enum neph_status neph_physics_run(const struct neph_physics_params *params,
                                  struct neph_store *store, json_t **document,
                                  struct neph_diag *diag)
{
    const double start_s = neph_wall_s();
    struct entrant entrants[PARTICIPANTS_MAX];
    int entrant_count = 0, check_count = 0;
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < params->engine_count; i++)
        if (!neph_engine_find(params->engines[i])) {
            neph_fail(diag, NEPH_ERR_USAGE, "there is no engine '%s'", params->engines[i]);
            neph_hint(diag, "`neph engines` lists them");
            return NEPH_ERR_USAGE;
        }
    for (int i = 0; i < neph_participant_count() && !status; i++)
        if (is_wanted(params, neph_participant_at(i)->engine) &&
            neph_engine_find(neph_participant_at(i)->engine))
            status = enrol(neph_participant_at(i), params->samples, &entrants[entrant_count++],
                           diag);
    for (int i = 0; i < neph_check_count(); i++)
        check_count += is_chosen(params, i);
    if (!status && check_count == 0)
        return refuse_check(params->only, diag);
    const int expected = status ? 0 : count_rows(params, entrants, entrant_count);
    struct neph_progress progress = neph_progress_start(params->quiet, 0);
    for (int i = 0; i < entrant_count && !status; i++)
        neph_progress_expect(&progress, i, count_rows(params, &entrants[i], 1), 0.0);
    json_t *checks = json_array(), *rows = json_array();
    for (int i = 0; i < neph_check_count() && !status; i++)
        if (is_chosen(params, i))
            status = run_check(params, i, entrants, entrant_count, store, &progress, checks, rows,
                               diag);
    neph_progress_end(&progress);
    if (!status)
        status = document_of(checks, rows, expected, neph_wall_s() - start_s, document, diag);
    json_decref(checks);
    json_decref(rows);
    return status;
}

static void print_cell(const json_t *row, const char *key, const char *format, int width)
{
    const json_t *value = json_object_get(row, key);
    if (json_is_number(value))
        printf(format, json_number_value(value));
    else
        printf(" %*s", width, "-");
}

static void print_phases(const json_t *phases)
{
    printf("%-22s %8s %14s %14s %14s  %s\n", "phase function", "g", "integral - 1", "cosine - g",
           "sampled - g", "verdict");
    for (size_t i = 0; i < json_array_size(phases); i++) {
        const json_t *phase = json_array_get(phases, i);
        const double g = json_number_value(json_object_get(phase, "g"));
        printf("%-22s %8.3f %+14.1e %+14.1e %+14.1e  %s\n",
               json_string_value(json_object_get(phase, "phase")), g,
               json_number_value(json_object_get(phase, "integral")) - 1.0,
               json_number_value(json_object_get(phase, "mean_cosine")) - g,
               json_number_value(json_object_get(phase, "sampled_mean_cosine")) - g,
               json_string_value(json_object_get(phase, "verdict")));
    }
}

void neph_physics_print(const json_t *document)
{
    print_phases(json_object_get(document, "phase_functions"));
    printf("%-22s %-14s %-9s %11s %10s %8s  %s\n", "check", "participant", "outcome", "deviation",
           "error", "z", "verdict");
    const json_t *rows = json_object_get(document, "rows");
    for (size_t i = 0; i < json_array_size(rows); i++) {
        const json_t *row = json_array_get(rows, i);
        const bool stochastic = json_is_number(json_object_get(row, "standard_error"));
        printf("%-22s %-14s %-9s", json_string_value(json_object_get(row, "check")),
               json_string_value(json_object_get(row, "participant")),
               json_string_value(json_object_get(row, "status")));
        print_cell(row, "deviation", " %+11.3e", 11);
        print_cell(row, stochastic ? "standard_error" : "step_bound", " %10.1e", 10);
        print_cell(row, "z", " %+8.2f", 8);
        printf("  %s%s\n", json_string_value(json_object_get(row, "verdict")),
               json_is_true(json_object_get(row, "lowered")) ? " (single scattering only)" : "");
    }
    for (size_t i = 0; i < json_array_size(rows); i++) {
        const json_t *row = json_array_get(rows, i);
        if (strcmp(json_string_value(json_object_get(row, "verdict")), "off") == 0)
            printf("%s: %s\n", json_string_value(json_object_get(row, "check")),
                   json_string_value(json_object_get(row, "sentence")));
    }
}
