/* SPDX-License-Identifier: MIT
 *
 * Jobs: key, checks, render, publication in the store.
 */
#include "harness/run/job.h"

#include "base/exr.h"
#include "base/files.h"
#include "base/text.h"
#include "harness/compare/frame.h"
#include "harness/engines/gpu_frames.h"
#include "scenes/injection.h"
#include "scenes/motion.h"
#include "truth/lamp_peak.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Fails to compile when a kind is added, as the tables of this file need a row for it. */
_Static_assert(NEPH_OUTCOME_COUNT == 7, "a new kind");

static const char *const outcome_names[] = {
    [NEPH_OUTCOME_RENDERED] = "rendered",       [NEPH_OUTCOME_CANNOT] = "cannot",
    [NEPH_OUTCOME_MISSING] = "missing",         [NEPH_OUTCOME_FAILED] = "failed",
    [NEPH_OUTCOME_TIMEOUT] = "timeout",         [NEPH_OUTCOME_INTERRUPTED] = "interrupted",
    [NEPH_OUTCOME_OVER_BUDGET] = "over_budget",
};

const char *neph_outcome_name(enum neph_outcome outcome)
{
    return outcome_names[outcome];
}

bool neph_outcome_is_broken(enum neph_outcome outcome)
{
    return outcome == NEPH_OUTCOME_FAILED || outcome == NEPH_OUTCOME_TIMEOUT;
}

enum neph_status neph_job_key(const struct neph_job *job, char key[NEPH_HASH_HEX_SIZE],
                              struct neph_diag *diag)
{
    const struct neph_shot *shot = &job->shot;
    char *settings = neph_settings_text(job->engine, &shot->settings);
    char *injected = job->engine->injects ? neph_injections_text(neph_scene_injections(shot->scene))
                                          : strdup("");
    char *text = neph_format(
        "neph-job-1\nscene %s\nengine %s driver %u\nversion %s\nbuild %s\n"
        "device %s\nsettings %s\nsize %dx%d\nframe %d\nlayers %u\nseed %llu\nrepeat %d\n"
        "%s%s",
        shot->scene->hash, job->engine->name, (unsigned)job->engine->version, job->info->version,
        job->info->build, job->info->device, settings ? settings : "", shot->width_px,
        shot->height_px, shot->frame, shot->layers, (unsigned long long)shot->seed, job->repeat,
        injected && injected[0] ? "inject " : "", injected ? injected : "");
    enum neph_status status = settings && injected && text
                                  ? neph_hash(text, strlen(text), key, diag)
                                  : neph_fail_memory(diag);
    free(settings);
    free(injected);
    free(text);
    return status;
}

/* +inf is valid for the sky and for an invisible medium. */
static bool may_be_infinite(const char *channel)
{
    return strcmp(channel, "Z") == 0 || strcmp(channel, "volume.distance") == 0;
}

static bool may_be_negative(const struct neph_image *frame, const char *channel)
{
    static const char *const radiance[] = {"R", "G", "B", "volume.R", "volume.G", "volume.B"};
    const bool is_signed = neph_image_attribute(frame, NEPH_SIGNED_NOISE_ATTRIBUTE) != NULL;
    for (size_t i = 0; i < sizeof(radiance) / sizeof(radiance[0]) && is_signed; i++)
        if (strcmp(channel, radiance[i]) == 0)
            return true;
    return strncmp(channel, "normal.", strlen("normal.")) == 0;
}

/* Counts invalid values of a channel: not finite, or negative. Exceptions: infinite distances, and
 * negative radiance of an unbiased estimator that labels its frame so. Returns the number of bad
 * values; -inf counts once there, and in both `*non_finite` and `*negative`. */
static size_t count_bad(const struct neph_image *frame, const struct neph_channel *channel,
                        size_t *non_finite, size_t *negative)
{
    const bool is_distance = may_be_infinite(channel->name);
    const bool is_signed = may_be_negative(frame, channel->name);
    const size_t count = neph_image_pixel_count(frame);
    size_t bad = 0;
    *non_finite = *negative = 0;
    for (size_t p = 0; p < count; p++) {
        const float value = channel->samples[p];
        const bool is_endless = !(isfinite(value) || (is_distance && value == INFINITY));
        const bool is_negative = value < 0.0f && !is_signed;
        *non_finite += is_endless;
        *negative += is_negative;
        bad += is_endless || is_negative;
    }
    return bad;
}

size_t neph_job_count_bad(const struct neph_image *frame)
{
    size_t sum = 0, non_finite, negative;
    for (int i = 0; i < frame->channel_count; i++)
        sum += count_bad(frame, &frame->channels[i], &non_finite, &negative);
    return sum;
}

