/* SPDX-License-Identifier: MIT
 *
 * Images as evidence of a verdict: selection of frames and rows, drawing, publication in the store.
 */
#include "harness/stress/evidence.h"

#include "base/exr.h"
#include "base/files.h"
#include "base/path.h"
#include "harness/compare/comparison.h"
#include "harness/document/display_png.h"
#include "metrics/extractors/extractors.h"
#include "metrics/extractors/seen_spectrum.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Residual of a pixel with an invalid value. It outweighs all finite residuals: their squares,
 * summed over all pixels of floats, stay below 1e90. */
static const double bad_weight = 1e100;
static const double scale_of_white = 0.1;

/* ---- frames ---------------------------------------------------------------------------------- */

enum part { FRAME, REFERENCE, DIFFERENCE };

/* A frame with its reference. */
struct pair {
    struct neph_image *own[2]; /* images read from files; owned */
    const float *planes[2][3];
    int width_px, height_px;
    bool has_reference;
};

/* Sets the planes of one part; reads the file when `image` is NULL. Call it for the frame before
 * its reference, as their sizes are compared. */
static enum neph_status open_planes(const char *path, const struct neph_image *image,
                                    enum part part, struct pair *pair, struct neph_diag *diag)
{
    float *planes[3];
    if (!image) {
        const enum neph_status status = neph_exr_read(path, &pair->own[part], diag);
        if (status)
            return status;
        image = pair->own[part];
    }
    if (part == REFERENCE &&
        (image->width_px != pair->width_px || image->height_px != pair->height_px))
        return neph_fail(diag, NEPH_ERR_INTERNAL, "the reference has another size");
    if (!neph_image_rgb(image, NULL, planes))
        return neph_fail(diag, NEPH_ERR_ENGINE, "a frame of the sequence has no radiance");
    for (int c = 0; c < 3; c++)
        pair->planes[part][c] = planes[c];
    pair->width_px = image->width_px;
    pair->height_px = image->height_px;
    return NEPH_OK;
}

/* Call close_pair() in any case. */
static enum neph_status open_pair(const struct neph_evidence_source *source, int frame,
                                  struct pair *pair, struct neph_diag *diag)
{
    const struct neph_sequence *reference = source->reference;
    *pair = (struct pair){.has_reference = reference->count > 0};
    const enum neph_status status = open_planes(source->files->paths[frame],
                                                source->images ? source->images[frame] : NULL,
                                                FRAME, pair, diag);
    return status || !pair->has_reference
               ? status
               : open_planes(reference->paths[reference->count == 1 ? 0 : frame], NULL, REFERENCE,
                             pair, diag);
}

static void close_pair(struct pair *pair)
{
    neph_image_destroy(pair->own[FRAME]);
    neph_image_destroy(pair->own[REFERENCE]);
}

/* ---- selection of frames and rows ------------------------------------------------------------ */

static double compute_squared_residual(const struct pair *pair, size_t pixel)
{
    double sum = 0.0;
    for (int c = 0; c < 3; c++) {
        const double value = pair->planes[0][c][pixel];
        const double residual = pair->has_reference ? value - pair->planes[1][c][pixel] : 0.0;
        sum += isfinite(value) && value >= 0.0 ? residual * residual : bad_weight;
    }
    return sum;
}

/* Adds the squared residuals of a frame to the sums of its rows; returns the sum over the frame. */
static double add_residuals(const struct pair *pair, double *rows)
{
    double sum = 0.0;
    for (int y = 0; y < pair->height_px; y++) {
        double row = 0.0;
        for (int x = 0; x < pair->width_px; x++)
            row += compute_squared_residual(pair, (size_t)y * (size_t)pair->width_px + (size_t)x);
        rows[y] += row;
        sum += row;
    }
    return sum;
}

static int largest(const double *values, int count)
{
    int found = 0;
    for (int i = 1; i < count; i++)
        if (values[i] > values[found])
            found = i;
    return found;
}

