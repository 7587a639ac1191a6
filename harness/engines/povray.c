/* SPDX-License-Identifier: MIT
 *
 * Engine `povray`: POV-Ray 3.7 as an external renderer for single scattering, and for light between
 * solids by radiosity. Light is additive, so a frame is the sum of monochrome images that POV-Ray
 * renders one after the other:
 *
 *   volume = sum over the scene's phase functions of the light scattered by their media
 *            + light emitted by media
 *   radiance = volume + surface (lit solids and background behind absorbing media)
 *
 * Transmittance and depth are separate images. povray_light.c chooses the images, povray_scene.c
 * writes them as text, povray_run.c renders them, povray_exposure.c reads numbers from them.
 */
#include "harness/engines/engines.h"

#include "base/clock.h"
#include "base/files.h"
#include "base/threads.h"
#include "harness/engines/baked_scene.h"
#include "harness/engines/bakes.h"
#include "harness/engines/frame_check.h"
#include "harness/engines/povray_lamps.h"
#include "harness/engines/povray_light.h"
#include "harness/engines/povray_mesh.h"
#include "harness/engines/povray_run.h"
#include "harness/engines/povray_solids.h"
#include "harness/engines/trial.h"
#include "scenes/display.h"
#include "scenes/media.h"
#include "scenes/solids.h"
#include "scenes/surfaces.h"
#include "scenes/volume_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_PATTERN_COUNT == 2, "a new kind");
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");
_Static_assert(NEPH_SOLID_KIND_COUNT == 3, "a new kind");

#define THREADS_MAX 64

static const struct neph_option options[] = {
    {.name = "intervals",
     .kind = NEPH_OPTION_INTEGER,
     .default_value = 50,
     .minimum = 1,
     .maximum = NEPH_POVRAY_INTERVALS_MAX,
     .help = "samples of each ray and of each of its shadow rays (midpoint rule)"},
    NEPH_OPTION_BAKE_RESOLUTION,
    {.name = "radiosity_rays",
     .kind = NEPH_OPTION_INTEGER,
     .default_value = 400,
     .minimum = 0,
     .maximum = NEPH_POVRAY_RAYS_MAX,
     .help = "light between solids: rays from each place that shares its light with those around; "
             "0: scenes with such light are refused"},
    {.name = "radiosity_error",
     .kind = NEPH_OPTION_REAL,
     .default_value = 0.25,
     .minimum = 0.01,
     .maximum = 10.0,
     .help = "POV-Ray's measure of how different the light may be that places share"},
    {.name = "photons",
     .kind = NEPH_OPTION_INTEGER,
     .default_value = 1000000,
     .minimum = 1000,
     .maximum = 10000000,
     .help = "photons of sunlight that mirrors reflect onto other solids; their light is blurred"},
    {.name = NULL},
};

/* Transmittance: 1e-4 of the value, down to a transmittance of 1e-8. */
static const struct neph_povray_target transmittance_target = {.relative = 1e-4, .absolute = 1e-12};

static const char trial_prefix[] = "neph-povray-";
static const double trial_limit_s = 60.0; /* each process takes 0.6 s */

/* ---- supported scenes ----------------------------------------------------------------------- */

static bool is_lit(struct neph_rgb colour)
{
    return colour.r > 0.0 || colour.g > 0.0 || colour.b > 0.0;
}

/* Whether the scene has a medium or solid that scatters light. */
static bool has_scatterer(const struct neph_scene *scene)
{
    for (int i = 0; i < scene->medium_count; i++) {
        if (is_lit(scene->media[i].albedo))
            return true;
    }
    for (int i = 0; i < scene->solid_count; i++) {
        const struct neph_solid *solid = &scene->solids[i];
        if (is_lit(solid->albedo) ||
            (neph_is_textured(&solid->surface) && is_lit(solid->surface.texture.other)))
            return true;
    }
    return false;
}

/* Why POV-Ray does not support the media, as text; NULL: it does. */
static const char *medium_obstacle(const struct neph_scene *scene)
{
    for (int i = 0; i < scene->medium_count; i++)
        if (!neph_povray_has_phase(scene->media[i].phase.kind))
            return "a phase function that POV-Ray does not have";
    return neph_scene_is_endless(scene) ? neph_endless_reason : NULL;
}

