/* SPDX-License-Identifier: MIT
 *
 * `neph study fog SCENE`: the error of each control of a scene's fog_look against engine exact.
 */
#include "harness/experiments/experiments.h"

#include "harness/data.h"
#include "harness/document/table.h"
#include "harness/study/fog_study.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct request {
    struct neph_cli_shared shared; /* operand: the scene */
    struct neph_cli_list models;
    struct neph_fog_study_params study;
    struct neph_scene *scene; /* owned */
};

static const struct neph_cli_option options[] = {
    {.name = "size", .otherwise = "192x108"},
    {"model", 0, NULL, "unreal or filament (default: all that know the scene's fog)",
     NEPH_CLI_NAMES, .at = offsetof(struct request, models)},
    {"directions", 0, "N", "Over the sphere around the camera", NEPH_CLI_INTEGER,
     .at = offsetof(struct request, study.directions), "4096", 16, 1 << 20},
    {.name = "all", .help = "The table of all controls"},
    {.name = "json", .help = "All numbers as JSON on stdout"},
    {.name = "quiet", .help = "Accepted; there is no progress"},
    {.name = "csv", .help = "A line for each row"},
    {.name = "markdown", .help = "The table into a file, too"},
    {.name = "quiet"},
    {.name = NULL},
};

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &neph_cli_one_scene,
    .doc = "Switch on each control of a scene's fog_look by itself, in the formulas of Unreal "
           "Engine and of Filament, and print its error against engine exact: transmittance and "
           "radiance of the frame, light that the control adds or removes over the sphere of "
           "directions around the camera, and the discontinuities over distance.\vRow `none` has "
           "all controls off. Row `of physics` has the look that matches the medium and the sun "
           "where the fog is thin. All numbers are computed in double precision on the CPU.\n\n"
           "Examples:\n"
           "  neph study fog fog_look_evening\n"
           "  neph study fog my_fog.yaml --model filament --markdown fog.md --csv fog.csv",
};

/* `*model` is -1 for all models. */
_Static_assert(NEPH_FOG_MODEL_COUNT == 2, "two different names are all models");

static enum neph_status read_models(const struct neph_cli_list *names, int *model,
                                    struct neph_diag *diag)
{
    *model = -1;
    for (int i = 0; i < names->count; i++) {
        int m = 0;
        while (m < NEPH_FOG_MODEL_COUNT && strcmp(names->words[i], neph_fog_model_words[m]) != 0)
            m++;
        if (m == NEPH_FOG_MODEL_COUNT) {
            neph_fail(diag, NEPH_ERR_USAGE, "--model: there is no model '%s'", names->words[i]);
            neph_hint(diag, "unreal or filament");
            return NEPH_ERR_USAGE;
        }
        *model = names->count == 1 ? m : -1;
    }
    return NEPH_OK;
}

static enum neph_status prepare(void *request_, struct neph_diag *diag)
{
    struct request *request = request_;
    struct neph_fog_study_params *study = &request->study;
    study->width_px = request->shared.size.width_px;
    study->height_px = request->shared.size.height_px;
    enum neph_status status = read_models(&request->models, &study->model, diag);
    if (!status)
        status = neph_data_load_scene(request->shared.operands[0], &request->scene, diag);
    study->scene = request->scene;
    return status;
}

static void finish(void *request)
{
    neph_scene_destroy(((struct request *)request)->scene);
}

/* ---- results --------------------------------------------------------------------------------- */

#define AT(member) offsetof(struct neph_fog_row, member)
static const struct neph_field numbers[] = {
    {{"transmittance_bias", "transmittance: bias", .format = "%+.4f"}, AT(transmittance_bias)},
    {{"transmittance_worst", "worst", .format = "%.4f"}, AT(transmittance_worst)},
    {{"radiance_bias", "radiance: bias, %", .format = "%+.1f", .scale = 100.0}, AT(radiance_bias)},
    {{"radiance_rms", "rms, %", .format = "%+.1f", .scale = 100.0}, AT(radiance_rms)},
    {{"fog_light", "fog's light over the sphere, %", .format = "%+.1f", .scale = 100.0},
     AT(fog_light)},
    {{.key = "all_light"}, AT(all_light)},
    {{"fog_light_alone", "by only this control", .format = "%+.1f", .scale = 100.0},
     AT(fog_light_alone)},
    {{"all_light_alone", "all light by it", .format = "%+.1f", .scale = 100.0},
     AT(all_light_alone)},
    {{"transmittance_jump", "jump of transmittance", "%g", .none = ""}, AT(transmittance_jump)},
    {{.key = "transmittance_jump_m"}, AT(transmittance_jump_m)},
    {{"light_jump", "jump of light, W/m2/sr", "%g", .none = ""}, AT(light_jump)},
    {{.key = "light_jump_m"}, AT(light_jump_m)},
    {{"lobe_over_sun", "lobe over sun", .format = "%.3f"}, AT(lobe_over_sun)},
};
#undef AT
/* End indices of the columns before each of the two discontinuities, including its size. */
enum { TO_JUMP = 9, TO_LIGHT_JUMP = 11, NUMBERS = sizeof(numbers) / sizeof(numbers[0]) };

