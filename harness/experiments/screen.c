/* SPDX-License-Identifier: MIT
 *
 * `neph study screen [SCENE...]`: screen-space passes on a G-buffer against engine surfaces
 * (screen.h).
 */
#include "harness/experiments/screen.h"

#include "base/files.h"
#include "base/path.h"
#include "harness/data.h"
#include "harness/document/table.h"
#include "harness/experiments/experiments.h"
#include "renderer/screen/options.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define AT(member) .at = offsetof(struct neph_screen_request, member)
static const struct neph_cli_option options[] = {
    {"model", 0, NULL, "Screens to compare with the truth; screen+KEY=VALUE+... changes one",
     NEPH_CLI_LIST, AT(models), "screen", .between = ",screen+preset=",
     .presets = neph_screen_presets, .uses = NEPH_SCREEN_STUDY, .maximum = NEPH_LIGHT_MODELS_MAX},
    {"radius", 0, "M", "Ambient occlusion: largest distance of an occluder [m]", NEPH_CLI_REAL,
     AT(radius_m), "1", 1e-3, 1e6},
    {.name = "size", .otherwise = "192x108"},
    {"samples", 0, NULL, "Samples a pixel of the truth", NEPH_CLI_INTEGER, AT(samples), "256", 2,
     1 << 24},
    {"rays", 0, "N", "Rays a pixel, to say why it is lost", NEPH_CLI_INTEGER, AT(rays), "64", 1,
     1 << 16},
    {"cycles", 0, "N", "Compare with the passes of Cycles, too, with N samples a pixel; 0: do not",
     NEPH_CLI_INTEGER, AT(cycles_samples), "0", 0, 1 << 16},
    {"frames", 0, NULL,
     "Pictures, over which error and flicker of the whole are measured, at least 16; a scene that "
     "moves has as many as it has; 0: none",
     NEPH_CLI_INTEGER, AT(frame_count), "0", 0, 1024},
    {.name = "jobs", .otherwise = "1"},
    {.name = "output", .help = "Folder of the store and of screen/", .otherwise = "out/study"},
    {.name = "all", .help = "The tables of all scenes and models"},
    {.name = "json", .help = "All numbers as JSON on stdout"},
    {.name = "markdown"},
    {.name = "quiet"},
    {.name = NULL},
};
#undef AT

static const struct neph_cli_operands operands = {
    .shown = "[SCENE...]", .maximum = NEPH_SCREEN_SCENES_MAX, .surplus = "so many scenes"};

static void check(const void *request_, const struct argp_state *state)
{
    const struct neph_screen_request *request = request_;
    if (request->frame_count > 0 && request->frame_count < 16)
        argp_error(state, "--frames=%d: flicker wants 16 frames or more, 0 is none",
                   request->frame_count);
}

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &operands,
    .check = check,
    .doc = "Render solids with screen-space passes on a G-buffer, and print how far ambient "
           "occlusion, indirect light and reflections are from the truth (engine surfaces): the "
           "error of the method, and the part that no screen-space method can know because it is "
           "outside the frame or hidden. Without a SCENE: the surface_ scenes of the "
           "catalogue.\vFinished frames stay in DIR/store, and the same command continues from "
           "there. DIR/screen/index.html shows the pixels that no screen-space method can know, "
           "and the reason.\n\n"
           "Examples:\n"
           "  neph study screen --markdown screen.md\n"
           "  neph study screen surface_corner --model screen,screen+preset=ours --radius 2\n"
           "  neph study screen surface_room --model screen+preset=ours,screen+preset=fast\n"
           "  neph study screen --cycles 256\n"
           "  neph study screen surface_ground --frames 32 --model "
           "screen,screen+gi=off,screen+ssr=off",
};

static const char *const usual_scenes[] = {"surface_step",   "surface_corner", "surface_room",
                                           "surface_ground", "surface_mirror", "surface_rough"};

static enum neph_status load_scenes(struct neph_screen_request *request, struct neph_diag *diag)
{
    const int given = request->shared.operand_count;
    const int wanted = given > 0 ? given : (int)(sizeof(usual_scenes) / sizeof(usual_scenes[0]));
    const char *const *names = given > 0 ? request->shared.operands : usual_scenes;
    enum neph_status status = NEPH_OK;
    for (int *count = &request->scene_count; *count < wanted && !status; *count += !status)
        status = neph_data_load_scene(names[*count], &request->scenes[*count], diag);
    return status;
}

