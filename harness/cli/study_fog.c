/* SPDX-License-Identifier: MIT
 *
 * `neph study fog SCENE`.
 */
#include "harness/cli/study.h"

#include "base/files.h"
#include "harness/data.h"
#include "harness/study/fog_study_output.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct request {
    struct neph_cli_shared shared; /* operand: the scene */
    const char *model, *csv, *markdown;
    int directions;
};

static const struct neph_cli_option options[] = {
    {.name = "size", .otherwise = "96x54"},
    {"model", 0, "NAME", "unreal or filament (default: all that know the scene's fog)",
     NEPH_CLI_WORD, .at = offsetof(struct request, model)},
    {"directions", 0, "N", "Over the sphere around the camera", NEPH_CLI_INTEGER,
     .at = offsetof(struct request, directions), .otherwise = "4096", .minimum = 16,
     .maximum = 1 << 20},
    {.name = "json", .help = "All numbers as JSON on stdout, instead of the table"},
    {"csv", 0, "FILE", "A line for each row", NEPH_CLI_FILE, .at = offsetof(struct request, csv)},
    {"markdown", 0, "FILE", "The table into a file, too", NEPH_CLI_FILE,
     .at = offsetof(struct request, markdown)},
    {.name = NULL},
};

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &neph_cli_one_scene,
    .doc =
        "Switch each control of a scene's fog_look on alone, in the formulas of Unreal Engine and "
        "of Filament, and say what it is off by against engine exact: transmittance and radiance "
        "of the picture, light that it gives or takes over the sphere of directions around the "
        "camera, and the steps that it makes as things come nearer.\v"
        "Row `none` has all controls off; `of physics` is the look that the medium and the sun "
        "would have where the fog is thin. All in double precision, on the CPU.\n\n"
        "Examples:\n"
        "  neph study fog fog_look_evening\n"
        "  neph study fog my_fog.yaml --model filament --markdown fog.md --csv fog.csv",
};

static enum neph_status read_model(const char *word, int *model, struct neph_diag *diag)
{
    *model = -1;
    for (int m = 0; word && m < NEPH_FOG_MODEL_COUNT; m++)
        if (strcmp(word, neph_fog_model_words[m]) == 0)
            *model = m;
    if (!word || *model >= 0)
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_USAGE, "--model: there is no model '%s'", word);
    neph_hint(diag, "unreal or filament");
    return NEPH_ERR_USAGE;
}

static enum neph_status write_csv(const char *path, const struct neph_fog_study *study,
                                  struct neph_diag *diag)
{
    char *text = NULL;
    enum neph_status status = neph_fog_study_csv(study, &text, diag);
    if (!status)
        status = neph_file_write(path, text, strlen(text), diag);
    free(text);
    return status;
}

static enum neph_status write_results(const struct request *request,
                                      const struct neph_fog_study *study, struct neph_diag *diag)
{
    char *text = NULL;
    enum neph_status status = neph_fog_study_text(study, &text, diag);
    if (!status && request->markdown)
        status = neph_file_write(request->markdown, text, strlen(text), diag);
    if (!status && request->csv)
        status = write_csv(request->csv, study, diag);
    if (!status && request->shared.json)
        status = neph_json_print(neph_fog_study_json(study), diag);
    else if (!status)
        fputs(text, stdout);
    free(text);
    return status;
}

enum neph_status neph_cli_study_fog(int argc, char **argv, struct neph_diag *diag)
{
    struct request request = {0};
    neph_cli_parse(&syntax, argc, argv, &request);
    struct neph_fog_study_params params = {.width_px = request.shared.size.width_px,
                                           .height_px = request.shared.size.height_px,
                                           .directions = request.directions};
    struct neph_scene *scene = NULL;
    struct neph_fog_study study;
    enum neph_status status = read_model(request.model, &params.model, diag);
    if (!status)
        status = neph_data_load_scene(request.shared.operands[0], &scene, diag);
    params.scene = scene;
    if (!status)
        status = neph_fog_study_run(&params, &study, diag);
    if (!status)
        status = write_results(&request, &study, diag);
    neph_scene_destroy(scene);
    return status;
}
