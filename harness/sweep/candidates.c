/* SPDX-License-Identifier: MIT
 *
 * The candidate configurations of `neph pick`: pipelines, lighting models, optional parts.
 */
#include "harness/sweep/candidates.h"

#include "base/files.h"
#include "harness/engines/engines.h"
#include "renderer/gpu_scene.h"
#include "renderer/realtime/options.h"
#include "scenes/media.h"
#include "scenes/motion.h"

#include <math.h>
#include <string.h>

/* Fails to compile when a kind is added: the tables of this file and the closed forms depend on it.
 */
_Static_assert(NEPH_CANDIDATE_MOTION_COUNT == 3, "a new kind");
_Static_assert(NEPH_MEDIUM_KIND_COUNT == 8, "a new kind");
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");

const struct neph_candidate_lighting neph_candidate_lightings[] = {
    {"no scattering", NEPH_SCATTERING_NONE, "march", NULL, false},
    {"scattered once", NEPH_SCATTERING_SINGLE, "march", NULL, false},
    {"octaves", NEPH_SCATTERING_MULTIPLE, "march_octaves", "lighting=octaves", false},
    {"fitted octaves", NEPH_SCATTERING_MULTIPLE, "march_octaves_fitted", "lighting=octaves_fitted",
     false},
    {"traced", NEPH_SCATTERING_MULTIPLE, "march_traced", "lighting=traced", true},
    {.name = NULL},
};

const char *neph_candidate_preset(int pipeline)
{
    int count = 0;
    while (neph_preset_find_by_use(neph_rt_presets, NEPH_RT_PICK, count))
        count++;
    const struct neph_preset *preset = neph_preset_find_by_use(neph_rt_presets, NEPH_RT_PICK,
                                                               count - 1 - pipeline);
    return preset ? preset->name : NULL;
}

const char *const neph_candidate_special_engines[] = {"fog_look", "sky", NULL};

const struct neph_candidate_part neph_candidate_motion_parts[] = {
    {"reprojection follows the wind", "wind=off", NEPH_CANDIDATE_WIND},
    {"camera cuts invalidate the history", "cut_reset=off", NEPH_CANDIDATE_CAMERA},
    {"disocclusion invalidates the history", "reject_depth=0", NEPH_CANDIDATE_CAMERA},
    /* at edges in front of a moving cloud: 13 % of the flicker of wind_cloud */
    {"motion of the nearest of five depths", "taa_motion=centre", NEPH_CANDIDATE_ANY},
    {.name = NULL},
};

/* ---- needs of a scene ------------------------------------------------------------------------ */

/* Whether media within the froxels' range have a relevant optical depth, on a grid of 4 x 4 rays.
 */
static bool has_media_in_froxels(const struct neph_scene *scene, int frame)
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

/* In the first, the middle or the last frame. */
static bool has_near_media(const struct neph_scene *scene)
{
    const int last = scene->frame_count > 0 ? scene->frame_count - 1 : 0;
    return has_media_in_froxels(scene, 0) || has_media_in_froxels(scene, last / 2) ||
           has_media_in_froxels(scene, last);
}

/* Whether sunlight passes through a cloud before it reaches a solid or fog. */
static bool has_cloud_shadows(const struct neph_scene *scene)
{
    struct neph_bounds clouds;
    bool has_fog = false;
    for (int m = 0; m < scene->medium_count; m++)
        has_fog |= neph_medium_is_fog(&scene->media[m]) ||
                   scene->media[m].kind == NEPH_MEDIUM_HOMOGENEOUS;
    return scene->sun.present && neph_find_media_bounds(scene, &clouds) &&
           (scene->solid_count > 0 || has_fog);
}

const struct neph_candidate_air_part neph_candidate_air_parts[] = {
    {"near froxels", "froxels=on", has_near_media, "no medium is visible within 64 m of the camera",
     false},
    {"a shadow map of the clouds", "cloud_shadow=map", has_cloud_shadows,
     "no cloud stands between the sun and a solid or a fog", true},
    {.name = NULL},
};

bool neph_candidate_needs_part(const struct neph_candidate_air_part *part,
                               const struct neph_scene *scene,
                               const struct neph_candidate_lighting *light)
{
    const bool is_known = part->for_fitted || !light->settings ||
                          strcmp(light->settings, "lighting=octaves") == 0;
    return light->scattering != NEPH_SCATTERING_NONE && is_known && part->is_needed(scene);
}