static enum neph_status check_frame(const struct neph_job *job, const struct neph_image *frame,
                                    struct neph_diag *diag)
{
    const struct neph_shot *shot = &job->shot;
    if (frame->width_px != shot->width_px || frame->height_px != shot->height_px)
        return neph_fail(diag, NEPH_ERR_ENGINE, "%s gave a frame of %dx%d instead of %dx%d",
                         job->engine->name, frame->width_px, frame->height_px, shot->width_px,
                         shot->height_px);
    for (int i = 0; i < frame->channel_count; i++) {
        const struct neph_channel *channel = &frame->channels[i];
        size_t non_finite, negative;
        count_bad(frame, channel, &non_finite, &negative);
        if (non_finite + negative > 0)
            return neph_fail(diag, NEPH_ERR_ENGINE,
                             "%s gave an unusable frame: channel %s has %zu non-finite and %zu "
                             "negative values",
                             job->engine->name, channel->name, non_finite, negative);
    }
    return NEPH_OK;
}

static enum neph_status label_frame(const struct neph_job *job, const struct neph_cost *cost,
                                    struct neph_image *frame, struct neph_diag *diag)
{
    const struct neph_shot *shot = &job->shot;
    struct neph_arena arena = {NULL};
    char *settings = neph_settings_text(job->engine, &shot->settings);
    const struct {
        const char *name, *text;
    } texts[] = {
        {"neph.scene", shot->scene->name},
        {"neph.scene_hash", shot->scene->hash},
        {"neph.engine", job->engine->name},
        {"neph.engine_version", job->info->version},
        {"neph.engine_build", job->info->build},
        {"neph.device", job->info->device},
        {"neph.settings", settings},
        {"neph.rung", neph_rung_name(job->engine->rung)},
        {"neph.driver_revision", neph_arena_format(&arena, "%u", (unsigned)job->engine->version)},
        {"neph.frame", neph_arena_format(&arena, "%d", shot->frame)},
        {NEPH_FRAME_RATE_ATTRIBUTE, neph_arena_format(&arena, "%.15g", shot->scene->frame_rate_hz)},
        {"neph.seed", neph_arena_format(&arena, "%llu", (unsigned long long)shot->seed)},
        {"neph.render_s", neph_arena_format(&arena, "%.6f", cost->render_s)},
        {"neph.wall_s", neph_arena_format(&arena, "%.6f", cost->wall_s)},
        {"neph.cpu_s", neph_arena_format(&arena, "%.6f", cost->cpu_s)},
    };
    enum neph_status status = settings ? neph_arena_check(&arena, diag) : neph_fail_memory(diag);
    for (size_t i = 0; i < sizeof(texts) / sizeof(texts[0]) && !status; i++)
        status = neph_image_set_attribute(frame, texts[i].name, diag, "%s", texts[i].text);
    free(settings);
    neph_arena_finish(&arena);
    return status;
}

/* Checks that the engine is available and models the scene. */
static enum neph_status check_possible(const struct neph_job *job, struct neph_diag *diag)
{
    char reason[512];
    const enum neph_status status = neph_engine_check_size(job->engine, job->shot.width_px,
                                                           job->shot.height_px, diag);
    if (status)
        return status;
    if (job->info->broken)
        return neph_fail(diag, NEPH_ERR_ENGINE, "%s is installed and does not work: %s",
                         job->engine->name, job->info->missing);
    if (!job->info->available) {
        neph_fail(diag, NEPH_ERR_UNAVAILABLE, "%s is not available: %s", job->engine->name,
                  job->info->missing);
        neph_hint(diag, "%s", job->info->install_line);
        return NEPH_ERR_UNAVAILABLE;
    }
    if (!neph_engine_can_render(job->engine, job->shot.scene, &job->shot.settings, reason,
                                sizeof(reason)))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "cannot: %s", reason);
    return NEPH_OK;
}

enum neph_status neph_job_explain(const struct neph_job *job, enum neph_status status,
                                  struct neph_diag *diag)
{
    if (status != NEPH_ERR_UNSUPPORTED || !diag || strncmp(diag->message, "cannot: ", 8) != 0)
        return status;
    const struct neph_diag before = *diag;
    const char *lighting = neph_engine_other_lighting(job->engine, job->shot.scene,
                                                      &job->shot.settings);
    neph_fail(diag, status, "%s %s", job->engine->name, before.message);
    if (lighting)
        neph_hint(diag, "-s lighting=%s", lighting);
    else
        neph_hint(diag, "%s", before.hint);
    return status;
}

