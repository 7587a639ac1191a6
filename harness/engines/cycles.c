/* SPDX-License-Identifier: MIT
 *
 * Engine `cycles`: Blender's path tracer as an external renderer for all orders of scattering; one
 * engine for each Blender (blender.h). Frames: cycles_frame.c; features of a Blender:
 * cycles_probe.c.
 */
#include "harness/engines/engines.h"

#include "base/clock.h"
#include "base/files.h"
#include "base/threads.h"
#include "harness/engines/bakes.h"
#include "harness/engines/blender.h"
#include "harness/engines/cycles_frame.h"
#include "harness/engines/cycles_phase.h"
#include "harness/engines/cycles_probe.h"
#include "harness/engines/frame_check.h"
#include "scenes/media.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const switches[] = {"off", "on", NULL};

/* Choices of option volume_biased. */
enum { BLENDERS_OWN, UNBIASED, BIASED };
static const char *const biases[] = {
    [BLENDERS_OWN] = "default", [UNBIASED] = "off", [BIASED] = "on", NULL};

/* The defaults come from measurements of height fogs with vertical optical depth 0.07 to 10, views
 * up and down.
 * - `step` 0.1 (scale heights): single scattering is within 0.1 % row by row, and within 0.03 %
 *   over the image where more than e^-4 of the sun arrives. The error grows as (step * optical
 *   depth towards the sun)^2 / 24; 0.2 costs half of the time.
 * - Transmittance of a pixel: the error of the jittered steps is proportional to their length, at
 *   most 2.3e-4 at 1/640 scale height. */
static const struct neph_option options[] = {
    {.name = "samples",
     .kind = NEPH_OPTION_INTEGER,
     .default_value = 64,
     .minimum = 1,
     .maximum = 8192, /* above, Cycles' single-precision sums lose light: -0.15 % at 1e5 */
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
     .help = "layer ao of surfaces: farther solids do not occlude [m]; 0: no limit"},
    {.name = "volume_biased",
     .kind = NEPH_OPTION_CHOICE,
     .choices = biases,
     .help = "on: volumes are rendered with steps; off: without steps and bias, from Blender 5.0 "
             "on; default: off if available"},
    {.name = NULL},
};

/* ---- probing --------------------------------------------------------------------------------- */

static int volume_biased(const struct neph_settings *settings)
{
    return (int)neph_setting(&neph_engine_cycles, settings, "volume_biased");
}

static void describe(const struct neph_cycles_features *features, struct neph_engine_info *info)
{
    info->is_unstepped = features->has_unbiased;
    snprintf(info->can, sizeof(info->can), "%s; volumes %s; %s",
             features->has_voxels ? "voxels" : "no voxels: it was built without them",
             features->has_unbiased ? "without bias, or in steps" : "in steps",
             features->has_phases ? "Henyey-Greenstein, two of them, Rayleigh, Draine and "
                                    "Jendersie-d'Eon"
                                  : "Henyey-Greenstein only");
}

static void probe(const struct neph_engine *engine, struct neph_shared_device *device,
                  struct neph_engine_info *info)
{
    (void)device;
    struct neph_cycles_features features;
    struct neph_diag diag = {0};
    neph_external_probe(&neph_blender, engine->program, info);
    if (!info->available)
        return;
    const enum neph_status status = neph_cycles_features(engine->program, &features, &diag);
    info->available = status == NEPH_OK;
    info->broken = !info->available;
    if (info->available)
        describe(&features, info);
    else
        snprintf(info->missing, sizeof(info->missing), "%.60s: %.440s", info->version,
                 diag.message);
}

static bool can_render(const struct neph_scene *scene, const struct neph_settings *settings,
                       char *reason, size_t reason_size)
{
    (void)settings;
    struct neph_diag diag = {0};
    struct neph_cycles_world world;
    const char *cannot = neph_scene_is_endless(scene) ? neph_endless_reason : NULL;
    if (!cannot && neph_cycles_world(scene, &world, &diag))
        cannot = diag.message;
    if (cannot && reason_size > 0)
        snprintf(reason, reason_size, "%s", cannot);
    return !cannot;
}

