/* SPDX-License-Identifier: MIT
 *
 * One Blender process renders several images of a shot (details: scripts/blender_render.py):
 *
 *   radiance       the scene; its two volume passes are the in-scattered light
 *   emission       light that media emit, rendered separately where scattering leaves it out
 *   transmittance  black media in front of a background and solids of radiance 1
 *   depth          only the solids
 *
 * Blender gets all inputs as numbers in spec.json and writes fixed file names in the scratch
 * folder: no text of a scene reaches a command line, a path or Python.
 */
#include "harness/engines/cycles_frame.h"

#include "base/exr.h"
#include "base/files.h"
#include "harness/data.h"
#include "harness/engines/bakes.h"
#include "harness/engines/blender.h"
#include "harness/engines/cycles_layers.h"
#include "harness/engines/cycles_mesh.h"
#include "harness/engines/cycles_surface.h"
#include "harness/engines/engines.h"
#include "harness/engines/frame_stats.h"
#include "harness/json_file.h"
#include "scenes/emission.h"
#include "scenes/media.h"
#include "scenes/volume_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Blender renders no smaller side: it silently raises it to 4. */
enum { SIDE_MIN_PX = 4 };

static enum neph_status adapt_scene(const struct neph_shot *shot,
                                    struct neph_cycles_session *session, struct neph_diag *diag)
{
    const int resolution = (int)neph_setting(&neph_engine_cycles, &shot->settings,
                                             "bake_resolution");
    struct neph_diag why = {0};
    enum neph_status status = neph_baked_scene_make(shot->scene, resolution, &session->baked, &why);
    if (!status)
        status = neph_cycles_world(&session->baked.scene, &session->world, &why);
    session->shot.scene = &session->baked.scene;
    session->world.cut_error += session->baked.cut_error;
    return neph_external_fail_scene("Cycles", status, &why, diag);
}

enum neph_status neph_cycles_open(const struct neph_shot *shot,
                                  const struct neph_cycles_quality *quality, const char *program,
                                  const char *directory, struct neph_cycles_session *session,
                                  struct neph_diag *diag)
{
    *session = (struct neph_cycles_session){
        .shot = *shot, .directory = directory, .program = program, .quality = *quality};
    if (shot->width_px < SIDE_MIN_PX || shot->height_px < SIDE_MIN_PX)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "Cycles cannot: a frame of %d x %d pixels; Blender renders %d x %d at the "
                         "least",
                         shot->width_px, shot->height_px, SIDE_MIN_PX, SIDE_MIN_PX);
    return adapt_scene(shot, session, diag);
}

void neph_cycles_close(struct neph_cycles_session *session)
{
    neph_baked_scene_finish(&session->baked);
}

static enum neph_status write_grids(const struct neph_cycles_session *session,
                                    struct neph_diag *diag)
{
    const struct neph_scene *scene = session->shot.scene;
    const struct neph_camera camera = neph_scene_camera(scene, session->shot.frame);
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < scene->medium_count && !status; i++) {
        if (!session->world.used[i] || !scene->media[i].grid)
            continue;
        const struct neph_grid placed = neph_cycles_grid(scene->media[i].grid, &camera,
                                                         session->world.unit_m);
        char name[NEPH_CYCLES_FILE_NAME_MAX];
        neph_cycles_grid_name(i, name);
        char *path = neph_path_join(session->directory, name);
        status = path ? neph_volume_write_vdb(path, &placed, NEPH_VDB_BLENDER, diag)
                      : neph_fail_memory(diag);
        free(path);
    }
    return status;
}