enum neph_status neph_job_open(struct neph_job *job, struct neph_diag *diag)
{
    if (!job->engine->sequence)
        return NEPH_OK;
    const enum neph_status status = check_possible(job, diag);
    return status ? status
                  : job->engine->sequence->open(job->engine, &job->shot, &job->sequence, diag);
}

void neph_job_close(struct neph_job *job)
{
    if (job->engine->sequence)
        job->engine->sequence->close(job->sequence);
    job->sequence = NULL;
}

/* Engines without a history render static scenes: where the sun or media move, `shot` gets the
 * scene at its frame, which is `*still` then; the caller destroys it. */
static enum neph_status hold_scene(const struct neph_engine *engine, struct neph_shot *shot,
                                   struct neph_scene **still, struct neph_diag *diag)
{
    if (engine->remembers || !neph_scene_moves(shot->scene))
        return NEPH_OK;
    const enum neph_status status = neph_scene_at(shot->scene, shot->frame, still, diag);
    if (!status)
        shot->scene = *still;
    return status;
}

/* Programs without disk space fail in different ways: with their own message, by dying, or with
 * half an image. */
static enum neph_status name_full_disk(enum neph_status status, const struct neph_shot *shot,
                                       struct neph_diag *diag)
{
    static const char *const words[] = {"No space left on device", "Disk quota exceeded",
                                        "Disk full"};
    const bool may_be = status == NEPH_ERR_ENGINE || status == NEPH_ERR_INPUT ||
                        status == NEPH_ERR_IO || status == NEPH_ERR_NOT_FOUND;
    if (!may_be || !shot->scratch_directory)
        return status;
    bool full = neph_disk_is_full(shot->scratch_directory);
    for (size_t i = 0; diag && i < sizeof(words) / sizeof(words[0]); i++)
        full |= strcasestr(diag->message, words[i]) != NULL;
    if (!full || !diag)
        return full ? NEPH_ERR_IO : status;
    const struct neph_diag before = *diag;
    neph_fail(diag, NEPH_ERR_IO, "the disk is full at '%s': %s", shot->scratch_directory,
              before.message);
    neph_hint(diag, "%s", before.hint);
    return NEPH_ERR_IO;
}

enum neph_status neph_job_check(const struct neph_job *job, struct neph_diag *diag)
{
    struct neph_job held = *job;
    struct neph_scene *still = NULL;
    enum neph_status status = hold_scene(job->engine, &held.shot, &still, diag);
    if (!status)
        status = check_possible(&held, diag);
    neph_scene_destroy(still);
    return status;
}

enum neph_status neph_job_render_unchecked(const struct neph_job *job, struct neph_image **frame,
                                           struct neph_cost *cost, struct neph_diag *diag)
{
    struct neph_job held = *job;
    struct neph_scene *still = NULL;
    struct neph_image *rendered = NULL;
    enum neph_status status = hold_scene(job->engine, &held.shot, &still, diag);
    if (!status)
        status = check_possible(&held, diag);
    if (!status) {
        status = held.sequence
                     ? held.engine->sequence->next(held.sequence, &held.shot, &rendered, cost, diag)
                     : neph_engine_render(held.engine, &held.shot, &rendered, cost, diag);
        status = name_full_disk(status, &held.shot, diag);
    }
    if (!status)
        status = label_frame(&held, cost, rendered, diag);
    neph_scene_destroy(still);
    if (status) {
        neph_image_destroy(rendered);
        return status;
    }
    *frame = rendered;
    return NEPH_OK;
}

/* Fails where the radiance is infinite, as no engine renders that correctly. */
static enum neph_status check_is_finite(const struct neph_shot *shot, struct neph_diag *diag)
{
    if (shot->scene->light_count == 0 || !(shot->layers & NEPH_LAYER_RADIANCE))
        return NEPH_OK;
    struct neph_scene *still = NULL;
    struct neph_lamp_peak peak;
    const enum neph_status status = neph_scene_at(shot->scene, shot->frame, &still, diag);
    if (status)
        return status;
    const struct neph_camera camera = neph_scene_camera(shot->scene, shot->frame);
    const bool is_infinite = neph_find_lamp_peak(still, &camera, shot->width_px, shot->height_px,
                                                 &peak);
    neph_scene_destroy(still);
    if (!is_infinite)
        return NEPH_OK;
    neph_fail(
        diag, NEPH_ERR_ENGINE,
        "the radiance of pixel (%d, %d) is infinite in frame %d of scene '%s': %s lights[%d], "
        "inside a medium that scatters its light",
        peak.column, peak.row, shot->frame, shot->scene->name,
        peak.is_at_the_eye ? "its ray begins at" : "its ray goes through", peak.light);
    neph_hint(diag, "%s",
              peak.is_at_the_eye
                  ? "move the light away from the camera, or begin the medium farther away"
                  : "move the light or the camera by a little, or keep the medium away from the "
                    "light");
    return NEPH_ERR_ENGINE;
}

