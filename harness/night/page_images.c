/* SPDX-License-Identifier: MIT */
#include "harness/night/page_images.h"

#include "base/exr.h"
#include "base/files.h"
#include "base/sort.h"
#include "harness/data.h"
#include "harness/document/display_png.h"
#include "harness/report/page.h"
#include "scenes/display.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The largest share of pixels that the scale of a difference image may clip. */
static const double beyond_share = 0.01;

enum neph_status neph_night_images_begin(struct neph_night_images *pictures,
                                         struct neph_store *store, const char *page_folder,
                                         size_t limit_bytes, struct neph_diag *diag)
{
    *pictures = (struct neph_night_images){.store = store,
                                           .folder = neph_path_in(page_folder, "images"),
                                           .scenes = json_object(),
                                           .counted = json_object(),
                                           .limit_bytes = limit_bytes};
    return pictures->scenes && pictures->counted ? neph_dir_create(pictures->folder.text, diag)
                                                 : neph_fail_memory(diag);
}

void neph_night_images_end(struct neph_night_images *pictures)
{
    json_decref(pictures->scenes);
    json_decref(pictures->counted);
    *pictures = (struct neph_night_images){.store = NULL};
}

/* ---- scenes ---------------------------------------------------------------------------------- */

static json_t *describe(const char *name)
{
    struct neph_scene *scene = NULL;
    if (neph_data_load_scene(name, &scene, NULL)) /* deleted, or not of the catalogue */
        return json_pack("{s:s, s:f}", "title", name, "exposure_ev", 0.0);
    json_t *json = json_pack("{s:o, s:f}", "title", neph_json_cleaned(scene->title), "exposure_ev",
                             neph_scene_display(scene)->exposure_ev);
    neph_scene_destroy(scene);
    return json;
}

static enum neph_status read_scene_exposure(struct neph_night_images *pictures, const char *scene,
                                            double *exposure_ev, struct neph_diag *diag)
{
    char name[256];
    snprintf(name, sizeof(name), "%.*s", (int)strcspn(scene, " @"), scene);
    enum neph_status status = NEPH_OK;
    if (!json_object_get(pictures->scenes, name))
        status = neph_json_put(pictures->scenes, name, describe(name), diag);
    *exposure_ev = neph_json_real(json_object_get(pictures->scenes, name), "exposure_ev");
    return status;
}

/* ---- frames ---------------------------------------------------------------------------------- */

struct frame {
    struct neph_image *image; /* NULL: there is no frame to show */
    char *path;
    float *planes[3];
};

/* Read a frame from the store. An unreadable frame counts as missing: the store may be cleaned at
 * any time. */
static void open_frame(struct neph_night_images *pictures, const char *key, struct frame *frame)
{
    json_t *record = NULL;
    *frame = (struct frame){.image = NULL};
    if (!key[0] || !neph_store_find(pictures->store, key, &frame->path, &record))
        return;
    json_decref(record);
    if (neph_exr_read(frame->path, &frame->image, NULL) == NEPH_OK &&
        neph_image_rgb(frame->image, NULL, frame->planes))
        return;
    neph_image_destroy(frame->image);
    frame->image = NULL;
}

static void close_frame(struct frame *frame)
{
    neph_image_destroy(frame->image);
    free(frame->path);
}

static bool is_one_size(const struct frame *a, const struct frame *b)
{
    return a->image && b->image && a->image->width_px == b->image->width_px &&
           a->image->height_px == b->image->height_px;
}

static double luminance(const struct frame *frame, size_t pixel)
{
    return 0.2126 * frame->planes[0][pixel] + 0.7152 * frame->planes[1][pixel] +
           0.0722 * frame->planes[2][pixel];
}

/* ---- files ----------------------------------------------------------------------------------- */

/* Add the size of a new image file to the total. A file that exceeds the limit is removed, and
 * `*fits` becomes false. */
