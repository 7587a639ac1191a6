/* SPDX-License-Identifier: MIT
 *
 * `neph study sky [SCENE]`.
 */
#include "harness/cli/study.h"

#include "base/files.h"
#include "harness/data.h"
#include "harness/engines/vulkan_device.h"
#include "harness/study/sky_study.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct request {
    struct neph_cli_shared shared; /* operands: a scene */
    const char *models, *truth, *suns, *altitudes, *markdown;
    int samples, steps, tile;
};

static const struct neph_cli_option options[] = {
    {"models", 0, "A,B", "Models to hold against the truth; ENGINE+KEY=VALUE changes one",
     NEPH_CLI_WORD, .at = offsetof(struct request, models),
     .otherwise = "sky,sky+multiple=closure"},
    {"truth", 0, "ENGINE",
     "tracer or oracle; or a model with finer settings, ENGINE+KEY=VALUE+..., for what its "
     "tables leave, without noise",
     NEPH_CLI_WORD, .at = offsetof(struct request, truth), .otherwise = "tracer"},
    {"suns", 0, "A,B", "Elevations of the sun [degrees]", NEPH_CLI_WORD,
     .at = offsetof(struct request, suns), .otherwise = "90,60,30,15,10,5,2,0,-1,-2"},
    {"altitudes", 0, "A,B", "Altitudes of the camera [m]", NEPH_CLI_WORD,
     .at = offsetof(struct request, altitudes), .otherwise = "2,10000"},
    {.name = "size", .otherwise = "48x32"},
    {"tile", 0, "N", "Pixels along a side of a direction", NEPH_CLI_INTEGER,
     .at = offsetof(struct request, tile), .otherwise = "4", .minimum = 1, .maximum = 64},
    {"steps", 0, "N", "Steps of every view ray, unless a model says otherwise", NEPH_CLI_INTEGER,
     .at = offsetof(struct request, steps), .otherwise = "48", .minimum = 2, .maximum = 4096},
    {"samples", 0, "N", "Samples a pixel of the truth, twice", NEPH_CLI_INTEGER,
     .at = offsetof(struct request, samples), .otherwise = "4096", .minimum = 2,
     .maximum = 1 << 28},
    {.name = "output", .help = "Folder of the store", .otherwise = "out"},
    {.name = "json", .help = "All numbers as JSON on stdout, instead of the tables"},
    {"markdown", 0, "FILE", "The tables into a file, too", NEPH_CLI_FILE,
     .at = offsetof(struct request, markdown)},
    {.name = "quiet"},
    {.name = NULL},
};

static const struct neph_cli_operands operands = {
    .shown = "[SCENE]", .maximum = 1, .surplus = "one scene"};

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &operands,
    .doc =
        "Render the sky of a planet (default: sky_earth) with models and with a tracer, and say "
        "how far each model is from all orders of scattering: by elevation of the sun, altitude "
        "of the camera, and direction.\v"
        "Each cell is two wide pictures, towards the sun and away from it. The truth is rendered "
        "twice, with two seeds, for its noise. What is finished stays in DIR/store, and the same "
        "command goes on from there.\n\n"
        "Examples:\n"
        "  neph study sky --markdown sky.md\n"
        "  neph study sky --suns 10,5 --truth oracle --samples 1024\n"
        "  neph study sky --models sky+degree=0,sky+view=table --truth sky+degree=4+steps=96",
};

static enum neph_status read_list(const char *text, const char *what,
                                  double list[NEPH_SKY_LIST_MAX], int *count,
                                  struct neph_diag *diag)
{
    const char *words[NEPH_SKY_LIST_MAX];
    char *copy = strdup(text);
    enum neph_status status = copy ? neph_cli_split(copy, what, NEPH_SKY_LIST_MAX, words, count,
                                                    diag)
                                   : neph_fail_memory(diag);
    for (int i = 0; i < *count && !status; i++) {
        char *end;
        list[i] = strtod(words[i], &end);
        if (end == words[i] || *end || !isfinite(list[i]))
            status = neph_fail(diag, NEPH_ERR_USAGE, "--%s: '%s' is no number", what, words[i]);
    }
    free(copy);
    return status;
}

static enum neph_status print_results(const struct request *request,
                                      const struct neph_sky_study *study, struct neph_diag *diag)
{
    char *text = NULL;
    enum neph_status status = neph_sky_study_text(study, &text, diag);
    if (!status && request->markdown)
        status = neph_file_write(request->markdown, text, strlen(text), diag);
    if (!status && request->shared.json)
        status = neph_json_print(neph_sky_study_json(study), diag);
    else if (!status)
        fputs(text, stdout);
    free(text);
    return status;
}

static enum neph_status run(const struct request *request,
                            const struct neph_sky_study_params *params, struct neph_diag *diag)
{
    struct neph_store *store = NULL;
    struct neph_sky_study study = {.params = params};
    char *folder = neph_path_join(request->shared.output, "store");
    enum neph_status status = folder ? neph_store_open(folder, &store, diag)
                                     : neph_fail_memory(diag);
    if (!status)
        status = neph_sky_study_run(params, store, &study, diag);
    if (!status)
        status = print_results(request, &study, diag);
    neph_sky_study_finish(&study);
    neph_store_close(store);
    free(folder);
    return status;
}

enum neph_status neph_cli_study_sky(int argc, char **argv, struct neph_diag *diag)
{
    struct request request = {0};
    neph_cli_parse(&syntax, argc, argv, &request);
    const struct neph_cli_shared *shared = &request.shared;
    const char *models[NEPH_LIGHT_MODELS_MAX];
    struct neph_scene *scene = NULL;
    struct neph_shared_device device = {.open = NULL};
    struct neph_sky_study_params params = {.models = models,
                                           .truth = request.truth,
                                           .width_px = shared->size.width_px,
                                           .height_px = shared->size.height_px,
                                           .tile_px = request.tile,
                                           .steps = request.steps,
                                           .samples = request.samples,
                                           .device = &device,
                                           .quiet = shared->quiet};
    char *words = strdup(request.models);
    enum neph_status status = words ? neph_cli_split(words, "models", NEPH_LIGHT_MODELS_MAX, models,
                                                     &params.model_count, diag)
                                    : neph_fail_memory(diag);
    if (!status)
        status = read_list(request.suns, "suns", params.suns_deg, &params.sun_count, diag);
    if (!status)
        status = read_list(request.altitudes, "altitudes", params.altitudes_m,
                           &params.altitude_count, diag);
    if (!status)
        status = neph_data_load_scene(shared->operand_count > 0 ? shared->operands[0] : "sky_earth",
                                      &scene, diag);
    params.scene = scene;
    if (!status)
        status = run(&request, &params, diag);
    neph_shared_device_close(&device);
    neph_scene_destroy(scene);
    free(words);
    return status;
}
