/* SPDX-License-Identifier: MIT */
#include "harness/study/post_study.h"

#include "base/clock.h"
#include "base/exr.h"
#include "base/interrupt.h"
#include "harness/data.h"
#include "harness/engines/engines.h"
#include "harness/engines/vulkan_device.h"
#include "harness/progress.h"
#include "harness/run/seed.h"
#include "harness/study/take.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WHOLE                                                                                      \
    "tone_map=unreal lut=on grain=1 vignette=0.5657 auto_exposure=on "                             \
    "bloom=conserving fxaa=quality_29 sharpen=cas "

const struct neph_post_row neph_post_rows[] = {
    {"no curve, cut off at 1", "tone_map=none", false},
    {NEPH_POST_BASE, "tone_map=unreal", false},
    {"Unreal's curve, HP", "film_slope=0.65 film_toe=0.63 film_shoulder=0.45 film_white_clip=0",
     false},
    {"narkowicz", "tone_map=narkowicz", false},
    {"neutral", "tone_map=neutral", false},
    {"agx", "tone_map=agx", false},
    {"reinhard", "tone_map=reinhard", false},
    {"HDR display, bt2390", "tone_map=bt2390 encode=pq", false},
    {"curve by table", "lut=on", false},
    {"grain", "grain=1", false},
    {"vignette", "vignette=0.5657", false},
    {"automatic exposure", "auto_exposure=on", false},
    {"bloom, conserving", "bloom=conserving", false},
    {"bloom, additive", "bloom=additive", false},
    {"fxaa, console", "fxaa=console", false},
    {"fxaa, quality 12", "fxaa=quality_12", false},
    {"fxaa, quality 29", "fxaa=quality_29", false},
    {"fxaa, quality 39", "fxaa=quality_39", false},
    {"cas", "sharpen=cas", false},
    {"rcas", "sharpen=rcas sharpen_amount=1", false},
    {"upscale to twice, nearest", "upscale=nearest", false},
    {"upscale to twice, bilinear", "upscale=bilinear", false},
    {"upscale to twice, smoothstep", "upscale=smoothstep", false},
    {"upscale to twice, directional", "upscale=directional", false},
    {"upscale to twice, gaussian", "upscale=gaussian", false},
    {"upscale to twice, catmull_rom", "upscale=catmull_rom", false},
    {"upscale to twice, lanczos", "upscale=lanczos", false},
    {"upscale to twice, easu", "upscale=easu", false},
    {"easu and rcas", "upscale=easu sharpen=rcas sharpen_amount=1", false},
    {"the whole", WHOLE, true},
    {"without automatic exposure", WHOLE "auto_exposure=off", true},
    {"without bloom", WHOLE "bloom=off", true},
    {"without table", WHOLE "lut=off", true},
    {"without grain", WHOLE "grain=0", true},
    {"without vignette", WHOLE "vignette=0", true},
    {"without fxaa", WHOLE "fxaa=off", true},
    {"without sharpening", WHOLE "sharpen=off", true},
    {.name = NULL},
};
_Static_assert(sizeof(neph_post_rows) / sizeof(neph_post_rows[0]) <= NEPH_POST_ROWS_MAX,
               "room for every row");

enum { KIND_REFERENCE, KIND_FRAMES, KIND_CHAIN, SETTINGS_MAX = 400 };

struct work {
    const struct neph_post_study_params *params;
    struct neph_post_study *study;
    struct neph_store *store;
    struct neph_progress progress;
    struct neph_open_device *device;
    struct neph_engine_info info; /* of realtime */
    int scene;                    /* at hand */
    struct neph_image **references;
};

/* ---- chains ---------------------------------------------------------------------------------- */

static enum neph_status set_words(const char *words, struct neph_settings *settings,
                                  struct neph_diag *diag)
{
    char copy[SETTINGS_MAX], *rest = copy;
    enum neph_status status = NEPH_OK;
    snprintf(copy, sizeof(copy), "%s", words);
    for (char *word; !status && (word = strsep(&rest, " "));)
        if (word[0])
            status = neph_options_set(neph_post_options, "the picture chain", word, settings, diag);
    return status;
}