enum neph_status neph_job_render(const struct neph_job *job, struct neph_image **frame,
                                 struct neph_cost *cost, struct neph_diag *diag)
{
    struct neph_image *rendered = NULL;
    enum neph_status status = check_is_finite(&job->shot, diag);
    if (!status)
        status = neph_job_render_unchecked(job, &rendered, cost, diag);
    if (!status)
        status = check_frame(job, rendered, diag);
    if (status) {
        neph_image_destroy(rendered);
        return status;
    }
    *frame = rendered;
    return NEPH_OK;
}

enum neph_status neph_outcome_check(enum neph_outcome outcome, const char *reason,
                                    struct neph_diag *diag)
{
    static const enum neph_status statuses[] = {
        [NEPH_OUTCOME_RENDERED] = NEPH_OK,
        [NEPH_OUTCOME_CANNOT] = NEPH_ERR_UNSUPPORTED,
        [NEPH_OUTCOME_MISSING] = NEPH_ERR_UNAVAILABLE,
        [NEPH_OUTCOME_FAILED] = NEPH_ERR_ENGINE,
        [NEPH_OUTCOME_TIMEOUT] = NEPH_ERR_TIMEOUT,
        [NEPH_OUTCOME_INTERRUPTED] = NEPH_ERR_INTERRUPTED,
        [NEPH_OUTCOME_OVER_BUDGET] = NEPH_ERR_TIMEOUT,
    };
    const enum neph_status status = statuses[outcome];
    return status ? neph_fail(diag, status, "%s", reason) : NEPH_OK;
}

static json_t *make_record(const struct neph_job *job, const struct neph_job_result *result)
{
    const struct neph_shot *shot = &job->shot;
    return json_pack(
        "{s:s, s:s, s:s, s:s, s:i, s:s, s:s, s:s, s:s, s:[i,i], s:i, s:i, s:i, s:i, s:f, s:f, s:f, "
        "s:I}",
        "format", "neph-job-1", "scene", shot->scene->name, "scene_hash", shot->scene->hash,
        "engine", job->engine->name, "driver", (int)job->engine->version, "version",
        job->info->version, "build", job->info->build, "device", job->info->device, "settings",
        result->settings, "size_px", shot->width_px, shot->height_px, "frame", shot->frame,
        "layers", (int)shot->layers, "seed", (int)shot->seed, "repeat", job->repeat, "render_s",
        result->cost.render_s, "wall_s", result->cost.wall_s, "cpu_s", result->cost.cpu_s,
        "peak_memory_bytes", (json_int_t)result->cost.peak_memory_bytes);
}

static struct neph_cost cost_of_record(const json_t *record)
{
    return (struct neph_cost){
        .render_s = json_number_value(json_object_get(record, "render_s")),
        .wall_s = json_number_value(json_object_get(record, "wall_s")),
        .cpu_s = json_number_value(json_object_get(record, "cpu_s")),
        .peak_memory_bytes = json_integer_value(json_object_get(record, "peak_memory_bytes")),
    };
}

/* The outcome of a status; `*ends_run`: the run cannot go on. All other failures concern one
 * engine. */
static enum neph_outcome outcome_of(enum neph_status status, bool *ends_run)
{
    *ends_run = status == NEPH_ERR_INTERRUPTED || status == NEPH_ERR_MEMORY;
    switch (status) {
    case NEPH_OK:
        return NEPH_OUTCOME_RENDERED;
    case NEPH_ERR_UNAVAILABLE:
        return NEPH_OUTCOME_MISSING;
    case NEPH_ERR_UNSUPPORTED:
        return NEPH_OUTCOME_CANNOT;
    case NEPH_ERR_TIMEOUT:
        return NEPH_OUTCOME_TIMEOUT;
    case NEPH_ERR_INTERRUPTED:
        return NEPH_OUTCOME_INTERRUPTED;
    case NEPH_ERR_USAGE:
    case NEPH_ERR_INPUT:
    case NEPH_ERR_NOT_FOUND:
    case NEPH_ERR_IO:
    case NEPH_ERR_MEMORY:
    case NEPH_ERR_ENGINE:
    case NEPH_ERR_GATE:
    case NEPH_ERR_INTERNAL:
    case NEPH_STATUS_COUNT:
        break;
    }
    return NEPH_OUTCOME_FAILED;
}

