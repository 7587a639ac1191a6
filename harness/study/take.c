/* SPDX-License-Identifier: MIT
 *
 * Captured sequences: rendering, measuring, publication in the store.
 */
#include "harness/study/take.h"

#include "base/exr.h"
#include "base/files.h"
#include "base/path.h"
#include "base/png.h"
#include "base/written.h"
#include "harness/compare/comparison.h"
#include "harness/engines/frame_stats.h"
#include "harness/json_file.h"
#include "metrics/display.h"
#include "metrics/extractors/extractors.h"
#include "metrics/statistics.h"
#include "scenes/display.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Part of the store key of measurements. Raise it when a metric over time changes, or the content
 * of documents or records. */
enum { MEASURED_REVISION = 4 };

/* Memory for the frames of a sequence; later frames are written to files until they are measured.
 */
static const size_t frames_limit_bytes = (size_t)1 << 30;

/* Memory for state of the extractors. Measurement sets share a pass over the frames while their
 * state fits; "seen" and "cycles" need 4 bytes for each pixel and frame. */
static const size_t kept_limit_bytes = (size_t)1 << 30;
enum { KEPT_BYTES_MAX = 8 };

/* ---- frames ---------------------------------------------------------------------------------- */

/* Counters of an engine for a frame (frame_stats.h), which the record sums over all frames. */
static const char *const counted_names[] = {"density_evaluations", "traffic_bytes"};
enum { COUNTED = sizeof(counted_names) / sizeof(counted_names[0]) };

struct frames {
    struct neph_sequence files; /* path of each frame, whether written or not; owned */
    struct neph_image **images; /* NULL: the frame is in its file; array and images owned */
    size_t size_bytes;          /* of the images */
    size_t bad_values;          /* over all frames, where they are counted */
    double counted[COUNTED];    /* sums; NaN: an engine without the counter */
    double *gpu_ms;             /* of each frame; NaN: no timestamps; owned */
};

static char *frame_path(const struct neph_capture *take, const char *folder, int frame)
{
    return frame == take->frame_count - 1 ? neph_path_join(folder, "frame.exr")
                                          : neph_format("%s/frame_%04d.exr", folder, frame);
}

static enum neph_status write_flip(const struct neph_capture *take, const struct neph_image *image,
                                   const char *folder, int number, struct neph_diag *diag)
{
    float *planes[3];
    if (!neph_image_rgb(image, NULL, planes))
        return neph_fail(diag, NEPH_ERR_ENGINE, "a frame of the sequence has no radiance");
    const float *const constant[3] = {planes[0], planes[1], planes[2]};
    uint8_t *rgb = malloc(3 * neph_image_pixel_count(image));
    enum neph_status status = rgb ? NEPH_OK : neph_fail_memory(diag);
    if (!status)
        status = neph_display_encode(constant, neph_image_pixel_count(image),
                                     neph_scene_display(take->job.shot.scene)->exposure_ev, rgb,
                                     diag);
    if (!status)
        status = neph_png_write_rgb8(neph_path_format("%s/flip_%d.png", folder, number).text,
                                     image->width_px, image->height_px, rgb, diag);
    free(rgb);
    return status;
}

/* Removes all layers except radiance, the only one that metrics over time use. */
static void keep_radiance(struct neph_image *frame)
{
    for (int c = frame->channel_count - 1; c >= 0; c--) {
        const char *name = frame->channels[c].name;
        if (strcmp(name, "R") != 0 && strcmp(name, "G") != 0 && strcmp(name, "B") != 0)
            neph_image_remove_channel(frame, name);
    }
}

static void add_counts(struct frames *frames, int number, const struct neph_image *frame)
{
    json_t *stats = neph_frame_stats(frame);
    for (int i = 0; i < COUNTED; i++)
        frames->counted[i] += neph_json_real(stats, counted_names[i]);
    frames->gpu_ms[number] = neph_json_real(stats, "gpu_ms");
    json_decref(stats);
}