static const char all_steps[] = "8 16 32 64";

/* As in the plan that is installed with neph. */
enum { FRAMES = 48, WARM_UP = 16, TRUTH_SAMPLES = 256, ROUNDS = 3 };

static bool is_same_camera(const struct neph_scene *scene, int frame)
{
    const struct neph_camera first = neph_scene_camera(scene, 0.0),
                             other = neph_scene_camera(scene, frame);
    return memcmp(&first, &other, sizeof(first)) == 0;
}

bool neph_candidate_has_motion(const struct neph_scene *scene, enum neph_candidate_motion what)
{
    if (what != NEPH_CANDIDATE_CAMERA && scene->wind_key_count > 0)
        return true;
    if (what == NEPH_CANDIDATE_WIND)
        return false;
    for (int frame = 1; frame < scene->frame_count; frame++)
        if (!is_same_camera(scene, frame))
            return true;
    return scene->frame_scale_count > 0 || scene->mover_count > 0;
}

bool neph_candidate_has_closed_form(const struct neph_scene *scene)
{
    for (int m = 0; m < scene->medium_count; m++)
        if (scene->media[m].kind != NEPH_MEDIUM_HOMOGENEOUS &&
            !neph_medium_is_fog(&scene->media[m]))
            return false;
    return true;
}

static void append(const char *setting, char held[NEPH_CANDIDATE_SETTINGS_SIZE])
{
    const size_t used = strlen(held);
    if (setting)
        snprintf(held + used, NEPH_CANDIDATE_SETTINGS_SIZE - used, "%s%s", used ? " " : "",
                 setting);
}

void neph_candidate_settings(const struct neph_scene *scene,
                             const struct neph_candidate_lighting *light, bool still, bool air,
                             char held[NEPH_CANDIDATE_SETTINGS_SIZE])
{
    held[0] = '\0';
    append(light->settings, held);
    for (const struct neph_candidate_part *part = neph_candidate_motion_parts; still && part->name;
         part++)
        append(neph_candidate_has_motion(scene, part->needed_by) ? NULL : part->off, held);
    for (const struct neph_candidate_air_part *part = neph_candidate_air_parts; air && part->name;
         part++)
        append(neph_candidate_needs_part(part, scene, light) ? part->on : NULL, held);
}

enum neph_status neph_candidate_add_series(struct neph_sweep_plan *plan,
                                           const struct neph_sweep_series *series,
                                           const char *steps, struct neph_diag *diag)
{
    struct neph_arena *arena = &plan->arena;
    struct neph_sweep_series *longer = neph_arena_allocate(arena, (size_t)plan->series_count + 1,
                                                           sizeof(*longer));
    const bool has_settings = series->held && series->held[0];
    if (!longer)
        return neph_fail_memory(diag);
    for (int i = 0; i < plan->series_count; i++)
        longer[i] = plan->series[i];
    plan->series = longer;
    longer[plan->series_count++] = (struct neph_sweep_series){
        .name = neph_arena_copy_text(arena, series->name),
        .engine = neph_arena_copy_text(arena, series->engine),
        .preset = neph_arena_copy_text(arena, series->preset),
        .held = neph_arena_copy_text(arena, has_settings ? series->held : NULL),
        .varied = steps ? "steps" : NULL,
        .values = neph_arena_copy_text(arena, steps),
        .flicker = series->flicker,
        .scattering = series->scattering};
    return neph_arena_check(arena, diag);
}

/* Adds a series named like "ours+air, octaves". */
static enum neph_status add(struct neph_sweep_plan *plan, const char *pipeline, const char *air,
                            const struct neph_candidate_lighting *light,
                            struct neph_sweep_series series, const char *steps,
                            struct neph_diag *diag)
{
    char name[64];
    snprintf(name, sizeof(name), "%s%s, %s", pipeline, air, light->name);
    series.name = name;
    series.scattering = light->scattering;
    return neph_candidate_add_series(plan, &series, steps, diag);
}

static bool needs_any_air_part(const struct neph_scene *scene,
                               const struct neph_candidate_lighting *light)
{
    bool any = false;
    for (const struct neph_candidate_air_part *part = neph_candidate_air_parts; part->name; part++)
        any |= neph_candidate_needs_part(part, scene, light);
    return any;
}

