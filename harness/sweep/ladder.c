/* SPDX-License-Identifier: MIT */
#include "harness/sweep/ladder.h"

#include "base/files.h"
#include "harness/engines/engines.h"
#include "renderer/gpu_scene.h"
#include "renderer/realtime/options.h"
#include "scenes/media.h"
#include "scenes/motion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_LADDER_MOTION_COUNT == 3, "a new kind");
_Static_assert(NEPH_MEDIUM_KIND_COUNT == 8, "a new kind");
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");

const struct neph_ladder_light neph_ladder_lights[] = {
    {"no scattering", NEPH_SCATTERING_NONE, "march", NULL, false},
    {"scattered once", NEPH_SCATTERING_SINGLE, "march", NULL, false},
    {"octaves", NEPH_SCATTERING_MULTIPLE, "march_octaves", "lighting=octaves", false},
    {"fitted octaves", NEPH_SCATTERING_MULTIPLE, "march_octaves_fitted", "lighting=octaves_fitted",
     false},
    {"traced", NEPH_SCATTERING_MULTIPLE, "march_traced", "lighting=traced", true},
    {.name = NULL},
};

const struct neph_ladder_pipeline neph_ladder_pipelines[] = {
    {"ours", "ours"},
    {"fixed", "fixed"},
    {"march", NULL},
    {.name = NULL},
};

const char *const neph_ladder_narrow[] = {"fog_look", "sky", NULL};

const struct neph_ladder_part neph_ladder_motion_parts[] = {
    {"history follows the wind", "wind=off", NEPH_LADDER_WIND},
    {"cuts of the camera void the history", "cut_reset=off", NEPH_LADDER_CAMERA},
    {"disocclusion voids the history", "reject_depth=0", NEPH_LADDER_CAMERA},
    /* at rims of what stands before a cloud that drifts: 13 % of the flicker of wind_cloud */
    {"motion of the nearest of five depths", "taa_motion=centre", NEPH_LADDER_ANY},
    {.name = NULL},
};

/* ---- what a scene has ------------------------------------------------------------------------ */

/* What is seen of media within the froxels of the camera: optical depths that count. */
static bool sees_near_media(const struct neph_scene *scene, int frame)
{
    const double end_m = neph_rt_options[RT_FROXEL_END_M].default_value, least = 0.01;
    const struct neph_camera camera = neph_scene_camera(scene, frame);
    enum { SIDE = 4 };
    for (int ray = 0; ray < SIDE * SIDE; ray++) {
        const struct neph_pixel_ray through = neph_camera_ray(&camera, SIDE, SIDE, ray % SIDE,
                                                              ray / SIDE);
        const struct neph_rgb depth = neph_scene_optical_depth(scene, through.origin_m,
                                                               through.direction, 0.0, end_m);
        if (fmax(depth.r, fmax(depth.g, depth.b)) > least)
            return true;
    }
    return false;
}

/* In the first picture, the last, or in the middle. */
static bool has_near_media(const struct neph_scene *scene)
{
    const int last = scene->frame_count > 0 ? scene->frame_count - 1 : 0;
    return sees_near_media(scene, 0) || sees_near_media(scene, last / 2) ||
           sees_near_media(scene, last);
}

/* Whether sunlight goes through a cloud on its way to a solid, or to a fog. */
static bool has_cloud_shadows(const struct neph_scene *scene)
{
    struct neph_bounds clouds;
    bool has_fog = false;
    for (int m = 0; m < scene->medium_count; m++)
        has_fog |= neph_medium_is_fog(&scene->media[m]) ||
                   scene->media[m].kind == NEPH_MEDIUM_HOMOGENEOUS;
    return scene->sun.present && neph_shapes_box(scene, &clouds) &&
           (scene->solid_count > 0 || has_fog);
}

const struct neph_ladder_air neph_ladder_air_parts[] = {
    {"near froxels", "froxels=on", has_near_media, "no medium is seen within 64 m of the camera",
     false},
    {"a shadow map of the clouds", "cloud_shadow=map", has_cloud_shadows,
     "no cloud stands between the sun and a solid or a fog", true},
    {.name = NULL},
};

bool neph_ladder_takes(const struct neph_ladder_air *part, const struct neph_scene *scene,
                       const struct neph_ladder_light *light)
{
    const bool is_known = part->for_fitted || !light->settings ||
                          strcmp(light->settings, "lighting=octaves") == 0;
    return light->scattering != NEPH_SCATTERING_NONE && is_known && part->is_needed(scene);
}