static bool has_spot(const struct neph_scene *scene)
{
    bool has = false;
    for (int i = 0; i < scene->light_count; i++)
        has |= scene->lights[i].is_spot;
    return has;
}

/* The first feature that the shot needs and this Blender lacks; NULL: it has all. */
static const char *find_lack(const struct neph_cycles_features *features,
                             const struct neph_scene *scene, const struct neph_settings *settings)
{
    if (neph_cycles_needs_phases(scene) && !features->has_phases)
        return "phase functions other than one Henyey-Greenstein, which Blender has from 4.3 on; "
               "one from blender.org has them, NEPH_BLENDER names it";
    if (neph_scene_needs_voxels(scene) && !features->has_voxels)
        return "voxels: this Blender was built without them (NanoVDB); one from blender.org has "
               "them, NEPH_BLENDER names it";
    if (has_spot(scene) && !features->has_spots)
        return "spots: their law changed between Blender 3.4 and 4.3, and was not measured in "
               "versions between them";
    if (volume_biased(settings) == UNBIASED && !features->has_unbiased)
        return "volume_biased=off: this Blender has volumes in steps only";
    return NULL;
}

static bool lacks(const struct neph_engine *engine, const struct neph_scene *scene,
                  const struct neph_settings *settings, char *reason, size_t reason_size)
{
    const bool needs_features = neph_cycles_needs_phases(scene) || neph_scene_needs_voxels(scene) ||
                                volume_biased(settings) == UNBIASED;
    struct neph_cycles_features features = {
        .has_voxels = true}; /* assumed for a Blender that is missing */
    if (needs_features && neph_cycles_features(engine->program, &features, NULL))
        features = (struct neph_cycles_features){.has_voxels = true};
    const char *lack = needs_features ? find_lack(&features, scene, settings) : NULL;
    if (lack && reason_size > 0)
        snprintf(reason, reason_size, "%s", lack);
    return lack != NULL;
}

static bool takes_steps(const struct neph_engine_info *info, const struct neph_settings *settings)
{
    return !info->is_unstepped || volume_biased(settings) == BIASED;
}

/* ---- one frame ------------------------------------------------------------------------------- */

static struct neph_cycles_quality choose_render_quality(const struct neph_shot *shot,
                                                        bool is_unbiased)
{
    const struct neph_settings *settings = &shot->settings;
    const int threads = (int)neph_setting(&neph_engine_cycles, settings, "threads");
    return (struct neph_cycles_quality){
        .samples = (int)neph_setting(&neph_engine_cycles, settings, "samples"),
        .step = neph_setting(&neph_engine_cycles, settings, "step"),
        .threads = threads > 0 ? threads : neph_processor_count(),
        .is_unbiased = is_unbiased,
        .surface_layers = neph_setting(&neph_engine_cycles, settings, "surface_layers") != 0.0,
        .ao_distance_m = neph_setting(&neph_engine_cycles, settings, "ao_distance_m"),
    };
}

static int shot_program_index(const struct neph_shot *shot)
{
    return shot->engine ? shot->engine->program : 0;
}

static enum neph_status render_with(const struct neph_shot *shot, const char *program,
                                    const struct neph_cycles_features *features,
                                    struct neph_image **frame, struct neph_cost *cost,
                                    struct neph_diag *diag)
{
    const bool is_unbiased = features->has_unbiased && volume_biased(&shot->settings) != BIASED;
    const struct neph_cycles_quality quality = choose_render_quality(shot, is_unbiased);
    struct neph_cycles_session session;
    struct neph_child_result result = {0};
    struct neph_image *made = NULL;
    double render_s = 0.0;
    enum neph_status status = neph_cycles_open(shot, &quality, program, shot->scratch_directory,
                                               &session, diag);
    if (!status)
        status = neph_cycles_write(&session, diag);
    if (!status)
        status = neph_cycles_run(&session, NULL, &result, diag);
    if (!status)
        status = neph_cycles_frame(&session, &made, &render_s, diag);
    if (!status)
        status = neph_frame_check(session.shot.scene, shot->frame, "Blender", made, diag);
    neph_cycles_close(&session);
    if (status) {
        neph_image_destroy(made);
        return status;
    }
    *frame = made;
    *cost = (struct neph_cost){
        .render_s = render_s, .cpu_s = result.cpu_s, .peak_memory_bytes = result.peak_memory_bytes};
    return NEPH_OK;
}

