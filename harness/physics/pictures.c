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

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_STAGE_TRUTH_COLUMNS == 4, "a new kind");

/* The brightest true pixel is shown a little below white. */
static const double white = 0.9;

/* --- views --------------------------------------------------------------------------------- */

/* Which way a view looks, in words. */
static void describe(const struct neph_stage_params *stage, char text[160])
{
    const double elevation_deg = stage->view_elevation_rad / NEPH_RAD_PER_DEG;
    const double sun_deg = asin(stage->sun_cosine) / NEPH_RAD_PER_DEG;
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
                 height, stage->view_azimuth_rad / NEPH_RAD_PER_DEG, sun_deg);
}

/* Half stops: the same truth gives the same picture although its last bits differ. */
static double exposure_ev(double brightest)
{
    return brightest > 0.0 ? floor(2.0 * log2(white / brightest)) / 2.0 : 0.0;
}

void neph_physics_view_describe(const struct neph_check_view *view, const double *truth_w_per_m2_sr,
                                struct neph_physics_view *described)
{
    const int count = view->width_px * view->height_px;
    double sum = 0.0, brightest = 0.0;
    for (int p = 0; p < count; p++) {
        sum += truth_w_per_m2_sr[p];
        brightest = fmax(brightest, truth_w_per_m2_sr[p]);
    }
    /* A black view has no scale of its own: that of the sun's irradiance over a hemisphere. */
    const double mean = sum > 0.0 ? sum / count
                                  : NEPH_STAGE_IRRADIANCE_W_PER_M2 / (360.0 * NEPH_RAD_PER_DEG);
    *described = (struct neph_physics_view){
        .width_px = view->width_px,
        .height_px = view->height_px,
        .exposure_ev = exposure_ev(brightest),
        .difference_scale = NEPH_PHYSICS_DIFFERENCE_SCALE * mean,
        .truth_w_per_m2_sr = truth_w_per_m2_sr,
    };
    describe(&view->stage, described->what);
}

/* --- pictures ------------------------------------------------------------------------------ */

/* Buffers of one view. */
struct canvas {
    const char *folder; /* the report's */
    const struct neph_physics_check *check;
    int view;
    const struct neph_physics_view *seen;
    struct neph_arena *arena;
    float *truth; /* one channel: the suite is grey */
    uint8_t *rgb;
};

/* "images/physics/CHECK/WHO_VIEWkind.png": only letters that a page may load. */
static char *picture_path(const struct canvas *canvas, const char *who, const char *kind)
{
    char *path = neph_format("images/physics/%s/%s_%d%s.png", canvas->check->name, who,
                             canvas->view, kind);
    for (char *c = path ? strrchr(path, '/') + 1 : NULL; c && *c; c++)
        if (!(*c == '.' || *c == '-' || (*c >= '0' && *c <= '9') || (*c >= 'A' && *c <= 'Z') ||
              (*c >= 'a' && *c <= 'z')))
            *c = '_';
    return path;
}

/* `*name` receives the path inside the report. */
static enum neph_status write_picture(const struct canvas *canvas, const char *who,
                                      const char *kind, const char **name, struct neph_diag *diag)
{
    char *relative = picture_path(canvas, who, kind);
    char *path = relative ? neph_path_join(canvas->folder, relative) : NULL;
    const enum neph_status status = path ? neph_png_write_rgb8(path, canvas->seen->width_px,
                                                               canvas->seen->height_px, canvas->rgb,
                                                               diag)
                                         : neph_fail_memory(diag);
    if (!status)
        *name = neph_arena_text(canvas->arena, relative);
    free(path);
    free(relative);
    return status;
}

static size_t pixel_count(const struct canvas *canvas)
{
    return (size_t)canvas->seen->width_px * (size_t)canvas->seen->height_px;
}

