/* SPDX-License-Identifier: MIT
 *
 * Renders the frames of a conformance test on a Vulkan device and checks their values.
 */
#include "harness/run/conform.h"

#include "base/clock.h"
#include "base/exr.h"
#include "base/files.h"
#include "base/path.h"
#include "harness/data.h"
#include "harness/engines/engines.h"
#include "harness/json_file.h"
#include "harness/progress.h"
#include "harness/run/job.h"
#include "metrics/validity.h"
#include "scenes/motion.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const engine_names[] = {
    "march",        "march_octaves",  "march_horizon",    "march_octaves_fitted",
    "march_traced", "march_diffused", "march_similarity", "march_slab",
    "fog_look",     "tracer",         "realtime"};

/* One rendered case: an engine with a preset. The last frame of a sequence is kept. */
struct picture {
    const struct neph_engine *engine;
    const struct neph_preset *preset; /* NULL: the defaults */
    struct neph_engine_info info;
};

static bool is_wanted(const struct neph_conform_params *params, const char *engine)
{
    bool wanted = params->engine_count == 0;
    for (int i = 0; i < params->engine_count; i++)
        wanted = wanted || strcmp(params->engines[i], engine) == 0;
    return wanted;
}

static int list_cases(const struct neph_conform_params *params, struct picture pictures[])
{
    int count = 0;
    for (size_t e = 0; e < sizeof(engine_names) / sizeof(engine_names[0]); e++) {
        const struct neph_engine *engine = neph_engine_find(engine_names[e]);
        if (!is_wanted(params, engine->name))
            continue;
        struct picture picture = {.engine = engine};
        neph_engine_probe(engine, params->device, &picture.info);
        const struct neph_preset *preset = engine->presets;
        do {
            picture.preset = preset && preset->name ? preset : NULL;
            pictures[count++] = picture;
        } while (preset && preset->name && (++preset)->name && count < NEPH_CONFORM_CASES_MAX);
    }
    return count;
}

static struct neph_path name_case(const char *scene, const struct picture *picture)
{
    return neph_path_format("%s_%s%s%s", scene, picture->engine->name, picture->preset ? "_" : "",
                            picture->preset ? picture->preset->name : "");
}

/* --- rendering ---------------------------------------------------------------------------- */

/* Presets have single scattering. In a scene with all orders of scattering, and in Horizon's
 * clouds, a preset is tested with the first lighting that can render the scene. Where none can, the
 * settings stay at the last one tried, and the report has its reason. */
static enum neph_status choose_lighting(const struct neph_scene *scene,
                                        const struct neph_engine *engine,
                                        struct neph_settings *settings, struct neph_diag *diag)
{
    static const char *const lightings[] = {"lighting=octaves", "lighting=horizon",
                                            "lighting=single"};
    char reason[512];
    enum neph_status status = NEPH_OK;
    for (size_t i = 0; i < sizeof(lightings) / sizeof(lightings[0]) && !status; i++) {
        if (engine->can_render(scene, settings, reason, sizeof(reason)))
            return NEPH_OK;
        status = neph_settings_set(engine, settings, lightings[i], diag);
    }
    return status;
}

static enum neph_status fill_job(const struct neph_conform_params *params,
                                 const struct neph_scene *scene, const struct picture *picture,
                                 struct neph_job *job, struct neph_diag *diag)
{
    const struct neph_engine *engine = picture->engine;
    char samples[64];
    *job = (struct neph_job){.engine = engine,
                             .info = &picture->info,
                             .shot = {.scene = scene,
                                      .settings = neph_settings_default(engine),
                                      .width_px = params->width_px,
                                      .height_px = params->height_px,
                                      .layers = NEPH_LAYERS_ALL,
                                      .seed = 1,
                                      .device = params->device}};
    snprintf(samples, sizeof(samples), "samples=%d", params->samples);
    if (strcmp(engine->name, "tracer") == 0)
        return neph_settings_set(engine, &job->shot.settings, samples, diag);
    if (!picture->preset)
        return NEPH_OK;
    const enum neph_status status = neph_settings_preset(engine, picture->preset->name,
                                                         &job->shot.settings, diag);
    return status ? status : choose_lighting(scene, engine, &job->shot.settings, diag);
}

