/* SPDX-License-Identifier: MIT
 *
 * Engine `cycles`: Blender's path tracer as a witness of all orders of scattering. One Blender
 * process renders a few pictures of a shot (scripts/blender_render.py says how):
 *
 *   radiance       the scene; its two volume passes are the in-scattered light
 *   emission       what media emit, where that is not scattered, too
 *   transmittance  black media before a world and solids of radiance 1
 *   depth          the solids alone
 *
 * Blender is told everything as numbers in spec.json and writes under fixed names in the scratch
 * folder: no text of a scene reaches a command line, a path or Python.
 */
#include "harness/engines/engines.h"

#include "base/child.h"
#include "base/clock.h"
#include "base/exr.h"
#include "base/files.h"
#include "base/threads.h"
#include "harness/data.h"
#include "harness/engines/baked_scene.h"
#include "harness/engines/bakes.h"
#include "harness/engines/cycles_spec.h"
#include "harness/engines/cycles_surface.h"
#include "harness/engines/program.h"
#include "scenes/emission.h"
#include "scenes/media.h"
#include "scenes/volume_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char script_name[] = "blender_render.py", script_path[] = "scripts/blender_render.py";

/* Blender writes nothing smaller: it silently makes it 4 x 4. */
enum { SIDE_MIN_PX = 4 };

/* Python asks for no files beside Blender's own, and leaves none. */
static const char *const environment[] = {"PYTHONNOUSERSITE=1", "PYTHONDONTWRITEBYTECODE=1", NULL};

static const char *const switches[] = {"off", "on", NULL};

/* Defaults by measurement over height fogs of vertical optical depth 0.07 to 10 and views up and
 * down. At a step of 0.1 scale heights single scattering is within 0.1 % row by row and 0.03 % over
 * the image where more than e^-4 of the sun arrives; the error grows as (step * optical depth
 * towards the sun)^2 / 24, and 0.2 costs half of the time. A pixel of transmittance errs by the
 * jitter of its steps, in proportion to their length: 2.3e-4 at most at 1/640 scale height. */
static const struct neph_option options[] = {
    {.name = "samples",
     .kind = NEPH_OPTION_INTEGER,
     .default_value = 64,
     .minimum = 1,
     .maximum = 8192, /* beyond, Cycles' single-precision sums lose light: -0.15 % at 1e5 */
     .help = "paths per pixel of the radiance pass"},
    {.name = "step",
     .kind = NEPH_OPTION_REAL,
     .default_value = 0.2,
     .minimum = 0.01,
     .maximum = 10.0,
     .help = "march step: in fog in scale heights, in voxels in their spacings or mean free paths "
             "(transmittance pass: 1/160 of it)"},
    {.name = "threads",
     .kind = NEPH_OPTION_INTEGER,
     .default_value = 0,
     .minimum = 0,
     .maximum = 1024,
     .help = "threads of Blender, 0 for one per processor (changes no bit of the frame)"},
    NEPH_OPTION_BAKE_RESOLUTION,
    {.name = "surface_layers",
     .kind = NEPH_OPTION_CHOICE,
     .choices = switches,
     .help = "the light of solids in parts, too: the layers of engine surfaces"},
    {.name = "ao_distance_m",
     .kind = NEPH_OPTION_REAL,
     .default_value = 0,
     .minimum = 0,
     .maximum = 1e6,
     .help = "their layer ao: what is farther hides nothing [m]; 0: no limit"},
    {.name = NULL},
};

/* ---- probe ----------------------------------------------------------------------------------- */

/* The version after "Blender " at the start of a line. */
static bool parse_version(const char *text, char version[64])
{
    static const char name[] = "Blender ";
    for (const char *at = text; (at = strstr(at, name)); at += sizeof(name) - 1)
        if ((at == text || at[-1] == '\n') &&
            sscanf(at + sizeof(name) - 1, "%63[0-9.]", version) == 1)
            return true;
    return false;
}