bool neph_capture_fits_memory(int width_px, int height_px, int frame_count)
{
    const size_t frame_bytes = 3 * sizeof(float) * (size_t)width_px * (size_t)height_px;
    return frame_bytes <= frames_limit_bytes / (size_t)frame_count;
}

/* Takes ownership of a frame: in memory, or written to a file when the limit is reached. */
static enum neph_status keep_frame(struct frames *frames, int number, struct neph_image *frame,
                                   struct neph_diag *diag)
{
    const size_t size_bytes = neph_image_pixel_count(frame) * (size_t)frame->channel_count *
                              sizeof(float);
    if (frames->size_bytes + size_bytes <= frames_limit_bytes) {
        frames->images[number] = frame;
        frames->size_bytes += size_bytes;
        return NEPH_OK;
    }
    const enum neph_status status = neph_exr_write_plain(frames->files.paths[number], frame, diag);
    neph_image_destroy(frame);
    return status;
}

/* Renders one frame. The last frame becomes frame.exr, which identifies the store entry. */
static enum neph_status render_frame(const struct neph_capture *take, const struct neph_job *job,
                                     int number, const char *folder, struct frames *frames,
                                     struct neph_cost *total, struct neph_diag *diag)
{
    struct neph_image *frame = NULL;
    struct neph_cost cost = {0};
    const int flip = number - (take->frame_count - NEPH_CAPTURE_IMAGES);
    enum neph_status status = (take->counts_bad ? neph_job_render_unchecked
                                                : neph_job_render)(job, &frame, &cost, diag);
    if (status)
        return status;
    if (take->counts_bad)
        frames->bad_values += neph_job_count_bad(frame);
    keep_radiance(frame);
    neph_cost_add(total, &cost);
    add_counts(frames, number, frame);
    if (number == take->frame_count - 1)
        status = neph_exr_write(frames->files.paths[number], frame, diag);
    if (!status && take->with_pictures && flip >= 0)
        status = write_flip(take, frame, folder, flip, diag);
    if (!status)
        return keep_frame(frames, number, frame, diag);
    neph_image_destroy(frame);
    return status;
}

static enum neph_status render_frames(const struct neph_capture *take, const char *folder,
                                      struct frames *frames, struct neph_cost *total,
                                      struct neph_diag *diag)
{
    struct neph_job job = take->job;
    job.shot.scratch_directory = folder;
    enum neph_status status = neph_job_open(&job, diag);
    for (int i = 0; i < take->frame_count && !status; i++) {
        job.shot.frame = take->job.shot.frame + i * (take->frame_step > 0 ? take->frame_step : 1);
        status = render_frame(take, &job, i, folder, frames, total, diag);
    }
    neph_job_close(&job);
    return status;
}

static enum neph_status prepare_frames(const struct neph_capture *take, const char *folder,
                                       struct frames *frames, struct neph_diag *diag)
{
    struct neph_sequence *files = &frames->files;
    frames->images = calloc((size_t)take->frame_count, sizeof(struct neph_image *));
    frames->gpu_ms = calloc((size_t)take->frame_count, sizeof(*frames->gpu_ms));
    files->paths = calloc((size_t)take->frame_count, sizeof(*files->paths));
    if (!frames->images || !frames->gpu_ms || !files->paths)
        return neph_fail_memory(diag);
    for (; files->count < take->frame_count; files->count++)
        if (!(files->paths[files->count] = frame_path(take, folder, files->count)))
            return neph_fail_memory(diag);
    return NEPH_OK;
}

static void finish_frames(const struct neph_capture *take, struct frames *frames)
{
    for (int i = 0; frames->images && i < take->frame_count; i++)
        neph_image_destroy(frames->images[i]);
    free(frames->images);
    free(frames->gpu_ms);
    neph_sequence_finish(&frames->files);
}