/* Invalid values over all frames of a case. */
struct tally {
    size_t non_finite, negative;
    char first[256]; /* place of the first invalid value; empty: none */
};

static enum neph_status tally_add(struct tally *tally, const struct neph_image *frame,
                                  int frame_number, struct neph_diag *diag)
{
    struct neph_validity validity;
    struct neph_diag words = {.line = 0};
    const enum neph_status status = neph_validity_count(frame, &validity, diag);
    if (status)
        return status;
    tally->non_finite += validity.non_finite_count;
    tally->negative += validity.negative_count;
    if (!tally->first[0] && neph_validity_gate(&validity, 0, &words))
        snprintf(tally->first, sizeof(tally->first), "frame %d: %.200s", frame_number,
                 words.message);
    neph_validity_finish(&validity);
    return NEPH_OK;
}

/* Renders `count` frames, counts the invalid values of all of them and returns the last one. */
static enum neph_status render_case(struct neph_job *job, int count, struct tally *tally,
                                    struct neph_image **last, struct neph_diag *diag)
{
    const int width_px = job->shot.width_px, height_px = job->shot.height_px;
    struct neph_image *frame = NULL;
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < count && !status; i++) {
        struct neph_cost cost;
        neph_image_destroy(frame);
        frame = NULL;
        job->shot.frame = i;
        job->shot.width_px = width_px;
        job->shot.height_px = height_px;
        neph_scene_frame_size(job->shot.scene, i, &job->shot.width_px, &job->shot.height_px);
        if (i == 0)
            status = neph_job_open(job, diag);
        if (!status)
            status = neph_job_render_unchecked(job, &frame, &cost, diag);
        if (!status)
            status = tally_add(tally, frame, i, diag);
    }
    neph_job_close(job);
    if (status) {
        neph_image_destroy(frame);
        return status;
    }
    *last = frame;
    return NEPH_OK;
}

/* --- the files of a frame ----------------------------------------------------------------- */

/* Pixels at the centres of equal parts of the frame. */
static enum neph_status sample_pixel_grid(const struct neph_image *frame,
                                          struct neph_image **lattice, struct neph_diag *diag)
{
    const int width_px = (int)fmin(frame->width_px, NEPH_CONFORM_GRID_WIDTH_PX);
    const int height_px = (int)fmin(frame->height_px, NEPH_CONFORM_GRID_HEIGHT_PX);
    struct neph_image *taken = NULL;
    enum neph_status status = neph_image_create(width_px, height_px, &taken, diag);
    for (int c = 0; c < frame->channel_count && !status; c++) {
        float *to;
        const float *from = frame->channels[c].samples;
        status = neph_image_add_channel(taken, frame->channels[c].name, &to, diag);
        for (int y = 0; y < height_px && !status; y++)
            for (int x = 0; x < width_px; x++) {
                const int at_x = (2 * x + 1) * frame->width_px / (2 * width_px);
                const int at_y = (2 * y + 1) * frame->height_px / (2 * height_px);
                to[y * width_px + x] = from[(size_t)at_y * (size_t)frame->width_px + (size_t)at_x];
            }
    }
    if (status) {
        neph_image_destroy(taken);
        return status;
    }
    *lattice = taken;
    return NEPH_OK;
}

/* Counts and means over all pixels; infinite distances are counted apart. */
static json_t *channel_json(const struct neph_image *frame, const struct neph_channel *channel)
{
    const size_t count = neph_image_pixel_count(frame);
    double sum = 0.0, largest = 0.0;
    size_t finite = 0;
    for (size_t p = 0; p < count; p++) {
        const double value = channel->samples[p];
        if (!isfinite(value))
            continue;
        finite++;
        sum += value;
        largest = fmax(largest, fabs(value));
    }
    return json_pack("{s:s, s:f, s:f, s:I}", "channel", channel->name, "mean",
                     finite > 0 ? sum / (double)finite : 0.0, "largest", largest, "far",
                     (json_int_t)(count - finite));
}

