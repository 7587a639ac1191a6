/* SPDX-License-Identifier: MIT
 *
 * `neph scenes`: lists the catalogue, shows one scene, or writes a variant of it.
 */
#include "harness/cli/cli.h"

#include "harness/cli/new_scene.h"
#include "harness/cli/scene_densities.h"
#include "harness/cli/scene_phases.h"
#include "harness/data.h"
#include "harness/engines/engines.h"
#include "scenes/failing.h"
#include "scenes/fog_translation.h"
#include "scenes/gates.h"
#include "scenes/media.h"
#include "scenes/mesh.h"
#include "scenes/variant.h"
#include "scenes/volume_scene.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");
_Static_assert(NEPH_MESH_INSIDE_COUNT == 3, "a new kind");

struct request {
    struct neph_cli_shared shared;
    const char *variant, *new_kind, *vdb;
    int at, frames;
    bool force;
};

#define AT(member) .at = offsetof(struct request, member)
static const struct neph_cli_option options[] = {
    {.name = "json"},
    {.name = "quiet", .help = "Do not print the required file name of a variant"},
    {"new", 0, "KIND",
     "Write a commented scene file to begin with: fog (a fence in fog, with shafts), cloud (a "
     "procedural cumulus), grid (voxels written in the file), vdb (around the medium of a .vdb)",
     NEPH_CLI_WORD, AT(new_kind), .group = 2},
    {"vdb", 0, "FILE.vdb", "Of --new vdb: the volume", NEPH_CLI_WORD, AT(vdb), .group = 2},
    {"force", 0, NULL, "Of --new: replace a file of that name", NEPH_CLI_FLAG, AT(force),
     .group = 2},
    {"variant", 0, "KIND",
     "Print the scene as a scene file in which something happens, to measure lag with: sun_step "
     "(the sun four times as bright from a frame on), sun_sine (1 + 0.3 times the sum of sines of "
     "16, 32 and 64 frames), camera_cut (the camera turns by half its field of view)",
     NEPH_CLI_WORD, AT(variant), .group = 1},
    {"at", 0, "FRAME", "Of the step or cut (default: the middle)", NEPH_CLI_INTEGER, AT(at),
     .minimum = 1, .maximum = NEPH_VARIANT_FRAMES_MAX - 1, .group = 1},
    {"frames", 0, NULL, "Frames of the sequence (default: the scene's own, or 128 of one)",
     NEPH_CLI_INTEGER, AT(frames), .minimum = 2, .maximum = NEPH_VARIANT_FRAMES_MAX, .group = 1},
    {.name = NULL},
};
#undef AT

static void check(const void *request_, const struct argp_state *state)
{
    const struct request *request = request_;
    const struct neph_cli_shared *shared = &request->shared;
    if (request->variant && (shared->operand_count == 0 || shared->json))
        argp_error(state, "--variant is of one scene, and prints YAML");
    if (!request->variant && (request->at >= 0 || request->frames >= 0))
        argp_error(state, "--at and --frames are of a --variant");
    if (request->variant && request->new_kind)
        argp_error(state, "either --new or --variant");
    if (request->new_kind && (shared->operand_count == 0 || shared->json))
        argp_error(state, "--new writes a file: name it, such as my_fog.yaml (and no --json)");
    if (!request->new_kind && (request->vdb || request->force))
        argp_error(state, "--vdb and --force belong to --new");
    if (request->new_kind && (strcmp(request->new_kind, "vdb") == 0) != (request->vdb != NULL))
        argp_error(state, "--new vdb needs --vdb FILE.vdb, and no other kind has one");
}

static const struct neph_cli_operands operands = {
    .shown = "[SCENE|FILE.vdb]",
    .maximum = 1,
    .surplus = "one scene",
};

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &operands,
    .check = check,
    .doc = "List the catalogue, check and describe one scene (a file or a name), or write a new "
           "one.\v"
           "All errors of a scene file are reported at once, by their lines. A .vdb in place of a "
           "scene, here and in every verb that takes one, is a scene with that medium: a camera "
           "that sees all of it, the sun, and an extinction that is a guess, because the file does "
           "not say it. `neph scenes FILE.vdb` prints that scene as a file.\n\n"
           "Examples:\n  neph scenes\n  neph scenes two_layer_fog\n"
           "  neph scenes --new fog my_fog.yaml\n  neph scenes my_fog.yaml\n"
           "  neph scenes --new vdb my_cloud.yaml --vdb cloud.vdb\n"
           "  neph scenes my_fog.yaml --variant sun_step > my_fog_sun_step.yaml",
};