/* ---- measuring ------------------------------------------------------------------------------- */

static struct neph_path map_name(const struct neph_measurement_set *reading)
{
    return neph_path_format("%s_%s.exr", reading->name, reading->map);
}

/* A measurement set whose map is kept in a folder. */
struct kept_map {
    const struct neph_measurement_set *reading;
    const char *folder;
};

static enum neph_status keep_map(void *context, const struct neph_map *map,
                                 const struct neph_quantity *quantity, int frame,
                                 const struct neph_image *image, struct neph_diag *diag)
{
    const struct kept_map *kept = context;
    if (frame >= 0 || quantity != neph_quantity_find("radiance") ||
        strcmp(map->name, kept->reading->map) != 0)
        return NEPH_OK;
    return neph_exr_write(neph_path_in(kept->folder, map_name(kept->reading).text).text, image,
                          diag);
}

static enum neph_status choose(const struct neph_measurement_set *reading,
                               struct neph_comparison *comparison, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; reading->extractors[i]; i++) {
        const struct neph_extractor *extractor = neph_extractor_find(reading->extractors[i]);
        struct neph_meter_choice *choice = &comparison->choices[comparison->choice_count++];
        *choice = (struct neph_meter_choice){extractor, neph_options_default(extractor->options)};
        const size_t length = strlen(extractor->name);
        for (int k = 0; reading->settings && reading->settings[k] && !status; k++)
            if (strncmp(reading->settings[k], extractor->name, length) == 0 &&
                reading->settings[k][length] == '.')
                status = neph_options_set(extractor->options, extractor->name,
                                          reading->settings[k] + length + 1, &choice->settings,
                                          diag);
    }
    return status;
}

/* The values that a document keeps: over all frames, or of the only frame. */
struct kept {
    const struct neph_meter_number *numbers;
    bool is_one_frame;
};

static bool is_kept(const struct neph_measurement *number, const void *context)
{
    const struct kept *of = context;
    if ((number->frame >= 0 && !of->is_one_frame) ||
        number->quantity != neph_quantity_find("radiance"))
        return false;
    for (const struct neph_meter_number *kept = of->numbers; kept->metric; kept++)
        if (strcmp(number->metric->name, kept->metric) == 0 &&
            strcmp(number->mask, kept->mask) == 0)
            return true;
    return false;
}

/* Writes the document of a measurement set. `kept` selects a few values of thousands, as hundreds
 * of documents may be read at once; NULL keeps the whole comparison. */
static enum neph_status write_document(const char *folder, const char *name,
                                       struct neph_compared *compared,
                                       const struct neph_meter_number *kept, struct neph_diag *diag)
{
    const struct kept of = {kept, compared->frame_count == 1};
    if (kept)
        neph_measurements_select(&compared->numbers, is_kept, &of);
    json_t *document = kept ? json_pack("{s:o}", "measurements",
                                        neph_measurements_json(&compared->numbers))
                            : neph_compared_json(compared);
    const enum neph_status status = neph_json_write(
        document, JSON_COMPACT, neph_path_format("%s/%s.json", folder, name).text, diag);
    json_decref(document);
    return status;
}

static enum neph_status prepare_comparison(const struct neph_capture *take,
                                           const struct neph_measurement_set *reading,
                                           struct kept_map *kept, const struct frames *frames,
                                           struct neph_comparison *comparison,
                                           struct neph_diag *diag)
{
    const struct neph_reference *reference = reading->reference ? reading->reference
                                                                : take->reference;
    *comparison = (struct neph_comparison){
        .source = &neph_frame_files,
        .reference = reference->frames[reading->against], /* borrowed */
        .test = frames->files,                            /* borrowed */
        .test_images = (const struct neph_image *const *)frames->images,
        .viewing = reading->viewing,
        .wanted = reading->kept,
        .warm_up_frames = reading->warm_up_frames,
        .detail_masks = take->all_masks,
        .take_map = reading->map ? keep_map : NULL,
        .map_context = kept,
        .allow_frozen_frames = take->allow_frozen_frames,
        .plain = take->plain,
        .by_position = true,
        .quiet = true};
    return choose(reading, comparison, diag);
}

