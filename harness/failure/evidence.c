/* SPDX-License-Identifier: MIT */
#include "harness/failure/evidence.h"

#include "base/exr.h"
#include "base/files.h"
#include "base/png.h"
#include "metrics/display.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A residual that is no number outweighs all that are: squares of floats, summed over all pixels,
 * stay below 1e90. */
static const double bad_weight = 1e100;
static const double scale_of_white = 0.1;

/* ---- frames ---------------------------------------------------------------------------------- */

/* A frame and its reference. */
struct pair {
    struct neph_image *own[2]; /* read for it */
    const float *planes[2][3]; /* frame, reference */
    int width_px, height_px;
    bool has_reference;
};

static enum neph_status take_planes(const struct neph_image *image, const float *planes[3],
                                    struct neph_diag *diag)
{
    float *found[3];
    if (!neph_image_rgb(image, NULL, found))
        return neph_fail(diag, NEPH_ERR_ENGINE, "a frame of the sequence has no radiance");
    for (int c = 0; c < 3; c++)
        planes[c] = found[c];
    return NEPH_OK;
}

static void close_pair(struct pair *pair)
{
    neph_image_destroy(pair->own[0]);
    neph_image_destroy(pair->own[1]);
}

static enum neph_status open_frame(const struct neph_evidence_source *source, int frame,
                                   struct pair *pair, struct neph_diag *diag)
{
    const struct neph_image *image = source->images ? source->images[frame] : NULL;
    if (!image) {
        const enum neph_status status = neph_exr_read(source->files->paths[frame], &pair->own[0],
                                                      diag);
        if (status)
            return status;
        image = pair->own[0];
    }
    pair->width_px = image->width_px;
    pair->height_px = image->height_px;
    return take_planes(image, pair->planes[0], diag);
}

static enum neph_status open_reference(const struct neph_evidence_source *source, int frame,
                                       struct pair *pair, struct neph_diag *diag)
{
    const struct neph_sequence *reference = source->reference;
    if (reference->count == 0)
        return NEPH_OK;
    const enum neph_status status = neph_exr_read(
        reference->paths[reference->count == 1 ? 0 : frame], &pair->own[1], diag);
    if (status)
        return status;
    if (pair->own[1]->width_px != pair->width_px || pair->own[1]->height_px != pair->height_px)
        return neph_fail(diag, NEPH_ERR_INTERNAL, "the reference is of another size");
    pair->has_reference = true;
    return take_planes(pair->own[1], pair->planes[1], diag);
}

/* For close_pair() in any case. */
static enum neph_status open_pair(const struct neph_evidence_source *source, int frame,
                                  struct pair *pair, struct neph_diag *diag)
{
    *pair = (struct pair){.has_reference = false};
    const enum neph_status status = open_frame(source, frame, pair, diag);
    return status ? status : open_reference(source, frame, pair, diag);
}

/* ---- what is shown --------------------------------------------------------------------------- */

static double residual_of(const struct pair *pair, size_t pixel)
{
    double sum = 0.0;
    for (int c = 0; c < 3; c++) {
        const double value = pair->planes[0][c][pixel];
        const double residual = pair->has_reference ? value - pair->planes[1][c][pixel] : 0.0;
        sum += isfinite(value) && value >= 0.0 ? residual * residual : bad_weight;
    }
    return sum;
}

/* Squared residuals of a frame are added to those of its rows. */
static double add_residuals(const struct pair *pair, double *rows)
{
    double sum = 0.0;
    for (int y = 0; y < pair->height_px; y++) {
        double row = 0.0;
        for (int x = 0; x < pair->width_px; x++)
            row += residual_of(pair, (size_t)y * (size_t)pair->width_px + (size_t)x);
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

/* The first of `length` out of `count` that hold `wanted`, with `before` of them before it. */
static int window(int wanted, int before, int length, int count)
{
    const int last = count - length;
    const int first = wanted - before < last ? wanted - before : last;
    return first > 0 ? first : 0;
}

static int at_most(int value, int most)
{
    return value < most ? value : most;
}

static void choose_frames(struct neph_evidence *evidence, int frame_count)
{
    evidence->slice_count = at_most(frame_count, NEPH_EVIDENCE_SLICE);
    evidence->flip_count = at_most(frame_count, NEPH_EVIDENCE_FLIPS);
    evidence->slice_first = window(evidence->worst_frame, evidence->slice_count / 2,
                                   evidence->slice_count, frame_count);
    evidence->flip_first = window(evidence->worst_frame, 1, evidence->flip_count, frame_count);
}

static struct neph_evidence evidence_of(const struct neph_evidence_source *source,
                                        const double *frames, const double *rows, int row_count)
{
    const int frame_count = source->files->count;
    struct neph_evidence evidence = {.worst_frame = largest(frames, frame_count),
                                     .row = largest(rows, row_count),
                                     .scale = scale_of_white * exp2(-source->exposure_ev)};
    if (frame_count > 1 && source->frame_step == 1)
        choose_frames(&evidence, frame_count);
    return evidence;
}

enum neph_status neph_evidence_find(const struct neph_evidence_source *source,
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
                               "frames of several sizes (frames.sizes) have no evidence");
        if (!status) {
            width_px = pair.width_px;
            row_count = pair.height_px;
            frames[i] = add_residuals(&pair, rows);
        }
        close_pair(&pair);
    }
    if (!status)
        *evidence = evidence_of(source, frames, rows, row_count);
    free(frames);
    free(rows);
    return status;
}