enum { CELL_SIZE = 80 };

/* ---- height fog: properties that non-physical fog models lack -------------------------------- */

static bool has_ends(const struct neph_medium *fog)
{
    const double sides[] = {fog->bounds.min_m.x, fog->bounds.min_m.y, fog->bounds.min_m.z,
                            fog->bounds.max_m.x, fog->bounds.max_m.y, fog->bounds.max_m.z};
    for (int i = 0; i < 6; i++)
        if (isfinite(sides[i]))
            return true;
    return false;
}

/* The `index`-th property of the physical fog that every non-physical fog model lacks; NULL beyond
 * the last one. */
static const char *find_missing_property(const struct neph_scene *scene,
                                         const struct neph_medium *fog, int index)
{
    const bool scatters = scene->sun.present && scene->scattering != NEPH_SCATTERING_NONE &&
                          fog->albedo.r + fog->albedo.g + fog->albedo.b > 0.0;
    const struct {
        bool is_there;
        const char *words;
    } rows[] = {
        {has_ends(fog), "bounds: the fog model fills all space"},
        {neph_medium_is_coloured(fog), "extinction_color: the fog model has one opacity"},
        {scatters, "attenuation of sunlight, and shadows in the fog: the fog model is equally "
                   "bright everywhere"},
        {scatters && fog->phase.kind != NEPH_PHASE_ISOTROPIC,
         "the phase function: the fog model has a lobe cos^e around the sun, and no "
         "backscattering"},
        {scene->scattering == NEPH_SCATTERING_MULTIPLE,
         "multiple scattering: the fog model has a given colour"},
    };
    for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++)
        if (rows[i].is_there && index-- == 0)
            return rows[i].words;
    return NULL;
}

/* ---- height fog, as text --------------------------------------------------------------------- */

static void print_row(const char *name, const char *physical, const char *unreal,
                      const char *filament)
{
    printf("  %-26s %-22s %-22s %s\n", name, physical, unreal, filament);
}

static const char *written(char cell[CELL_SIZE], const char *format, ...)
    __attribute__((format(printf, 2, 3)));

static const char *written(char cell[CELL_SIZE], const char *format, ...)
{
    va_list values;
    va_start(values, format);
    vsnprintf(cell, CELL_SIZE, format, values);
    va_end(values);
    return cell;
}

static void print_layer(const struct neph_fog_layer *layer, int index)
{
    const struct neph_unreal_fog unreal = neph_fog_layer_to_unreal(layer);
    char name[CELL_SIZE], physical[CELL_SIZE], theirs[CELL_SIZE], filament[CELL_SIZE];
    print_row(written(name, "layer %d: density", index),
              written(physical, "%.6g /m", layer->extinction_per_m),
              written(theirs, "%.6g", unreal.fog_density),
              index > 0 ? "(it has one layer)"
                        : written(filament, "%.6g /m", layer->extinction_per_m));
    print_row("  falloff", written(physical, "%.6g /m", layer->falloff_per_m),
              written(theirs, "%.6g", unreal.fog_height_falloff),
              index > 0 ? "" : written(filament, "%.6g /m", layer->falloff_per_m));
    print_row("  height", written(physical, "%.6g m", layer->height_m),
              written(theirs, "%.6g cm", 100.0 * layer->height_m),
              index > 0 ? "" : written(filament, "%.6g m", layer->height_m));
}

static const char *written_values(char cell[CELL_SIZE], const double *values, int count)
{
    return count == 3 ? written(cell, "%.4g %.4g %.4g", values[0], values[1], values[2])
                      : written(cell, "%.6g", values[0]);
}

/* Print the controls of the fog model, with the names of both engines: the values that follow from
 * the physics beside the values of the scene. */
