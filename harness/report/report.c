/* SPDX-License-Identifier: MIT */
#include "harness/report/report.h"

#include "base/exr.h"
#include "base/files.h"
#include "base/path.h"
#include "harness/document/display_png.h"
#include "harness/engines/engines.h"
#include "harness/physics/images.h"
#include "harness/report/page.h"
#include "harness/report/report_folder.h"
#include "harness/report/vega.h"
#include "harness/report/viewer_page.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Size limit of all viewers of a report together. A report of the quick tier then stays below 20 MB
 * with its numbers, images and charts. */
static const double viewers_limit_bytes = 16e6;

static const struct neph_page_parts parts = {
    .title = "Nephelometer report",
    .files = {"report.html", "report.js"},
    .folders = {"images", "charts", "vendor"},
};

struct neph_report {
    struct neph_report_folder *folder;
    bool is_interactive;
    bool has_screen;      /* the page of `neph study screen` is included */
    double viewers_bytes; /* total size of the viewers so far */
};

/* ---- images of scenes ------------------------------------------------------------------------ */

/* The images of one scene, at its exposure. */
struct scene_images {
    const char *folder; /* of the report */
    struct neph_scene_result *scene;
    struct neph_arena *arena;
    const struct neph_image *truth; /* NULL: no difference maps */
};

static enum neph_status draw_beauty(const struct scene_images *scene_images,
                                    const struct neph_image *image, struct neph_frame_result *frame,
                                    struct neph_diag *diag)
{
    float *rgb[3];
    if (!neph_image_rgb(image, NULL, rgb))
        return NEPH_OK;
    frame->picture = neph_arena_format(scene_images->arena, "images/%s/%s.png",
                                       scene_images->scene->name, frame->engine->name);
    return neph_display_png(
        neph_arena_format(scene_images->arena, "%s/%s", scene_images->folder, frame->picture),
        image->width_px, image->height_px, (const float *const[]){rgb[0], rgb[1], rgb[2]},
        scene_images->scene->viewing.exposure_ev, diag);
}

static enum neph_status draw_difference(const struct scene_images *scene_images,
                                        const struct neph_image *image, enum neph_shown which,
                                        struct neph_frame_result *frame, struct neph_diag *diag)
{
    const char *layer = which == NEPH_SHOWN_RADIANCE ? NULL : neph_shown_name(which);
    float *test[3], *truth[3];
    if (!scene_images->truth || !neph_image_rgb(image, layer, test) ||
        !neph_image_rgb(scene_images->truth, layer, truth))
        return NEPH_OK;
    const char *name = neph_arena_format(scene_images->arena, "images/%s/%s_difference_%s.png",
                                         scene_images->scene->name, frame->engine->name,
                                         neph_shown_name(which));
    frame->differences[which] = name;
    return neph_difference_png(
        neph_arena_format(scene_images->arena, "%s/%s", scene_images->folder, name),
        image->width_px, image->height_px, (const float *const[]){truth[0], truth[1], truth[2]},
        (const float *const[]){test[0], test[1], test[2]},
        scene_images->scene->difference_scales[which], diag);
}

static enum neph_status draw_frame(const struct scene_images *scene_images,
                                   struct neph_frame_result *frame, bool is_truth,
                                   struct neph_diag *diag)
{
    struct neph_image *image = NULL;
    enum neph_status status = neph_exr_read(frame->path, &image, diag);
    if (!status)
        status = draw_beauty(scene_images, image, frame, diag);
    for (int d = 0; d < NEPH_SHOWN_COUNT && !status && !is_truth; d++)
        status = draw_difference(scene_images, image, (enum neph_shown)d, frame, diag);
    neph_image_destroy(image);
    return status;
}

