/* SPDX-License-Identifier: MIT */
#include "harness/physics/pictures.h"

#include "base/exr.h"
#include "base/files.h"
#include "base/png.h"
#include "metrics/display.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DEG (M_PI / 180.0)

/* The brightest true pixel is shown a little below white. */
static const double white = 0.9;

static const char *text_of(const json_t *object, const char *key)
{
    return json_string_value(json_object_get(object, key));
}

/* --- views --------------------------------------------------------------------------------- */

/* Which way a view looks, in words. */
static void describe(const struct neph_stage_params *stage, char text[160])
{
    const double elevation_deg = stage->view_elevation_rad / DEG;
    const double sun_deg = asin(stage->sun_cosine) / DEG;
    const bool upright = fabs(elevation_deg) > 89.5;
    const char *side = elevation_deg < 0.0 ? "down" : "up";
    char height[48] = "level";
    if (upright)
        snprintf(height, sizeof(height), "straight %s", side);
    else if (fabs(elevation_deg) > 0.5)
        snprintf(height, sizeof(height), "%.0f° %s", fabs(elevation_deg), side);
    if (stage->truth == NEPH_STAGE_TRUTH_FURNACE)
        snprintf(text, 160, "camera looks %s", height);
    else if (upright || sun_deg > 89.5)
        snprintf(text, 160, "camera looks %s; the sun stands %.0f° high", height, sun_deg);
    else
        snprintf(text, 160, "camera looks %s, %.0f° aside from the sun, which stands %.0f° high",
                 height, stage->view_azimuth_rad / DEG, sun_deg);
}

/* Half stops: the same truth gives the same picture although its last bits differ. */
static double exposure_ev(double brightest)
{
    return brightest > 0.0 ? floor(2.0 * log2(white / brightest)) / 2.0 : 0.0;
}

json_t *neph_physics_view_json(const struct neph_check_view *view, const double *truth_w_per_m2_sr)
{
    const int count = view->width_px * view->height_px;
    double sum = 0.0, brightest = 0.0;
    json_t *truth = json_array();
    for (int p = 0; p < count; p++) {
        sum += truth_w_per_m2_sr[p];
        brightest = fmax(brightest, truth_w_per_m2_sr[p]);
        neph_json_add(&truth, json_real(truth_w_per_m2_sr[p]));
    }
    char words[160];
    describe(&view->stage, words);
    /* A black view has no scale of its own: that of the sun's irradiance over a hemisphere. */
    const double mean = sum > 0.0 ? sum / count : NEPH_STAGE_IRRADIANCE_W_PER_M2 / (360.0 * DEG);
    return json_pack("{s:s, s:[i,i], s:f, s:f, s:n, s:o}", "what", words, "size_px", view->width_px,
                     view->height_px, "exposure_ev", exposure_ev(brightest), "difference_scale",
                     NEPH_PHYSICS_DIFFERENCE_SCALE * mean, "picture", "truth", truth);
}

/* --- pictures ------------------------------------------------------------------------------ */

/* Buffers of one view. */
struct canvas {
    const char *folder; /* the report's */
    const char *check;
    int view, width_px, height_px;
    double exposure_ev, scale;
    float *truth; /* one channel: the suite is grey */
    uint8_t *rgb;
};

/* "images/physics/CHECK/WHO_VIEWkind.png": only letters that a page may load. */
static char *picture_path(const struct canvas *canvas, const char *who, const char *kind)
{
    char *path = neph_format("images/physics/%s/%s_%d%s.png", canvas->check, who, canvas->view,
                             kind);
    for (char *c = path ? strrchr(path, '/') + 1 : NULL; c && *c; c++)
        if (!(*c == '.' || *c == '-' || (*c >= '0' && *c <= '9') || (*c >= 'A' && *c <= 'Z') ||
              (*c >= 'a' && *c <= 'z')))
            *c = '_';
    return path;
}

/* `*name` receives the path inside the report. */
static enum neph_status write_picture(const struct canvas *canvas, const char *who,
                                      const char *kind, json_t **name, struct neph_diag *diag)
{
    char *relative = picture_path(canvas, who, kind);
    char *path = relative ? neph_path_join(canvas->folder, relative) : NULL;
    enum neph_status status = path ? neph_png_write_rgb8(path, canvas->width_px, canvas->height_px,
                                                         canvas->rgb, diag)
                                   : neph_fail_memory(diag);
    if (!status)
        *name = json_string(relative);
    free(path);
    free(relative);
    return status;
}

static size_t pixel_count(const struct canvas *canvas)
{
    return (size_t)canvas->width_px * (size_t)canvas->height_px;
}