/* Replace the text of a discontinuity that was just added. Sizes below 1e-9 are rounding errors. */
static void show_jump(struct neph_table *table, double jump, double at_m)
{
    const double least_jump = 1e-9;
    if (jump < least_jump)
        neph_table_shown(table, "-");
    else if (!isnan(jump))
        neph_table_shown(table, "%.2g at %.4g m", jump, at_m);
}

static void add_row(const char *scene, const struct neph_fog_row *row, struct neph_table *table)
{
    neph_table_word(table, scene);
    neph_table_word(table, neph_fog_model_words[row->model]);
    neph_table_word(table, row->name);
    neph_table_field_cells(table, numbers, TO_JUMP, row);
    show_jump(table, row->transmittance_jump, row->transmittance_jump_m);
    neph_table_field_cells(table, numbers + TO_JUMP, TO_LIGHT_JUMP - TO_JUMP, row);
    show_jump(table, row->light_jump, row->light_jump_m);
    neph_table_field_cells(table, numbers + TO_LIGHT_JUMP, NUMBERS - TO_LIGHT_JUMP, row);
}

static void fill(const struct neph_fog_study *study, struct neph_table *table)
{
    static const struct neph_column words[] = {
        {.key = "scene", .forms = NEPH_TABLE_CSV},
        {.key = "model", .title = "model"},
        {.key = "controls", .title = "controls"},
    };
    neph_table_columns(table, words, 3);
    neph_table_fields(table, numbers, NUMBERS);
    for (int i = 0; i < study->row_count; i++)
        add_row(study->params->scene->name, &study->rows[i], table);
}

static void print_head(const struct neph_fog_study *study, FILE *out)
{
    const struct neph_fog_study_params *params = study->params;
    fprintf(out,
            "neph %s, %s: the controls of its fog_look, each by itself, against engine exact; "
            "%dx%d pixels and %d\n"
            "directions over the sphere around the camera. Exact has a mean radiance of %.4g "
            "W/m2/sr in the frame; over the\n"
            "sphere %.4g, of which the fog's own light is %.4g.\n"
            "\n",
            NEPH_VERSION, params->scene->name, params->width_px, params->height_px,
            params->directions, study->exact_radiance, study->exact_all_light,
            study->exact_fog_light);
}

/* Sort rows by radiance error, largest first; NaN last. */
static int sort_rows(const struct neph_fog_study *study, int order[NEPH_FOG_ROWS_MAX])
{
    int count = 0;
    for (int i = 0; i < study->row_count; i++) {
        int place = count++;
        for (;
             place > 0 && study->rows[i].radiance_rms > study->rows[order[place - 1]].radiance_rms;
             place--)
            order[place] = order[place - 1];
        order[place] = i;
    }
    return count;
}

static void answer(const struct neph_fog_study *study, struct neph_answer *answer)
{
    enum { MORE = 5 };
    int order[NEPH_FOG_ROWS_MAX];
    const int count = sort_rows(study, order);
    for (int i = 0; i < count && i <= MORE; i++) {
        const struct neph_fog_row *row = &study->rows[order[i]];
        const char *model = neph_fog_model_words[row->model];
        if (i == 0)
            neph_answer_add(answer,
                            "%s, %s: the largest error of %d rows in %s: radiance %.1f %% (rms), "
                            "%+.1f %% in the mean, against exact; closed forms, no noise",
                            model, row->name, count, study->params->scene->name,
                            100.0 * row->radiance_rms, 100.0 * row->radiance_bias);
        else
            neph_answer_add(answer,
                            "%s, %s: radiance %.1f %% (rms), %+.1f %% in the mean; light of the "
                            "fog over the sphere %+.1f %%",
                            model, row->name, 100.0 * row->radiance_rms, 100.0 * row->radiance_bias,
                            100.0 * row->fog_light);
    }
}

static enum neph_status run(void *request, const struct neph_experiment_run *run,
                            struct neph_publication *publication, struct neph_diag *diag)
{
    const struct neph_fog_study_params *params = &((struct request *)request)->study;
    struct neph_table table = {.cells = NULL};
    struct neph_fog_study study;
    const enum neph_status status = neph_fog_study_run(params, &study, diag);
    (void)run;
    if (status)
        return status;
    fill(&study, &table);
    answer(&study, &publication->answer);
    if (publication->text)
        print_head(&study, publication->text);
    if (publication->csv)
        neph_table_print_csv(&table, "\r\n", publication->csv);
    publication->json = json_pack(
        "{s:s, s:s, s:s, s:[i, i], s:i, s:f, s:f, s:f, s:o}", "format", "neph-fog-study-1",
        "version", NEPH_VERSION, "scene", params->scene->name, "size_px", params->width_px,
        params->height_px, "directions", params->directions, "exact_radiance", study.exact_radiance,
        "exact_fog_light", study.exact_fog_light, "exact_all_light", study.exact_all_light, "rows",
        neph_table_json(&table));
    neph_publication_table(publication, &table);
    return NEPH_OK;
}

const struct neph_experiment neph_experiment_fog = {.syntax = &syntax,
                                                    .request_size = sizeof(struct request),
                                                    .prepare = prepare,
                                                    .run = run,
                                                    .finish = finish};