static enum neph_status prepare(void *request_, struct neph_diag *diag)
{
    struct neph_screen_request *request = request_;
    const enum neph_status status = load_scenes(request, diag);
    return status
               ? status
               : neph_screen_page_claim(neph_path_in(request->shared.output, "screen").text, diag);
}

static void finish(void *request_)
{
    struct neph_screen_request *request = request_;
    for (int i = 0; i < request->scene_count; i++)
        neph_scene_destroy(request->scenes[i]);
}

/* A job for each scene. */
static bool part(void *request_, int index)
{
    struct neph_screen_request *request = request_;
    if (index >= request->scene_count)
        return false;
    request->scenes[0] = request->scenes[index];
    request->scene_count = 1;
    request->is_part = true;
    return true;
}

/* ---- tables ---------------------------------------------------------------------------------- */

#define AT(member) offsetof(struct neph_screen_gap, member)
static const struct neph_field gap_fields[] = {
    {{"error", "error", "%.2f", 100.0, .none = ""}, AT(error)},
    {{"bias", "bias", "%.2f", 100.0, .none = ""}, AT(bias)},
    {{"own", "against the visible part", "%.2f", 100.0, .none = ""}, AT(own)},
    {{"known", "known pixels", "%.2f", 100.0, .none = ""}, AT(known_error)},
    {{"lost", "lost pixels", "%.2f", 100.0, .none = ""}, AT(lost_error)},
};
#undef AT
#define AT(member) offsetof(struct neph_post_numbers, member)
static const struct neph_field flicker_fields[] = {
    {{"ms", "ms", .format = "%.3g"}, AT(ms)},
    {{"error", "error", "%.2f", 100.0, .none = ""}, AT(scene_error)},
    {{"change", "its change", "%.2f", 100.0, .none = ""}, AT(scene_change)},
    {{"flip", "FLIP", .format = "%.4f"}, AT(flip)},
    {{"seen", "flicker seen", .format = "%.2f"}, AT(seen)},
    {{"seen_share", "share [%]", "%.2f", 100.0, .none = ""}, AT(seen_share)},
    {{.key = "luma_change"}, AT(luma_change)},
};
#undef AT
enum {
    GAP_FIELDS = sizeof(gap_fields) / sizeof(gap_fields[0]),
    FLICKER_FIELDS = sizeof(flicker_fields) / sizeof(flicker_fields[0]),
};
static const struct neph_column name_columns[] = {{.title = "scene"}, {.title = ""}};

static void add_names(struct neph_table *table, const char *scene, const char *model)
{
    neph_table_word(table, scene);
    neph_table_word(table, model);
}

static void add_truth(struct neph_table *table, const struct neph_screen_truth *truth)
{
    neph_table_numbers(table, 4, (const double[]){truth->beyond, NAN, NAN, truth->noise});
    neph_table_shown(table, "noise %.2f", 100.0 * truth->noise);
    neph_table_number(table, truth->lost);
    neph_table_shown(table, "lost %.0f %% of %d px: %d off, %d behind, %d thin, %d else",
                     100.0 * truth->lost / truth->pixels, truth->pixels,
                     truth->lost_by[NEPH_LOST_OFF], truth->lost_by[NEPH_LOST_BEHIND],
                     truth->lost_by[NEPH_LOST_THIN], truth->lost_by[NEPH_SCREEN_LOSSES]);
}

static void print_part(const struct neph_screen_study *study, int part,
                       struct neph_publication *publication)
{
    const struct neph_screen_request *request = study->request;
    struct neph_table table = {.cells = NULL};
    neph_table_columns(&table, name_columns, 2);
    neph_table_fields(&table, gap_fields, GAP_FIELDS);
    for (int s = 0; s < request->scene_count; s++) {
        const struct neph_screen_scene *scene = &study->scenes[s];
        if (scene->truths[part].pixels == 0)
            continue;
        add_names(&table, request->scenes[s]->name, "*no model can*");
        add_truth(&table, &scene->truths[part]);
        for (int m = 0; m < request->models.count; m++) {
            add_names(&table, request->scenes[s]->name, request->models.words[m]);
            neph_table_field_cells(&table, gap_fields, GAP_FIELDS, &scene->gaps[m][part]);
        }
    }
    fprintf(publication->text, "\n**%s** [%% of %s]\n\n", neph_screen_part_names[part],
            part == NEPH_SCREEN_AO ? "the hemisphere" : "all such light");
    neph_publication_table(publication, &table);
}