/* Why POV-Ray does not support the solids, as text; NULL: it does. */
static const char *solid_obstacle(const struct neph_scene *scene)
{
    int mirrors = 0;
    for (int i = 0; i < scene->solid_count; i++) {
        const struct neph_surface *surface = &scene->solids[i].surface;
        if (surface->metalness == 0.0)
            continue;
        if (scene->scattering != NEPH_SCATTERING_MULTIPLE)
            return "solids of metal where light is scattered once";
        if (surface->roughness > 0.0)
            return "rough metal on solids: its highlights follow another law in POV-Ray";
        if (neph_is_textured(surface))
            return "a pattern on a mirror";
        if (scene->light_count > 0)
            return "point lights with a mirror: their reflected light in POV-Ray was not tested";
        if (scene->sun.present && (scene->solids[i].kind != NEPH_SOLID_BOX || ++mirrors > 1))
            return "the sun in a mirrored ball, or in several mirrors";
    }
    return NULL;
}

/* Whether the scene needs radiosity: multiple scattering between solids, without media. */
static bool wants_radiosity(const struct neph_scene *scene)
{
    return scene->scattering == NEPH_SCATTERING_MULTIPLE && scene->medium_count == 0;
}

static bool can_render(const struct neph_scene *scene, const struct neph_settings *settings,
                       char *reason, size_t reason_size)
{
    const bool has_rays = neph_setting(&neph_engine_povray, settings, "radiosity_rays") > 0.0;
    const bool has_light_between = wants_radiosity(scene) && has_rays;
    const char *cannot = solid_obstacle(scene);
    struct neph_diag diag = {0};
    struct neph_povray_world world;
    if (!cannot)
        cannot = medium_obstacle(scene);
    if (cannot)
        ;
    else if (scene->scattering == NEPH_SCATTERING_MULTIPLE && has_scatterer(scene) &&
             !has_light_between)
        cannot = wants_radiosity(scene) ? "light between solids without radiosity_rays"
                                        : "multiple scattering";
    else if (scene->environment_light && has_scatterer(scene) && !has_light_between)
        cannot = "environment light on media or solids";
    else if (neph_povray_world(scene, 0, 1, 1, 1, &world, &diag))
        cannot = diag.message;
    if (cannot && reason_size > 0)
        snprintf(reason, reason_size, "%s", cannot);
    return !cannot;
}

/* One thread for radiosity: the order in which POV-Ray finds sample points decides the result. */
static int thread_count(const struct neph_scene *scene)
{
    int count = neph_processor_count();
    if (wants_radiosity(scene))
        return 1;
    return count < THREADS_MAX ? count : THREADS_MAX;
}

/* ---- layers of the frame -------------------------------------------------------------------- */

static enum neph_status radiance_layers(struct neph_povray_session *session,
                                        struct neph_image *frame, struct neph_diag *diag)
{
    float *all[3], *scattered[3];
    struct neph_povray_light volume = {.planes = {NULL}}, surface = {.planes = {NULL}};
    enum neph_status status = neph_povray_light_make(session->pixel_count, &volume, diag);
    if (!status)
        status = neph_povray_light_make(session->pixel_count, &surface, diag);
    if (!status)
        status = neph_image_add_rgb(frame, NULL, all, diag);
    if (!status)
        status = neph_image_add_rgb(frame, "volume", scattered, diag);
    if (!status)
        status = neph_povray_add_volume(session, &volume, diag);
    if (!status)
        status = neph_povray_add_emission(session, &volume, diag);
    if (!status)
        status = neph_povray_add_surface(session, &surface, diag);
    for (int channel = 0; !status && channel < 3; channel++) {
        for (size_t i = 0; i < session->pixel_count; i++) {
            double from_media = volume.planes[channel][i];
            scattered[channel][i] = (float)from_media;
            all[channel][i] = (float)(from_media + surface.planes[channel][i]);
        }
    }
    neph_povray_light_free(&volume);
    neph_povray_light_free(&surface);
    return status;
}