static enum neph_status count_image_bytes(struct neph_night_images *pictures, const char *name,
                                          const char *path, bool *fits, struct neph_diag *diag)
{
    const size_t bytes = neph_page_file_size(pictures->folder.text, name);
    *fits = json_object_get(pictures->counted, name) ||
            pictures->bytes + bytes <= pictures->limit_bytes;
    if (!*fits) {
        pictures->left_out++;
        return neph_dir_remove(path, diag);
    }
    if (json_object_get(pictures->counted, name))
        return NEPH_OK;
    pictures->bytes += bytes;
    return neph_json_put(pictures->counted, name, json_true(), diag);
}

/* Write the PNG file unless it exists: the frame itself, or with `reference` the difference from
 * it. */
static enum neph_status draw(const char *path, const struct frame *frame,
                             const struct frame *reference, double exposure_or_scale,
                             struct neph_diag *diag)
{
    const int width_px = frame->image->width_px, height_px = frame->image->height_px;
    const float *const *planes = (const float *const *)frame->planes;
    if (neph_path_exists(path))
        return NEPH_OK;
    return reference ? neph_difference_png(path, width_px, height_px,
                                           (const float *const *)reference->planes, planes,
                                           exposure_or_scale, diag)
                     : neph_display_png(path, width_px, height_px, planes, exposure_or_scale, diag);
}

/* Make an image of the page. `*picture` is its name in the page's folder, or JSON null when the
 * size limit is reached. */
static enum neph_status add_page_image(struct neph_night_images *pictures, const char *name,
                                       const struct frame *frame, const struct frame *reference,
                                       double exposure_or_scale, json_t **picture,
                                       struct neph_diag *diag)
{
    bool fits = false;
    const struct neph_path path = neph_path_in(pictures->folder.text, name);
    enum neph_status status = draw(path.text, frame, reference, exposure_or_scale, diag);
    if (!status)
        status = count_image_bytes(pictures, name, path.text, &fits, diag);
    if (!status)
        *picture = fits ? json_sprintf("images/%s", name) : json_null();
    return status;
}

static enum neph_status add_frame_image(struct neph_night_images *pictures, const char *key,
                                        const struct frame *frame, double exposure_ev,
                                        json_t **picture, struct neph_diag *diag)
{
    char name[64];
    snprintf(name, sizeof(name), "%.24s.png", key);
    return add_page_image(pictures, name, frame, NULL, exposure_ev, picture, diag);
}

static json_t *size_json(const struct frame *frame)
{
    return json_pack("[i, i]", frame->image->width_px, frame->image->height_px);
}

enum neph_status neph_night_images_one(struct neph_night_images *pictures, const char *scene,
                                       const char *key, json_t **shown, struct neph_diag *diag)
{
    double exposure_ev = 0.0;
    struct frame frame;
    json_t *picture = NULL;
    enum neph_status status = read_scene_exposure(pictures, scene, &exposure_ev, diag);
    open_frame(pictures, key, &frame);
    if (!status && frame.image)
        status = add_frame_image(pictures, key, &frame, exposure_ev, &picture, diag);
    if (!status)
        *shown = frame.image && !json_is_null(picture)
                     ? json_pack("{s:O, s:o}", "picture", picture, "size_px", size_json(&frame))
                     : json_null();
    json_decref(picture);
    close_frame(&frame);
    return status;
}

/* ---- differences ----------------------------------------------------------------------------- */

/* The least of 1, 2, 5 times a power of ten that is not below `least`. */
static double round_up_scale(double least)
{
    const double power = pow(10.0, floor(log10(least)));
    return power * (least <= power         ? 1.0
                    : least <= 2.0 * power ? 2.0
                    : least <= 5.0 * power ? 5.0
                                           : 10.0);
}

struct difference {
    double scale, mean, changed; /* scale 0: no pixel differs */
};