enum neph_status neph_cycles_write(struct neph_cycles_session *session, struct neph_diag *diag)
{
    json_t *spec = NULL;
    enum neph_status status = neph_cycles_spec(&session->shot, &session->world, &session->quality,
                                               &spec, &session->sphere_error_px, diag);
    if (status)
        return status;
    char *text = json_dumps(spec, JSON_INDENT(1) | JSON_REAL_PRECISION(17));
    char *path = neph_path_join(session->directory, "spec.json");
    char *script = neph_data_path(NEPH_BLENDER_SCRIPT_PATH);
    char *copy = neph_path_join(session->directory, NEPH_BLENDER_SCRIPT);
    status = text && path && script && copy ? NEPH_OK : neph_fail_memory(diag);
    if (!status)
        status = neph_file_write(path, text, strlen(text), diag);
    if (!status) {
        status = neph_file_copy(script, copy, diag);
        if (status)
            neph_hint(diag, "set NEPH_DATA_DIR to the folder with %s", NEPH_BLENDER_SCRIPT_PATH);
    }
    if (!status)
        status = write_grids(session, diag);
    if (!status)
        status = neph_cycles_write_meshes(session->shot.scene, session->directory, diag);
    json_decref(spec);
    free(text);
    free(path);
    free(script);
    free(copy);
    return status;
}

enum neph_status neph_cycles_run(const struct neph_cycles_session *session, const char *blend,
                                 struct neph_child_result *result, struct neph_diag *diag)
{
    char threads[16];
    snprintf(threads, sizeof(threads), "%d", session->quality.threads);
    /* Blender evaluates arguments in order: --python-exit-code must precede --python. */
    const char *argv[] = {session->program,
                          "-b",
                          "--factory-startup",
                          "-noaudio",
                          "-t",
                          threads,
                          "--python-exit-code",
                          "7",
                          "--python",
                          NEPH_BLENDER_SCRIPT,
                          "--",
                          "spec.json",
                          blend ? "--save" : NULL,
                          blend,
                          NULL};
    char *log = neph_path_join(session->directory, "blender.log");
    const enum neph_status status = log ? neph_external_run(&neph_blender, argv, session->directory,
                                                            log, &session->shot, result, diag)
                                        : neph_fail_memory(diag);
    free(log);
    return status;
}

/* Read the image of a pass. The scratch folder started empty, so an existing file is new. */
static enum neph_status read_pass(const struct neph_cycles_session *session, const char *kind,
                                  struct neph_image **image, struct neph_diag *diag)
{
    struct neph_image *read = NULL;
    char *which = neph_format("%s ", kind),
         *path = neph_format("%s/%s.exr", session->directory, kind),
         *log = neph_format("%s/blender.log", session->directory);
    enum neph_status status = which && path && log
                                  ? neph_external_check_image(&neph_blender, path, which, log, diag)
                                  : neph_fail_memory(diag);
    if (!status)
        status = neph_program_status(neph_exr_read(path, &read, diag));
    if (!status)
        status = neph_external_check_size(&neph_blender, which, read->width_px, read->height_px,
                                          &session->shot, diag);
    free(which);
    free(path);
    free(log);
    if (status) {
        neph_image_destroy(read);
        return status;
    }
    *image = read;
    return NEPH_OK;
}

/* Read an image, and get three channels of each of its layers. The caller destroys the image. */
static enum neph_status read_layers(const struct neph_cycles_session *session, const char *kind,
                                    const char *const names[], int count, float *layers[][3],
                                    struct neph_image **image, struct neph_diag *diag)
{
    enum neph_status status = read_pass(session, kind, image, diag);
    for (int i = 0; i < count && !status; i++)
        status = neph_cycles_layer(*image, names[i], layers[i], diag);
    return status;
}

static enum neph_status fail_not_finite(const char *kind, size_t pixel, int width_px,
                                        struct neph_diag *diag)
{
    return neph_fail(diag, NEPH_ERR_ENGINE,
                     "Blender's %s image has a value that is not finite, at pixel (%zu, %zu)", kind,
                     pixel % (size_t)width_px, pixel / (size_t)width_px);
}

static const char *const combined_name = "Combined";

/* Read channels first..last of one image: R = combined, volume = direct and indirect volume light
 * plus visible emission of media. */