/* ---- drawing --------------------------------------------------------------------------------- */

/* Pictures of one size, one after the other. */
struct easel {
    const char *folder;
    double exposure_ev, scale;
    int width_px, height_px;
    json_t *names; /* borrowed */
};

static size_t pixel_count(const struct easel *easel)
{
    return (size_t)easel->width_px * (size_t)easel->height_px;
}

static enum neph_status write_picture(const struct easel *easel, const char *name,
                                      const uint8_t *rgb, struct neph_diag *diag)
{
    char *path = neph_path_join(easel->folder, name);
    enum neph_status status = path ? neph_png_write_rgb8(path, easel->width_px, easel->height_px,
                                                         rgb, diag)
                                   : neph_fail_memory(diag);
    free(path);
    return status ? status : neph_json_append(easel->names, json_string(name), diag);
}

static enum neph_status draw_frame(const struct easel *easel, const float *const planes[3],
                                   const char *name, struct neph_diag *diag)
{
    uint8_t *rgb = malloc(3 * pixel_count(easel));
    enum neph_status status = rgb ? neph_display_encode(planes, pixel_count(easel),
                                                        easel->exposure_ev, rgb, diag)
                                  : neph_fail_memory(diag);
    if (!status)
        status = write_picture(easel, name, rgb, diag);
    free(rgb);
    return status;
}

static enum neph_status draw_difference(const struct easel *easel, const float *const reference[3],
                                        const float *const test[3], const char *name,
                                        struct neph_diag *diag)
{
    uint8_t *rgb = malloc(3 * pixel_count(easel));
    enum neph_status status = rgb ? neph_display_difference(reference, test, 3, pixel_count(easel),
                                                            easel->scale, rgb, diag)
                                  : neph_fail_memory(diag);
    if (!status)
        status = write_picture(easel, name, rgb, diag);
    free(rgb);
    return status;
}

/* "worst" as worst.png, worst_reference.png and worst_difference.png. */
static enum neph_status draw_three(const struct easel *easel, const struct pair *pair,
                                   const char *const names[3], struct neph_diag *diag)
{
    enum neph_status status = draw_frame(easel, pair->planes[0], names[0], diag);
    if (!status && pair->has_reference)
        status = draw_frame(easel, pair->planes[1], names[1], diag);
    if (!status && pair->has_reference)
        status = draw_difference(easel, pair->planes[1], pair->planes[0], names[2], diag);
    return status;
}

static enum neph_status draw_worst(const struct easel *easel, const struct pair *pair,
                                   struct neph_diag *diag)
{
    static const char *const names[] = {"worst.png", "worst_reference.png", "worst_difference.png"};
    return draw_three(easel, pair, names, diag);
}

static enum neph_status draw_flip(const struct easel *easel, const struct pair *pair, int number,
                                  bool with_reference, struct neph_diag *diag)
{
    char name[32];
    snprintf(name, sizeof(name), "flip_%d.png", number);
    enum neph_status status = draw_frame(easel, pair->planes[0], name, diag);
    snprintf(name, sizeof(name), "flip_reference_%d.png", number);
    if (!status && with_reference)
        status = draw_frame(easel, pair->planes[1], name, diag);
    return status;
}

/* A row of pixels of each frame and of its reference, one below the other. */
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

static enum neph_status draw_slice(const struct easel *frames, const struct slice *slice,
                                   struct neph_diag *diag)
{
    static const char *const names[] = {"slice.png", "slice_reference.png", "slice_difference.png"};
    struct easel easel = *frames;
    easel.width_px = slice->rows.width_px;
    easel.height_px = slice->rows.height_px;
    return draw_three(&easel, &slice->rows, names, diag);
}

/* All that a frame is in. */
static enum neph_status draw_pair(const struct neph_evidence_source *source,
                                  const struct neph_evidence *evidence, const struct easel *easel,
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
        status = draw_worst(easel, pair, diag);
    if (!status && flip >= 0 && flip < evidence->flip_count)
        status = draw_flip(easel, pair, flip,
                           source->reference->count > 1 || (pair->has_reference && flip == 0),
                           diag);
    return status;
}

enum neph_status neph_evidence_draw(const struct neph_evidence_source *source,
                                    const struct neph_evidence *evidence, const char *folder,
                                    json_t *names, struct neph_diag *diag)
{
    /* The flips are a part of the slice, and so is the worst. */
    const bool has_slice = evidence->slice_count > 0;
    const int first = has_slice ? evidence->slice_first : evidence->worst_frame;
    const int last = first + (has_slice ? evidence->slice_count : 1);
    struct easel easel = {.folder = folder,
                          .exposure_ev = source->exposure_ev,
                          .scale = evidence->scale,
                          .names = names};
    struct slice slice = {.samples = NULL};
    enum neph_status status = NEPH_OK;
    for (int i = first; i < last && !status; i++) {
        struct pair pair;
        status = open_pair(source, i, &pair, diag);
        easel.width_px = pair.width_px;
        easel.height_px = pair.height_px;
        if (!status)
            status = draw_pair(source, evidence, &easel, &pair, i, &slice, diag);
        close_pair(&pair);
    }
    if (!status && has_slice)
        status = draw_slice(&easel, &slice, diag);
    free(slice.samples);
    return status;
}