/* Chooses up to `most` consecutive frames, starting `before` frames before the worst one where
 * possible. */
static void choose_window(int worst, int most, int before, int frame_count, int *first, int *count)
{
    *count = frame_count < most ? frame_count : most;
    const int last = frame_count - *count;
    const int wanted = worst - before < last ? worst - before : last;
    *first = wanted > 0 ? wanted : 0;
}

enum neph_status neph_evidence_choose(const struct neph_evidence_source *source,
                                      struct neph_evidence *evidence, struct neph_diag *diag)
{
    const int count = source->files->count;
    double *frames = calloc((size_t)count, sizeof(*frames));
    double *rows = calloc(NEPH_IMAGE_SIDE_MAX_PX, sizeof(*rows));
    int width_px = 0, row_count = 0;
    enum neph_status status = frames && rows ? NEPH_OK : neph_fail_memory(diag);
    for (int i = 0; i < count && !status; i++) {
        struct pair pair;
        status = open_pair(source, i, &pair, diag);
        if (!status && i > 0 && (pair.width_px != width_px || pair.height_px != row_count))
            status = neph_fail(diag, NEPH_ERR_INPUT,
                               "no evidence is drawn for frames of several sizes (frames.sizes)");
        if (!status) {
            width_px = pair.width_px;
            row_count = pair.height_px;
            frames[i] = add_residuals(&pair, rows);
        }
        close_pair(&pair);
    }
    if (!status)
        *evidence = (struct neph_evidence){.worst_frame = largest(frames, count),
                                           .row = largest(rows, row_count),
                                           .scale = scale_of_white * exp2(-source->exposure_ev)};
    if (!status && count > 1 && source->frame_step == 1) {
        choose_window(evidence->worst_frame, NEPH_EVIDENCE_SLICE, NEPH_EVIDENCE_SLICE / 2, count,
                      &evidence->slice_first, &evidence->slice_count);
        choose_window(evidence->worst_frame, NEPH_EVIDENCE_FLIPS, 1, count, &evidence->flip_first,
                      &evidence->flip_count);
    }
    free(frames);
    free(rows);
    return status;
}

/* ---- drawing --------------------------------------------------------------------------------- */

/* Destination and display of the images. */
struct target {
    const char *folder;
    double exposure_ev, scale;
    json_t *names; /* borrowed */
};

static enum neph_status draw(const struct target *target, const struct pair *pair, enum part part,
                             const char *name, struct neph_diag *diag)
{
    const struct neph_path path = neph_path_in(target->folder, name);
    const enum neph_status status =
        part == DIFFERENCE
            ? neph_difference_png(path.text, pair->width_px, pair->height_px,
                                  pair->planes[REFERENCE], pair->planes[FRAME], target->scale, diag)
            : neph_display_png(path.text, pair->width_px, pair->height_px, pair->planes[part],
                               target->exposure_ev, diag);
    return status ? status : neph_json_append(target->names, json_string(name), diag);
}

/* Draws for example worst.png, worst_reference.png and worst_difference.png. */
static enum neph_status draw_three(const struct target *target, const struct pair *pair,
                                   const char *stem, struct neph_diag *diag)
{
    static const char *const ends[] = {"", "_reference", "_difference"};
    enum neph_status status = NEPH_OK;
    for (int part = FRAME; part <= (pair->has_reference ? DIFFERENCE : FRAME) && !status; part++) {
        char name[40];
        snprintf(name, sizeof(name), "%s%s.png", stem, ends[part]);
        status = draw(target, pair, (enum part)part, name, diag);
    }
    return status;
}

static enum neph_status draw_flip(const struct target *target, const struct pair *pair, int number,
                                  bool with_reference, struct neph_diag *diag)
{
    char name[32];
    snprintf(name, sizeof(name), "flip_%d.png", number);
    enum neph_status status = draw(target, pair, FRAME, name, diag);
    snprintf(name, sizeof(name), "flip_reference_%d.png", number);
    if (!status && with_reference)
        status = draw(target, pair, REFERENCE, name, diag);
    return status;
}