static bool has_media(const struct neph_povray_session *session)
{
    for (int i = 0; i < session->shot.scene->medium_count; i++) {
        if (session->world.containers[i].used)
            return true;
    }
    return false;
}

static void store_transmittance(const struct neph_povray_reading *readings, size_t count,
                                float *layer)
{
    for (size_t i = 0; i < count; i++)
        layer[i] = readings ? (float)fmin(readings[i].value, 1.0) : 1.0f;
}

/* Transmittance: a colour with the same extinction as an earlier colour is not rendered again. */
static enum neph_status transmittance_layer(struct neph_povray_session *session,
                                            struct neph_image *frame, struct neph_diag *diag)
{
    static const char *const names[3] = {"transmittance-r", "transmittance-g", "transmittance-b"};
    float *layer[3];
    struct neph_povray_pass pass = {.kind = NEPH_POVRAY_TRANSMITTANCE};
    enum neph_status status = neph_image_add_rgb(frame, "transmittance", layer, diag);
    for (int channel = 0; !status && channel < 3; channel++) {
        double wall_s = 0.0;
        struct neph_povray_reading *readings = NULL;
        if (channel > 0 && neph_povray_same_extinction(session->shot.scene, channel - 1, channel)) {
            memcpy(layer[channel], layer[channel - 1], session->pixel_count * sizeof(float));
            continue;
        }
        pass.channel = channel;
        if (has_media(session))
            status = neph_povray_expose(session, names[channel], pass, 1.0, &transmittance_target,
                                        &readings, &wall_s, diag);
        if (!status)
            store_transmittance(readings, session->pixel_count, layer[channel]);
        free(readings);
    }
    return status;
}

static enum neph_status depth_layer(struct neph_povray_session *session, struct neph_image *frame,
                                    struct neph_diag *diag)
{
    float *layer = NULL;
    double wall_s = 0.0;
    uint16_t *codes = NULL;
    struct neph_povray_pass pass = {.kind = NEPH_POVRAY_DEPTH};
    double range_m = session->world.depth_range_m;
    enum neph_status status = neph_image_add_channel(frame, "Z", &layer, diag);
    if (!status && range_m > 0.0)
        status = neph_povray_image(session, "depth", &pass, &codes, &wall_s, diag);
    for (size_t i = 0; !status && i < session->pixel_count; i++) {
        double depth_m = INFINITY;
        bool solid = codes && neph_povray_read_depth(codes + 3 * i, range_m, &depth_m);
        layer[i] = solid ? (float)depth_m : INFINITY;
    }
    free(codes);
    return status;
}

static enum neph_status add_attributes(const struct neph_povray_session *session,
                                       struct neph_image *frame, struct neph_diag *diag)
{
    const int *renders = session->renders;
    enum neph_status status = neph_image_set_attribute(frame, "neph.povray.intervals", diag, "%d",
                                                       session->world.intervals);
    if (!status)
        status = neph_image_set_attribute(
            frame, "neph.povray.passes", diag, "volume %d, surface %d, transmittance %d, depth %d",
            renders[NEPH_POVRAY_VOLUME], renders[NEPH_POVRAY_SURFACE],
            renders[NEPH_POVRAY_TRANSMITTANCE], renders[NEPH_POVRAY_DEPTH]);
    if (!status && renders[NEPH_POVRAY_EMISSION] > 0)
        status = neph_image_set_attribute(frame, "neph.povray.emission_passes", diag, "%d",
                                          renders[NEPH_POVRAY_EMISSION]);
    if (!status)
        status = neph_image_set_attribute(frame, "neph.povray.cut_error", diag, "%.3g",
                                          session->world.cut_error);
    if (!status)
        status = neph_image_set_attribute(frame, "neph.povray.shift_optical_depth", diag, "%.3g",
                                          session->world.shift_error);
    if (!status)
        status = neph_image_set_attribute(
            frame, "neph.povray.render_s", diag,
            "wall time of the last volume and surface processes, start-up of about 0.6 s included");
    if (!status)
        status = neph_bakes_label(session->baked.bakes, session->baked.bake_count, frame, diag);
    return status;
}