static enum neph_status start_canvas(struct canvas *canvas, struct neph_diag *diag)
{
    canvas->truth = calloc(pixel_count(canvas), sizeof(*canvas->truth));
    canvas->rgb = calloc(pixel_count(canvas), 3);
    if (!canvas->truth || !canvas->rgb)
        return neph_fail_memory(diag);
    for (size_t p = 0; p < pixel_count(canvas); p++)
        canvas->truth[p] = (float)canvas->seen->truth_w_per_m2_sr[p];
    return NEPH_OK;
}

static enum neph_status draw_truth(const struct canvas *canvas, const char **picture,
                                   struct neph_diag *diag)
{
    const float *const planes[3] = {canvas->truth, canvas->truth, canvas->truth};
    const enum neph_status status = neph_display_encode(
        planes, pixel_count(canvas), canvas->seen->exposure_ev, canvas->rgb, diag);
    return status ? status : write_picture(canvas, "truth", "", picture, diag);
}

/* A frame of one participant, and what it differs by. */
static enum neph_status draw_planes(const struct canvas *canvas, struct neph_physics_row *row,
                                    float *const rgb[3], struct neph_diag *diag)
{
    const char *who = row->participant->name;
    const float *const truth[3] = {canvas->truth, canvas->truth, canvas->truth};
    const float *const planes[3] = {rgb[0], rgb[1], rgb[2]};
    enum neph_status status = neph_display_encode(planes, pixel_count(canvas),
                                                  canvas->seen->exposure_ev, canvas->rgb, diag);
    if (!status)
        status = write_picture(canvas, who, "", &row->pictures[canvas->view], diag);
    if (!status)
        status = neph_display_difference(truth, planes, 3, pixel_count(canvas),
                                         canvas->seen->difference_scale, canvas->rgb, diag);
    return status
               ? status
               : write_picture(canvas, who, "_difference", &row->differences[canvas->view], diag);
}

static enum neph_status draw_frame(const struct canvas *canvas, struct neph_physics_row *row,
                                   struct neph_diag *diag)
{
    const char *path = row->paths[canvas->view];
    struct neph_image *image = NULL;
    float *rgb[3];
    enum neph_status status = neph_exr_read(path, &image, diag);
    if (!status && neph_image_rgb(image, NULL, rgb) &&
        neph_image_pixel_count(image) == pixel_count(canvas))
        status = draw_planes(canvas, row, rgb, diag);
    else if (!status)
        status = neph_fail(diag, NEPH_ERR_INPUT, "'%s' is not a frame of check %s", path,
                           canvas->check->name);
    neph_image_destroy(image);
    return status;
}

static enum neph_status draw_view(struct canvas *canvas, struct neph_physics *physics,
                                  const char **picture, struct neph_diag *diag)
{
    enum neph_status status = start_canvas(canvas, diag);
    if (!status)
        status = draw_truth(canvas, picture, diag);
    for (int i = 0; i < physics->row_count && !status; i++) {
        struct neph_physics_row *row = &physics->rows[i];
        if (row->check == canvas->check && row->paths[canvas->view])
            status = draw_frame(canvas, row, diag);
    }
    free(canvas->truth);
    free(canvas->rgb);
    return status;
}

static enum neph_status draw_check(struct neph_physics *physics, struct neph_physics_check *check,
                                   const char *folder, struct neph_diag *diag)
{
    char *images = neph_format("%s/images/physics/%s", folder, check->name);
    enum neph_status status = images ? neph_dir_create(images, diag) : neph_fail_memory(diag);
    free(images);
    for (int v = 0; v < check->view_count && !status; v++) {
        struct canvas canvas = {.folder = folder,
                                .check = check,
                                .view = v,
                                .seen = &check->views[v],
                                .arena = &physics->arena};
        if (!check->views[v].picture)
            status = draw_view(&canvas, physics, &check->views[v].picture, diag);
    }
    return status;
}

enum neph_status neph_physics_pictures(struct neph_physics *physics, const char *folder,
                                       struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int c = 0; physics && c < physics->check_count && !status; c++)
        status = draw_check(physics, &physics->checks[c], folder, diag);
    return !status && physics ? neph_arena_check(&physics->arena, diag) : status;
}