static enum neph_status read_radiance(const struct neph_cycles_session *session,
                                      const char *picture, int first, int last, float *const all[3],
                                      float *const scattered[3], struct neph_diag *diag)
{
    enum { COMBINED, DIRECT, INDIRECT, EMITTED, COUNT };
    static const char *const names[] = {"Combined", "VolumeDir", "VolumeInd", "Emit"};
    struct neph_image *image = NULL;
    float *layers[COUNT][3];
    const bool emits = neph_scene_emits(session->shot.scene) &&
                       !neph_cycles_has_emission_pictures(session->shot.scene);
    enum neph_status status = read_layers(session, picture, names, emits ? COUNT : EMITTED, layers,
                                          &image, diag);
    for (int channel = first; channel <= last && !status; channel++) {
        for (size_t i = 0; i < neph_image_pixel_count(image) && !status; i++) {
            all[channel][i] = layers[COMBINED][channel][i];
            scattered[channel][i] = layers[DIRECT][channel][i] + layers[INDIRECT][channel][i];
            if (emits)
                scattered[channel][i] += layers[EMITTED][channel][i];
            if (!isfinite(all[channel][i]) || !isfinite(scattered[channel][i]))
                status = fail_not_finite(picture, i, image->width_px, diag);
        }
    }
    neph_image_destroy(image);
    return status;
}

/* Add the emission to radiance and volume. */
static enum neph_status add_emission(const struct neph_cycles_session *session, const char *picture,
                                     int first, int last, float *const all[3],
                                     float *const scattered[3], struct neph_diag *diag)
{
    struct neph_image *image = NULL;
    float *layers[1][3];
    enum neph_status status = read_layers(session, picture, &combined_name, 1, layers, &image,
                                          diag);
    for (int channel = first; channel <= last && !status; channel++) {
        for (size_t i = 0; i < neph_image_pixel_count(image) && !status; i++) {
            const float emitted = layers[0][channel][i];
            all[channel][i] += emitted;
            scattered[channel][i] += emitted;
            if (!isfinite(emitted))
                status = fail_not_finite(picture, i, image->width_px, diag);
        }
    }
    neph_image_destroy(image);
    return status;
}

static enum neph_status radiance_layers(const struct neph_cycles_session *session,
                                        struct neph_image *frame, struct neph_diag *diag)
{
    static const struct {
        const char *radiance, *emission;
        int first, last; /* the channels of this image that are valid */
    } pictures[] = {{"radiance", "emission", 0, 2},
                    {"radiance0", "emission0", 0, 0},
                    {"radiance1", "emission1", 1, 1},
                    {"radiance2", "emission2", 2, 2}};
    const bool coloured = neph_cycles_is_coloured(session->shot.scene);
    const bool emits = neph_cycles_has_emission_pictures(session->shot.scene);
    float *all[3], *scattered[3];
    enum neph_status status = neph_image_add_rgb(frame, NULL, all, diag);
    if (!status)
        status = neph_image_add_rgb(frame, "volume", scattered, diag);
    for (int i = coloured ? 1 : 0; i <= (coloured ? 3 : 0) && !status; i++) {
        const int first = pictures[i].first, last = pictures[i].last;
        status = read_radiance(session, pictures[i].radiance, first, last, all, scattered, diag);
        if (!status && emits)
            status = add_emission(session, pictures[i].emission, first, last, all, scattered, diag);
    }
    return status;
}

/* Read the surface layers, from the image with all channels. */
static enum neph_status surface_layers(const struct neph_cycles_session *session,
                                       struct neph_image *frame, struct neph_diag *diag)
{
    struct neph_image *image = NULL;
    enum neph_status status = read_pass(session, "radiance", &image, diag);
    if (!status)
        status = neph_cycles_surface_layers(image, frame, diag);
    neph_image_destroy(image);
    return status;
}

