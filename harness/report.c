/* SPDX-License-Identifier: MIT */
#include "harness/report.h"

#include "base/child.h"
#include "base/exr.h"
#include "base/files.h"
#include "base/png.h"
#include "harness/data.h"
#include "harness/physics/pictures.h"
#include "metrics/display.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* renameat2 with RENAME_EXCHANGE swaps two folders in one step. */
#ifndef RENAME_EXCHANGE
#define RENAME_EXCHANGE (1 << 1)
#endif

static const double chart_time_limit_s = 120.0;

static const char *text_of(const json_t *object, const char *key)
{
    return json_string_value(json_object_get(object, key));
}

/* Write an 8-bit picture under the report and set its relative path in `holder`. */
static enum neph_status write_picture(const char *folder, const char *relative,
                                      const struct neph_image *image, const uint8_t *rgb,
                                      json_t *holder, const char *key, struct neph_diag *diag)
{
    char *path = neph_path_join(folder, relative);
    if (!path)
        return neph_fail_memory(diag);
    enum neph_status status = neph_png_write_rgb8(path, image->width_px, image->height_px, rgb,
                                                  diag);
    if (!status)
        status = neph_json_put(holder, key, json_string(relative), diag);
    free(path);
    return status;
}

struct picture {
    const char *folder, *scene, *engine;
    double exposure_ev;
    const struct neph_image *truth; /* NULL: no difference maps */
    const json_t *scale;
};

static enum neph_status write_beauty(const struct picture *picture, const struct neph_image *image,
                                     uint8_t *rgb, json_t *frame, struct neph_diag *diag)
{
    float *planes[3];
    if (!neph_image_rgb(image, NULL, planes))
        return NEPH_OK;
    const float *const constant[3] = {planes[0], planes[1], planes[2]};
    enum neph_status status = neph_display_encode(constant, neph_image_pixel_count(image),
                                                  picture->exposure_ev, rgb, diag);
    char *relative = neph_format("images/%s/%s.png", picture->scene, picture->engine);
    if (!status)
        status = relative
                     ? write_picture(picture->folder, relative, image, rgb, frame, "picture", diag)
                     : neph_fail_memory(diag);
    free(relative);
    return status;
}

/* `layer` NULL is radiance. */
static enum neph_status write_difference(const struct picture *picture,
                                         const struct neph_image *image, const char *layer,
                                         const char *quantity, uint8_t *rgb, json_t *frame,
                                         struct neph_diag *diag)
{
    float *test[3], *truth[3];
    if (!picture->truth || !neph_image_rgb(image, layer, test) ||
        !neph_image_rgb(picture->truth, layer, truth))
        return NEPH_OK;
    const float *const a[3] = {truth[0], truth[1], truth[2]};
    const float *const b[3] = {test[0], test[1], test[2]};
    const double scale = json_number_value(json_object_get(picture->scale, quantity));
    enum neph_status status = neph_display_difference(a, b, 3, neph_image_pixel_count(image), scale,
                                                      rgb, diag);
    char *relative = neph_format("images/%s/%s_difference_%s.png", picture->scene, picture->engine,
                                 quantity);
    if (!status)
        status = relative ? write_picture(picture->folder, relative, image, rgb,
                                          json_object_get(frame, "difference"), quantity, diag)
                          : neph_fail_memory(diag);
    free(relative);
    return status;
}

static enum neph_status write_frame_pictures(struct picture *picture, json_t *frame, bool is_truth,
                                             struct neph_diag *diag)
{
    const char *exr = text_of(frame, "exr");
    if (!exr)
        return NEPH_OK;
    struct neph_image *image = NULL;
    enum neph_status status = neph_exr_read(exr, &image, diag);
    if (status)
        return status;
    picture->engine = text_of(frame, "engine");
    uint8_t *rgb = malloc(neph_image_pixel_count(image) * 3);
    status = rgb ? write_beauty(picture, image, rgb, frame, diag) : neph_fail_memory(diag);
    if (!status && !is_truth)
        status = write_difference(picture, image, NULL, "radiance", rgb, frame, diag);
    if (!status && !is_truth)
        status = write_difference(picture, image, "transmittance", "transmittance", rgb, frame,
                                  diag);
    free(rgb);
    neph_image_destroy(image);
    return status;
}

static const char *truth_path(const json_t *scene)
{
    const char *engine = text_of(json_object_get(scene, "truth"), "engine");
    const json_t *frames = json_object_get(scene, "frames");
    for (size_t i = 0; engine && i < json_array_size(frames); i++)
        if (strcmp(text_of(json_array_get(frames, i), "engine"), engine) == 0)
            return text_of(json_array_get(frames, i), "exr");
    return NULL;
}