static const struct neph_external_renderer blender = {
    .program = "blender",
    .name = "Blender",
    .install_line = "apt-get install blender python3-numpy",
    .data_file = script_path,
    .parse_version = parse_version,
    .measured = "3.4.",
    .other = {"wrong version: 'blender' is ",
              ", and our laws of Cycles were measured for 3.4.x; 5.0 has another volume "
              "integrator (null scattering in place of marching)"},
    .environment = environment,
};

static void probe(struct neph_shared_device *device, struct neph_engine_info *info)
{
    (void)device;
    neph_external_probe(&blender, info);
}

static bool can_render(const struct neph_scene *scene, const struct neph_settings *settings,
                       char *reason, size_t reason_size)
{
    (void)settings;
    struct neph_diag diag = {0};
    struct neph_cycles_world world;
    const bool is_endless = neph_scene_is_endless(scene);
    if (!is_endless && !neph_cycles_world(scene, &world, &diag))
        return true;
    if (reason_size > 0)
        snprintf(reason, reason_size, "%s", is_endless ? neph_endless_reason : diag.message);
    return false;
}

/* ---- one frame ------------------------------------------------------------------------------- */

struct session {
    struct neph_shot shot; /* its scene is `baked` */
    struct neph_baked_scene baked;
    const char *directory;
    struct neph_cycles_world world;
    struct neph_cycles_quality quality;
    double sphere_error_px;
};

static enum neph_status adapt_scene(const struct neph_shot *shot, struct session *session,
                                    struct neph_diag *diag)
{
    const int resolution = (int)neph_setting(&neph_engine_cycles, &shot->settings,
                                             "bake_resolution");
    struct neph_diag why = {0};
    enum neph_status status = neph_baked_scene_make(shot->scene, resolution, &session->baked, &why);
    if (!status)
        status = neph_cycles_world(&session->baked.scene, &session->world, &why);
    session->shot.scene = &session->baked.scene;
    session->world.cut_error += session->baked.cut_error;
    return neph_external_cannot("Cycles", status, &why, diag);
}

/* The caller ends session->baked, whatever the status. */
static enum neph_status open_session(const struct neph_shot *shot, const char *directory,
                                     struct session *session, struct neph_diag *diag)
{
    *session = (struct session){.shot = *shot, .directory = directory};
    if (shot->width_px < SIDE_MIN_PX || shot->height_px < SIDE_MIN_PX)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "Cycles cannot: a frame of %d x %d pixels; Blender renders %d x %d at the "
                         "least",
                         shot->width_px, shot->height_px, SIDE_MIN_PX, SIDE_MIN_PX);
    const struct neph_settings *settings = &shot->settings;
    const int threads = (int)neph_setting(&neph_engine_cycles, settings, "threads");
    session->quality = (struct neph_cycles_quality){
        .samples = (int)neph_setting(&neph_engine_cycles, settings, "samples"),
        .step = neph_setting(&neph_engine_cycles, settings, "step"),
        .threads = threads > 0 ? threads : neph_processor_count(),
        .surface_layers = neph_setting(&neph_engine_cycles, settings, "surface_layers") != 0.0,
        .ao_distance_m = neph_setting(&neph_engine_cycles, settings, "ao_distance_m"),
    };
    return adapt_scene(shot, session, diag);
}

static enum neph_status write_grids(const struct session *session, struct neph_diag *diag)
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