static enum neph_status transmittance_layer(const struct neph_cycles_session *session,
                                            struct neph_image *frame, struct neph_diag *diag)
{
    struct neph_image *image = NULL;
    float *layers[1][3], *layer[3];
    enum neph_status status = read_layers(session, "transmittance", &combined_name, 1, layers,
                                          &image, diag);
    if (!status)
        status = neph_image_add_rgb(frame, "transmittance", layer, diag);
    for (int channel = 0; channel < 3 && !status; channel++) {
        for (size_t i = 0; i < neph_image_pixel_count(frame) && !status; i++) {
            layer[channel][i] = layers[0][channel][i];
            if (!isfinite(layer[channel][i]))
                status = fail_not_finite("transmittance", i, frame->width_px, diag);
        }
    }
    neph_image_destroy(image);
    return status;
}

static enum neph_status depth_layer(const struct neph_cycles_session *session,
                                    struct neph_image *frame, struct neph_diag *diag)
{
    static const float sky_units = 1e10f;
    struct neph_image *image = NULL;
    float *layer;
    enum neph_status status = read_pass(session, "depth", &image, diag);
    const float *units = NULL;
    if (!status)
        status = neph_cycles_depth(image, &units, diag);
    if (!status)
        status = neph_image_add_channel(frame, "Z", &layer, diag);
    for (size_t i = 0; !status && i < neph_image_pixel_count(frame); i++) {
        if (isnan(units[i]))
            status = fail_not_finite("depth", i, frame->width_px, diag);
        layer[i] = units[i] >= sky_units ? INFINITY : (float)(units[i] * session->world.unit_m);
    }
    neph_image_destroy(image);
    return status;
}

enum neph_status neph_cycles_about(const struct neph_cycles_session *session, json_t **about,
                                   struct neph_diag *diag)
{
    char *path = neph_path_join(session->directory, "about.json");
    enum neph_status status = path ? neph_program_status(neph_json_read(path, 1 << 16, about, diag))
                                   : neph_fail_memory(diag);
    if (!status && !*about)
        status = neph_fail(diag, NEPH_ERR_ENGINE, "'%s' is no JSON", path);
    free(path);
    return status;
}

/* Total time of all radiance and emission images [s]; negative: none. */
static double sum_radiance_s(const json_t *timing)
{
    static const char *const pictures[] = {"radiance", "radiance0", "radiance1", "radiance2",
                                           "emission", "emission0", "emission1", "emission2"};
    double sum_s = 0.0;
    bool found = false;
    for (size_t i = 0; i < sizeof(pictures) / sizeof(pictures[0]); i++) {
        const json_t *seconds = json_object_get(timing, pictures[i]);
        sum_s += json_number_value(seconds);
        found |= json_is_number(seconds);
    }
    return found ? sum_s : -1.0;
}

/* Seconds that the radiance render took inside Blender. */
static enum neph_status read_timing(const struct neph_cycles_session *session, double *render_s,
                                    struct neph_diag *diag)
{
    char *path = neph_path_join(session->directory, "timing.json");
    char *text = NULL;
    size_t size = 0;
    enum neph_status status = path ? neph_program_status(
                                         neph_file_read(path, 1 << 16, &text, &size, diag))
                                   : neph_fail_memory(diag);
    json_t *timing = status ? NULL : json_loadb(text, size, JSON_REJECT_DUPLICATES, NULL);
    const double seconds = sum_radiance_s(timing);
    if (!status && (session->shot.layers & NEPH_LAYER_RADIANCE) && seconds < 0.0)
        status = neph_fail(diag, NEPH_ERR_ENGINE, "'%s' has no render time", path);
    if (!status)
        *render_s = fmax(0.0, seconds);
    json_decref(timing);
    free(text);
    free(path);
    return status;
}

/* The shortest feature length of the media; +inf: all are homogeneous. */
static double shortest_feature_m(const struct neph_cycles_session *session)
{
    double shortest_m = INFINITY;
    for (int i = 0; i < session->shot.scene->medium_count; i++)
        if (session->world.used[i])
            shortest_m = fmin(shortest_m, session->world.feature_m[i]);
    return shortest_m;
}

/* Label the frame with the number of negative pixels and their sum: an unbiased volume estimator
 * may give values below 0. */