static enum neph_status write_scene_pictures(const char *folder, json_t *scene,
                                             struct neph_diag *diag)
{
    struct neph_image *truth = NULL;
    const char *path = truth_path(scene);
    enum neph_status status = path ? neph_exr_read(path, &truth, diag) : NEPH_OK;
    struct picture picture = {
        .folder = folder,
        .scene = text_of(scene, "name"),
        .exposure_ev = json_number_value(json_object_get(scene, "exposure_ev")),
        .truth = truth,
        .scale = json_object_get(scene, "difference_scale"),
    };
    char *images = neph_format("%s/images/%s", folder, picture.scene);
    if (!status)
        status = images ? neph_dir_create(images, diag) : neph_fail_memory(diag);
    json_t *frames = json_object_get(scene, "frames");
    for (size_t i = 0; i < json_array_size(frames) && !status; i++) {
        json_t *frame = json_array_get(frames, i);
        const char *exr = text_of(frame, "exr");
        status = write_frame_pictures(&picture, frame, exr && path && strcmp(exr, path) == 0, diag);
    }
    free(images);
    neph_image_destroy(truth);
    return status;
}

/* The static picture of a chart, by node from the very specification that the page shows. */
static enum neph_status draw_chart(const char *folder, json_t *chart, struct neph_diag *diag)
{
    const char *id = text_of(chart, "id");
    char *script = neph_data_path("scripts/report/render_chart.mjs");
    char *spec_path = neph_format("%s/charts/%s.vl.json", folder, id);
    char *svg = neph_format("charts/%s.svg", id);
    char *svg_path = neph_format("%s/charts/%s.svg", folder, id);
    char *log_path = neph_format("%s/charts/%s.log", folder, id);
    char *spec = json_dumps(json_object_get(chart, "spec"), JSON_INDENT(1));
    enum neph_status status = NEPH_OK;
    if (!script || !spec_path || !svg || !svg_path || !log_path || !spec)
        status = neph_fail_memory(diag);
    if (!status)
        status = neph_file_write(spec_path, spec, strlen(spec), diag);
    if (!status) {
        const char *const argv[] = {"node", script, spec_path, svg_path, NULL};
        const struct neph_child_params params = {
            .argv = argv, .log_path = log_path, .time_limit_s = chart_time_limit_s};
        struct neph_child_result result;
        struct neph_diag why = {.line = 0};
        status = neph_child_run(&params, &result, &why);
        if (status == NEPH_OK) {
            status = neph_json_put(chart, "svg", json_string(svg), diag);
            unlink(log_path);
        } else if (status == NEPH_ERR_INTERRUPTED) {
            if (diag)
                *diag = why;
        } else {
            char missing[1280];
            snprintf(missing, sizeof(missing),
                     "static chart not drawn: %s (apt-get install nodejs npm; npm ci --omit=dev in "
                     "scripts/report)",
                     why.message);
            /* said on the page; the interactive chart is still there */
            status = neph_json_put(chart, "missing", json_string(missing), diag);
        }
    }
    free(script);
    free(spec_path);
    free(svg);
    free(svg_path);
    free(log_path);
    free(spec);
    return status;
}

/* What the page is made of: from scripts/report/ into the report. */
static const struct {
    const char *from, *to;
    bool vendored; /* comes with npm; the page does without */
} page_files[] = {
    {"index.html", "index.html", false},
    {"report.css", "report.css", false},
    {"report.js", "report.js", false},
    {"node_modules/vega/build/vega.min.js", "vendor/vega.min.js", true},
    {"node_modules/vega-lite/build/vega-lite.min.js", "vendor/vega-lite.min.js", true},
    {"node_modules/vega-embed/build/vega-embed.min.js", "vendor/vega-embed.min.js", true},
    {"vendor-licences.txt", "vendor/LICENSES.txt", true},
};

static enum neph_status copy_page(const char *folder, bool with_vendor, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (size_t i = 0; i < sizeof(page_files) / sizeof(page_files[0]) && !status; i++) {
        if (page_files[i].vendored && !with_vendor)
            continue;
        char *from = neph_format("%s/scripts/report/%s", neph_data_directory(), page_files[i].from);
        char *to = neph_path_join(folder, page_files[i].to);
        status = from && to ? neph_file_copy(from, to, diag) : neph_fail_memory(diag);
        free(from);
        free(to);
    }
    return status;
}