/* spec.json and the script, side by side in the folder. */
static enum neph_status write_inputs(struct session *session, struct neph_diag *diag)
{
    json_t *spec = NULL;
    enum neph_status status = neph_cycles_spec(&session->shot, &session->world, &session->quality,
                                               &spec, &session->sphere_error_px, diag);
    if (status)
        return status;
    char *text = json_dumps(spec, JSON_INDENT(1) | JSON_REAL_PRECISION(17));
    char *path = neph_path_join(session->directory, "spec.json");
    char *script = neph_data_path(script_path);
    char *copy = neph_path_join(session->directory, script_name);
    status = text && path && script && copy ? NEPH_OK : neph_fail_memory(diag);
    if (!status)
        status = neph_file_write(path, text, strlen(text), diag);
    if (!status) {
        status = neph_file_copy(script, copy, diag);
        if (status)
            neph_hint(diag, "NEPH_DATA_DIR names the folder that holds %s", script_path);
    }
    if (!status)
        status = write_grids(session, diag);
    json_decref(spec);
    free(text);
    free(path);
    free(script);
    free(copy);
    return status;
}

/* Run the script on spec.json, or, with `blend` not NULL, save the scenes under that name. */
static enum neph_status run_script(const struct session *session, const char *blend,
                                   struct neph_child_result *result, struct neph_diag *diag)
{
    char threads[16];
    snprintf(threads, sizeof(threads), "%d", session->quality.threads);
    /* Blender reads its arguments in order: --python-exit-code must stand before --python. */
    const char *argv[] = {"blender",
                          "-b",
                          "--factory-startup",
                          "-noaudio",
                          "-t",
                          threads,
                          "--python-exit-code",
                          "7",
                          "--python",
                          script_name,
                          "--",
                          "spec.json",
                          blend ? "--save" : NULL,
                          blend,
                          NULL};
    char *log = neph_path_join(session->directory, "blender.log");
    const enum neph_status status = log ? neph_external_run(&blender, argv, session->directory, log,
                                                            &session->shot, result, diag)
                                        : neph_fail_memory(diag);
    free(log);
    return status;
}

/* The scratch folder was empty, so a file that is there is fresh. */
static enum neph_status read_pass(const struct session *session, const char *kind,
                                  struct neph_image **image, struct neph_diag *diag)
{
    struct neph_image *read = NULL;
    char *which = neph_format("%s ", kind),
         *path = neph_format("%s/%s.exr", session->directory, kind),
         *log = neph_format("%s/blender.log", session->directory);
    enum neph_status status = which && path && log
                                  ? neph_external_left(&blender, path, which, log, diag)
                                  : neph_fail_memory(diag);
    if (!status)
        status = neph_program_status(neph_exr_read(path, &read, diag));
    if (!status)
        status = neph_external_size(&blender, which, read->width_px, read->height_px,
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

/* A picture and three channels of each of its layers; it is the caller's to destroy. */
static enum neph_status read_layers(const struct session *session, const char *kind,
                                    const char *const names[], int count, float *layers[][3],
                                    struct neph_image **image, struct neph_diag *diag)
{
    enum neph_status status = read_pass(session, kind, image, diag);
    for (int i = 0; i < count && !status; i++)
        if (!neph_image_rgb(*image, names[i], layers[i]))
            status = neph_fail(diag, NEPH_ERR_ENGINE, "Blender's image has no layer '%s'",
                               names[i]);
    return status;
}

static enum neph_status not_finite(const char *kind, size_t pixel, int width_px,
                                   struct neph_diag *diag)
{
    return neph_fail(diag, NEPH_ERR_ENGINE,
                     "Blender's %s image holds a value that is not finite, at pixel (%zu, %zu)",
                     kind, pixel % (size_t)width_px, pixel / (size_t)width_px);
}

static const char *const combined_name = "pass.Combined";

/* R = combined, volume = its direct and indirect part and what media in view emit; of one picture,
 * in channels first..last. */
static enum neph_status take_radiance(const struct session *session, const char *picture, int first,
                                      int last, float *const all[3], float *const scattered[3],
                                      struct neph_diag *diag)
{
    enum { COMBINED, DIRECT, INDIRECT, EMITTED, COUNT };
    static const char *const names[] = {"pass.Combined", "pass.VolumeDir", "pass.VolumeInd",
                                        "pass.Emit"};
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
                status = not_finite(picture, i, image->width_px, diag);
        }
    }
    neph_image_destroy(image);
    return status;
}