static enum neph_status label_noise(const struct neph_cycles_session *session,
                                    struct neph_image *frame, struct neph_diag *diag)
{
    float *rgb[3];
    double sum = 0.0;
    size_t count = 0;
    if (!(session->shot.layers & NEPH_LAYER_RADIANCE) || !neph_image_rgb(frame, NULL, rgb))
        return NEPH_OK;
    for (size_t p = 0; p < neph_image_pixel_count(frame); p++) {
        count += rgb[0][p] < 0.0f || rgb[1][p] < 0.0f || rgb[2][p] < 0.0f;
        for (int c = 0; c < 3; c++)
            sum += fmin(0.0, (double)rgb[c][p]) / 3.0;
    }
    enum neph_status status = neph_image_set_attribute(
        frame, NEPH_SIGNED_NOISE_ATTRIBUTE, diag,
        "unbiased volumes: %zu pixels are below 0, by %.6g in sum", count, sum);
    if (!status)
        status = neph_frame_stats_set(frame, "negative_pixels", (double)count, diag);
    return status ? status : neph_frame_stats_set(frame, "negative_sum", sum, diag);
}

static enum neph_status add_attributes(const struct neph_cycles_session *session,
                                       struct neph_image *frame, struct neph_diag *diag)
{
    const bool has_steps = !session->quality.is_unbiased;
    const double step_m = session->quality.step * shortest_feature_m(session);
    enum neph_status status = neph_image_set_attribute(frame, "neph.cycles.samples", diag, "%d",
                                                       session->quality.samples);
    if (!status)
        status = neph_image_set_attribute(frame, "neph.cycles.filter", diag,
                                          "Blackman-Harris 0.01 px: pixel centre, but for 0.13 %% "
                                          "of the samples (up to 0.48 px off); transmittance and "
                                          "Z: exactly the centre");
    if (!status && !has_steps)
        status = label_noise(session, frame, diag);
    if (!status && has_steps && isfinite(step_m))
        status = neph_image_set_attribute(frame, "neph.cycles.step_m", diag,
                                          "radiance %.6g, transmittance %.6g", step_m,
                                          step_m / NEPH_CYCLES_FINE_STEPS);
    if (!status)
        status = neph_image_set_attribute(frame, "neph.cycles.unit_m", diag, "%.9g",
                                          session->world.unit_m);
    if (!status)
        status = neph_image_set_attribute(frame, "neph.cycles.cut_error", diag, "%.3g",
                                          session->world.cut_error);
    if (!status)
        status = neph_image_set_attribute(frame, "neph.cycles.sphere_error_px", diag, "%.3g",
                                          session->sphere_error_px);
    if (!status)
        status = neph_bakes_label(session->baked.bakes, session->baked.bake_count, frame, diag);
    return status;
}

static enum neph_status make_layers(const struct neph_cycles_session *session,
                                    struct neph_image *made, struct neph_diag *diag)
{
    const unsigned layers = session->shot.layers;
    enum neph_status status = NEPH_OK;
    if (layers & NEPH_LAYER_RADIANCE)
        status = radiance_layers(session, made, diag);
    if (!status && (layers & NEPH_LAYER_RADIANCE) && session->quality.surface_layers)
        status = surface_layers(session, made, diag);
    if (!status && (layers & NEPH_LAYER_TRANSMITTANCE))
        status = transmittance_layer(session, made, diag);
    if (!status && (layers & NEPH_LAYER_DEPTH))
        status = depth_layer(session, made, diag);
    return status;
}

enum neph_status neph_cycles_frame(const struct neph_cycles_session *session,
                                   struct neph_image **frame, double *render_s,
                                   struct neph_diag *diag)
{
    const struct neph_shot *shot = &session->shot;
    struct neph_image *made = NULL;
    enum neph_status status = read_timing(session, render_s, diag);
    if (!status)
        status = neph_image_create(shot->width_px, shot->height_px, &made, diag);
    if (!status)
        status = make_layers(session, made, diag);
    if (!status)
        status = add_attributes(session, made, diag);
    if (status) {
        neph_image_destroy(made);
        return status;
    }
    *frame = made;
    return NEPH_OK;
}
