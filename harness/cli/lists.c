/* SPDX-License-Identifier: MIT
 *
 * `neph scenes`, `neph engines` and `neph doctor`: what there is.
 */
#include "harness/cli/cli.h"

#include "base/child.h"
#include "base/files.h"
#include "harness/data.h"
#include "harness/engines/engines.h"
#include "harness/report/validate.h"
#include "scenes/media.h"
#include "scenes/variant.h"
#include "scenes/volume_file.h"

#include <argp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { KEY_JSON = 1 };

struct request {
    const char *name;
    bool json;
};

static const struct argp_option options[] = {
    {"json", KEY_JSON, NULL, 0, "Results as JSON on stdout", 0},
    {"quiet", 'q', NULL, 0, "Accepted; these verbs print results alone", 0},
    {0},
};

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct request *request = state->input;
    switch (key) {
    case 'q':
        return 0;
    case KEY_JSON:
        request->json = true;
        return 0;
    case ARGP_KEY_ARG:
        if (request->name)
            argp_error(state, "one name, not '%s' as well", argument);
        request->name = argument;
        return 0;
    }
    return ARGP_ERR_UNKNOWN;
}

static json_t *layer_json(const struct neph_fog_layer *layer)
{
    const struct neph_unreal_fog unreal = neph_fog_layer_to_unreal(layer);
    return json_pack("{s:f, s:f, s:f, s:{s:f, s:f}}", "extinction_per_m", layer->extinction_per_m,
                     "falloff_per_m", layer->falloff_per_m, "height_m", layer->height_m, "unreal",
                     "fog_density", unreal.fog_density, "fog_height_falloff",
                     unreal.fog_height_falloff);
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
    return json_pack("{s:s, s:s, s:s, s:s, s:s, s:i, s:i, s:i, s:o, s:o}", "name", scene->name,
                     "title", scene->title, "physics", scene->physics, "hash", scene->hash,
                     "scattering", neph_scattering_name(scene->scattering), "frames",
                     scene->frame_count, "solids", scene->solid_count, "gates", scene->gate_count,
                     "layers", layers, "engines", engines);
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

static enum neph_status show_scene(const struct request *request, struct neph_diag *diag)
{
    struct neph_scene *scene = NULL;
    enum neph_status status = neph_data_load_scene(request->name, &scene, diag);
    if (status)
        return status;
    if (request->json)
        status = neph_cli_print_json(scene_json(scene), diag);
    else
        print_scene(scene);
    neph_scene_destroy(scene);
    return status;
}

/* A scene whose data is not on this machine. */
static enum neph_status list_absent(const struct request *request, const char *name,
                                    const struct neph_diag *why, json_t *list,
                                    struct neph_diag *diag)
{
    if (request->json)
        return neph_json_append(
            list, json_pack("{s:o, s:s}", "name", neph_json_cleaned(name), "absent", why->message),
            diag);
    printf("%-24s not here: %s\n", name, why->message);
    return NEPH_OK;
}

/* One line, or one entry of `list`, per scene of a folder. */
static enum neph_status list_folder(const struct request *request, enum neph_data_scenes folder,
                                    json_t *list, struct neph_diag *diag)
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
            status = list_absent(request, names[i], &why, list, diag);
            continue;
        }
        if (status)
            break;
        if (request->json)
            status = neph_json_append(list, scene_json(scene), diag);
        else
            printf("%-24s %s\n", scene->name, scene->title);
        neph_scene_destroy(scene);
    }
    neph_data_free_names(names);
    return status;
}

/* ---- variants -------------------------------------------------------------------------------- */

enum { KEY_VARIANT = 0x100, KEY_AT, KEY_FRAMES };

static const struct argp_option variant_options[] = {
    {"variant", KEY_VARIANT, "KIND", 0,
     "Print the scene as a scene file in which something happens, to measure lag with: sun_step "
     "(the sun four times as bright from a frame on), sun_sine (1 + 0.3 times the sum of sines of "
     "16, 32 and 64 frames), camera_cut (the camera turns by half its field of view)",
     1},
    {"at", KEY_AT, "FRAME", 0, "Of the step or cut (default: the middle)", 1},
    {"frames", KEY_FRAMES, "N", 0, "Of the sequence (default: the scene's own, or 128 of one)", 1},
    {0},
};

struct scenes_request {
    struct request shared;
    const char *variant, *at, *frames; /* NULL: not given */
};

static error_t parse_scenes(int key, char *argument, struct argp_state *state)
{
    struct scenes_request *request = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &request->shared;
        return 0;
    case KEY_VARIANT:
        request->variant = argument;
        return 0;
    case KEY_AT:
        request->at = argument;
        return 0;
    case KEY_FRAMES:
        request->frames = argument;
        return 0;
    case ARGP_KEY_END:
        if (request->variant && (!request->shared.name || request->shared.json))
            argp_error(state, "--variant is of one scene, and prints YAML");
        if (!request->variant && (request->at || request->frames))
            argp_error(state, "--at and --frames are of a --variant");
        return 0;
    }
    return ARGP_ERR_UNKNOWN;
}

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

