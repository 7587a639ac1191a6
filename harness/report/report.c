/* SPDX-License-Identifier: MIT */
#include "harness/report/report.h"

#include "base/child.h"
#include "base/exr.h"
#include "base/files.h"
#include "base/hash.h"
#include "base/png.h"
#include "harness/data.h"
#include "harness/physics/pictures.h"
#include "harness/report/over_time.h"
#include "harness/report/report_folder.h"
#include "metrics/display.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const double chart_time_limit_s = 120.0;

/* What drawing sets. */
static const char *const frame_outputs[2] = {"picture", "difference"};
static const char *const chart_outputs[2] = {"svg", "missing"};

struct neph_report {
    struct neph_report_folder *folder;
    json_t *drawn; /* by name: what it was drawn from, "inputs", and what came out, "outputs" */
    bool with_vendor;
};

static const char *text_of(const json_t *object, const char *key)
{
    return json_string_value(json_object_get(object, key));
}

/* What came of drawing `name` from these very inputs before, or NULL. `hash` receives theirs, for
 * keep_drawn(). */
static enum neph_status find_drawn(const struct neph_report *report, const char *name,
                                   const char *inputs, char hash[NEPH_HASH_HEX_SIZE],
                                   json_t **outputs, struct neph_diag *diag)
{
    json_t *drawn = json_object_get(report->drawn, name);
    const enum neph_status status = neph_hash(inputs, strlen(inputs), hash, diag);
    *outputs = !status && drawn && strcmp(text_of(drawn, "inputs"), hash) == 0
                   ? json_object_get(drawn, "outputs")
                   : NULL;
    return status;
}