/* Both layers get it. */
static enum neph_status add_emission(const struct session *session, const char *picture, int first,
                                     int last, float *const all[3], float *const scattered[3],
                                     struct neph_diag *diag)
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
                status = not_finite(picture, i, image->width_px, diag);
        }
    }
    neph_image_destroy(image);
    return status;
}

static enum neph_status radiance_layers(const struct session *session, struct neph_image *frame,
                                        struct neph_diag *diag)
{
    static const struct {
        const char *radiance, *emission;
        int first, last; /* of the channels that are right in it */
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
        status = take_radiance(session, pictures[i].radiance, first, last, all, scattered, diag);
        if (!status && emits)
            status = add_emission(session, pictures[i].emission, first, last, all, scattered, diag);
    }
    return status;
}

/* They are in the picture of all channels. */
static enum neph_status surface_layers(const struct session *session, struct neph_image *frame,
                                       struct neph_diag *diag)
{
    struct neph_image *image = NULL;
    enum neph_status status = read_pass(session, "radiance", &image, diag);
    if (!status)
        status = neph_cycles_surface_layers(image, frame, diag);
    neph_image_destroy(image);
    return status;
}

static enum neph_status transmittance_layer(const struct session *session, struct neph_image *frame,
                                            struct neph_diag *diag)
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
                status = not_finite("transmittance", i, frame->width_px, diag);
        }
    }
    neph_image_destroy(image);
    return status;
}

static enum neph_status depth_layer(const struct session *session, struct neph_image *frame,
                                    struct neph_diag *diag)
{
    static const float sky_units = 1e10f;
    struct neph_image *image = NULL;
    float *layer;
    enum neph_status status = read_pass(session, "depth", &image, diag);
    const float *units = status ? NULL : neph_image_channel(image, "pass.Depth.Z");
    if (!status && !units)
        status = neph_fail(diag, NEPH_ERR_ENGINE, "Blender's image has no depth");
    if (!status)
        status = neph_image_add_channel(frame, "Z", &layer, diag);
    for (size_t i = 0; !status && i < neph_image_pixel_count(frame); i++) {
        if (isnan(units[i]))
            status = not_finite("depth", i, frame->width_px, diag);
        layer[i] = units[i] >= sky_units ? INFINITY : (float)(units[i] * session->world.unit_m);
    }
    neph_image_destroy(image);
    return status;
}

/* Seconds of all pictures of radiance; negative when there is none. */
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
static enum neph_status read_timing(const struct session *session, double *render_s,
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
        status = neph_fail(diag, NEPH_ERR_ENGINE, "'%s' does not tell the render time", path);
    if (!status)
        *render_s = fmax(0.0, seconds);
    json_decref(timing);
    free(text);
    free(path);
    return status;
}

/* The shortest feature of the scene; +inf when all media are homogeneous. */
static double shortest_feature_m(const struct session *session)
{
    double shortest_m = INFINITY;
    for (int i = 0; i < session->shot.scene->medium_count; i++)
        if (session->world.used[i])
            shortest_m = fmin(shortest_m, session->world.feature_m[i]);
    return shortest_m;
}