static enum neph_status print_variant_of(const struct scenes_request *request,
                                         const struct neph_scene *scene, struct neph_diag *diag)
{
    struct neph_variant variant = {.frame_count = scene->frame_count > 1 ? scene->frame_count
                                                                         : 128};
    char *text = NULL;
    enum neph_status status = parse_kind(request->variant, &variant.kind, diag);
    if (!status && request->frames)
        status = neph_cli_parse_int("--frames", request->frames, 2, NEPH_VARIANT_FRAMES_MAX,
                                    &variant.frame_count, diag);
    variant.frame = variant.frame_count / 2;
    if (!status && request->at)
        status = neph_cli_parse_int("--at", request->at, 1, variant.frame_count - 1, &variant.frame,
                                    diag);
    if (!status)
        status = neph_scene_variant_text(scene, &variant, &text, diag);
    if (!status)
        fputs(text, stdout);
    free(text);
    return status;
}

static enum neph_status print_variant(const struct scenes_request *request, struct neph_diag *diag)
{
    struct neph_scene *scene = NULL;
    enum neph_status status = neph_data_load_scene(request->shared.name, &scene, diag);
    if (!status)
        status = print_variant_of(request, scene, diag);
    neph_scene_destroy(scene);
    return status;
}

/* ---- the verbs ------------------------------------------------------------------------------- */

enum neph_status neph_cli_scenes(int argc, char **argv, struct neph_diag *diag)
{
    static const struct argp shared_argp = {.options = options, .parser = parse};
    static const struct argp_child children[] = {{&shared_argp, 0, NULL, 0}, {0}};
    static const struct argp argp = {
        .options = variant_options,
        .parser = parse_scenes,
        .children = children,
        .args_doc = "[SCENE]",
        .doc = "List the catalogue, or check and describe one scene (a file or a name).\v"
               "A variant's file must have the variant's name.\n\n"
               "Examples:\n  neph scenes\n  neph scenes two_layer_fog\n  neph scenes my_fog.yaml\n"
               "  neph scenes my_fog.yaml --variant sun_step > my_fog_sun_step.yaml",
    };
    struct scenes_request asked = {.variant = NULL};
    neph_cli_parse(&argp, argc, argv, &asked);
    if (asked.variant)
        return print_variant(&asked, diag);
    const struct request request = asked.shared;
    if (request.name)
        return show_scene(&request, diag);
    enum neph_status status = NEPH_OK;
    json_t *list = json_array();
    for (int folder = 0; folder < NEPH_DATA_SCENES_COUNT && !status; folder++)
        status = list_folder(&request, (enum neph_data_scenes)folder, list, diag);
    if (!status && request.json)
        status = neph_cli_print_json(json_incref(list), diag);
    json_decref(list);
    return status;
}

static json_t *presets_json(const struct neph_engine *engine)
{
    json_t *list = json_array();
    for (const struct neph_preset *preset = engine->presets; preset && preset->name; preset++)
        neph_json_add(&list, json_pack("{s:s, s:s, s:s}", "name", preset->name, "summary",
                                       preset->summary, "settings", preset->assignments));
    return list;
}

static void print_presets(const struct neph_engine *engine)
{
    if (engine->presets)
        printf("    presets, given by --preset, each the defaults with\n");
    for (const struct neph_preset *preset = engine->presets; preset && preset->name; preset++)
        printf("      %-8s %s\n               %s\n", preset->name, preset->summary,
               preset->assignments[0] ? preset->assignments : "(nothing else)");
}

static json_t *passes_json(const struct neph_engine *engine)
{
    json_t *list = json_array();
    struct neph_engine_pass pass;
    for (int i = 0; engine->describe_pass && engine->describe_pass(i, &pass); i++)
        neph_json_add(&list, json_pack("{s:s, s:s, s:s, s:s, s:s, s:s, s:s}", "name", pass.name,
                                       "note", pass.note, "resolution", pass.resolution,
                                       "condition", pass.condition, "reads", pass.reads, "writes",
                                       pass.writes, "hands_on", pass.hands_on));
    return list;
}

static void print_passes(const struct neph_engine *engine)
{
    struct neph_engine_pass pass;
    if (engine->describe_pass)
        printf("    passes of a frame\n");
    for (int i = 0; engine->describe_pass && engine->describe_pass(i, &pass); i++) {
        const char *const rows[][2] = {
            {"reads", pass.reads}, {"writes", pass.writes}, {"hands on", pass.hands_on}};
        printf("      %-15s %s\n%22s%s resolution, where %s\n", pass.name, pass.note, "",
               pass.resolution, pass.condition);
        for (size_t r = 0; r < sizeof(rows) / sizeof(rows[0]); r++)
            if (rows[r][1][0])
                printf("%22s%-8s %s\n", "", rows[r][0], rows[r][1]);
    }
}