static struct difference compare(const struct frame *accepted, const struct frame *tonight,
                                 double *sizes)
{
    const size_t count = neph_image_pixel_count(tonight->image);
    double sum = 0.0, sum_before = 0.0;
    size_t changed = 0, finite = 0;
    for (size_t i = 0; i < count; i++) {
        bool same = true;
        for (int c = 0; c < 3; c++)
            same = same &&
                   memcmp(&accepted->planes[c][i], &tonight->planes[c][i], sizeof(float)) == 0;
        const double size = fabs(luminance(tonight, i) - luminance(accepted, i));
        changed += !same;
        if (!isfinite(size))
            continue;
        sizes[finite++] = size;
        sum += size;
        sum_before += luminance(accepted, i);
    }
    neph_sort_doubles(sizes, finite);
    const size_t at = (size_t)((1.0 - beyond_share) * (double)finite);
    const double high = finite ? sizes[at < finite ? at : finite - 1] : 0.0,
                 most = finite ? sizes[finite - 1] : 0.0, least = high > 0.0 ? high : most;
    return (struct difference){least > 0.0   ? round_up_scale(least)
                               : changed > 0 ? 1.0
                                             : 0.0,
                               sum_before > 0.0 ? sum / sum_before : NAN,
                               (double)changed / (double)count};
}

static enum neph_status add_difference_image(struct neph_night_images *pictures,
                                             const char *keys[2], const struct frame frames[2],
                                             json_t **json, struct neph_diag *diag)
{
    char name[64];
    json_t *picture = json_null();
    double *sizes = calloc(neph_image_pixel_count(frames[1].image), sizeof(*sizes));
    if (!sizes)
        return neph_fail_memory(diag);
    const struct difference difference = compare(&frames[0], &frames[1], sizes);
    free(sizes);
    snprintf(name, sizeof(name), "%.12s-%.12s.png", keys[1], keys[0]);
    const enum neph_status status = difference.scale > 0.0
                                        ? add_page_image(pictures, name, &frames[1], &frames[0],
                                                         difference.scale, &picture, diag)
                                        : NEPH_OK;
    if (!status)
        *json = json_pack("{s:o, s:f, s:o, s:f}", "picture", picture, "scale", difference.scale,
                          "mean", neph_json_number(difference.mean), "changed", difference.changed);
    return status;
}

static json_t *frame_json(json_t *picture, const struct frame *frame)
{
    return frame->image ? json_pack("{s:o, s:o}", "picture", picture ? picture : json_null(), "exr",
                                    neph_json_cleaned(frame->path))
                        : json_null();
}

/* Frame 0 is the baseline's, frame 1 this run's. */
static enum neph_status show_pair(struct neph_night_images *pictures, const char *keys[2],
                                  const struct frame frames[2], double exposure_ev, json_t **shown,
                                  struct neph_diag *diag)
{
    json_t *drawn[2] = {NULL, NULL}, *difference = json_null();
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < 2 && !status; i++)
        if (frames[i].image)
            status = add_frame_image(pictures, keys[i], &frames[i], exposure_ev, &drawn[i], diag);
    if (!status && is_one_size(&frames[0], &frames[1]))
        status = add_difference_image(pictures, keys, frames, &difference, diag);
    if (status) {
        json_decref(drawn[0]);
        json_decref(drawn[1]);
        return status;
    }
    *shown = json_pack("{s:o, s:o, s:o, s:f, s:o}", "accepted", frame_json(drawn[0], &frames[0]),
                       "tonight", frame_json(drawn[1], &frames[1]), "size_px",
                       size_json(&frames[frames[1].image ? 1 : 0]), "exposure_ev", exposure_ev,
                       "difference", difference);
    return NEPH_OK;
}

enum neph_status neph_night_images_pair(struct neph_night_images *pictures, const char *scene,
                                        const char *accepted, const char *tonight, json_t **shown,
                                        struct neph_diag *diag)
{
    const char *keys[2] = {accepted, tonight};
    struct frame frames[2];
    double exposure_ev = 0.0;
    for (int i = 0; i < 2; i++)
        open_frame(pictures, keys[i], &frames[i]);
    enum neph_status status = NEPH_OK;
    *shown = json_null();
    if (frames[0].image || frames[1].image) {
        status = read_scene_exposure(pictures, scene, &exposure_ev, diag);
        if (!status)
            status = show_pair(pictures, keys, frames, exposure_ev, shown, diag);
    }
    for (int i = 0; i < 2; i++)
        close_frame(&frames[i]);
    return status;
}