static enum neph_status add_attributes(const struct session *session, struct neph_image *frame,
                                       struct neph_diag *diag)
{
    const double step_m = session->quality.step * shortest_feature_m(session);
    enum neph_status status = neph_image_set_attribute(frame, "neph.cycles.samples", diag, "%d",
                                                       session->quality.samples);
    if (!status)
        status = neph_image_set_attribute(frame, "neph.cycles.filter", diag,
                                          "Blackman-Harris 0.01 px: pixel centre, but for 0.13 %% "
                                          "of the samples (up to 0.48 px off); transmittance and "
                                          "Z: exactly the centre");
    if (!status && isfinite(step_m))
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

static enum neph_status make_frame(const struct session *session, struct neph_image **frame,
                                   struct neph_diag *diag)
{
    const struct neph_shot *shot = &session->shot;
    struct neph_image *made = NULL;
    enum neph_status status = neph_image_create(shot->width_px, shot->height_px, &made, diag);
    if (!status && (shot->layers & NEPH_LAYER_RADIANCE))
        status = radiance_layers(session, made, diag);
    if (!status && (shot->layers & NEPH_LAYER_RADIANCE) && session->quality.surface_layers)
        status = surface_layers(session, made, diag);
    if (!status && (shot->layers & NEPH_LAYER_TRANSMITTANCE))
        status = transmittance_layer(session, made, diag);
    if (!status && (shot->layers & NEPH_LAYER_DEPTH))
        status = depth_layer(session, made, diag);
    if (!status)
        status = add_attributes(session, made, diag);
    if (status) {
        neph_image_destroy(made);
        return status;
    }
    *frame = made;
    return NEPH_OK;
}

static enum neph_status render(const struct neph_shot *shot, struct neph_image **frame,
                               struct neph_cost *cost, struct neph_diag *diag)
{
    const double start_s = neph_wall_s();
    struct session session;
    struct neph_child_result result = {0};
    struct neph_image *made = NULL;
    double render_s = 0.0;
    enum neph_status status = open_session(shot, shot->scratch_directory, &session, diag);
    if (!status)
        status = write_inputs(&session, diag);
    if (!status)
        status = run_script(&session, NULL, &result, diag);
    if (!status)
        status = read_timing(&session, &render_s, diag);
    if (!status)
        status = make_frame(&session, &made, diag);
    neph_baked_scene_finish(&session.baked);
    if (status)
        return status;
    *frame = made;
    *cost = (struct neph_cost){
        .render_s = render_s,
        .wall_s = neph_wall_s() - start_s,
        .cpu_s = result.cpu_s,
        .peak_memory_bytes = result.peak_memory_bytes,
    };
    return NEPH_OK;
}

/* ---- export ---------------------------------------------------------------------------------- */

/* scene.blend is a convenience: without Blender, the other files are still complete. */
static enum neph_status save_blend(const struct session *session, struct neph_diag *diag)
{
    struct neph_child_result result;
    if (!neph_child_program_exists("blender"))
        return NEPH_OK;
    return run_script(session, "scene.blend", &result, diag);
}

static enum neph_status export_scene(const struct neph_shot *shot, const char *directory,
                                     char *command, size_t command_size, struct neph_diag *diag)
{
    struct session session;
    enum neph_status status = open_session(shot, directory, &session, diag);
    if (!status)
        status = write_inputs(&session, diag);
    if (!status)
        status = save_blend(&session, diag);
    if (!status)
        snprintf(command, command_size,
                 "blender -b --factory-startup -noaudio --python-exit-code 7 --python %s -- "
                 "spec.json",
                 script_name);
    neph_baked_scene_finish(&session.baked);
    return status;
}

const struct neph_engine neph_engine_cycles = {
    .name = "cycles",
    .summary = "Blender 3.4 Cycles, all orders of scattering",
    .rung = NEPH_RUNG_WITNESS,
    .typical_s = 25.0,
    .bias =
        "exact in homogeneous media; ray-march step bias in uneven ones (step 0.1: 0.1 % of single "
        "scattering, more where little sun arrives; 3e-4 of transmittance); what it has no formula "
        "for is baked to voxels; throughput below "
        "1e-6 is cut to 0 (optical depth > 13.8); air thinner than 1e-6 of the densest does not "
        "scatter; paths end at 1024 bounces, Blender's own limit: -2 % at an optical depth of 64 "
        "without absorption, -3 % in a white furnace of optical depth 100",
    .options = options,
    .version = 2,
    .stochastic = true,
    .step = {.option = "step", .coarsest = 0.4, .refine = 0.5, .level_count = 3, .order = 2},
    .probe = probe,
    .can_render = can_render,
    .render = render,
    .export_scene = export_scene,
};
