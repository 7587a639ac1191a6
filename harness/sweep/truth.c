/* SPDX-License-Identifier: MIT
 *
 * The ground truth of a sweep, and errors against it.
 */
#include "harness/sweep/truth.h"

#include "base/exr.h"
#include "harness/compare/measure.h"
#include "harness/engines/engines.h"
#include "harness/run/job.h"
#include "harness/sweep/repeat.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Fails to compile when a kind is added, as has_interval() interprets them. */
_Static_assert(NEPH_INTERVAL_KIND_COUNT == 5, "a new kind");

static const char *const candidates[] = {"exact", "tracer"};

/* --- frames --------------------------------------------------------------------------------- */

static enum neph_status render(const struct neph_engine *engine,
                               const struct neph_engine_info *info, const struct neph_shot *shot,
                               uint64_t seed, struct neph_store *store,
                               struct neph_sweep_truth *truth, struct neph_image **image,
                               struct neph_diag *diag)
{
    struct neph_job job = {.engine = engine, .info = info, .shot = *shot};
    struct neph_job_result result = {.outcome = NEPH_OUTCOME_FAILED};
    job.shot.seed = seed;
    enum neph_status status = neph_job_run(&job, store, &result, diag);
    if (!status)
        status = neph_outcome_check(result.outcome, result.reason, diag);
    if (!status)
        status = neph_exr_read(result.frame_path, image, diag);
    truth->cpu_s += result.cost.cpu_s;
    truth->wall_s += result.cost.wall_s;
    neph_job_result_finish(&result);
    return status;
}

static enum neph_status check_light(const struct neph_image *image, double *mean,
                                    struct neph_diag *diag)
{
    const size_t count = neph_image_pixel_count(image);
    float *planes[3];
    double sum = 0.0;
    if (!neph_image_rgb(image, NULL, planes))
        return neph_fail(diag, NEPH_ERR_INTERNAL, "a frame of the truth has no radiance");
    for (int c = 0; c < 3; c++)
        for (size_t i = 0; i < count; i++)
            sum += planes[c][i];
    *mean = sum / (3.0 * (double)count);
    return *mean > 0.0
               ? NEPH_OK
               : neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                           "the truth of this scene is black: a relative error is undefined");
}

/* Averages both frames into the first; half their difference is the noise. */
static enum neph_status merge(struct neph_image *first, const struct neph_image *second,
                              double *noise, struct neph_diag *diag)
{
    const size_t count = neph_image_pixel_count(first);
    float *a[3], *b[3];
    double squares = 0.0, mean = 0.0;
    if (!neph_image_rgb(first, NULL, a) || !neph_image_rgb(second, NULL, b))
        return neph_fail(diag, NEPH_ERR_INTERNAL, "a frame of the truth has no radiance");
    for (int c = 0; c < 3; c++)
        for (size_t i = 0; i < count; i++) {
            const double half = 0.5 * ((double)a[c][i] - b[c][i]);
            squares += half * half;
            a[c][i] = (float)(a[c][i] - half);
        }
    const enum neph_status status = check_light(first, &mean, diag);
    if (!status)
        *noise = sqrt(squares / (3.0 * (double)count)) / mean;
    return status;
}

static const char *clear_mask(const struct neph_image *image, struct neph_diag *diag,
                              enum neph_status *status)
{
    const struct neph_viewing viewing = NEPH_VIEWING_DEFAULTS; /* not used by linear errors */
    struct neph_measurements list = {0};
    *status = neph_measure(image, image, "error", &viewing, &list, diag);
    const bool has_edges = neph_measurement_find(&list, "radiance", "rel_rmse", "non_edge");
    neph_measurements_finish(&list);
    return has_edges ? "non_edge" : "all";
}

static enum neph_status render_truth_frames(const struct neph_sweep_plan *plan,
                                            const struct neph_engine *engine,
                                            const struct neph_engine_info *info,
                                            const struct neph_shot *shot, struct neph_store *store,
                                            struct neph_sweep_truth *truth, struct neph_diag *diag)
{
    struct neph_shot own = *shot;
    struct neph_image *second = NULL;
    const int samples = neph_engine_samples(engine);
    own.settings = neph_settings_default(engine);
    own.layers = NEPH_LAYERS_ALL;
    if (samples >= 0)
        own.settings.values[samples] = 0.5 * plan->truth_samples;
    enum neph_status status = render(engine, info, &own,
                                     neph_sweep_seed(shot->seed, NEPH_SWEEP_TRUTH_REPEAT), store,
                                     truth, &truth->image, diag);
    if (!status && engine->stochastic)
        status = render(engine, info, &own,
                        neph_sweep_seed(shot->seed, NEPH_SWEEP_TRUTH_REPEAT + 1), store, truth,
                        &second, diag);
    double mean;
    if (!status)
        status = second ? merge(truth->image, second, &truth->noise, diag)
                        : check_light(truth->image, &mean, diag);
    neph_image_destroy(second);
    return status;
}

enum neph_status neph_sweep_truth_make(const struct neph_sweep_plan *plan,
                                       const struct neph_shot *shot, struct neph_store *store,
                                       struct neph_sweep_truth *truth, struct neph_diag *diag)
{
    char why[512] = "", reason[256];
    *truth = (struct neph_sweep_truth){.mask = "all"};
    for (size_t i = 0; i < sizeof(candidates) / sizeof(candidates[0]); i++) {
        const struct neph_engine *engine = neph_engine_find(candidates[i]);
        const struct neph_settings settings = neph_settings_default(engine);
        struct neph_engine_info info;
        neph_engine_probe(engine, shot->device, &info);
        const bool can = info.available &&
                         engine->can_render(shot->scene, &settings, reason, sizeof(reason));
        if (can) {
            truth->engine = engine;
            enum neph_status status = render_truth_frames(plan, engine, &info, shot, store, truth,
                                                          diag);
            if (!status)
                truth->mask = clear_mask(truth->image, diag, &status);
            return status;
        }
        const size_t used = strlen(why);
        snprintf(why + used, sizeof(why) - used, "%s%s: %s", i > 0 ? "; " : "", engine->name,
                 info.available ? reason : info.missing);
    }
    return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "scene %s has no truth: %s", shot->scene->name,
                     why);
}

void neph_sweep_truth_finish(struct neph_sweep_truth *truth)
{
    neph_image_destroy(truth->image);
    truth->image = NULL;
}

/* --- errors --------------------------------------------------------------------------------- */

static bool has_interval(const struct neph_measurement *found)
{
    return found->interval != NEPH_INTERVAL_NONE && found->low <= found->high;
}

enum neph_status neph_sweep_truth_error(const struct neph_sweep_truth *truth,
                                        const char *frame_path, struct neph_sweep_value *error,
                                        struct neph_diag *diag)
{
    const struct neph_viewing viewing = NEPH_VIEWING_DEFAULTS;
    struct neph_image *image = NULL;
    struct neph_measurements list = {0};
    *error = (struct neph_sweep_value){NAN, NAN, NAN};
    if (!truth->image)
        return NEPH_OK;
    enum neph_status status = neph_exr_read(frame_path, &image, diag);
    if (!status)
        status = neph_measure(truth->image, image, "error", &viewing, &list, diag);
    const struct neph_measurement *found = neph_measurement_find(&list, "radiance", "rel_rmse",
                                                                 truth->mask);
    if (!status && found && found->defined)
        *error = (struct neph_sweep_value){found->value, has_interval(found) ? found->low : NAN,
                                           has_interval(found) ? found->high : NAN};
    neph_measurements_finish(&list);
    neph_image_destroy(image);
    return status;
}