/* ---- one frame ------------------------------------------------------------------------------- */

static enum neph_status write_noise(const struct neph_solid *solid, const char *directory,
                                    struct neph_diag *diag)
{
    char name[NEPH_POVRAY_FILE_NAME_MAX];
    struct neph_grid *grid = NULL;
    neph_povray_noise_name(solid->surface.texture.seed, name);
    char *path = neph_path_join(directory, name);
    enum neph_status status = path ? neph_povray_noise(solid->surface.texture.seed, &grid, diag)
                                   : neph_fail_memory(diag);
    if (!status)
        status = neph_volume_write_df3(path, grid, diag);
    neph_grid_destroy(grid);
    free(path);
    return status;
}

static enum neph_status write_noises(const struct neph_scene *scene, const char *directory,
                                     struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < scene->solid_count && !status; i++)
        if (neph_is_textured(&scene->solids[i].surface) &&
            scene->solids[i].surface.texture.pattern == NEPH_PATTERN_NOISE)
            status = write_noise(&scene->solids[i], directory, diag);
    return status;
}

static enum neph_status write_grids(const struct neph_povray_session *session,
                                    const char *directory, struct neph_diag *diag)
{
    const struct neph_scene *scene = session->shot.scene;
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < scene->medium_count && !status; i++) {
        if (!session->world.containers[i].used || !scene->media[i].grid)
            continue;
        const struct neph_grid scaled = neph_povray_grid(scene->media[i].grid);
        char name[NEPH_POVRAY_FILE_NAME_MAX];
        neph_povray_grid_name(i, name);
        char *path = neph_path_join(directory, name);
        status = path ? neph_volume_write_df3(path, &scaled, diag) : neph_fail_memory(diag);
        free(path);
    }
    return status;
}

static enum neph_status adapt_scene(const struct neph_shot *shot,
                                    struct neph_povray_session *session, struct neph_diag *diag)
{
    const int intervals = (int)neph_setting(&neph_engine_povray, &shot->settings, "intervals");
    const int resolution = (int)neph_setting(&neph_engine_povray, &shot->settings,
                                             "bake_resolution");
    struct neph_diag why = {0};
    enum neph_status status = neph_baked_scene_make(shot->scene, resolution, &session->baked, &why);
    session->shot.scene = &session->baked.scene;
    if (!status)
        status = neph_povray_world(session->shot.scene, shot->frame, shot->width_px,
                                   shot->height_px, intervals, &session->world, &why);
    if (!status)
        status = neph_povray_cut_rays(&session->world, &why);
    session->world.cut_error += session->baked.cut_error;
    if (!status && wants_radiosity(session->shot.scene))
        session->world.radiosity = (struct neph_povray_radiosity){
            (int)neph_setting(&neph_engine_povray, &shot->settings, "radiosity_rays"),
            neph_setting(&neph_engine_povray, &shot->settings, "radiosity_error"),
            (int)neph_setting(&neph_engine_povray, &shot->settings, "photons")};
    return neph_external_fail_scene("POV-Ray", status, &why, diag);
}

/* Prepare a session; grids and the ini file are written to `directory`. The caller always finishes
 * session->baked. */
static enum neph_status start(const struct neph_shot *shot, const char *program,
                              const char *directory, struct neph_povray_session *session,
                              struct neph_diag *diag)
{
    *session = (struct neph_povray_session){
        .shot = *shot, .program = program, .threads = thread_count(shot->scene)};
    session->pixel_count = (size_t)shot->width_px * (size_t)shot->height_px;
    char reason[256] = "";
    if (!can_render(shot->scene, &shot->settings, reason, sizeof(reason)))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "POV-Ray cannot: %s", reason);
    enum neph_status status = adapt_scene(shot, session, diag);
    if (!status)
        status = neph_povray_write_ini(directory, diag);
    if (!status)
        status = write_noises(session->shot.scene, directory, diag);
    if (!status)
        status = neph_povray_put_meshes(&session->world, directory, diag);
    return status ? status : write_grids(session, directory, diag);
}