static void print_losses(const struct neph_screen_study *study,
                         struct neph_publication *publication)
{
    static const struct neph_column columns[] = {
        {.title = "scene"},
        {.title = "as far as", .format = "%s"},
        {.title = "meets surfaces outside the frame", .format = "%.2f", .scale = 100.0},
        {.title = "meets hidden surfaces", .format = "%.2f", .scale = 100.0},
        {.title = "passes behind something thin", .format = "%.2f", .scale = 100.0},
    };
    char radius[32];
    struct neph_table table = {.cells = NULL};
    snprintf(radius, sizeof(radius), "%g m", study->request->radius_m);
    neph_table_columns(&table, columns, 2 + NEPH_SCREEN_LOSSES);
    for (int s = 0; s < study->request->scene_count; s++)
        for (int far = 0; far < 2; far++) {
            const struct neph_screen_scene *scene = &study->scenes[s];
            add_names(&table, study->request->scenes[s]->name, far ? "all the way" : radius);
            neph_table_numbers(&table, NEPH_SCREEN_LOSSES, far ? scene->far : scene->near);
        }
    fprintf(publication->text, "\n"
                               "**Why** [%% of the hemisphere over surfaces in the frame]\n"
                               "\n");
    neph_publication_table(publication, &table);
}

/* Error and bias of all parts. */
static void add_cycles_row(struct neph_table *table, const char *scene, const char *model,
                           const struct neph_screen_gap gaps[NEPH_SCREEN_PARTS])
{
    add_names(table, scene, model);
    for (int part = 0; part < NEPH_SCREEN_PARTS; part++)
        neph_table_field_cells(table, gap_fields, 2, &gaps[part]);
}

static void print_cycles(const struct neph_screen_study *study,
                         struct neph_publication *publication)
{
    const struct neph_screen_request *request = study->request;
    struct neph_table table = {.cells = NULL};
    neph_table_columns(&table, name_columns, 2);
    for (int part = 0; part < NEPH_SCREEN_PARTS; part++) {
        char title[64];
        struct neph_field fields[2] = {gap_fields[0], gap_fields[1]};
        snprintf(title, sizeof(title), "%s: error", neph_screen_part_names[part]);
        fields[0].column.title = title;
        neph_table_fields(&table, fields, 2);
    }
    for (int s = 0; s < request->scene_count; s++) {
        const struct neph_screen_scene *scene = &study->scenes[s];
        const char *name = request->scenes[s]->name;
        if (scene->cycles_cannot[0]) {
            add_names(&table, name, "");
            neph_table_shown(&table, "*it cannot: %s*", scene->cycles_cannot);
            neph_table_end_row(&table);
            continue;
        }
        add_cycles_row(&table, name, "*cycles against surfaces*", scene->cycles);
        for (int m = 0; m < request->models.count; m++)
            add_cycles_row(&table, name, request->models.words[m], scene->against_cycles[m]);
    }
    fprintf(publication->text, "\n**Against Cycles** [%%, as above], %d samples\n\n",
            request->cycles_samples);
    neph_publication_table(publication, &table);
}

static void print_flicker(const struct neph_screen_study *study,
                          struct neph_publication *publication)
{
    static const struct neph_column frames = {.title = "frames", .format = "%ld"};
    const struct neph_screen_request *request = study->request;
    struct neph_table table = {.cells = NULL};
    neph_table_columns(&table, name_columns, 2);
    neph_table_column(&table, frames);
    neph_table_fields(&table, flicker_fields + 1, FLICKER_FIELDS - 1);
    neph_table_fields(&table, flicker_fields, 1); /* the first column of the JSON */
    for (int s = 0; s < request->scene_count; s++)
        for (int m = 0; m < request->models.count; m++) {
            const struct neph_post_numbers *numbers = &study->flicker[s][m];
            add_names(&table, request->scenes[s]->name, request->models.words[m]);
            neph_table_count(&table, study->scenes[s].frame_count);
            neph_table_field_cells(&table, flicker_fields + 1, FLICKER_FIELDS - 1, numbers);
            neph_table_field_cells(&table, flicker_fields, 1, numbers);
        }
    fprintf(publication->text, "\n"
                               "**Over frames**, the frame against engine surfaces: light over its "
                               "mean [%%]; on a display by Unreal's curve FLIP,\n"
                               "flicker seen over threshold, share of pixels where it is seen; "
                               "milliseconds of the passes\n"
                               "\n");
    neph_publication_table(publication, &table);
}