static const char all_steps[] = "8 16 32 64";

/* As the plan that comes with neph. */
enum { FRAMES = 48, WARM_UP = 16, TRUTH_SAMPLES = 256, ROUNDS = 3 };

bool neph_ladder_is_still(const struct neph_scene *scene)
{
    for (int frame = 1; frame < scene->frame_count; frame++)
        if (!neph_scene_is_same_moment(scene, 0, frame))
            return false;
    return true;
}

static bool is_same_camera(const struct neph_scene *scene, int frame)
{
    const struct neph_camera first = neph_scene_camera(scene, 0.0),
                             other = neph_scene_camera(scene, frame);
    return memcmp(&first, &other, sizeof(first)) == 0;
}

bool neph_ladder_moves(const struct neph_scene *scene, enum neph_ladder_motion what)
{
    if (what != NEPH_LADDER_CAMERA && scene->wind_key_count > 0)
        return true;
    if (what == NEPH_LADDER_WIND)
        return false;
    for (int frame = 1; frame < scene->frame_count; frame++)
        if (!is_same_camera(scene, frame))
            return true;
    return scene->frame_scale_count > 0 || scene->mover_count > 0;
}

bool neph_ladder_has_closed_form(const struct neph_scene *scene)
{
    for (int m = 0; m < scene->medium_count; m++)
        if (scene->media[m].kind != NEPH_MEDIUM_HOMOGENEOUS &&
            !neph_medium_is_fog(&scene->media[m]))
            return false;
    return true;
}

/* `*text` with one more setting, which is NULL from then on when memory is short. */
static void append(char **text, const char *setting)
{
    char *longer = *text && setting ? neph_format("%s%s%s", *text, (*text)[0] ? " " : "", setting)
                                    : NULL;
    if (setting) {
        free(*text);
        *text = longer;
    }
}

char *neph_ladder_held(const struct neph_scene *scene, const struct neph_ladder_light *light,
                       bool still, bool air)
{
    char *text = strdup("");
    append(&text, light->settings);
    for (const struct neph_ladder_part *part = neph_ladder_motion_parts; still && part->name;
         part++)
        append(&text, neph_ladder_moves(scene, part->needed_by) ? NULL : part->off);
    for (const struct neph_ladder_air *part = neph_ladder_air_parts; air && part->name; part++)
        append(&text, neph_ladder_takes(part, scene, light) ? part->on : NULL);
    return text;
}

static char *copy(const char *text, bool *is_short)
{
    char *made = text ? strdup(text) : NULL;
    *is_short |= text && !made;
    return made;
}

enum neph_status neph_ladder_add(struct neph_sweep_plan *plan, const char *name, const char *engine,
                                 const char *preset, const char *held, const char *steps,
                                 int scattering, bool flicker, struct neph_diag *diag)
{
    struct neph_sweep_series *longer = realloc(plan->series,
                                               (size_t)(plan->series_count + 1) * sizeof(*longer));
    bool is_short = false;
    if (!longer)
        return neph_fail_memory(diag);
    plan->series = longer;
    longer[plan->series_count++] = (struct neph_sweep_series){
        .name = copy(name, &is_short),
        .engine = copy(engine, &is_short),
        .preset = copy(preset, &is_short),
        .held = copy(held && held[0] ? held : NULL, &is_short),
        .varied = copy(steps ? "steps" : NULL, &is_short),
        .values = copy(steps, &is_short),
        .flicker = flicker,
        .scattering = scattering};
    return is_short ? neph_fail_memory(diag) : NEPH_OK;
}

static bool takes_any(const struct neph_scene *scene, const struct neph_ladder_light *light)
{
    bool any = false;
    for (const struct neph_ladder_air *part = neph_ladder_air_parts; part->name; part++)
        any |= neph_ladder_takes(part, scene, light);
    return any;
}

/* A light of one preset of realtime, with the parts of the air or without. */
static enum neph_status add_realtime(struct neph_sweep_plan *plan,
                                     const struct neph_ladder_pipeline *pipeline,
                                     const struct neph_ladder_light *light,
                                     const struct neph_scene *scene, bool air,
                                     struct neph_diag *diag)
{
    char *name = neph_format("%s%s, %s", pipeline->name, air ? "+air" : "", light->name);
    char *held = neph_ladder_held(scene, light, true, air);
    const enum neph_status status = name && held
                                        ? neph_ladder_add(plan, name, "realtime", pipeline->preset,
                                                          held, all_steps, light->scattering, true,
                                                          diag)
                                        : neph_fail_memory(diag);
    free(held);
    free(name);
    return status;
}