/* Remember the fields of `holder`, a frame or chart, that drawing sets. */
static enum neph_status keep_drawn(struct neph_report *report, const char *name, const char *hash,
                                   const json_t *holder, const char *const fields[2],
                                   struct neph_diag *diag)
{
    json_t *outputs = json_object();
    for (int i = 0; i < 2; i++)
        if (json_object_get(holder, fields[i]))
            neph_json_set(&outputs, fields[i], json_incref(json_object_get(holder, fields[i])));
    json_t *drawn = json_pack("{s:s, s:o}", "inputs", hash, "outputs", outputs);
    return neph_json_put(report->drawn, name, drawn, diag);
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
    struct neph_image *truth; /* read when it is first needed; NULL: no difference maps */
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
    struct neph_image *image = NULL;
    enum neph_status status = neph_exr_read(text_of(frame, "exr"), &image, diag);
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

/* What the pictures of a frame are drawn from, for the caller to free. The paths of frames in the
 * store hold the hashes of all that made them. */
static char *inputs_of(const json_t *scene, const json_t *frame, const char *truth)
{
    const json_t *scale = json_object_get(scene, "difference_scale");
    return neph_format("%s against %s at %.17g, %.17g, %.17g", text_of(frame, "exr"),
                       truth ? truth : "nothing",
                       json_number_value(json_object_get(scene, "exposure_ev")),
                       json_number_value(json_object_get(scale, "radiance")),
                       json_number_value(json_object_get(scale, "transmittance")));
}

static enum neph_status draw_frame(struct neph_report *report, struct picture *picture,
                                   const json_t *scene, json_t *frame, struct neph_diag *diag)
{
    const char *exr = text_of(frame, "exr"), *truth = truth_path(scene);
    char *name = neph_format("images/%s/%s", picture->scene, text_of(frame, "engine"));
    char *inputs = inputs_of(scene, frame, truth);
    char hash[NEPH_HASH_HEX_SIZE];
    json_t *drawn = NULL;
    enum neph_status status = name && inputs ? find_drawn(report, name, inputs, hash, &drawn, diag)
                                             : neph_fail_memory(diag);
    if (drawn && json_object_update(frame, drawn) != 0)
        status = neph_fail_memory(diag);
    const bool anew = !status && !drawn;
    if (anew && truth && !picture->truth)
        status = neph_exr_read(truth, &picture->truth, diag);
    if (anew && !status)
        status = write_frame_pictures(picture, frame, truth && strcmp(exr, truth) == 0, diag);
    if (anew && !status)
        status = keep_drawn(report, name, hash, frame, frame_outputs, diag);
    free(name);
    free(inputs);
    return status;
}

static enum neph_status draw_scene(struct neph_report *report, const json_t *scene,
                                   struct neph_diag *diag)
{
    const char *folder = neph_report_folder_work(report->folder);
    struct picture picture = {
        .folder = folder,
        .scene = text_of(scene, "name"),
        .exposure_ev = json_number_value(json_object_get(scene, "exposure_ev")),
        .scale = json_object_get(scene, "difference_scale"),
    };
    char *images = neph_format("%s/images/%s", folder, picture.scene);
    enum neph_status status = images ? neph_dir_create(images, diag) : neph_fail_memory(diag);
    json_t *frames = json_object_get(scene, "frames");
    for (size_t i = 0; i < json_array_size(frames) && !status; i++) {
        json_t *frame = json_array_get(frames, i);
        if (text_of(frame, "exr"))
            status = draw_frame(report, &picture, scene, frame, diag);
    }
    free(images);
    neph_image_destroy(picture.truth);
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
    if (!status)
        unlink(svg_path); /* an older one is linked to from the report, and not to be written to */
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

static enum neph_status show_chart(struct neph_report *report, json_t *chart,
                                   struct neph_diag *diag)
{
    char *name = neph_format("charts/%s", text_of(chart, "id"));
    char *spec = json_dumps(json_object_get(chart, "spec"), JSON_COMPACT | JSON_SORT_KEYS);
    char hash[NEPH_HASH_HEX_SIZE];
    json_t *drawn = NULL;
    enum neph_status status = name && spec ? find_drawn(report, name, spec, hash, &drawn, diag)
                                           : neph_fail_memory(diag);
    if (drawn && json_object_update(chart, drawn) != 0)
        status = neph_fail_memory(diag);
    const bool anew = !status && !drawn;
    if (anew)
        status = draw_chart(neph_report_folder_work(report->folder), chart, diag);
    if (anew && !status)
        status = keep_drawn(report, name, hash, chart, chart_outputs, diag);
    free(name);
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

/* All but the data, into the folder that is kept between publications. */
static enum neph_status draw(struct neph_report *report, json_t *document, struct neph_diag *diag)
{
    const char *folder = neph_report_folder_work(report->folder);
    enum neph_status status = NEPH_OK;
    json_t *scenes = json_object_get(document, "scenes");
    for (size_t i = 0; i < json_array_size(scenes) && !status; i++)
        status = draw_scene(report, json_array_get(scenes, i), diag);
    if (!status)
        status = neph_physics_pictures(json_object_get(document, "physics"), folder, diag);
    if (!status)
        status = neph_over_time_pictures(json_object_get(document, "sequences"), folder, diag);
    json_t *charts = json_object_get(document, "charts");
    for (size_t i = 0; i < json_array_size(charts) && !status; i++)
        status = show_chart(report, json_array_get(charts, i), diag);
    if (!status)
        status = neph_json_put(document, "interactive", json_boolean(report->with_vendor), diag);
    if (!status)
        status = neph_json_put(document, "difference_colours", difference_colours_json(), diag);
    return status;
}

/* What is the same in every publication. */
static enum neph_status start_folder(struct neph_report *report, struct neph_diag *diag)
{
    static const char *const folders[] = {"images", "charts", "vendor"};
    const char *folder = neph_report_folder_work(report->folder);
    enum neph_status status = NEPH_OK;
    for (size_t i = 0; i < 3 && !status; i++) {
        char *path = neph_path_join(folder, folders[i]);
        status = path ? neph_dir_create(path, diag) : neph_fail_memory(diag);
        free(path);
    }
    report->with_vendor = vendor_is_installed();
    return status ? status : copy_page(folder, report->with_vendor, diag);
}

enum neph_status neph_report_open(const char *folder, struct neph_report **report,
                                  struct neph_diag *diag)
{
    struct neph_report *opened = calloc(1, sizeof(*opened));
    if (!opened)
        return neph_fail_memory(diag);
    enum neph_status status = neph_report_folder_open(folder, &opened->folder, diag);
    if (!status && !(opened->drawn = json_object()))
        status = neph_fail_memory(diag);
    if (!status)
        status = start_folder(opened, diag);
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
    json_decref(report->drawn);
    free(report);
}

enum neph_status neph_report_publish(struct neph_report *report, json_t *document,
                                     struct neph_diag *diag)
{
    struct neph_scratch *fresh = NULL;
    enum neph_status status = draw(report, document, diag);
    if (!status)
        status = neph_report_folder_begin(report->folder, &fresh, diag);
    if (!status)
        status = write_data(neph_scratch_path(fresh), document, diag);
    if (!status)
        status = neph_report_folder_exchange(report->folder, fresh, diag);
    neph_scratch_destroy(fresh);
    return status;
}