static void print_text(const struct neph_screen_study *study, struct neph_publication *publication)
{
    const struct neph_screen_request *request = study->request;
    fprintf(publication->text,
            "neph %s, against surfaces with %d samples, %dx%d, ambient occlusion within %g m.\n"
            "Errors are mean and absolute, light times the colour of its surface. A pixel is lost "
            "where the visible part of\n"
            "its truth differs by more than %g %% (of the hemisphere, %g %%).\n",
            NEPH_VERSION, request->samples, request->shared.size.width_px,
            request->shared.size.height_px, request->radius_m, 100.0 * NEPH_SCREEN_LOST,
            50.0 * NEPH_SCREEN_LOST);
    for (int part = 0; part < NEPH_SCREEN_PARTS; part++)
        print_part(study, part, publication);
    print_losses(study, publication);
    if (request->cycles_samples > 0)
        print_cycles(study, publication);
    if (request->frame_count > 0)
        print_flicker(study, publication);
}

/* ---- JSON ------------------------------------------------------------------------------------ */

/* One part of all models. */
static json_t *gaps_json(const struct neph_screen_study *study,
                         const struct neph_screen_gap (*gaps)[NEPH_SCREEN_PARTS], int part)
{
    json_t *models = json_object();
    for (int m = 0; m < study->request->models.count; m++)
        neph_json_set(&models, study->request->models.words[m],
                      neph_fields_json(json_object(), gap_fields, GAP_FIELDS, &gaps[m][part]));
    return models;
}

static json_t *part_json(const struct neph_screen_study *study,
                         const struct neph_screen_scene *scene, int part)
{
    const struct neph_screen_truth *truth = &scene->truths[part];
    return json_pack("{s:i, s:i, s:{s:i, s:i, s:i, s:i}, s:o, s:o, s:o}", "pixels", truth->pixels,
                     "lost", truth->lost, "lost_by", "off", truth->lost_by[NEPH_LOST_OFF], "behind",
                     truth->lost_by[NEPH_LOST_BEHIND], "thin", truth->lost_by[NEPH_LOST_THIN],
                     "else", truth->lost_by[NEPH_SCREEN_LOSSES], "noise",
                     neph_json_number(truth->noise), "beyond", neph_json_number(truth->beyond),
                     "models", gaps_json(study, scene->gaps, part));
}

static json_t *flicker_json(const struct neph_screen_study *study, int s)
{
    const int frame_count = study->scenes[s].frame_count;
    json_t *models = json_object();
    for (int m = 0; m < study->request->models.count && frame_count > 0; m++)
        neph_json_set(
            &models, study->request->models.words[m],
            neph_fields_json(json_object(), flicker_fields, FLICKER_FIELDS, &study->flicker[s][m]));
    return json_pack("{s:i, s:o}", "frames", frame_count, "models", models);
}

static json_t *losses_json(const double shares[NEPH_SCREEN_LOSSES])
{
    return json_pack("{s:f, s:f, s:f}", "off", shares[NEPH_LOST_OFF], "behind",
                     shares[NEPH_LOST_BEHIND], "thin", shares[NEPH_LOST_THIN]);
}

static json_t *scene_json(const struct neph_screen_study *study, int s)
{
    const struct neph_screen_scene *scene = &study->scenes[s];
    json_t *found = json_object(), *cycles = json_object();
    for (int part = 0; part < NEPH_SCREEN_PARTS; part++) {
        neph_json_set(&found, neph_screen_part_names[part], part_json(study, scene, part));
        neph_json_set(
            &cycles, neph_screen_part_names[part],
            json_pack("{s:o, s:o}", "cycles",
                      neph_fields_json(json_object(), gap_fields, GAP_FIELDS, &scene->cycles[part]),
                      "models", gaps_json(study, scene->against_cycles, part)));
    }
    neph_json_set(&found, "against_cycles", cycles);
    neph_json_set(&found, "over_frames", flicker_json(study, s));
    neph_json_set(&found, "near", losses_json(scene->near));
    neph_json_set(&found, "far", losses_json(scene->far));
    return found;
}