/* One row of pixels of each frame and of its reference, as images over time. */
struct slice {
    float *samples; /* owned: six planes */
    struct pair rows;
};

static enum neph_status start_slice(struct slice *slice, int width_px, int count,
                                    struct neph_diag *diag)
{
    const size_t size = (size_t)width_px * (size_t)count;
    slice->samples = calloc(6 * size, sizeof(float));
    slice->rows = (struct pair){.width_px = width_px, .height_px = count};
    for (size_t p = 0; p < 6 && slice->samples; p++)
        slice->rows.planes[p / 3][p % 3] = slice->samples + p * size;
    return slice->samples ? NEPH_OK : neph_fail_memory(diag);
}

static void fill_slice(struct slice *slice, const struct pair *pair, int row, int number)
{
    const size_t width = (size_t)pair->width_px;
    const size_t plane = width * (size_t)slice->rows.height_px;
    slice->rows.has_reference = pair->has_reference;
    for (size_t p = 0; p < (pair->has_reference ? 6 : 3); p++)
        memcpy(slice->samples + p * plane + (size_t)number * width,
               pair->planes[p / 3][p % 3] + (size_t)row * width, width * sizeof(float));
}

/* Draws all images that a frame is part of. */
static enum neph_status draw_pair(const struct neph_evidence_source *source,
                                  const struct neph_evidence *evidence, const struct target *target,
                                  const struct pair *pair, int frame, struct slice *slice,
                                  struct neph_diag *diag)
{
    const int flip = frame - evidence->flip_first, row = frame - evidence->slice_first;
    enum neph_status status = NEPH_OK;
    if (!slice->samples && evidence->slice_count > 0)
        status = start_slice(slice, pair->width_px, evidence->slice_count, diag);
    if (!status && row >= 0 && row < evidence->slice_count)
        fill_slice(slice, pair, evidence->row, row);
    if (!status && frame == evidence->worst_frame)
        status = draw_three(target, pair, "worst", diag);
    if (!status && flip >= 0 && flip < evidence->flip_count)
        status = draw_flip(target, pair, flip,
                           source->reference->count > 1 || (pair->has_reference && flip == 0),
                           diag);
    return status;
}

enum neph_status neph_evidence_draw(const struct neph_evidence_source *source,
                                    const struct neph_evidence *evidence, const char *folder,
                                    json_t *names, struct neph_diag *diag)
{
    /* The slice contains the flip-book and the worst frame. */
    const bool has_slice = evidence->slice_count > 0;
    const int first = has_slice ? evidence->slice_first : evidence->worst_frame;
    const int last = first + (has_slice ? evidence->slice_count : 1);
    const struct target target = {.folder = folder,
                                  .exposure_ev = source->exposure_ev,
                                  .scale = evidence->scale,
                                  .names = names};
    struct slice slice = {.samples = NULL};
    enum neph_status status = NEPH_OK;
    for (int i = first; i < last && !status; i++) {
        struct pair pair;
        status = open_pair(source, i, &pair, diag);
        if (!status)
            status = draw_pair(source, evidence, &target, &pair, i, &slice, diag);
        close_pair(&pair);
    }
    if (!status && has_slice)
        status = draw_three(&target, &slice.rows, "slice", diag);
    free(slice.samples);
    return status;
}

/* ---- in the store ---------------------------------------------------------------------------- */

/* Part of the store key: raise it when the images change. */
enum { DRAWN_REVISION = 2 };

enum neph_status neph_evidence_key(const char *take_key, double exposure_ev,
                                   char key[NEPH_HASH_HEX_SIZE], struct neph_diag *diag)
{
    char text[160];
    snprintf(text, sizeof(text), "neph-exhibit-%d\n%s\nexposure_ev %.17g\n", DRAWN_REVISION,
             take_key, exposure_ev);
    return neph_hash(text, strlen(text), key, diag);
}

