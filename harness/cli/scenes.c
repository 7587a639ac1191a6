/* SPDX-License-Identifier: MIT
 *
 * `neph scenes`: the catalogue, one scene, or a variant of it.
 */
#include "harness/cli/cli.h"

#include "harness/cli/scenes_fog.h"
#include "harness/data.h"
#include "harness/engines/engines.h"
#include "scenes/media.h"
#include "scenes/variant.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct request {
    struct neph_cli_shared shared;
    const char *variant;
    int at, frames;
};

static const struct neph_cli_option options[] = {
    {.name = "json"},
    {.name = "quiet", .help = "Not a word on what the file of a variant has to be called"},
    {"variant", 0, "KIND",
     "Print the scene as a scene file in which something happens, to measure lag with: sun_step "
     "(the sun four times as bright from a frame on), sun_sine (1 + 0.3 times the sum of sines of "
     "16, 32 and 64 frames), camera_cut (the camera turns by half its field of view)",
     NEPH_CLI_WORD, .at = offsetof(struct request, variant), .group = 1},
    {"at", 0, "FRAME", "Of the step or cut (default: the middle)", NEPH_CLI_INTEGER,
     .at = offsetof(struct request, at), .minimum = 1, .maximum = NEPH_VARIANT_FRAMES_MAX - 1,
     .group = 1},
    {"frames", 0, "N", "Of the sequence (default: the scene's own, or 128 of one)",
     NEPH_CLI_INTEGER, .at = offsetof(struct request, frames), .minimum = 2,
     .maximum = NEPH_VARIANT_FRAMES_MAX, .group = 1},
    {.name = NULL},
};

static void check(const void *request_, const struct argp_state *state)
{
    const struct request *request = request_;
    const struct neph_cli_shared *shared = &request->shared;
    if (request->variant && (shared->operand_count == 0 || shared->json))
        argp_error(state, "--variant is of one scene, and prints YAML");
    if (!request->variant && (request->at >= 0 || request->frames >= 0))
        argp_error(state, "--at and --frames are of a --variant");
}

static const struct neph_cli_operands operands = {
    .shown = "[SCENE]",
    .maximum = 1,
    .surplus = "one scene",
};

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &operands,
    .check = check,
    .doc = "List the catalogue, or check and describe one scene (a file or a name).\v"
           "Examples:\n  neph scenes\n  neph scenes two_layer_fog\n  neph scenes my_fog.yaml\n"
           "  neph scenes my_fog.yaml --variant sun_step > my_fog_sun_step.yaml",
};

static json_t *layer_json(const struct neph_fog_layer *layer)
{
    const struct neph_unreal_fog unreal = neph_fog_layer_to_unreal(layer);
    return json_pack("{s:f, s:f, s:f, s:{s:f, s:f, s:f}, s:{s:f, s:f, s:f}}", "extinction_per_m",
                     layer->extinction_per_m, "falloff_per_m", layer->falloff_per_m, "height_m",
                     layer->height_m, "unreal", "fog_density", unreal.fog_density,
                     "fog_height_falloff", unreal.fog_height_falloff, "fog_height_m",
                     unreal.fog_height_m, "filament", "density", layer->extinction_per_m,
                     "heightFalloff", layer->falloff_per_m, "height", layer->height_m);
}

static json_t *limits_json(const struct neph_failing *failing)
{
    json_t *list = json_array();
    for (int i = 0; i < failing->limit_count; i++) {
        const struct neph_failing_limit *limit = &failing->limits[i];
        neph_json_add(&list,
                      json_pack("{s:s, s:s, s:f, s:s}", "measure",
                                neph_failing_measure_name(limit->measure), "over", limit->over,
                                "limit", limit->limit, "reason", limit->reason));
    }
    return list;
}

static json_t *points_json(const struct neph_failing *failing)
{
    json_t *list = json_array();
    for (int point = 0; point < neph_failing_point_count(failing); point++) {
        char name[NEPH_FAILING_POINT_SIZE];
        neph_failing_point_name(failing, point, name, sizeof(name));
        neph_json_add(&list, json_string(name));
    }
    return list;
}