/* Evaluates `count` measurement sets from `first` on in one pass over the frames. */
static enum neph_status evaluate_sets(const struct neph_capture *take, int first, int count,
                                      const char *folder, const struct frames *frames,
                                      struct neph_diag *diag)
{
    struct neph_comparison comparisons[NEPH_COMPARISONS_MAX];
    struct neph_compared compared[NEPH_COMPARISONS_MAX] = {{.asked = NULL}};
    struct kept_map kept[NEPH_COMPARISONS_MAX];
    const struct neph_measurement_set *readings = take->readings + first;
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < count && !status; i++) {
        kept[i] = (struct kept_map){&readings[i], folder};
        status = prepare_comparison(take, &readings[i], &kept[i], frames, &comparisons[i], diag);
    }
    if (!status)
        status = neph_comparisons_run(comparisons, count, false, compared, diag);
    for (int i = 0; i < count; i++) {
        if (!status)
            status = write_document(folder, readings[i].name, &compared[i], readings[i].kept, diag);
        neph_compared_finish(&compared[i]);
    }
    return status;
}

static enum neph_status evaluate_all_sets(const struct neph_capture *take, const char *folder,
                                          const struct frames *frames, struct neph_diag *diag)
{
    const struct neph_shot *shot = &take->job.shot;
    const size_t kept_bytes = KEPT_BYTES_MAX * (size_t)shot->width_px * (size_t)shot->height_px *
                              (size_t)take->frame_count;
    const int at_once = (int)fmin(fmax((double)(kept_limit_bytes / kept_bytes), 1.0),
                                  NEPH_COMPARISONS_MAX);
    enum neph_status status = NEPH_OK;
    for (int first = 0; first < take->reading_count && !status; first += at_once) {
        const int left = take->reading_count - first;
        status = evaluate_sets(take, first, left < at_once ? left : at_once, folder, frames, diag);
    }
    return status;
}

/* ---- the store ------------------------------------------------------------------------------- */

/* Prints everything that a document depends on, except the frames. */
static void write_reading(const struct neph_measurement_set *reading, FILE *out)
{
    const struct neph_viewing *viewing = &reading->viewing;
    const char *const *const lists[] = {reading->extractors, reading->settings};
    fprintf(out, "%s against %d at %g Hz %g ppd %g EV %g cd/m2:", reading->name,
            (int)reading->against, viewing->frame_rate_hz, viewing->pixels_per_degree,
            viewing->exposure_ev, viewing->white_cd_per_m2);
    if (reading->reference)
        fprintf(out, " reference %s", reading->reference->key);
    if (reading->map)
        fprintf(out, " map %s", reading->map);
    if (reading->warm_up_frames > 0)
        fprintf(out, " after %d", reading->warm_up_frames);
    for (size_t l = 0; l < sizeof(lists) / sizeof(lists[0]); l++)
        for (int i = 0; lists[l] && lists[l][i]; i++)
            fprintf(out, " %s", lists[l][i]);
    for (const struct neph_meter_number *kept = reading->kept; kept && kept->metric; kept++)
        fprintf(out, " %s@%s", kept->metric, kept->mask);
    fputc('\n', out);
}

struct entry {
    const struct neph_capture *take;
    char first[NEPH_HASH_HEX_SIZE]; /* key of the first frame */
};

