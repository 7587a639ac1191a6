/* SPDX-License-Identifier: MIT */
#include "harness/physics/images.h"

#include "base/exr.h"
#include "base/files.h"
#include "harness/document/display_png.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Compiles only when this file handles every kind. */
_Static_assert(NEPH_STAGE_TRUTH_COLUMNS == 4, "a new kind");

/* Display value of the brightest reference pixel. */
static const double white = 0.9;

/* --- views --------------------------------------------------------------------------------- */

/* Describe the direction of a view. */
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

/* Exposure in half stops, so that last-bit differences of the reference do not change the image. */
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
    /* A black view uses the scale of the sun's irradiance spread over a hemisphere. */
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

/* --- images -------------------------------------------------------------------------------- */

/* A view of a check in a report. */
struct drawing {
    const char *folder; /* of the report */
    const struct neph_physics_check *check;
    int view;
    const struct neph_physics_view *seen;
    struct neph_arena *arena;
    const float *truth[3]; /* the same plane three times: the suite is grey */
};

/* Draw planes at the view's exposure, or their difference from the reference, as
 * images/physics/CHECK/NAME_VIEW[_difference].png. Characters that are unsafe in URLs become '_'.
 * `*name` gets the path inside the report. */
static enum neph_status draw(const struct drawing *drawing, const char *who,
                             const float *const planes[3], bool is_difference, const char **name,
                             struct neph_diag *diag)
{
    static const char letters[] =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-";
    const struct neph_physics_view *seen = drawing->seen;
    char file[160];
    snprintf(file, sizeof(file), "%s_%d%s.png", who, drawing->view,
             is_difference ? "_difference" : "");
    for (size_t at; file[at = strspn(file, letters)];)
        file[at] = '_';
    const char *relative = neph_arena_format(drawing->arena, "images/physics/%s/%s",
                                             drawing->check->name, file);
    const char *path = neph_arena_format(drawing->arena, "%s/%s", drawing->folder, relative);
    enum neph_status status = neph_arena_check(drawing->arena, diag);
    if (!status && is_difference)
        status = neph_difference_png(path, seen->width_px, seen->height_px, drawing->truth, planes,
                                     seen->difference_scale, diag);
    else if (!status)
        status = neph_display_png(path, seen->width_px, seen->height_px, planes, seen->exposure_ev,
                                  diag);
    if (!status)
        *name = relative;
    return status;
}

/* Draw a frame of a participant and its difference from the reference. */
static enum neph_status draw_frame(const struct drawing *drawing, struct neph_physics_row *row,
                                   struct neph_diag *diag)
{
    const struct neph_physics_view *seen = drawing->seen;
    const char *who = row->participant->name, *path = row->paths[drawing->view];
    struct neph_image *image = NULL;
    float *rgb[3];
    enum neph_status status = neph_exr_read(path, &image, diag);
    if (!status &&
        !(neph_image_rgb(image, NULL, rgb) &&
          neph_image_pixel_count(image) == (size_t)seen->width_px * (size_t)seen->height_px))
        status = neph_fail(diag, NEPH_ERR_INPUT, "'%s' is not a frame of check %s", path,
                           drawing->check->name);
    if (!status) {
        const float *const planes[3] = {rgb[0], rgb[1], rgb[2]};
        status = draw(drawing, who, planes, false, &row->pictures[drawing->view], diag);
        if (!status)
            status = draw(drawing, who, planes, true, &row->differences[drawing->view], diag);
    }
    neph_image_destroy(image);
    return status;
}

static enum neph_status draw_view(struct drawing *drawing, struct neph_physics *physics,
                                  const char **picture, struct neph_diag *diag)
{
    const size_t count = (size_t)drawing->seen->width_px * (size_t)drawing->seen->height_px;
    float *truth = calloc(count, sizeof(*truth));
    if (!truth)
        return neph_fail_memory(diag);
    for (size_t p = 0; p < count; p++)
        truth[p] = (float)drawing->seen->truth_w_per_m2_sr[p];
    for (int c = 0; c < 3; c++)
        drawing->truth[c] = truth;
    enum neph_status status = draw(drawing, "truth", drawing->truth, false, picture, diag);
    for (int i = 0; i < physics->row_count && !status; i++) {
        struct neph_physics_row *row = &physics->rows[i];
        if (row->check == drawing->check && row->paths[drawing->view])
            status = draw_frame(drawing, row, diag);
    }
    free(truth);
    return status;
}

static enum neph_status draw_check(struct neph_physics *physics, struct neph_physics_check *check,
                                   const char *folder, struct neph_diag *diag)
{
    const char *images = neph_arena_format(&physics->arena, "%s/images/physics/%s", folder,
                                           check->name);
    enum neph_status status = neph_dir_create(images, diag);
    for (int v = 0; v < check->view_count && !status; v++) {
        struct drawing drawing = {.folder = folder,
                                  .check = check,
                                  .view = v,
                                  .seen = &check->views[v],
                                  .arena = &physics->arena};
        if (!check->views[v].picture)
            status = draw_view(&drawing, physics, &check->views[v].picture, diag);
    }
    return status;
}

enum neph_status neph_physics_images(struct neph_physics *physics, const char *folder,
                                     struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int c = 0; physics && c < physics->check_count && !status; c++)
        status = draw_check(physics, &physics->checks[c], folder, diag);
    return !status && physics ? neph_arena_check(&physics->arena, diag) : status;
}