static json_t *failing_json(const struct neph_failing *failing)
{
    if (!failing->fails)
        return json_null();
    return json_pack("{s:s, s:s, s:s, s:s, s:[i, i], s:i, s:i, s:s, s:b, s:b, s:o, s:o}", "fails",
                     failing->fails, "known", failing->known, "symptom", failing->symptom,
                     "presets", failing->presets, "size_px", failing->width_px, failing->height_px,
                     "frames", failing->frame_count, "steps", failing->steps, "truth",
                     neph_failing_truth_name(failing->truth), "quick", failing->quick, "engines",
                     failing->engines, "measures", limits_json(failing), "points",
                     points_json(failing));
}

static json_t *scene_json(const struct neph_scene *scene)
{
    json_t *layers = json_array(), *engines = json_array();
    for (int m = 0; m < scene->medium_count; m++)
        for (int l = 0; l < scene->media[m].layer_count; l++)
            neph_json_add(&layers, layer_json(&scene->media[m].layers[l]));
    int count;
    const struct neph_engine *const *list = neph_engines(&count);
    for (int i = 0; i < count; i++) {
        char reason[512] = "";
        const struct neph_settings settings = neph_settings_default(list[i]);
        const bool can = list[i]->can_render(scene, &settings, reason, sizeof(reason));
        neph_json_add(&engines, json_pack("{s:s, s:b, s:s}", "engine", list[i]->name, "can_render",
                                          can, "reason", reason));
    }
    return json_pack("{s:s, s:s, s:s, s:s, s:s, s:i, s:i, s:i, s:o, s:o, s:o, s:o}", "name",
                     scene->name, "title", scene->title, "physics", scene->physics, "hash",
                     scene->hash, "scattering", neph_scattering_name(scene->scattering), "frames",
                     scene->frame_count, "solids", scene->solid_count, "gates", scene->gate_count,
                     "layers", layers, "fog", neph_cli_fog_json(scene), "failure",
                     failing_json(&scene->failing), "engines", engines);
}

static void print_failing(const struct neph_failing *failing)
{
    if (!failing->fails)
        return;
    printf("fails       %s\nknown       %s\nsymptom     %s\n"
           "judged      %dx%d px, %d frames, %d steps, against %s, presets %s%s, tier %s\n",
           failing->fails, failing->known, failing->symptom, failing->width_px, failing->height_px,
           failing->frame_count, failing->steps, neph_failing_truth_name(failing->truth),
           failing->presets[0] ? failing->presets : "all", failing->engines ? " and engines" : "",
           failing->quick ? "quick" : "full");
    for (int i = 0; i < failing->limit_count; i++)
        printf("limit       %s over %s <= %g: %s\n",
               neph_failing_measure_name(failing->limits[i].measure), failing->limits[i].over,
               failing->limits[i].limit, failing->limits[i].reason);
    for (int i = 0; i < failing->axis_count; i++)
        printf("sweep       %s, %d values of %s\n", failing->axes[i].name,
               neph_failing_axis_count(&failing->axes[i]), failing->axes[i].paths);
}

static void print_scene(const struct neph_scene *scene)
{
    printf("%s: %s\n\n%s\n\nhash        %s\nscattering  %s\nframes      %d\nsolids      %d\n",
           scene->name, scene->title, scene->physics, scene->hash,
           neph_scattering_name(scene->scattering), scene->frame_count, scene->solid_count);
    for (int m = 0; m < scene->medium_count; m++)
        for (int l = 0; l < scene->media[m].layer_count; l++) {
            const struct neph_fog_layer *layer = &scene->media[m].layers[l];
            const struct neph_unreal_fog unreal = neph_fog_layer_to_unreal(layer);
            printf("medium %d    extinction %g /m, falloff %g /m, height %g m"
                   " (Unreal: density %g, falloff %g)\n",
                   m, layer->extinction_per_m, layer->falloff_per_m, layer->height_m,
                   unreal.fog_density, unreal.fog_height_falloff);
        }
    neph_cli_print_fog(scene);
    print_failing(&scene->failing);
    int count;
    const struct neph_engine *const *engines = neph_engines(&count);
    for (int i = 0; i < count; i++) {
        char reason[512];
        const struct neph_settings settings = neph_settings_default(engines[i]);
        if (engines[i]->can_render(scene, &settings, reason, sizeof(reason)))
            printf("%-11s can\n", engines[i]->name);
        else
            printf("%-11s cannot: %s\n", engines[i]->name, reason);
    }
}

static enum neph_status show_scene(const char *name, bool as_json, struct neph_diag *diag)
{
    struct neph_scene *scene = NULL;
    enum neph_status status = neph_data_load_scene(name, &scene, diag);
    if (status)
        return status;
    if (as_json)
        status = neph_json_print(scene_json(scene), diag);
    else
        print_scene(scene);
    neph_scene_destroy(scene);
    return status;
}