static void write_entry(const void *entry_, FILE *out)
{
    const struct entry *entry = entry_;
    const struct neph_capture *take = entry->take;
    fprintf(out,
            "neph-take-1\nfirst %s\nframes %d\nreference %s\nmeasured %d\nmasks %d plain %d\n"
            "pictures %d \n%s",
            entry->first, take->frame_count, take->reference->key, MEASURED_REVISION,
            take->all_masks, take->plain, take->with_pictures,
            take->counts_bad ? "bad values counted\n" : "");
    if (take->frame_step > 1)
        fprintf(out, "every %d\n", take->frame_step);
    for (int i = 0; i < take->reading_count; i++)
        write_reading(&take->readings[i], out);
}

enum neph_status neph_capture_key(const struct neph_capture *take, char key[NEPH_HASH_HEX_SIZE],
                                  struct neph_diag *diag)
{
    struct entry entry = {.take = take};
    char *text = NULL;
    enum neph_status status = neph_job_key(&take->job, entry.first, diag);
    if (!status)
        status = neph_write_to_text(write_entry, &entry, &text, diag);
    if (!status)
        status = neph_hash(text, strlen(text), key, diag);
    free(text);
    return status;
}

/* The images that the store keeps. */
static json_t *image_names(const struct neph_capture *take)
{
    json_t *names = json_array();
    for (int i = 0; i < take->reading_count; i++)
        if (take->readings[i].map)
            neph_json_add(&names, json_string(map_name(&take->readings[i]).text));
    for (int i = 0; i < NEPH_CAPTURE_IMAGES && take->with_pictures; i++)
        neph_json_add(&names, json_sprintf("flip_%d.png", i));
    return names;
}

/* The median, as drivers compile shaders in some frames. */
static double median_gpu_ms(const struct neph_capture *take, const struct frames *frames)
{
    for (int i = 0; i < take->frame_count; i++)
        if (isnan(frames->gpu_ms[i]))
            return NAN;
    return neph_percentile(frames->gpu_ms, (size_t)take->frame_count, 0.5);
}

/* Adds the fields that the store's database has for each job. */
static void describe_job(const struct neph_job *job, json_t **record)
{
    const struct neph_shot *shot = &job->shot;
    char *settings = neph_settings_text(job->engine, &shot->settings);
    neph_json_set(record, "scene_hash", json_string(shot->scene->hash));
    neph_json_set(record, "build", json_string(job->info->build));
    neph_json_set(record, "device", json_string(job->info->device));
    neph_json_set(record, "settings", json_string(settings));
    neph_json_set(record, "size_px", json_pack("[i, i]", shot->width_px, shot->height_px));
    neph_json_set(record, "frame", json_integer(shot->frame));
    neph_json_set(record, "seed", json_integer((json_int_t)shot->seed));
    free(settings);
}

static json_t *make_capture_record(const struct neph_capture *take, const struct neph_cost *cost,
                                   const struct frames *frames)
{
    json_t *record = json_pack(
        "{s:s, s:s, s:s, s:s, s:i, s:f, s:f, s:f, s:o, s:o}", "format", "neph-take-1", "scene",
        take->job.shot.scene->name, "engine", take->job.engine->name, "version",
        take->job.info->version, "frames", take->frame_count, "render_s", cost->render_s, "wall_s",
        cost->wall_s, "cpu_s", cost->cpu_s, "bad_values",
        take->counts_bad ? json_integer((json_int_t)frames->bad_values) : json_null(), "pictures",
        image_names(take));
    for (int i = 0; i < COUNTED; i++)
        neph_json_set(&record, counted_names[i], neph_json_number(frames->counted[i]));
    neph_json_set(&record, "gpu_ms_median", neph_json_number(median_gpu_ms(take, frames)));
    describe_job(&take->job, &record);
    return record;
}

static enum neph_status call_frame_callback(const struct neph_capture *take, const char *folder,
                                            const struct frames *frames, struct neph_diag *diag)
{
    const struct neph_capture_frames seen = {
        .folder = folder,
        .files = &frames->files,
        .images = (const struct neph_image *const *)frames->images,
        .bad_values = frames->bad_values};
    return take->look ? take->look(take, &seen, take->callback_context, diag) : NEPH_OK;
}

