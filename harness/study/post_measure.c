/* SPDX-License-Identifier: MIT
 *
 * Measures one chain of a post study: frames and reference pass through the chain, then the meter.
 */
#include "harness/study/post_measure.h"

#include "metrics/extractors/extractors.h"
#include "metrics/meter.h"
#include "metrics/statistics.h"
#include "renderer/post/display.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const struct neph_meter_number scene_numbers[] = {
    {"rmse", "all"}, {"rel_rmse", "all"}, {"residual_change_rms", "all"}, {.metric = NULL}};
static const struct neph_meter_number display_numbers[] = {{"flip_mean", "all"},
                                                           {"seen_contrast", "all"},
                                                           {"seen_share", "all"},
                                                           {"residual_change_luma_rms", "all"},
                                                           {.metric = NULL}};
static const char *const scene_extractors[] = {"error", "residual_change", NULL};
static const char *const display_extractors[] = {"flip", "seen", "residual_change", NULL};

/* The sequence passing through one chain. */
struct pass {
    struct neph_vulkan *vulkan;
    const struct neph_post_sequence_pair *film;
    struct neph_settings settings;
    struct neph_exposure_state test_eye, reference_eye;
    struct neph_image *reference; /* the latest reference after the chain; owned */
    struct neph_mask *mask;       /* owned */
    struct neph_meter *meter;     /* owned */
    double *ms;                   /* GPU time of each test frame; owned */
};

/* ---- frames through the chain ---------------------------------------------------------------- */

static bool does_anything(const struct neph_settings *settings)
{
    const struct neph_post_stage *sequence[NEPH_POST_STAGES_MAX];
    return neph_post_sequence(NULL, settings, sequence) > 0;
}

static enum neph_status copy(const struct neph_image *frame, struct neph_image **made,
                             struct neph_diag *diag)
{
    float *from[3], *to[3];
    enum neph_status status = neph_image_create(frame->width_px, frame->height_px, made, diag);
    if (!status)
        status = neph_image_add_rgb(*made, NULL, to, diag);
    if (!status && !neph_image_rgb(frame, NULL, from))
        status = neph_fail(diag, NEPH_ERR_INPUT, "a frame has no channels R, G and B");
    for (int c = 0; c < 3 && !status; c++)
        memcpy(to[c], from[c], neph_image_pixel_count(frame) * sizeof(float));
    return status;
}

static enum neph_status run_display_chain(const struct pass *pass,
                                          const struct neph_settings *settings,
                                          const struct neph_image *frame, int number,
                                          struct neph_exposure_state *eye, double *ms,
                                          struct neph_image **made, struct neph_diag *diag)
{
    const struct neph_post_params params = {.settings = *settings,
                                            .frame = number,
                                            .seed = pass->film->seed,
                                            .step_s = 1.0 / pass->film->frame_rate_hz,
                                            .eye = eye};
    struct neph_post_stats stats = {.metered_ev = NAN, .adapted_ev = NAN};
    if (!does_anything(settings))
        return copy(frame, made, diag);
    const enum neph_status status = neph_post_run(pass->vulkan, &params, frame, made, &stats, diag);
    if (status)
        return status;
    if (neph_post_is_displayed(settings))
        neph_post_apply_display(settings, *made);
    *ms = 0.0;
    for (int i = 0; i < NEPH_POST_STAGES_MAX; i++)
        *ms += 1e3 * stats.gpu_s[i];
    return NEPH_OK;
}

/* Processes the reference of a frame; a static reference only once. */
static enum neph_status make_reference(struct pass *pass, int number, struct neph_diag *diag)
{
    const bool stands = pass->film->reference_count == 1;
    struct neph_settings settings = pass->settings;
    double ms;
    if (pass->reference && stands)
        return NEPH_OK;
    settings.values[POST_GRAIN] = 0.0;
    neph_image_destroy(pass->reference);
    pass->reference = NULL;
    return run_display_chain(pass, &settings, pass->film->references[stands ? 0 : number], number,
                             &pass->reference_eye, &ms, &pass->reference, diag);
}

/* ---- the meter ------------------------------------------------------------------------------- */

static enum neph_status open_meter(struct pass *pass, const char *const *extractors,
                                   const struct neph_meter_number *wanted, struct neph_diag *diag)
{
    const struct neph_mask *masks[1];
    struct neph_meter_choice choices[4];
    struct neph_meter_params params = {.choices = choices,
                                       .viewing = NEPH_VIEWING_DEFAULTS,
                                       .masks = masks,
                                       .mask_count = 1,
                                       .wanted = wanted,
                                       .frame_count = pass->film->count - pass->film->warm_up};
    enum neph_status status = neph_mask_create(pass->reference, "all", NULL, &pass->mask, diag);
    masks[0] = pass->mask;
    params.viewing.frame_rate_hz = pass->film->frame_rate_hz;
    if (neph_post_is_hdr(&pass->settings)) /* its values are relative to the peak */
        params.viewing.white_cd_per_m2 = pass->settings.values[POST_PEAK_NITS];
    params.viewing.pixels_per_degree = 60.0; /* as the flicker study's first display */
    for (int i = 0; extractors[i]; i++) {
        const struct neph_extractor *extractor = neph_extractor_find(extractors[i]);
        choices[params.choice_count++] = (struct neph_meter_choice){
            extractor, neph_options_default(extractor->options)};
    }
    return status ? status : neph_meter_create(&params, &pass->meter, diag);
}