static enum neph_status describe_frame(const struct neph_image *frame, const char *path,
                                       json_t *entry, struct neph_diag *diag)
{
    char hash[NEPH_HASH_HEX_SIZE];
    struct neph_image *lattice = NULL;
    json_t *channels = json_array();
    enum neph_status status = neph_frozen_hash(frame, hash, diag);
    if (!status)
        status = sample_pixel_grid(frame, &lattice, diag);
    if (!status)
        status = neph_exr_write(path, lattice, diag);
    neph_image_destroy(lattice);
    for (int c = 0; c < frame->channel_count; c++)
        neph_json_add(&channels, channel_json(frame, &frame->channels[c]));
    if (!status)
        status = neph_json_put(entry, "hash", json_string(hash), diag);
    if (!status)
        return neph_json_put(entry, "channels", channels, diag);
    json_decref(channels);
    return status;
}

/* --- one case ----------------------------------------------------------------------------- */

static json_t *entry_json(const char *name, const struct neph_job *job, int pictures,
                          const struct tally *tally, enum neph_status status, const char *reason,
                          double seconds)
{
    const bool cannot = status == NEPH_ERR_UNSUPPORTED;
    char *settings = neph_settings_text(job->engine, &job->shot.settings);
    json_t *entry = json_pack(
        "{s:s, s:s, s:s, s:s, s:i, s:[i,i], s:I, s:I, s:s, s:s, s:f}", "picture", name, "engine",
        job->engine->name, "settings", settings ? settings : "", "outcome",
        status == NEPH_OK ? "rendered"
        : cannot          ? "cannot"
                          : "failed",
        "pictures", pictures, "size_px", job->shot.width_px, job->shot.height_px, "non_finite",
        (json_int_t)tally->non_finite, "negative", (json_int_t)tally->negative, "first_wrong",
        tally->first, "reason", reason, "seconds", seconds);
    free(settings);
    return entry;
}

static enum neph_status check_case(const struct neph_conform_params *params,
                                   const struct neph_scene *scene, const struct picture *picture,
                                   const char *name, json_t *entries, struct neph_diag *diag)
{
    const double start_s = neph_wall_s();
    const int count = picture->engine->has_frame_history ? params->pictures : 1;
    struct neph_job job;
    struct neph_image *frame = NULL;
    struct tally tally = {0};
    struct neph_diag words = {.line = 0};
    enum neph_status status = fill_job(params, scene, picture, &job, diag);
    if (status)
        return status;
    const enum neph_status rendered = render_case(&job, count, &tally, &frame, &words);
    /* An engine may fail: the failure becomes an entry of the report. */
    if (rendered == NEPH_ERR_INTERRUPTED || rendered == NEPH_ERR_MEMORY ||
        rendered == NEPH_ERR_UNAVAILABLE) {
        *diag = words;
        return rendered;
    }
    json_t *entry = entry_json(name, &job, count, &tally, rendered, words.message,
                               neph_wall_s() - start_s);
    status = neph_json_append(entries, entry, diag);
    if (!status && frame)
        status = describe_frame(frame, neph_path_format("%s/%s.exr", params->folder, name).text,
                                entry, diag);
    neph_image_destroy(frame);
    return status;
}

static bool is_sound(const json_t *entry)
{
    return strcmp(neph_json_text(entry, "outcome"), "rendered") == 0 &&
           json_integer_value(json_object_get(entry, "non_finite")) == 0 &&
           json_integer_value(json_object_get(entry, "negative")) == 0;
}

/* --- one scene ---------------------------------------------------------------------------- */