static enum neph_status draw_frames(const char *folder, struct neph_scene_result *scene,
                                    struct neph_arena *arena, struct neph_diag *diag)
{
    struct neph_image *truth = NULL;
    enum neph_status status = NEPH_OK;
    if (scene->truth >= 0)
        status = neph_exr_read(scene->frames[scene->truth].path, &truth, diag);
    const struct scene_images scene_images = {
        .folder = folder, .scene = scene, .arena = arena, .truth = truth};
    for (int f = 0; f < scene->frame_count && !status; f++)
        if (scene->frames[f].path)
            status = draw_frame(&scene_images, &scene->frames[f], f == scene->truth, diag);
    neph_image_destroy(truth);
    return status;
}

/* ---- viewers of scenes ----------------------------------------------------------------------- */

/* A viewer has room for all engines. */
#define ONE(name) +1
_Static_assert(0 NEPH_ENGINES(ONE) <= NEPH_VIEWER_SETS_MAX, "a viewer has a set for each engine");
#undef ONE

/* Make one set for each frame, the reference first. */
static void collect_sets(const struct neph_scene_result *scene, char *paths[NEPH_VIEWER_SETS_MAX],
                         struct neph_viewer *viewer)
{
    for (int i = -1; i < scene->frame_count && viewer->set_count < NEPH_VIEWER_SETS_MAX; i++) {
        const int f = i < 0 ? scene->truth : i;
        if (f < 0 || (i >= 0 && f == scene->truth) || !scene->frames[f].picture)
            continue; /* no radiance, so no image */
        const int set = viewer->set_count++;
        paths[set] = (char *)scene->frames[f].path; /* only read */
        viewer->sets[set] = (struct neph_viewer_set){
            .label = scene->frames[f].engine->name,
            .frames = {.count = 1, .paths = &paths[set]},
        };
    }
}

/* Upper bound of the size of all floats: base64 without compression. */
static double most_bytes(const struct neph_viewer *viewer, const struct neph_scene_result *scene)
{
    const double floats = 3.0 * scene->width_px * scene->height_px;
    return 2.0 * viewer->set_count * floats * sizeof(float) * 4.0 / 3.0;
}

/* Write the viewer of a scene, which shows its frames over each other, if the size limit allows
 * it. */
static enum neph_status draw_viewer(struct neph_report *report, struct neph_scene_result *scene,
                                    struct neph_validation *validation, struct neph_diag *diag)
{
    char *paths[NEPH_VIEWER_SETS_MAX];
    struct neph_viewer_made made = {.bytes = 0};
    struct neph_viewer viewer = {
        .title = scene->title,
        .viewing = scene->viewing,
        .quantities = NEPH_RADIANCE | NEPH_TRANSMITTANCE,
        .difference_scale = scene->difference_scales[NEPH_SHOWN_RADIANCE],
        .limit_bytes = viewers_limit_bytes,
        .quiet = true,
    };
    collect_sets(scene, paths, &viewer);
    if (viewer.set_count == 0)
        return NEPH_OK;
    if (report->viewers_bytes + most_bytes(&viewer, scene) > viewers_limit_bytes) {
        scene->no_viewer = neph_arena_format(
            &validation->arena, "viewers have %.0f MB of the report, and this one does not fit in",
            viewers_limit_bytes / 1e6);
        return NEPH_OK;
    }
    const char *folder = neph_arena_format(&validation->arena, "%s/view/%s",
                                           neph_report_folder_work(report->folder), scene->name);
    enum neph_status status = neph_dir_create(folder, diag);
    if (!status)
        status = neph_viewer_write(&viewer, folder, &made, diag);
    if (status == NEPH_ERR_GATE) { /* NaN or infinite values, which the frame's measurements
                                      report */
        status = neph_dir_remove(folder, diag);
        scene->no_viewer = "a frame has values that are no numbers";
    } else if (!status) {
        report->viewers_bytes += (double)made.bytes;
        scene->viewer = neph_arena_format(&validation->arena, "view/%s/index.html", scene->name);
    }
    return status;
}