static double read_meter_value(const struct neph_meter *meter, const char *metric)
{
    int count;
    const struct neph_measurement *all = neph_meter_measurements(meter, &count);
    for (int i = 0; i < count; i++)
        if (all[i].frame < 0 && all[i].defined && strcmp(all[i].metric->name, metric) == 0)
            return all[i].value;
    return NAN;
}

static void finish(struct pass *pass)
{
    neph_image_destroy(pass->reference);
    neph_meter_destroy(pass->meter);
    neph_mask_destroy(pass->mask);
    free(pass->ms);
}

/* ---- a sequence through the chain ------------------------------------------------------------ */

static enum neph_status take_frame(struct pass *pass, int number, const char *const *extractors,
                                   const struct neph_meter_number *wanted, struct neph_diag *diag)
{
    struct neph_image *test = NULL;
    enum neph_status status = run_display_chain(pass, &pass->settings, pass->film->tests[number],
                                                number, &pass->test_eye, &pass->ms[number], &test,
                                                diag);
    if (!status)
        status = make_reference(pass, number, diag);
    if (!status && !pass->meter)
        status = open_meter(pass, extractors, wanted, diag);
    if (!status && number >= pass->film->warm_up)
        status = neph_meter_frame(pass->meter, pass->reference, NULL, test, diag);
    neph_image_destroy(test);
    return status;
}

static enum neph_status run(struct pass *pass, const char *const *extractors,
                            const struct neph_meter_number *wanted, struct neph_diag *diag)
{
    const int count = pass->film->count;
    pass->ms = calloc((size_t)count, sizeof(*pass->ms));
    enum neph_status status = pass->ms ? NEPH_OK : neph_fail_memory(diag);
    for (int i = 0; i < count && !status; i++)
        status = take_frame(pass, i, extractors, wanted, diag);
    return status ? status : neph_meter_finish(pass->meter, diag);
}

enum neph_status neph_post_meter(struct neph_vulkan *vulkan, const struct neph_image *frame,
                                 double *exposure_ev, struct neph_diag *diag)
{
    struct neph_post_params params = {.settings = neph_options_default(neph_post_options)};
    struct neph_image *made = NULL;
    struct neph_post_stats stats;
    params.settings.values[POST_TONE] = params.settings.values[POST_AUTO_EXPOSURE] = 1.0;
    const enum neph_status status = neph_post_run(vulkan, &params, frame, &made, &stats, diag);
    if (!status)
        *exposure_ev = log2(0.18) - stats.adapted_ev;
    neph_image_destroy(made);
    return status;
}

/* Keeps the stages of a chain that work on scene light. */
static void disable_display_stages(struct neph_settings *settings)
{
    static const int codes[] = {POST_TONE, POST_FXAA, POST_SHARPEN, POST_AUTO_EXPOSURE};
    for (size_t i = 0; i < sizeof(codes) / sizeof(codes[0]); i++)
        settings->values[codes[i]] = 0.0;
}

enum neph_status neph_post_measure(struct neph_vulkan *vulkan,
                                   const struct neph_post_sequence_pair *film,
                                   const struct neph_settings *settings,
                                   struct neph_post_numbers *numbers, struct neph_diag *diag)
{
    struct pass light = {.vulkan = vulkan, .film = film, .settings = *settings};
    struct pass shown = {.vulkan = vulkan, .film = film, .settings = *settings};
    disable_display_stages(&light.settings);
    enum neph_status status = run(&light, scene_extractors, scene_numbers, diag);
    if (!status)
        status = run(&shown, display_extractors, display_numbers, diag);
    if (!status) {
        const double mean = read_meter_value(light.meter, "rmse") /
                            read_meter_value(light.meter, "rel_rmse");
        *numbers = (struct neph_post_numbers){
            .scene_error = read_meter_value(light.meter, "rel_rmse"),
            .scene_change = read_meter_value(light.meter, "residual_change_rms") / mean,
            .flip = neph_post_is_hdr(settings) ? NAN : read_meter_value(shown.meter, "flip_mean"),
            .seen = read_meter_value(shown.meter, "seen_contrast"),
            .seen_share = read_meter_value(shown.meter, "seen_share"),
            .luma_change = read_meter_value(shown.meter, "residual_change_luma_rms"),
            .ms = isnan(shown.ms[0]) ? NAN : neph_percentile(shown.ms, (size_t)film->count, 0.5),
        };
    }
    finish(&light);
    finish(&shown);
    return status;
}