static enum neph_status make_layers(struct neph_povray_session *session, struct neph_image *image,
                                    struct neph_diag *diag)
{
    const unsigned layers = session->shot.layers;
    enum neph_status status = NEPH_OK;
    if (layers & NEPH_LAYER_RADIANCE)
        status = radiance_layers(session, image, diag);
    if (!status && (layers & NEPH_LAYER_TRANSMITTANCE))
        status = transmittance_layer(session, image, diag);
    if (!status && (layers & NEPH_LAYER_DEPTH))
        status = depth_layer(session, image, diag);
    return status ? status : add_attributes(session, image, diag);
}

static enum neph_status render_with(const struct neph_shot *shot, const char *program,
                                    bool is_trial, struct neph_image **frame,
                                    struct neph_cost *cost, struct neph_diag *diag)
{
    double start_s = neph_wall_s();
    struct neph_povray_session session;
    struct neph_image *image = NULL;
    enum neph_status status = start(shot, program, shot->scratch_directory, &session, diag);
    if (!status)
        status = neph_image_create(shot->width_px, shot->height_px, &image, diag);
    if (!status)
        status = make_layers(&session, image, diag);
    if (!status && !is_trial)
        status = neph_frame_check(session.shot.scene, shot->frame, "POV-Ray", image, diag);
    neph_baked_scene_finish(&session.baked);
    if (status) {
        neph_image_destroy(image);
        return status;
    }
    session.cost.wall_s = neph_wall_s() - start_s;
    *cost = session.cost;
    *frame = image;
    return NEPH_OK;
}

/* ---- features of this POV-Ray ---------------------------------------------------------------- */

static enum neph_status try_scene(const struct neph_trial *trial, const char *program,
                                  const char *folder, bool *has_voxels, struct neph_diag *diag)
{
    const struct neph_shot shot = {.scene = &trial->scene,
                                   .settings = neph_settings_default(&neph_engine_povray),
                                   .width_px = NEPH_TRIAL_WIDTH_PX,
                                   .height_px = NEPH_TRIAL_HEIGHT_PX,
                                   .layers = NEPH_LAYERS_ALL,
                                   .scratch_directory = folder,
                                   .time_limit_s = trial_limit_s};
    struct neph_image *image = NULL;
    struct neph_cost cost;
    enum neph_status status = render_with(&shot, program, true, &image, &cost, diag);
    if (!status)
        status = neph_trial_judge(trial, image, has_voxels, diag);
    neph_image_destroy(image);
    return status;
}

static enum neph_status try_program(const char *program, bool *has_voxels, struct neph_diag *diag)
{
    struct neph_scratch *folder = NULL;
    struct neph_trial trial;
    enum neph_status status = neph_trial_open(true, &trial, diag);
    if (!status)
        status = neph_program_make_folder(trial_prefix, &folder, diag);
    if (!status)
        status = try_scene(&trial, program, neph_scratch_path(folder), has_voxels, diag);
    if (status && folder)
        neph_move_paths(diag, neph_scratch_path(folder), NULL);
    neph_scratch_destroy(folder);
    neph_trial_close(&trial);
    return status;
}

/* Find by a trial, once, whether POV-Ray renders media from df3 files. Errors as of
 * neph_cycles_features(). */
static enum neph_status find_voxels(bool *has_voxels, struct neph_diag *diag)
{
    char missing[512] = "";
    char *program = neph_external_find(&neph_povray, 0, missing, sizeof(missing));
    if (!program)
        return neph_fail(diag, NEPH_ERR_UNAVAILABLE, "%s", missing);
    char *file = neph_trial_file(program, NULL);
    json_t *kept = neph_trial_load_result(file);
    const bool is_kept = json_is_boolean(json_object_get(kept, "has_voxels"));
    enum neph_status status = NEPH_OK;
    if (is_kept)
        *has_voxels = json_is_true(json_object_get(kept, "has_voxels"));
    else
        status = try_program(program, has_voxels, diag);
    if (!status && !is_kept)
        neph_trial_save_result(
            file, json_pack("{s:s, s:b}", "program", program, "has_voxels", *has_voxels));
    json_decref(kept);
    free(file);
    free(program);
    return status;
}