/* Renders, measures, shows and publishes a sequence. `key` NULL: only renders and shows it. */
static enum neph_status render_and_publish_capture(const struct neph_capture *take,
                                                   struct neph_store *store, const char *key,
                                                   struct neph_diag *diag)
{
    struct neph_scratch *scratch = NULL;
    char *kept = NULL;
    struct neph_cost cost = {0};
    struct frames frames = {.images = NULL};
    enum neph_status status = neph_store_begin(store, &scratch, diag);
    if (status)
        return status;
    const char *folder = neph_scratch_path(scratch);
    status = prepare_frames(take, folder, &frames, diag);
    if (!status)
        status = render_frames(take, folder, &frames, &cost, diag);
    if (!status && key && frames.bad_values == 0)
        status = evaluate_all_sets(take, folder, &frames, diag);
    if (!status)
        status = call_frame_callback(take, folder, &frames, diag);
    json_t *record = status || !key ? NULL : make_capture_record(take, &cost, &frames);
    finish_frames(take, &frames);
    if (!status && key)
        status = neph_json_check(record, diag);
    if (!status && key)
        status = neph_store_publish(store, key, scratch, record, diag);
    else if (key)
        neph_store_abandon(store, key, scratch, &kept);
    if (status)
        neph_move_paths(diag, folder, kept);
    json_decref(record);
    free(kept);
    neph_scratch_destroy(scratch);
    return status;
}

enum neph_status neph_capture_replay(const struct neph_capture *take, struct neph_store *store,
                                     struct neph_diag *diag)
{
    return render_and_publish_capture(take, store, NULL, diag);
}

bool neph_capture_is_stored(const struct neph_capture *take, struct neph_store *store)
{
    char key[NEPH_HASH_HEX_SIZE], *last_frame = NULL;
    json_t *record = NULL;
    const bool is_stored = neph_capture_key(take, key, NULL) == NEPH_OK &&
                           neph_store_find(store, key, &last_frame, &record);
    json_decref(record);
    free(last_frame);
    return is_stored;
}

enum neph_status neph_capture_run(const struct neph_capture *take, struct neph_store *store,
                                  char **folder, json_t **record, struct neph_diag *diag)
{
    char key[NEPH_HASH_HEX_SIZE], *last_frame = NULL;
    enum neph_status status = neph_capture_key(take, key, diag);
    if (!status && !neph_store_find(store, key, &last_frame, record)) {
        status = render_and_publish_capture(take, store, key, diag);
        if (!status && !neph_store_find(store, key, &last_frame, record))
            status = neph_fail(diag, NEPH_ERR_IO,
                               "the sequence %s is not readable after publishing", key);
    }
    if (status)
        return status;
    *strrchr(last_frame, '/') = '\0';
    *folder = last_frame;
    return NEPH_OK;
}

enum neph_status neph_capture_document(const char *folder, const char *reading, json_t **document,
                                       struct neph_diag *diag)
{
    const struct neph_path path = neph_path_format("%s/%s.json", folder, reading);
    json_error_t error;
    *document = json_load_file(path.text, 0, &error);
    return *document ? NEPH_OK
                     : neph_fail(diag, NEPH_ERR_IO, "cannot read '%s': %s", path.text, error.text);
}

const json_t *neph_capture_find_value(const json_t *document, const char *metric, const char *mask)
{
    const json_t *list = json_object_get(document, "measurements");
    for (size_t i = json_array_size(list); i-- > 0;) { /* values over all frames are listed after
                                                          those of single frames */
        const json_t *item = json_array_get(list, i);
        if (strcmp(neph_json_text(item, "metric"), metric) == 0 &&
            strcmp(neph_json_text(item, "mask"), mask) == 0 &&
            strcmp(neph_json_text(item, "quantity"), "radiance") == 0)
            return item;
    }
    return NULL;
}