static enum neph_status start_canvas(const json_t *view, struct canvas *canvas,
                                     struct neph_diag *diag)
{
    const json_t *size = json_object_get(view, "size_px");
    const json_t *truth = json_object_get(view, "truth");
    canvas->width_px = (int)json_integer_value(json_array_get(size, 0));
    canvas->height_px = (int)json_integer_value(json_array_get(size, 1));
    canvas->exposure_ev = json_number_value(json_object_get(view, "exposure_ev"));
    canvas->scale = json_number_value(json_object_get(view, "difference_scale"));
    canvas->truth = calloc(pixel_count(canvas), sizeof(*canvas->truth));
    canvas->rgb = calloc(pixel_count(canvas), 3);
    if (!canvas->truth || !canvas->rgb)
        return neph_fail_memory(diag);
    for (size_t p = 0; p < pixel_count(canvas); p++)
        canvas->truth[p] = (float)json_number_value(json_array_get(truth, p));
    return NEPH_OK;
}

static enum neph_status draw_truth(const struct canvas *canvas, json_t *view,
                                   struct neph_diag *diag)
{
    const float *const planes[3] = {canvas->truth, canvas->truth, canvas->truth};
    json_t *name = NULL;
    enum neph_status status = neph_display_encode(planes, pixel_count(canvas), canvas->exposure_ev,
                                                  canvas->rgb, diag);
    if (!status)
        status = write_picture(canvas, "truth", "", &name, diag);
    if (!status)
        status = neph_json_put(view, "picture", name, diag);
    return status;
}

/* The frame of one participant, and what it differs by. */
static enum neph_status draw_frame(const struct canvas *canvas, json_t *row, const char *exr,
                                   struct neph_diag *diag)
{
    const char *who = text_of(row, "participant");
    const float *const truth[3] = {canvas->truth, canvas->truth, canvas->truth};
    struct neph_image *image = NULL;
    float *rgb[3];
    json_t *picture = NULL, *difference = NULL;
    enum neph_status status = neph_exr_read(exr, &image, diag);
    if (status)
        return status;
    if (!neph_image_rgb(image, NULL, rgb) || neph_image_pixel_count(image) != pixel_count(canvas)) {
        neph_image_destroy(image);
        return neph_fail(diag, NEPH_ERR_INPUT, "'%s' is not a frame of check %s", exr,
                         canvas->check);
    }
    const float *const planes[3] = {rgb[0], rgb[1], rgb[2]};
    status = neph_display_encode(planes, pixel_count(canvas), canvas->exposure_ev, canvas->rgb,
                                 diag);
    if (!status)
        status = write_picture(canvas, who, "", &picture, diag);
    if (!status)
        status = neph_display_difference(truth, planes, 3, pixel_count(canvas), canvas->scale,
                                         canvas->rgb, diag);
    if (!status)
        status = write_picture(canvas, who, "_difference", &difference, diag);
    if (!status)
        status = neph_json_append(json_object_get(row, "pictures"), json_incref(picture), diag);
    if (!status)
        status = neph_json_append(json_object_get(row, "differences"), json_incref(difference),
                                  diag);
    json_decref(picture);
    json_decref(difference);
    neph_image_destroy(image);
    return status;
}

static enum neph_status draw_view(struct canvas *canvas, json_t *view, json_t *rows,
                                  struct neph_diag *diag)
{
    if (!json_object_get(view, "truth"))
        return NEPH_OK; /* drawn already */
    enum neph_status status = start_canvas(view, canvas, diag);
    if (!status)
        status = draw_truth(canvas, view, diag);
    for (size_t i = 0; i < json_array_size(rows) && !status; i++) {
        json_t *row = json_array_get(rows, i);
        const char *exr = json_string_value(
            json_array_get(json_object_get(row, "exr"), (size_t)canvas->view));
        if (exr && strcmp(text_of(row, "check"), canvas->check) == 0)
            status = draw_frame(canvas, row, exr, diag);
    }
    free(canvas->truth);
    free(canvas->rgb);
    json_object_del(view, "truth");
    return status;
}

enum neph_status neph_physics_pictures(json_t *physics, const char *folder, struct neph_diag *diag)
{
    const json_t *checks = json_object_get(physics, "checks");
    enum neph_status status = NEPH_OK;
    for (size_t i = 0; i < json_array_size(checks) && !status; i++) {
        const json_t *check = json_array_get(checks, i);
        const json_t *views = json_object_get(check, "views");
        char *images = neph_format("%s/images/physics/%s", folder, text_of(check, "name"));
        status = images ? neph_dir_create(images, diag) : neph_fail_memory(diag);
        free(images);
        for (size_t v = 0; v < json_array_size(views) && !status; v++) {
            struct canvas canvas = {
                .folder = folder, .check = text_of(check, "name"), .view = (int)v};
            status = draw_view(&canvas, json_array_get(views, v), json_object_get(physics, "rows"),
                               diag);
        }
    }
    return status;
}