/* A scene whose data is not on this machine. */
static enum neph_status list_absent(const char *name, bool as_json, const struct neph_diag *why,
                                    json_t *list, struct neph_diag *diag)
{
    if (as_json)
        return neph_json_append(
            list, json_pack("{s:o, s:s}", "name", neph_json_cleaned(name), "absent", why->message),
            diag);
    printf("%-24s not here: %s\n", name, why->message);
    return NEPH_OK;
}

/* One line, or one entry of `list`, per scene of a folder. */
static enum neph_status list_folder(enum neph_data_scenes folder, bool as_json, json_t *list,
                                    struct neph_diag *diag)
{
    char **names = NULL;
    int count = 0;
    enum neph_status status = neph_data_list_scenes(folder, &names, &count, diag);
    for (int i = 0; i < count && !status; i++) {
        struct neph_scene *scene = NULL;
        status = neph_data_load_scene(names[i], &scene, diag);
        if (status == NEPH_ERR_NOT_FOUND) { /* its data is not on this machine */
            const struct neph_diag why = *diag;
            *diag = (struct neph_diag){.line = 0};
            status = list_absent(names[i], as_json, &why, list, diag);
            continue;
        }
        if (status)
            break;
        if (as_json)
            status = neph_json_append(list, scene_json(scene), diag);
        else
            printf("%-24s %s\n", scene->name, scene->title);
        neph_scene_destroy(scene);
    }
    neph_data_free_names(names);
    return status;
}

/* ---- variants -------------------------------------------------------------------------------- */

static enum neph_status parse_kind(const char *word, enum neph_variant_kind *kind,
                                   struct neph_diag *diag)
{
    for (int k = 0; k < NEPH_VARIANT_KIND_COUNT; k++)
        if (strcmp(word, neph_variant_name((enum neph_variant_kind)k)) == 0) {
            *kind = (enum neph_variant_kind)k;
            return NEPH_OK;
        }
    neph_fail(diag, NEPH_ERR_USAGE, "there is no variant '%s'", word);
    neph_hint(diag, "sun_step, sun_sine or camera_cut");
    return NEPH_ERR_USAGE;
}

static enum neph_status print_variant_of(const struct request *request,
                                         const struct neph_scene *scene, struct neph_diag *diag)
{
    struct neph_variant variant = {.frame_count = scene->frame_count > 1 ? scene->frame_count
                                                                         : 128};
    char *text = NULL;
    enum neph_status status = parse_kind(request->variant, &variant.kind, diag);
    if (request->frames >= 0)
        variant.frame_count = request->frames;
    variant.frame = request->at >= 0 ? request->at : variant.frame_count / 2;
    if (!status)
        status = neph_cli_check_range("--at", variant.frame, 1, variant.frame_count - 1, diag);
    if (!status)
        status = neph_scene_variant_text(scene, &variant, &text, diag);
    if (!status)
        fputs(text, stdout);
    if (!status && !request->shared.quiet)
        fprintf(stderr, "neph scenes: its file has to be called %s_%s.yaml, as the scene is\n",
                scene->name, request->variant);
    free(text);
    return status;
}

static enum neph_status print_variant(const struct request *request, struct neph_diag *diag)
{
    struct neph_scene *scene = NULL;
    enum neph_status status = neph_data_load_scene(request->shared.operands[0], &scene, diag);
    if (!status)
        status = print_variant_of(request, scene, diag);
    neph_scene_destroy(scene);
    return status;
}

/* ---- the verb -------------------------------------------------------------------------------- */

enum neph_status neph_cli_scenes(int argc, char **argv, struct neph_diag *diag)
{
    struct request request = {0};
    neph_cli_parse(&syntax, argc, argv, &request);
    const bool as_json = request.shared.json;
    if (request.variant)
        return print_variant(&request, diag);
    if (request.shared.operand_count > 0)
        return show_scene(request.shared.operands[0], as_json, diag);
    enum neph_status status = NEPH_OK;
    json_t *list = json_array();
    for (int folder = 0; folder < NEPH_DATA_SCENES_COUNT && !status; folder++)
        status = list_folder((enum neph_data_scenes)folder, as_json, list, diag);
    if (!status && as_json)
        status = neph_json_print(json_incref(list), diag);
    json_decref(list);
    return status;
}