static enum neph_status settings_of(const struct neph_post_row *row, double exposure_ev,
                                    struct neph_settings *settings, struct neph_diag *diag)
{
    *settings = neph_options_default(neph_post_options);
    settings->values[POST_TONE] = 1.0;
    const enum neph_status status = set_words(row->settings, settings, diag);
    if (settings->values[POST_AUTO_EXPOSURE] == 0.0)
        settings->values[POST_EXPOSURE_EV] = exposure_ev;
    return status;
}

static enum neph_status measure_rows(struct work *work, const struct neph_post_film *film,
                                     struct neph_diag *diag)
{
    double exposure_ev;
    enum neph_status status = neph_post_meter(work->device->vulkan, film->references[0],
                                              &exposure_ev, diag);
    work->progress.kind = KIND_CHAIN;
    const struct neph_post_row *rows = work->study->rows;
    for (int r = 0; rows[r].name && !status; r++) {
        struct neph_settings settings;
        const double start_s = neph_wall_s();
        if (neph_interrupted())
            return neph_fail(diag, NEPH_ERR_INTERRUPTED, "interrupted");
        neph_progress_begin(&work->progress, rows[r].name);
        status = settings_of(&rows[r], exposure_ev, &settings, diag);
        if (!status)
            status = neph_post_measure(work->device->vulkan, film, &settings,
                                       &work->study->numbers[work->scene][r], diag);
        if (!status)
            neph_progress_step(&work->progress, rows[r].name, "measured", neph_wall_s() - start_s);
    }
    return status;
}

/* ---- frames ---------------------------------------------------------------------------------- */

static enum neph_status read_references(struct work *work, const struct neph_sequence *files,
                                        struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    work->references = calloc((size_t)files->count, sizeof(struct neph_image *));
    if (!work->references)
        return neph_fail_memory(diag);
    for (int i = 0; i < files->count && !status; i++)
        status = neph_exr_read(files->paths[i], &work->references[i], diag);
    return status;
}

static void free_references(struct work *work, int count)
{
    for (int i = 0; work->references && i < count; i++)
        neph_image_destroy(work->references[i]);
    free(work->references);
    work->references = NULL;
}

static enum neph_status look(const struct neph_take *take, const struct neph_take_frames *frames,
                             void *context, struct neph_diag *diag)
{
    struct work *work = context;
    const struct neph_sequence *files = &take->reference->frames[NEPH_REFERENCE_AVERAGED];
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < take->frame_count && !status; i++)
        if (!frames->images[i])
            status = neph_fail(diag, NEPH_ERR_INPUT,
                               "so many frames of that size are not held in memory");
    if (!status)
        status = read_references(work, files, diag);
    const struct neph_post_film film = {
        .tests = frames->images,
        .references = (const struct neph_image *const *)work->references,
        .count = take->frame_count,
        .reference_count = files->count,
        .warm_up = work->params->warm_up,
        .frame_rate_hz = work->params->frame_rate_hz,
        .seed = take->job.shot.seed,
    };
    if (!status)
        status = measure_rows(work, &film, diag);
    free_references(work, files->count);
    return status;
}

static enum neph_status make_job(struct work *work, const struct neph_scene *scene,
                                 struct neph_job *job, struct neph_diag *diag)
{
    const struct neph_post_study_params *params = work->params;
    char steps[32], why[512];
    snprintf(steps, sizeof(steps), "steps=%d", params->steps);
    *job = (struct neph_job){.info = &work->info,
                             .shot = {.scene = scene,
                                      .width_px = params->width_px,
                                      .height_px = params->height_px,
                                      .layers = NEPH_LAYERS_ALL,
                                      .seed = neph_seed_of(scene, params->seed),
                                      .device = params->device}};
    enum neph_status status = neph_engine_words(params->preset, steps, &job->engine,
                                                &job->shot.settings, diag);
    if (!status && !job->engine->can_render(scene, &job->shot.settings, why, sizeof(why)))
        status = neph_fail(diag, NEPH_ERR_UNSUPPORTED, "%s: %s cannot: %s", scene->name,
                           params->preset, why);
    return status;
}