char *neph_evidence_find(struct neph_store *store, const char *key)
{
    char *path;
    json_t *record;
    if (!neph_store_find(store, key, &path, &record))
        return NULL;
    json_decref(record);
    *strrchr(path, '/') = '\0';
    return path;
}

/* Draws the map of visible flicker. One value is requested because a comparison needs at least one.
 */
static enum neph_status draw_flicker(const struct neph_evidence_source *source,
                                     const struct neph_viewing *viewing, const char *folder,
                                     json_t *names, struct neph_diag *diag)
{
    static const struct neph_meter_number wanted[] = {{"seen_contrast", "all"}, {.metric = NULL}};
    const struct neph_extractor *seen = neph_extractor_find("seen");
    struct neph_comparison comparison = {.source = &neph_frame_files,
                                         .reference = *source->reference,
                                         .test = *source->files,
                                         .test_images = source->images,
                                         .viewing = *viewing,
                                         .wanted = wanted,
                                         .maps_directory = folder,
                                         .allow_frozen_frames = true,
                                         .plain = true,
                                         .by_position = true,
                                         .quiet = true};
    struct neph_compared compared = {.asked = NULL};
    comparison.choices[comparison.choice_count++] = (struct neph_meter_choice){
        seen, neph_options_default(seen->options)};
    enum neph_status status = neph_comparison_run(&comparison, false, &compared, diag);
    if (!status && neph_path_exists(neph_path_in(folder, NEPH_EVIDENCE_FLICKER_MAP).text))
        status = neph_json_append(names, json_string(NEPH_EVIDENCE_FLICKER_MAP), diag);
    neph_compared_finish(&compared);
    return status;
}

/* Keeps the worst frame as frame.exr, which identifies the store entry. */
static enum neph_status keep_worst(const struct neph_evidence_source *source, int frame,
                                   const char *folder, struct neph_diag *diag)
{
    const struct neph_image *image = source->images ? source->images[frame] : NULL;
    const struct neph_path path = neph_path_in(folder, "frame.exr");
    return image ? neph_exr_write(path.text, image, diag)
                 : neph_file_copy(source->files->paths[frame], path.text, diag);
}

enum neph_status neph_evidence_make(struct neph_store *store, const char *key,
                                    const struct neph_job *job,
                                    const struct neph_evidence_source *source,
                                    const struct neph_viewing *viewing, bool with_map,
                                    struct neph_diag *diag)
{
    struct neph_scratch *scratch = NULL;
    struct neph_evidence evidence;
    json_t *names = json_array(), *record = NULL;
    enum neph_status status = neph_json_check(names, diag);
    if (!status)
        status = neph_evidence_choose(source, &evidence, diag);
    if (!status)
        status = neph_store_begin(store, &scratch, diag);
    if (!status)
        status = neph_evidence_draw(source, &evidence, neph_scratch_path(scratch), names, diag);
    if (!status && with_map && source->reference->count > 0 &&
        source->files->count >= NEPH_SEEN_FRAMES_MIN)
        status = draw_flicker(source, viewing, neph_scratch_path(scratch), names, diag);
    if (!status)
        status = keep_worst(source, evidence.worst_frame, neph_scratch_path(scratch), diag);
    if (!status) {
        record = json_pack(
            "{s:s, s:O, s:i, s:i, s:i, s:i, s:i, s:i, s:i, s:f, s:s, s:s, s:s, s:s}", "format",
            "neph-exhibit-1", "pictures", names, "frame_step", source->frame_step, "worst_frame",
            evidence.worst_frame, "row", evidence.row, "slice_first", evidence.slice_first,
            "slice_count", evidence.slice_count, "flip_first", evidence.flip_first, "flip_count",
            evidence.flip_count, "scale", evidence.scale, "engine", job->engine->name, "version",
            job->info->version, "build", job->info->build, "device", job->info->device);
        status = neph_json_check(record, diag);
    }
    if (!status)
        status = neph_store_publish(store, key, scratch, record, diag);
    json_decref(names);
    json_decref(record);
    neph_scratch_destroy(scratch);
    return status;
}