static void print_look(const struct neph_scene *scene, const struct neph_fog_look *physics)
{
    const struct neph_fog_look *look = &scene->fog_look;
    char physical[CELL_SIZE], set[CELL_SIZE];
    print_row("inscattering", written_values(physical, &physics->inscattering_w_per_m2_sr.r, 3),
              written_values(set, &look->inscattering_w_per_m2_sr.r, 3), set);
    for (int c = 0; c < NEPH_FOG_CONTROL_COUNT; c++) {
        const struct neph_fog_control_row *row = &neph_fog_controls()[c];
        const double *values = (const double *)((const char *)look + row->at);
        const double *thin = (const double *)((const char *)physics + row->at);
        const bool is_known = neph_fog_control_is_on(physics, (enum neph_fog_control)c);
        written_values(set, values, row->count);
        print_row(row->name, is_known ? written_values(physical, thin, row->count) : "-",
                  neph_fog_control_is_on(look, (enum neph_fog_control)c) ? set : "off",
                  !row->filament                                           ? "(has none)"
                  : neph_fog_control_is_on(look, (enum neph_fog_control)c) ? set
                                                                           : "off");
    }
    print_row("directional_exponent",
              neph_fog_control_is_on(physics, NEPH_FOG_DIRECTIONAL)
                  ? written_values(physical, &physics->directional_exponent, 1)
                  : "-",
              written_values(set, &look->directional_exponent, 1), set);
}

static void print_departures(const struct neph_fog_look *look)
{
    printf("  controls of the fog model without a counterpart in the medium:\n");
    for (int c = 0; c < NEPH_FOG_CONTROL_COUNT; c++)
        if (neph_fog_control_is_on(look, (enum neph_fog_control)c))
            printf("    %s (%s): %s\n", neph_fog_controls()[c].name, neph_fog_controls()[c].unreal,
                   neph_fog_controls()[c].physics);
}

static void print_fog(const struct neph_scene *scene)
{
    const struct neph_medium *fog = neph_fog_look_find_medium(scene);
    if (!fog)
        return;
    const struct neph_fog_look physics = neph_fog_look_from_physics(scene, fog);
    printf("height fog\n");
    print_row("", "physical", "Unreal", "Filament");
    for (int l = 0; l < fog->layer_count; l++)
        print_layer(&fog->layers[l], l);
    if (scene->fog_look.present) {
        print_look(scene, &physics);
        print_departures(&scene->fog_look);
    }
    if (find_missing_property(scene, fog, 0))
        printf("  properties of the medium without a counterpart in the fog model:\n");
    for (int i = 0; find_missing_property(scene, fog, i); i++)
        printf("    %s\n", find_missing_property(scene, fog, i));
}

/* ---- height fog, as JSON --------------------------------------------------------------------- */

static json_t *values_json(const double *values, int count)
{
    return count == 3 ? json_pack("[f, f, f]", values[0], values[1], values[2])
                      : json_real(values[0]);
}

static json_t *control_json(const struct neph_fog_look *look, enum neph_fog_control control)
{
    const struct neph_fog_control_row *row = &neph_fog_controls()[control];
    const double *values = (const double *)((const char *)look + row->at);
    return json_pack("{s:s, s:s, s:o, s:b, s:s, s:s?, s:s}", "name", row->name, "key", row->key,
                     "value", values_json(values, row->count), "on",
                     neph_fog_control_is_on(look, control), "unreal", row->unreal, "filament",
                     row->filament, "physics", row->physics);
}

static json_t *look_json(const struct neph_fog_look *look)
{
    if (!look->present)
        return json_null();
    json_t *controls = json_array();
    for (int c = 0; c < NEPH_FOG_CONTROL_COUNT; c++)
        neph_json_add(&controls, control_json(look, (enum neph_fog_control)c));
    return json_pack("{s:o, s:f, s:o}", "inscattering_w_per_m2_sr",
                     values_json(&look->inscattering_w_per_m2_sr.r, 3), "directional_exponent",
                     look->directional_exponent, "controls", controls);
}