enum neph_status neph_cli_engines(int argc, char **argv, struct neph_diag *diag)
{
    static const struct argp argp = {
        .options = options,
        .parser = parse,
        .args_doc = "[ENGINE]",
        .doc = "List the engines with their rung of truth, version and settings.\v"
               "Examples:\n  neph engines\n  neph engines march --json",
    };
    struct request request = {0};
    neph_cli_parse(&argp, argc, argv, &request);
    if (request.name && !neph_engine_find(request.name))
        return neph_fail(diag, NEPH_ERR_USAGE, "there is no engine '%s'; `neph engines` lists them",
                         request.name);
    json_t *list = json_array();
    int count;
    const struct neph_engine *const *engines = neph_engines(&count);
    for (int i = 0; i < count; i++) {
        const struct neph_engine *engine = engines[i];
        if (request.name && neph_engine_find(request.name) != engine)
            continue;
        struct neph_engine_info info;
        neph_engine_probe(engine, &info);
        if (request.json) {
            neph_json_add(
                &list,
                json_pack("{s:s, s:s, s:s, s:s?, s:b, s:b, s:s, s:s, s:s, s:s, s:o, s:o, s:o}",
                          "name", engine->name, "summary", engine->summary, "rung",
                          neph_rung_name(engine->rung), "bias", engine->bias, "available",
                          info.available, "broken", info.broken, "version", info.version, "device",
                          info.device, "missing", info.missing, "install_line", info.install_line,
                          "options", neph_cli_options_json(engine->options), "presets",
                          presets_json(engine), "passes", passes_json(engine)));
            continue;
        }
        printf("%s (%s): %s\n    %s%s\n", engine->name, neph_rung_name(engine->rung),
               engine->summary,
               info.available ? info.version
               : info.broken  ? "broken: "
                              : "missing: ",
               info.available ? "" : info.missing);
        if (engine->bias)
            printf("    known bias: %s\n", engine->bias);
        neph_cli_print_options(engine->options);
        print_presets(engine);
        print_passes(engine);
    }
    enum neph_status status = NEPH_OK;
    if (request.json)
        status = neph_cli_print_json(json_incref(list), diag);
    json_decref(list);
    return status;
}

/* Beside the engines: what the report and the tests need. */
static bool has_openvdb(const char *program)
{
    (void)program;
    char *path = NULL;
    const bool found = neph_volume_find_openvdb(&path, NULL) == NEPH_OK;
    free(path);
    return found;
}

static const struct {
    const char *program;
    bool (*is_there)(const char *program);
    const char *needed_for, *install_line;
} tools[] = {
    {"neph-vdb", has_openvdb, "OpenVDB files, and voxels in cycles",
     "copy it from the build folder into that of neph, or let NEPH_VDB name it"},
    {"node", neph_child_program_exists, "static charts in the report",
     "apt-get install nodejs npm"},
    {"chromium", neph_child_program_exists, "the browser test of the report",
     "apt-get install chromium"},
};

enum neph_status neph_cli_doctor(int argc, char **argv, struct neph_diag *diag)
{
    static const struct argp argp = {
        .options = options,
        .parser = parse,
        .doc = "What is installed, on which device, and how to get what is missing.\v"
               "Exit code 69 when an engine is missing, 3 when one is installed and does not "
               "work.\n\nExample:\n  neph doctor",
    };
    struct request request = {0};
    neph_cli_parse(&argp, argc, argv, &request);
    json_t *list = json_array();
    int count, missing = 0, broken = 0;
    const struct neph_engine *const *engines = neph_engines(&count);
    for (int i = 0; i < count; i++) {
        struct neph_engine_info info;
        neph_engine_probe(engines[i], &info);
        missing += !info.available;
        broken += info.broken;
        neph_json_add(&list, json_pack("{s:s, s:b, s:b, s:s, s:s, s:s, s:s}", "name",
                                       engines[i]->name, "available", info.available, "broken",
                                       info.broken, "version", info.version, "device", info.device,
                                       "missing", info.missing, "install_line", info.install_line));
        if (!request.json && info.available)
            printf("ok       %-9s %s; %s\n", engines[i]->name, info.version, info.device);
        else if (!request.json && info.broken)
            printf("broken   %-9s %s\n", engines[i]->name, info.missing);
        else if (!request.json)
            printf("missing  %-9s %s\n         get it:   %s\n", engines[i]->name, info.missing,
                   info.install_line);
    }
    for (size_t i = 0; i < sizeof(tools) / sizeof(tools[0]); i++) {
        const bool there = tools[i].is_there(tools[i].program);
        neph_json_add(&list, json_pack("{s:s, s:b, s:s, s:s}", "name", tools[i].program,
                                       "available", there, "needed_for", tools[i].needed_for,
                                       "install_line", tools[i].install_line));
        if (!request.json)
            printf("%-8s %-9s for %s%s%s\n", there ? "ok" : "missing", tools[i].program,
                   tools[i].needed_for,
                   there ? "" : "\n         get it:   ", there ? "" : tools[i].install_line);
    }
    enum neph_status status = NEPH_OK;
    if (request.json)
        status = neph_cli_print_json(
            json_pack("{s:o, s:o}", "host", neph_host_json(), "parts", json_incref(list)), diag);
    else
        printf("data     %s\n", neph_data_directory());
    json_decref(list);
    if (status)
        return status;
    return broken ? NEPH_ERR_ENGINE : missing ? NEPH_ERR_UNAVAILABLE : NEPH_OK;
}