static void explain(struct neph_job_result *result, const struct neph_diag *diag, const char *kept)
{
    neph_text_format(result->reason, sizeof(result->reason), "%s%s%s%s%s", diag->message,
                     diag->hint[0] ? "; " : "", diag->hint, kept ? "; logs: " : "",
                     kept ? kept : "");
}

/* Renders into a scratch folder and publishes the frame. */
static enum neph_status render_and_publish(const struct neph_job *job, struct neph_store *store,
                                           const char *key, struct neph_job_result *result,
                                           struct neph_diag *diag)
{
    struct neph_scratch *scratch = NULL;
    char *kept = NULL;
    const struct neph_path resting = neph_store_resting_place(store, key);
    struct neph_image *frame = NULL;
    json_t *record = NULL;
    enum neph_status status = neph_store_begin(store, &scratch, diag);
    if (status)
        return status;
    struct neph_job placed = *job;
    placed.shot.scratch_directory = neph_scratch_path(scratch);
    placed.shot.checkpoint = job->engine->rests ? resting.text : NULL;
    struct neph_diag engine_diag = {.line = 0};
    status = neph_job_render(&placed, &frame, &result->cost, &engine_diag);
    bool ends_run;
    result->outcome = outcome_of(status, &ends_run);
    if (placed.shot.checkpoint && status != NEPH_ERR_INTERRUPTED)
        unlink(resting.text); /* finished, or unusable */
    if (status) {
        neph_store_abandon(store, key, scratch, &kept);
        neph_move_paths(&engine_diag, neph_scratch_path(scratch), kept);
        explain(result, &engine_diag, kept);
        if (ends_run && diag)
            *diag = engine_diag;
        status = ends_run ? status : NEPH_OK;
        goto done;
    }
    record = make_record(job, result);
    status = neph_json_check(record, diag);
    if (!status)
        status = neph_store_clean(scratch, diag);
    if (!status)
        status = neph_exr_write(neph_path_in(neph_scratch_path(scratch), "frame.exr").text, frame,
                                diag);
    if (!status)
        status = neph_store_publish(store, key, scratch, record, diag);
done:
    json_decref(record);
    neph_image_destroy(frame);
    free(kept);
    neph_scratch_destroy(scratch);
    return status;
}

/* Like neph_job_reuse(), and computes the key. */
static enum neph_status look_up(const struct neph_job *job, struct neph_store *store,
                                char key[NEPH_HASH_HEX_SIZE], struct neph_job_result *result,
                                bool *found, struct neph_diag *diag)
{
    memset(result, 0, sizeof(*result));
    const enum neph_status status = neph_job_key(job, key, diag);
    if (status)
        return status;
    result->settings = neph_settings_text(job->engine, &job->shot.settings);
    if (!result->settings)
        return neph_fail_memory(diag);
    json_t *record = NULL;
    *found = neph_store_find(store, key, &result->frame_path, &record);
    if (*found) {
        result->outcome = NEPH_OUTCOME_RENDERED;
        result->reused = true;
        result->cost = cost_of_record(record);
    }
    json_decref(record);
    return NEPH_OK;
}

enum neph_status neph_job_reuse(const struct neph_job *job, struct neph_store *store,
                                struct neph_job_result *result, bool *found, struct neph_diag *diag)
{
    char key[NEPH_HASH_HEX_SIZE];
    return look_up(job, store, key, result, found, diag);
}

enum neph_status neph_job_run(const struct neph_job *job, struct neph_store *store,
                              struct neph_job_result *result, struct neph_diag *diag)
{
    char key[NEPH_HASH_HEX_SIZE];
    bool found = false;
    enum neph_status status = look_up(job, store, key, result, &found, diag);
    if (status || found)
        return status;
    struct neph_diag why = {.line = 0};
    bool ends_run;
    result->outcome = outcome_of(check_possible(job, &why), &ends_run);
    if (result->outcome != NEPH_OUTCOME_RENDERED) {
        explain(result, &why, NULL);
        return NEPH_OK;
    }
    status = render_and_publish(job, store, key, result, diag);
    if (status || result->outcome != NEPH_OUTCOME_RENDERED)
        return status;
    json_t *record = NULL;
    if (!neph_store_find(store, key, &result->frame_path, &record))
        return neph_fail(diag, NEPH_ERR_IO, "frame %s of %s is not readable after publishing", key,
                         job->engine->name);
    json_decref(record);
    return NEPH_OK;
}

void neph_job_result_finish(struct neph_job_result *result)
{
    free(result->settings);
    free(result->frame_path);
    result->settings = NULL;
    result->frame_path = NULL;
}