static json_t *fog_json(const struct neph_scene *scene)
{
    const struct neph_medium *fog = neph_fog_look_find_medium(scene);
    if (!fog)
        return json_null();
    const struct neph_fog_look physics = neph_fog_look_from_physics(scene, fog);
    json_t *lost = json_array();
    for (int i = 0; find_missing_property(scene, fog, i); i++)
        neph_json_add(&lost, json_string(find_missing_property(scene, fog, i)));
    return json_pack("{s:o, s:{s:o, s:o, s:f}, s:o}", "look", look_json(&scene->fog_look),
                     "of_physics", "inscattering_w_per_m2_sr",
                     values_json(&physics.inscattering_w_per_m2_sr.r, 3), "directional_w_per_m2_sr",
                     values_json(&physics.directional_w_per_m2_sr.r, 3), "directional_exponent",
                     physics.directional_exponent, "lost_in_looks", lost);
}

/* ---- a scene --------------------------------------------------------------------------------- */

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
                     neph_failing_reference_name(failing->truth), "quick", failing->quick,
                     "engines", failing->engines, "measures", limits_json(failing), "points",
                     points_json(failing));
}

/* Indexed by enum neph_mesh_inside. */
static const char *const mesh_insides[NEPH_MESH_INSIDE_COUNT] = {
    [NEPH_MESH_OPEN] = "with a boundary",
    [NEPH_MESH_EVEN] = "closed, without one outside",
    [NEPH_MESH_ORIENTED] = "closed"};

static json_t *meshes_json(const struct neph_scene *scene)
{
    json_t *meshes = json_array();
    for (int i = 0; i < scene->mesh_count; i++)
        neph_json_add(&meshes, json_pack("{s:i, s:i, s:s}", "triangles",
                                         scene->meshes[i]->data.triangle_count, "left_out",
                                         scene->meshes[i]->dropped_count, "inside",
                                         mesh_insides[scene->meshes[i]->inside]));
    return meshes;
}

static void print_meshes(const struct neph_scene *scene)
{
    for (int i = 0; i < scene->mesh_count; i++) {
        const struct neph_mesh *mesh = scene->meshes[i];
        printf("mesh %-2d     %d triangles, %s; left out for having no area: %d\n", i,
               mesh->data.triangle_count, mesh_insides[mesh->inside], mesh->dropped_count);
    }
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
        const bool can = neph_engine_can_render(list[i], scene, &settings, reason, sizeof(reason));
        neph_json_add(&engines, json_pack("{s:s, s:b, s:s}", "engine", list[i]->name, "can_render",
                                          can, "reason", reason));
    }
    return json_pack("{s:s, s:s, s:s, s:s, s:s, s:i, s:i, s:o, s:i, s:o, s:o, s:o, s:o, s:o, s:o}",
                     "name", scene->name, "title", scene->title, "physics", scene->description,
                     "hash", scene->hash, "scattering", neph_scattering_name(scene->scattering),
                     "frames", scene->frame_count, "solids", scene->solid_count, "meshes",
                     meshes_json(scene), "gates", neph_scene_gates(scene)->count, "layers", layers,
                     "phases", neph_phases_json(scene), "densities", neph_densities_json(scene),
                     "fog", fog_json(scene), "failure", failing_json(scene->failing), "engines",
                     engines);
}