static enum neph_status render(const struct neph_shot *shot, struct neph_image **frame,
                               struct neph_cost *cost, struct neph_diag *diag)
{
    const double start_s = neph_wall_s();
    char missing[512] = "";
    struct neph_cycles_features features;
    char *program = neph_external_find(&neph_blender, shot_program_index(shot), missing,
                                       sizeof(missing));
    enum neph_status status = program ? NEPH_OK
                                      : neph_external_fail_missing(&neph_blender, missing, diag);
    if (!status)
        status = neph_cycles_features(shot_program_index(shot), &features, diag);
    const char *lack = status ? NULL : find_lack(&features, shot->scene, &shot->settings);
    if (lack)
        status = neph_fail(diag, NEPH_ERR_UNSUPPORTED, "Cycles cannot: %s", lack);
    if (!status)
        status = render_with(shot, program, &features, frame, cost, diag);
    if (!status)
        cost->wall_s = neph_wall_s() - start_s;
    free(program);
    return status;
}

/* ---- export ---------------------------------------------------------------------------------- */

/* Save scene.blend. It is optional: without Blender the other files are still complete. */
static enum neph_status save_blend(const struct neph_cycles_session *session,
                                   struct neph_diag *diag)
{
    struct neph_child_result result;
    return session->program ? neph_cycles_run(session, "scene.blend", &result, diag) : NEPH_OK;
}

static enum neph_status export_scene(const struct neph_shot *shot, const char *directory,
                                     char *command, size_t command_size, struct neph_diag *diag)
{
    char missing[512];
    char *program = neph_external_find(&neph_blender, shot_program_index(shot), missing,
                                       sizeof(missing));
    struct neph_cycles_features features = {.has_voxels = true};
    if (program)
        (void)neph_cycles_features(shot_program_index(shot), &features, NULL);
    const struct neph_cycles_quality quality = choose_render_quality(
        shot, features.has_unbiased && volume_biased(&shot->settings) != BIASED);
    struct neph_cycles_session session;
    enum neph_status status = neph_cycles_open(shot, &quality, program, directory, &session, diag);
    if (!status)
        status = neph_cycles_write(&session, diag);
    if (!status)
        status = save_blend(&session, diag);
    if (!status)
        snprintf(command, command_size,
                 "%s -b --factory-startup -noaudio --python-exit-code 7 --python %s -- spec.json",
                 program ? program : neph_blender.program, NEPH_BLENDER_SCRIPT);
    neph_cycles_close(&session);
    free(program);
    return status;
}

const struct neph_engine neph_engine_cycles = {
    .name = "cycles",
    .summary = "Blender Cycles, all orders of scattering",
    .rung = NEPH_LEVEL_EXTERNAL,
    .typical_s = 25.0,
    .bias =
        "exact in homogeneous media; in uneven ones, where volumes are in steps (before Blender "
        "5.0, or volume_biased=on), ray-march step bias (step 0.1: 0.1 % of single scattering, "
        "more where little sun arrives; 3e-4 of transmittance); where they are not, up to 0.14 / "
        "samples; media without a formula in Cycles are baked to voxels; before 5.0 throughput "
        "below 1e-6 is cut to 0 (optical depth > 13.8); air thinner than 1e-6 of the densest does "
        "not scatter; paths end at 1024 bounces, Blender's own limit: -2 % at an optical depth of "
        "64 without absorption, -3 % in a white furnace of optical depth 100",
    .options = options,
    .version = 2,
    .stochastic = true,
    .step = {.option = "step",
             .coarsest = 0.4,
             .refine = 0.5,
             .level_count = 3,
             .order = 2,
             .is_taken = takes_steps},
    .probe = probe,
    .can_render = can_render,
    .lacks = lacks,
    .render = render,
    .export_scene = export_scene,
};