static bool vendor_is_installed(void)
{
    bool installed = true;
    for (size_t i = 0; i < sizeof(page_files) / sizeof(page_files[0]); i++) {
        char *path = neph_format("%s/scripts/report/%s", neph_data_directory(), page_files[i].from);
        if (page_files[i].vendored)
            installed &= path && neph_path_exists(path);
        free(path);
    }
    return installed;
}

/* "</script>" and friends cannot end the script early: '<' is written as an escape. */
static char *escape_for_script(const char *json)
{
    size_t extra = 0;
    for (const char *c = json; *c; c++)
        extra += *c == '<' ? 5 : 0;
    char *escaped = malloc(strlen(json) + extra + 1), *out = escaped;
    if (!escaped)
        return NULL;
    for (const char *c = json; *c; c++) {
        if (*c == '<')
            out = stpcpy(out, "\\u003c");
        else
            *out++ = *c;
    }
    *out = '\0';
    return escaped;
}

static enum neph_status write_data(const char *folder, const json_t *document,
                                   struct neph_diag *diag)
{
    char *json = json_dumps(document, JSON_INDENT(1));
    char *escaped = json ? escape_for_script(json) : NULL;
    char *script = escaped ? neph_format("window.NEPH_REPORT = %s;\n", escaped) : NULL;
    char *json_path = neph_path_join(folder, "data.json");
    char *script_path = neph_path_join(folder, "data.js");
    enum neph_status status = script && json_path && script_path ? NEPH_OK : neph_fail_memory(diag);
    if (!status)
        status = neph_file_write(json_path, json, strlen(json), diag);
    if (!status)
        status = neph_file_write(script_path, script, strlen(script), diag);
    free(json);
    free(escaped);
    free(script);
    free(json_path);
    free(script_path);
    return status;
}

/* The stops of the difference maps, evenly spaced from -scale to +scale, for the page's legend. */
static json_t *difference_colours_json(void)
{
    const struct neph_display_legend *legend = neph_display_difference_legend();
    json_t *colours = json_array();
    for (int i = 0; i < legend->stop_count; i++) {
        const uint8_t *rgb = legend->stops[i].rgb;
        neph_json_add(&colours, json_sprintf("#%02x%02x%02x", rgb[0], rgb[1], rgb[2]));
    }
    return colours;
}

static enum neph_status fill_folder(const char *folder, json_t *document, struct neph_diag *diag)
{
    static const char *const folders[] = {"images", "charts", "vendor"};
    const bool with_vendor = vendor_is_installed();
    enum neph_status status = NEPH_OK;
    for (size_t i = 0; i < 3 && !status; i++) {
        char *path = neph_path_join(folder, folders[i]);
        status = path ? neph_dir_create(path, diag) : neph_fail_memory(diag);
        free(path);
    }
    json_t *scenes = json_object_get(document, "scenes");
    for (size_t i = 0; i < json_array_size(scenes) && !status; i++)
        status = write_scene_pictures(folder, json_array_get(scenes, i), diag);
    if (!status)
        status = neph_physics_pictures(json_object_get(document, "physics"), folder, diag);
    json_t *charts = json_object_get(document, "charts");
    for (size_t i = 0; i < json_array_size(charts) && !status; i++)
        status = draw_chart(folder, json_array_get(charts, i), diag);
    if (!status)
        status = neph_json_put(document, "interactive", json_boolean(with_vendor), diag);
    if (!status)
        status = neph_json_put(document, "difference_colours", difference_colours_json(), diag);
    if (!status)
        status = copy_page(folder, with_vendor, diag);
    if (!status)
        status = write_data(folder, document, diag);
    return status;
}

/* Put `fresh` where `folder` is, in one step, and remove what was there. */
static enum neph_status exchange(const char *fresh, const char *folder, struct neph_diag *diag)
{
    if (!neph_path_exists(folder)) {
        if (rename(fresh, folder) == 0)
            return NEPH_OK;
    } else if (renameat2(AT_FDCWD, fresh, AT_FDCWD, folder, RENAME_EXCHANGE) == 0) {
        return neph_dir_remove(fresh, diag);
    }
    return neph_fail(diag, NEPH_ERR_IO, "cannot put the report at '%s': %s", folder,
                     strerror(errno));
}

enum neph_status neph_report_write(json_t *document, const char *folder, struct neph_diag *diag)
{
    char *fresh = neph_format("%s.new", folder);
    if (!fresh)
        return neph_fail_memory(diag);
    enum neph_status status = neph_dir_remove(fresh, diag); /* left by a killed run */
    if (!status)
        status = neph_dir_create(fresh, diag);
    if (!status)
        status = fill_folder(fresh, document, diag);
    if (!status)
        status = exchange(fresh, folder, diag);
    free(fresh);
    return status;
}