static void print_failing(const struct neph_failing *failing)
{
    if (!failing->fails)
        return;
    printf("fails       %s\nknown       %s\nsymptom     %s\n"
           "judged      %dx%d px, %d frames, %d steps, against %s, presets %s%s, tier %s\n",
           failing->fails, failing->known, failing->symptom, failing->width_px, failing->height_px,
           failing->frame_count, failing->steps, neph_failing_reference_name(failing->truth),
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
    printf("%s: %s\n\n%s%shash        %s\nscattering  %s\nframes      %d\nsolids      %d\n",
           scene->name, scene->title, scene->description, scene->description[0] ? "\n\n" : "",
           scene->hash, neph_scattering_name(scene->scattering), scene->frame_count,
           scene->solid_count);
    print_meshes(scene);
    for (int m = 0; m < scene->medium_count; m++)
        for (int l = 0; l < scene->media[m].layer_count; l++) {
            const struct neph_fog_layer *layer = &scene->media[m].layers[l];
            const struct neph_unreal_fog unreal = neph_fog_layer_to_unreal(layer);
            printf("medium %d    extinction %g /m, falloff %g /m, height %g m"
                   " (Unreal: density %g, falloff %g)\n",
                   m, layer->extinction_per_m, layer->falloff_per_m, layer->height_m,
                   unreal.fog_density, unreal.fog_height_falloff);
        }
    neph_print_phases(scene);
    neph_print_densities(scene);
    print_fog(scene);
    print_failing(scene->failing);
    int count;
    const struct neph_engine *const *engines = neph_engines(&count);
    for (int i = 0; i < count; i++) {
        char reason[512];
        const struct neph_settings settings = neph_settings_default(engines[i]);
        if (neph_engine_can_render(engines[i], scene, &settings, reason, sizeof(reason)))
            printf("%-11s can\n", engines[i]->name);
        else
            printf("%-11s cannot: %s\n", engines[i]->name, reason);
    }
}

/* ---- the catalogue --------------------------------------------------------------------------- */

/* List the scenes of a folder: one line, or one entry of `list`, for each scene. */
static enum neph_status list_folder(enum neph_data_scenes folder, bool as_json, json_t *list,
                                    struct neph_diag *diag)
{
    char **names = NULL;
    int count = 0;
    enum neph_status status = neph_data_list_scenes(folder, &names, &count, diag);
    for (int i = 0; i < count && !status; i++) {
        struct neph_scene *scene = NULL;
        status = neph_data_load_scene(names[i], &scene, diag);
        if (!status && as_json)
            status = neph_json_append(list, scene_json(scene), diag);
        else if (!status)
            printf("%-24s %s\n", scene->name, scene->title);
        neph_scene_destroy(scene);
        if (status != NEPH_ERR_NOT_FOUND)
            continue;
        const struct neph_diag why = *diag; /* the scene's data is not installed */
        *diag = (struct neph_diag){.line = 0};
        status = NEPH_OK;
        if (as_json)
            status = neph_json_append(
                list,
                json_pack("{s:o, s:s}", "name", neph_json_cleaned(names[i]), "absent", why.message),
                diag);
        else
            printf("%-24s not here: %s\n", names[i], why.message);
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

static enum neph_status print_variant(const struct request *request, const struct neph_scene *scene,
                                      struct neph_diag *diag)
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

/* ---- the verb -------------------------------------------------------------------------------- */

static enum neph_status write_new(const struct request *request, struct neph_diag *diag)
{
    const struct neph_new_scene new_scene = {.kind = request->new_kind,
                                             .path = request->shared.operands[0],
                                             .vdb = request->vdb,
                                             .may_overwrite = request->force};
    const enum neph_status status = neph_new_scene_write(&new_scene, diag);
    if (!status && !request->shared.quiet)
        printf("%s: written; `neph scenes %s` checks it, `neph render %s` renders it\n",
               new_scene.path, new_scene.path, new_scene.path);
    return status;
}

static enum neph_status show_scene(const struct request *request, struct neph_diag *diag)
{
    const char *name = request->shared.operands[0];
    if (neph_is_volume_scene(name) && !request->variant && !request->shared.json)
        return neph_new_scene_print(name, diag);
    struct neph_scene *scene = NULL;
    enum neph_status status = neph_data_load_scene(name, &scene, diag);
    if (!status && request->variant)
        status = print_variant(request, scene, diag);
    else if (!status && request->shared.json)
        status = neph_json_print(scene_json(scene), diag);
    else if (!status)
        print_scene(scene);
    neph_scene_destroy(scene);
    return status;
}

enum neph_status neph_cli_scenes(int argc, char **argv, struct neph_diag *diag)
{
    struct request request = {0};
    neph_cli_parse(&syntax, argc, argv, &request);
    const bool as_json = request.shared.json;
    if (request.new_kind)
        return write_new(&request, diag);
    if (request.shared.operand_count > 0)
        return show_scene(&request, diag);
    enum neph_status status = NEPH_OK;
    json_t *list = json_array();
    for (int folder = 0; folder < NEPH_DATA_SCENES_COUNT && !status; folder++)
        status = list_folder((enum neph_data_scenes)folder, as_json, list, diag);
    const enum neph_status printed = neph_cli_print_json(list, !status && as_json, diag);
    return status ? status : printed;
}