static enum neph_status add_march(struct neph_sweep_plan *plan, const char *pipeline,
                                  const struct neph_ladder_light *light, bool is_still,
                                  struct neph_diag *diag)
{
    char *name = neph_format("%s, %s", pipeline, light->name);
    const enum neph_status status = name ? neph_ladder_add(plan, name, light->march, NULL, NULL,
                                                           all_steps, light->scattering, !is_still,
                                                           diag)
                                         : neph_fail_memory(diag);
    free(name);
    return status;
}

/* A light of one pipeline. */
static enum neph_status add_rung(struct neph_sweep_plan *plan,
                                 const struct neph_ladder_pipeline *pipeline,
                                 const struct neph_ladder_light *light,
                                 const struct neph_scene *scene, struct neph_diag *diag)
{
    if (!pipeline->preset)
        return add_march(plan, pipeline->name, light, neph_ladder_is_still(scene), diag);
    enum neph_status status = add_realtime(plan, pipeline, light, scene, false, diag);
    if (!status && takes_any(scene, light))
        status = add_realtime(plan, pipeline, light, scene, true, diag);
    return status;
}

static enum neph_status add_closed_form(struct neph_sweep_plan *plan,
                                        const struct neph_ladder_light *light,
                                        struct neph_diag *diag)
{
    char *name = neph_format("closed form, %s", light->name);
    const enum neph_status status = name ? neph_ladder_add(plan, name, "exact", NULL, NULL, NULL,
                                                           light->scattering, false, diag)
                                         : neph_fail_memory(diag);
    free(name);
    return status;
}

/* The user's own renderer, where there is one. */
static enum neph_status add_guest(struct neph_sweep_plan *plan, struct neph_diag *diag)
{
    const struct neph_engine *guest = neph_engine_find("command");
    struct neph_engine_info info;
    neph_engine_probe(guest, NULL, &info);
    return info.available
               ? neph_ladder_add(plan, "yours", guest->name, NULL, NULL, NULL, -1, true, diag)
               : NEPH_OK;
}

/* Engines for one kind of scene, where it is of that kind. */
static enum neph_status add_narrow(struct neph_sweep_plan *plan, const struct neph_scene *scene,
                                   struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; neph_ladder_narrow[i] && !status; i++) {
        const struct neph_engine *engine = neph_engine_find(neph_ladder_narrow[i]);
        const struct neph_settings settings = neph_settings_default(engine);
        char why[256];
        if (engine->can_render(scene, &settings, why, sizeof(why)))
            status = neph_ladder_add(plan, engine->name, engine->name, NULL, NULL, NULL, -1,
                                     !neph_ladder_is_still(scene), diag);
    }
    return status;
}

enum neph_status neph_ladder_plan(const struct neph_scene *scene, bool late, int width_px,
                                  int height_px, struct neph_sweep_plan *plan,
                                  struct neph_diag *diag)
{
    const bool closed = neph_ladder_has_closed_form(scene);
    *plan = (struct neph_sweep_plan){.title = strdup("pick"),
                                     .light = strdup("octaves"),
                                     .width_px = width_px,
                                     .height_px = height_px,
                                     .frame_count = FRAMES,
                                     .warm_up = WARM_UP,
                                     .truth_samples = TRUTH_SAMPLES,
                                     .round_count = ROUNDS,
                                     .seed_count = 1};
    enum neph_status status = plan->title && plan->light ? NEPH_OK : neph_fail_memory(diag);
    const struct neph_ladder_light *light = neph_ladder_lights;
    for (; light->name && closed && !late && !status; light++)
        if (light->scattering <= (int)scene->scattering &&
            light->scattering != NEPH_SCATTERING_MULTIPLE)
            status = add_closed_form(plan, light, diag);
    for (light = neph_ladder_lights; light->name; light++)
        for (const struct neph_ladder_pipeline *pipeline = neph_ladder_pipelines;
             pipeline->name && !status; pipeline++)
            if (light->scattering <= (int)scene->scattering && light->is_late == late &&
                !(late && !pipeline->preset))
                status = add_rung(plan, pipeline, light, scene, diag);
    if (!status && !late)
        status = add_narrow(plan, scene, diag);
    return status || late ? status : add_guest(plan, diag);
}