/* ---- the answer ------------------------------------------------------------------------------ */

/* Mean error of a part over the scenes that have it; NaN: none. `model` -1: the error that no model
 * can avoid. */
static double mean_error(const struct neph_screen_study *study, int part, int model, int *count)
{
    double sum = 0.0;
    *count = 0;
    for (int s = 0; s < study->request->scene_count; s++) {
        const struct neph_screen_scene *scene = &study->scenes[s];
        const double error = model < 0 ? scene->truths[part].beyond
                                       : scene->gaps[model][part].error;
        if (scene->truths[part].pixels == 0 || isnan(error))
            continue;
        sum += error;
        ++*count;
    }
    return *count > 0 ? sum / *count : NAN;
}

/* The model with the smallest error in a part; -1: none was measured. */
static int best_model(const struct neph_screen_study *study, int part)
{
    int best = -1, count;
    for (int m = 0; m < study->request->models.count; m++) {
        const double error = mean_error(study, part, m, &count);
        if (isfinite(error) && (best < 0 || error < mean_error(study, part, best, &count)))
            best = m;
    }
    return best;
}

static void answer(const struct neph_screen_study *study, struct neph_answer *answer)
{
    char verdict[600] = "nearest to surfaces:";
    int count;
    for (int part = 0; part < NEPH_SCREEN_PARTS; part++) {
        const int best = best_model(study, part);
        const size_t used = strlen(verdict);
        if (best >= 0)
            snprintf(verdict + used, sizeof(verdict) - used, "%s %s: %.80s, error %.2f %%",
                     used > strlen("nearest to surfaces:") ? ";" : "", neph_screen_part_names[part],
                     study->request->models.words[best],
                     100.0 * mean_error(study, part, best, &count));
    }
    neph_answer_add(answer, "%s; means over %d scene%s, no interval", verdict,
                    study->request->scene_count, study->request->scene_count == 1 ? "" : "s");
    for (int part = 0; part < NEPH_SCREEN_PARTS; part++) {
        const double beyond = mean_error(study, part, -1, &count);
        if (count > 0)
            neph_answer_add(answer, "%s: no model can know %.2f %% (mean of %d scenes)",
                            neph_screen_part_names[part], 100.0 * beyond, count);
    }
    for (int s = 0; s < study->request->scene_count && study->request->cycles_samples > 0; s++)
        if (study->scenes[s].cycles_cannot[0])
            neph_answer_add(answer, "cycles: %s: %.200s", study->request->scenes[s]->name,
                            study->scenes[s].cycles_cannot);
}

/* ---- the run --------------------------------------------------------------------------------- */

static void write_results(const struct neph_screen_study *study,
                          struct neph_publication *publication)
{
    const struct neph_screen_request *request = study->request;
    json_t *scenes = json_object();
    if (publication->text)
        print_text(study, publication);
    answer(study, &publication->answer);
    for (int s = 0; s < request->scene_count; s++)
        neph_json_set(&scenes, request->scenes[s]->name, scene_json(study, s));
    publication->json = json_pack("{s:f, s:i, s:o}", "radius_m", request->radius_m, "samples",
                                  request->samples, "scenes", scenes);
}

static enum neph_status run(void *request_, const struct neph_experiment_run *run,
                            struct neph_publication *publication, struct neph_diag *diag)
{
    const struct neph_screen_request *request = request_;
    struct neph_screen_study *study = calloc(1, sizeof(*study));
    if (!study)
        return neph_fail_memory(diag);
    study->request = request;
    study->run = run;
    enum neph_status status = neph_screen_measure(study, diag);
    if (!status && !request->is_part)
        status = neph_screen_page_write(study, neph_path_in(study->run->output, "screen").text,
                                        diag);
    if (!status && !request->is_part)
        write_results(study, publication);
    neph_arena_finish(&study->arena);
    free(study);
    return status;
}

static const char *const files[] = {"screen/index.html", NULL};

const struct neph_experiment neph_experiment_screen = {
    .syntax = &syntax,
    .files = files,
    .request_size = sizeof(struct neph_screen_request),
    .prepare = prepare,
    .part = part,
    .run = run,
    .finish = finish};