static void probe(const struct neph_engine *engine, struct neph_shared_device *device,
                  struct neph_engine_info *info)
{
    (void)engine, (void)device;
    bool has_voxels = false;
    struct neph_diag diag = {0};
    neph_external_probe(&neph_povray, 0, info);
    if (!info->available)
        return;
    info->available = find_voxels(&has_voxels, &diag) == NEPH_OK;
    info->broken = !info->available;
    if (info->available)
        snprintf(info->can, sizeof(info->can), "%s",
                 has_voxels ? "voxels" : "no voxels: it reads no df3 files");
    else
        snprintf(info->missing, sizeof(info->missing), "%.60s: %.440s", info->version,
                 diag.message);
}

static bool lacks(const struct neph_engine *engine, const struct neph_scene *scene,
                  const struct neph_settings *settings, char *reason, size_t reason_size)
{
    (void)engine, (void)settings;
    bool has_voxels = true;
    const bool is_lacking = neph_scene_needs_voxels(scene) &&
                            find_voxels(&has_voxels, NULL) == NEPH_OK && !has_voxels;
    if (is_lacking && reason_size > 0)
        snprintf(reason, reason_size, "voxels: this POV-Ray reads no df3 files");
    return is_lacking;
}

/* ---- the engine ------------------------------------------------------------------------------ */

static enum neph_status render(const struct neph_shot *shot, struct neph_image **frame,
                               struct neph_cost *cost, struct neph_diag *diag)
{
    char missing[512] = "";
    char *program = neph_external_find(&neph_povray, 0, missing, sizeof(missing));
    enum neph_status status = program ? NEPH_OK
                                      : neph_external_fail_missing(&neph_povray, missing, diag);
    if (!status)
        status = render_with(shot, program, false, frame, cost, diag);
    free(program);
    return status;
}

static enum neph_status export_scene(const struct neph_shot *shot, const char *directory,
                                     char *command, size_t command_size, struct neph_diag *diag)
{
    struct neph_povray_session session;
    struct neph_povray_pass beauty = {.kind = NEPH_POVRAY_BEAUTY,
                                      .gain = exp2(neph_scene_display(shot->scene)->exposure_ev)};
    char *path = neph_path_join(directory, "scene.pov");
    enum neph_status status = start(shot, NULL, directory, &session, diag);
    if (!status)
        status = path ? neph_povray_write(&session, &beauty, path, diag) : neph_fail_memory(diag);
    free(path);
    neph_baked_scene_finish(&session.baked);
    if (!status)
        snprintf(command, command_size,
                 "POVINI=povray.ini povray +Iscene.pov +Oscene.png +FN16 Dither=off +W%d +H%d -A "
                 "-D -P -GA +WT%d "
                 "+BS8",
                 shot->width_px, shot->height_px, session.threads);
    return status;
}

const struct neph_engine neph_engine_povray = {
    .name = "povray",
    .summary = "POV-Ray 3.7 media, single scattering; between solids all of it, by radiosity",
    .rung = NEPH_LEVEL_EXTERNAL,
    .typical_s = 12.0,
    .bias = "single scattering only; midpoint rule of its intervals, error ~ 1/intervals^2 (~ "
            "1/intervals at the edges of shadows); 16-bit output in brackets: 1e-4 of the value or "
            "1e-6 of the brightest, transmittance to 1e-8; media without a formula in POV-Ray are "
            "baked to voxels; radiosity interpolates between sample points: error 0.01 to 1 %, "
            "docs/screen.md",
    .options = options,
    .version = 4,
    /* POV-Ray aborts above 256 intervals. */
    .step = {.option = "intervals", .coarsest = 25, .refine = 2, .level_count = 4, .order = 2},
    .probe = probe,
    .can_render = can_render,
    .lacks = lacks,
    .render = render,
    .export_scene = export_scene,
};