static enum neph_status run_scene(struct work *work, const struct neph_scene *scene,
                                  struct neph_diag *diag)
{
    struct neph_reference reference = {.text = NULL};
    struct neph_take take = {.frame_count = work->params->warm_up + work->params->frame_count,
                             .reference = &reference,
                             .look = look,
                             .look_context = work};
    enum neph_status status = make_job(work, scene, &take.job, diag);
    work->progress.kind = KIND_REFERENCE;
    if (!status)
        status = neph_reference_make(&take.job, take.frame_count, work->store, &work->progress,
                                     &reference, diag);
    work->progress.kind = KIND_FRAMES;
    neph_progress_begin(&work->progress, scene->name);
    if (!status)
        status = neph_take_see(&take, work->store, diag);
    neph_reference_finish(&reference);
    return status;
}

/* ---- the whole ------------------------------------------------------------------------------- */

static bool is_chosen(const struct neph_post_study_params *params, const char *name)
{
    bool has_word = params->chain_count == 0 || strcmp(name, NEPH_POST_BASE) == 0;
    for (int i = 0; i < params->chain_count; i++)
        has_word |= strstr(name, params->chains[i]) != NULL;
    return has_word;
}

static bool is_known(const char *word)
{
    for (int r = 0; neph_post_rows[r].name; r++)
        if (strstr(neph_post_rows[r].name, word))
            return true;
    return false;
}

static enum neph_status choose_rows(struct neph_post_study *study, int *count,
                                    struct neph_diag *diag)
{
    const struct neph_post_study_params *params = study->params;
    for (int i = 0; i < params->chain_count; i++)
        if (!is_known(params->chains[i])) {
            neph_fail(diag, NEPH_ERR_USAGE, "no chain has '%s' in its name", params->chains[i]);
            neph_hint(diag, "`neph study post SCENE` without --chains has all of them");
            return NEPH_ERR_USAGE;
        }
    *count = 0;
    for (int r = 0; neph_post_rows[r].name; r++)
        if (is_chosen(params, neph_post_rows[r].name))
            study->rows[(*count)++] = neph_post_rows[r];
    study->rows[*count].name = NULL;
    return NEPH_OK;
}

static enum neph_status run_scenes(struct work *work, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < work->params->scene_count && !status; i++) {
        struct neph_scene *scene = NULL;
        work->scene = i;
        status = neph_data_load_scene(work->params->scenes[i], &scene, diag);
        if (!status && !(work->study->names[i] = strdup(scene->name)))
            status = neph_fail_memory(diag);
        if (!status)
            status = run_scene(work, scene, diag);
        neph_scene_destroy(scene);
    }
    return status;
}

enum neph_status neph_post_study_run(const struct neph_post_study_params *params,
                                     struct neph_store *store, struct neph_post_study *study,
                                     struct neph_diag *diag)
{
    const struct neph_engine *engine = neph_engine_find("realtime");
    struct work work = {.params = params,
                        .study = study,
                        .store = store,
                        .progress = neph_progress_start(params->quiet, 0)};
    int row_count;
    study->params = params;
    enum neph_status status = choose_rows(study, &row_count, diag);
    if (status)
        return status;
    neph_progress_expect(&work.progress, KIND_REFERENCE, params->scene_count, 0.0);
    neph_progress_expect(&work.progress, KIND_CHAIN, params->scene_count * row_count, 0.0);
    neph_engine_probe(engine, params->device, &work.info);
    if (!work.info.available)
        return neph_fail(diag, NEPH_ERR_UNAVAILABLE, "realtime: %s", work.info.missing);
    snprintf(study->device, sizeof(study->device), "%s", work.info.device);
    status = neph_device_acquire(params->device, &work.device, diag);
    if (!status)
        status = run_scenes(&work, diag);
    neph_progress_end(&work.progress);
    neph_device_release(work.device);
    return status;
}

void neph_post_study_finish(struct neph_post_study *study)
{
    for (int i = 0; i < NEPH_POST_SCENES_MAX; i++)
        free(study->names[i]);
}