/* Adds a lighting model with one pipeline: a preset of realtime, or the marcher (NULL). For
 * realtime again with the optional parts of the air, where the scene needs any. */
static enum neph_status add_pipeline_lighting(struct neph_sweep_plan *plan, const char *preset,
                                              const struct neph_candidate_lighting *light,
                                              const struct neph_scene *scene,
                                              struct neph_diag *diag)
{
    const struct neph_sweep_series march = {.engine = light->march,
                                            .flicker = !neph_scene_is_static(scene)};
    enum neph_status status = NEPH_OK;
    if (!preset)
        return add(plan, "march", "", light, march, all_steps, diag);
    for (int air = 0; air <= needs_any_air_part(scene, light) && !status; air++) {
        char held[NEPH_CANDIDATE_SETTINGS_SIZE];
        neph_candidate_settings(scene, light, true, air, held);
        const struct neph_sweep_series series = {
            .engine = "realtime", .preset = preset, .held = held, .flicker = true};
        status = add(plan, preset, air ? "+air" : "", light, series, all_steps, diag);
    }
    return status;
}

/* A late lighting model gets no marcher as pipeline. */
static enum neph_status add_pipelines(struct neph_sweep_plan *plan,
                                      const struct neph_candidate_lighting *light,
                                      const struct neph_scene *scene, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    const char *preset;
    for (int i = 0; (preset = neph_candidate_preset(i)) && !status; i++)
        status = add_pipeline_lighting(plan, preset, light, scene, diag);
    return status || light->is_late ? status
                                    : add_pipeline_lighting(plan, NULL, light, scene, diag);
}

/* Adds the user engine, where one is configured. */
static enum neph_status add_user_engine(struct neph_sweep_plan *plan, struct neph_diag *diag)
{
    const struct neph_sweep_series series = {
        .name = "yours", .engine = "command", .flicker = true, .scattering = -1};
    struct neph_engine_info info;
    neph_engine_probe(neph_engine_find(series.engine), NULL, &info);
    return info.available ? neph_candidate_add_series(plan, &series, NULL, diag) : NEPH_OK;
}

/* Adds engines for one kind of scene that can render this scene. */
static enum neph_status add_narrow(struct neph_sweep_plan *plan, const struct neph_scene *scene,
                                   struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; neph_candidate_special_engines[i] && !status; i++) {
        const struct neph_engine *engine = neph_engine_find(neph_candidate_special_engines[i]);
        const struct neph_settings settings = neph_settings_default(engine);
        char why[256];
        const struct neph_sweep_series series = {.name = engine->name,
                                                 .engine = engine->name,
                                                 .flicker = !neph_scene_is_static(scene),
                                                 .scattering = -1};
        if (engine->can_render(scene, &settings, why, sizeof(why)))
            status = neph_candidate_add_series(plan, &series, NULL, diag);
    }
    return status;
}

enum neph_status neph_candidate_plan(const struct neph_scene *scene, bool late, int width_px,
                                     int height_px, struct neph_sweep_plan *plan,
                                     struct neph_diag *diag)
{
    const bool closed = neph_candidate_has_closed_form(scene);
    *plan = (struct neph_sweep_plan){.title = "pick",
                                     .light = "octaves",
                                     .width_px = width_px,
                                     .height_px = height_px,
                                     .frame_count = FRAMES,
                                     .warm_up = WARM_UP,
                                     .truth_samples = TRUTH_SAMPLES,
                                     .round_count = ROUNDS,
                                     .seed_count = 1};
    enum neph_status status = NEPH_OK;
    const struct neph_candidate_lighting *light = neph_candidate_lightings;
    for (; light->name && closed && !late && !status; light++)
        if (light->scattering <= (int)scene->scattering &&
            light->scattering != NEPH_SCATTERING_MULTIPLE)
            status = add(plan, "closed form", "", light,
                         (struct neph_sweep_series){.engine = "exact"}, NULL, diag);
    for (light = neph_candidate_lightings; light->name && !status; light++)
        if (light->scattering <= (int)scene->scattering && light->is_late == late)
            status = add_pipelines(plan, light, scene, diag);
    if (!status && !late)
        status = add_narrow(plan, scene, diag);
    return status || late ? status : add_user_engine(plan, diag);
}