static enum neph_status conform_scene(const struct neph_conform_params *params, const char *which,
                                      const struct picture pictures[], int picture_count,
                                      struct neph_progress *progress, json_t *report,
                                      struct neph_diag *diag)
{
    struct neph_scene *scene = NULL;
    enum neph_status status = neph_data_load_scene(which, &scene, diag);
    if (status)
        return status;
    json_t *entries = json_array();
    for (int i = 0; i < picture_count && !status; i++) {
        const double start_s = neph_wall_s();
        const struct neph_path name = name_case(scene->name, &pictures[i]);
        neph_progress_begin(progress, name.text);
        status = check_case(params, scene, &pictures[i], name.text, entries, diag);
        const json_t *entry = json_array_get(entries, (size_t)i);
        const char *outcome = status ? neph_status_name(status) : neph_json_text(entry, "outcome");
        if (strcmp(outcome, "rendered") == 0 && !is_sound(entry))
            outcome = neph_json_text(entry, "first_wrong");
        neph_progress_step(progress, name.text, outcome, neph_wall_s() - start_s);
    }
    json_t *json = json_pack("{s:s, s:s, s:s, s:s, s:s, s:o}", "format", "neph-conform-1", "scene",
                             scene->name, "scene_hash", scene->hash, "device",
                             pictures[0].info.device, "driver", pictures[0].info.version,
                             "pictures", entries);
    if (!status)
        status = neph_json_write(json, JSON_INDENT(1) | JSON_REAL_PRECISION(9),
                                 neph_path_format("%s/%s.json", params->folder, scene->name).text,
                                 diag);
    if (!status)
        status = neph_json_append(report, json_incref(json), diag);
    json_decref(json);
    neph_scene_destroy(scene);
    return status;
}

/* --- all scenes --------------------------------------------------------------------------- */

static enum neph_status check_engines(const struct neph_conform_params *params,
                                      struct neph_diag *diag)
{
    for (int i = 0; i < params->engine_count; i++) {
        bool is_there = false;
        for (size_t e = 0; e < sizeof(engine_names) / sizeof(engine_names[0]); e++)
            is_there = is_there || strcmp(params->engines[i], engine_names[e]) == 0;
        if (is_there)
            continue;
        neph_fail(diag, NEPH_ERR_USAGE, "'%s' is no engine of neph on a Vulkan device",
                  params->engines[i]);
        neph_hint(diag,
                  "march, march_octaves, march_horizon, march_octaves_fitted, march_traced, "
                  "march_diffused, march_similarity, march_slab, fog_look, tracer or realtime");
        return NEPH_ERR_USAGE;
    }
    return NEPH_OK;
}

enum neph_status neph_conform_render(const struct neph_conform_params *params, json_t **report,
                                     struct neph_diag *diag)
{
    struct picture pictures[NEPH_CONFORM_CASES_MAX];
    enum neph_status status = check_engines(params, diag);
    if (status)
        return status;
    const int picture_count = list_cases(params, pictures);
    if (!pictures[0].info.available) {
        neph_fail(diag, NEPH_ERR_UNAVAILABLE, "%s", pictures[0].info.missing);
        neph_hint(diag, "%s", pictures[0].info.install_line);
        return NEPH_ERR_UNAVAILABLE;
    }
    json_t *made = json_array();
    struct neph_progress progress = neph_progress_start(params->quiet,
                                                        params->scene_count * picture_count);
    status = neph_dir_create(params->folder, diag);
    for (int i = 0; i < params->scene_count && !status; i++) {
        struct neph_diag why = {.line = 0};
        status = conform_scene(params, params->scenes[i], pictures, picture_count, &progress, made,
                               &why);
        if (status == NEPH_ERR_NOT_FOUND && params->skip_absent) {
            neph_progress_expect(&progress, progress.kind, -picture_count, 0.0);
            status = neph_json_append(made,
                                      json_pack("{s:s, s:s, s:[]}", "scene", params->scenes[i],
                                                "absent", why.message, "pictures"),
                                      diag);
        } else if (status && diag)
            *diag = why;
    }
    neph_progress_end(&progress);
    if (status)
        json_decref(made);
    else
        *report = made;
    return status;
}

void neph_conform_count(const json_t *report, int *expected, int *sound)
{
    *expected = *sound = 0;
    size_t i, j;
    json_t *scene, *entry;
    json_array_foreach(report, i, scene)
    {
        json_array_foreach(json_object_get(scene, "pictures"), j, entry)
        {
            *expected += strcmp(neph_json_text(entry, "outcome"), "cannot") != 0;
            *sound += is_sound(entry);
        }
    }
}