/* Draw the images of a scene once; its frames do not change. */
static enum neph_status draw_scene(struct neph_report *report, struct neph_scene_result *scene,
                                   struct neph_validation *validation, struct neph_diag *diag)
{
    const char *folder = neph_report_folder_work(report->folder);
    if (scene->is_drawn)
        return NEPH_OK;
    const char *images = neph_arena_format(&validation->arena, "%s/images/%s", folder, scene->name);
    enum neph_status status = neph_dir_create(images, diag);
    if (!status)
        status = draw_frames(folder, scene, &validation->arena, diag);
    if (!status)
        status = draw_viewer(report, scene, validation, diag);
    scene->is_drawn = !status;
    return status;
}

/* ---- charts ---------------------------------------------------------------------------------- */

static enum neph_status draw_chart(const char *folder, struct neph_chart *chart,
                                   struct neph_arena *arena, struct neph_diag *diag)
{
    if (chart->svg || chart->missing)
        return NEPH_OK;
    struct neph_path path = neph_path_format("%s/charts/%s", folder, chart->id);
    char *const stem = path.text;
    struct neph_diag why = {.line = 0};
    bool drawn = false;
    enum neph_status status = neph_vega_write(chart->spec, stem, diag);
    if (!status)
        status = neph_vega_draw(&stem, 1, &drawn, &why, diag);
    if (!status && drawn)
        chart->svg = neph_arena_format(arena, "charts/%s.svg", chart->id);
    else if (!status) /* the page says so and has the interactive chart */
        chart->missing = neph_arena_format(
            arena,
            "static chart not drawn: %s (apt-get install nodejs npm; npm ci --omit=dev in "
            "scripts/report)",
            why.message);
    return status;
}

/* ---- the page -------------------------------------------------------------------------------- */

/* Draw all images and charts into the folder that is kept between publications. */
static enum neph_status draw(struct neph_report *report, struct neph_validation *validation,
                             struct neph_diag *diag)
{
    const char *folder = neph_report_folder_work(report->folder);
    struct neph_arena *arena = &validation->arena;
    enum neph_status status = NEPH_OK;
    for (int s = 0; s < validation->scene_count && !status; s++)
        status = draw_scene(report, &validation->scenes[s], validation, diag);
    if (!status)
        status = neph_physics_images(validation->physics, folder, diag);
    if (!status)
        status = neph_over_time_images(validation->over_time, folder, arena, diag);
    for (int c = 0; c < validation->chart_count && !status; c++)
        status = draw_chart(folder, &validation->charts[c], arena, diag);
    validation->interactive = report->is_interactive;
    if (!status && !report->has_screen)
        status = neph_report_folder_take(report->folder, "screen", &report->has_screen, diag);
    validation->has_screen = report->has_screen;
    return status ? status : neph_arena_check(arena, diag);
}

enum neph_status neph_report_open(const char *folder, struct neph_report **report,
                                  struct neph_diag *diag)
{
    struct neph_report *opened = calloc(1, sizeof(*opened));
    if (!opened)
        return neph_fail_memory(diag);
    enum neph_status status = neph_report_folder_open(folder, &opened->folder, diag);
    if (!status)
        status = neph_page_start(neph_report_folder_work(opened->folder), &parts,
                                 &opened->is_interactive, diag);
    if (status) {
        neph_report_close(opened);
        return status;
    }
    *report = opened;
    return NEPH_OK;
}

void neph_report_close(struct neph_report *report)
{
    if (!report)
        return;
    neph_report_folder_close(report->folder);
    free(report);
}

enum neph_status neph_report_publish(struct neph_report *report, struct neph_validation *validation,
                                     struct neph_diag *diag)
{
    enum neph_status status = draw(report, validation, diag);
    json_t *document = status ? NULL : neph_validation_json(validation);
    if (!status)
        status = neph_json_check(document, diag);
    if (!status)
        status = neph_page_publish(report->folder, "NEPH_REPORT", document, diag);
    json_decref(document);
    return status;
}
