/* SPDX-License-Identifier: MIT
 *
 * `neph ablate [SCENE...]`.
 */
#include "harness/cli/cli.h"

#include "base/files.h"
#include "harness/data.h"
#include "harness/engines/vulkan_device.h"
#include "harness/study/ablation_output.h"
#include "harness/study/flicker_suites.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_STUDY_TAKES == 4, "a new kind");

struct request {
    struct neph_cli_shared shared; /* operands: scenes */
    const char *preset, *suite, *takes, *only;
    int seed_count, frame_count, steps;
    bool list;
};

static const struct neph_cli_option options[] = {
    {"preset", 'p', "NAME", "Preset whose parts are looked at; PRESET+KEY=VALUE changes it",
     NEPH_CLI_WORD, .at = offsetof(struct request, preset), .otherwise = "ours"},
    {"suite", 0, "NAME",
     "tuning: the scenes that presets were chosen by; test, test2: others, for what is to be "
     "reported; air: near fog, lamps, shafts, cirrus and shadows of clouds (default, without a "
     "SCENE: tuning)",
     NEPH_CLI_WORD, .at = offsetof(struct request, suite)},
    {"only", 0, "PART,...", "These parts alone, in place of all that the preset has", NEPH_CLI_WORD,
     .at = offsetof(struct request, only)},
    {"list", 0, NULL, "What the parts are, who claims them, and their settings; renders nothing",
     NEPH_CLI_FLAG, .at = offsetof(struct request, list)},
    {"seeds", 0, "N", "Seeds of the dithers, for each scene", NEPH_CLI_INTEGER,
     .at = offsetof(struct request, seed_count), .otherwise = "2", .minimum = 1,
     .maximum = NEPH_STUDY_SEEDS_MAX},
    {"frames", 0, "N",
     "Frames that error and flicker are measured in, a multiple of 4; a scene that moves has as "
     "many as it has",
     NEPH_CLI_INTEGER, .at = offsetof(struct request, frame_count), .otherwise = "32",
     .minimum = 16, .maximum = 4096},
    {.name = "size", .otherwise = "96x54"},
    {"steps", 0, "N", "Steps of every ray, of the reference's too", NEPH_CLI_INTEGER,
     .at = offsetof(struct request, steps), .otherwise = "8", .minimum = 1, .maximum = 65536},
    {"takes", 0, "A,B",
     "What is rendered of a scene: flicker (as it is: error, flicker, cost), step (of the sun: "
     "half-life)",
     NEPH_CLI_WORD, .at = offsetof(struct request, takes), .otherwise = "flicker,step"},
    {.name = "output",
     .help = "Folder of the store and of ablation.json, ablation.csv, ablation.svg",
     .otherwise = "out"},
    {.name = "json", .help = "All numbers as JSON on stdout, instead of the tables"},
    {.name = "quiet"},
    {.name = NULL},
};

static const struct neph_cli_operands operands = {.shown = "[SCENE...]"};

static void check(const void *request_, const struct argp_state *state)
{
    const struct request *request = request_;
    if (request->suite && request->shared.operand_count > 0)
        argp_error(state, "a suite or scenes by name, not both");
    if (request->frame_count % 4 != 0)
        argp_error(state,
                   "%d frames are no multiple of 4: pictures repeat after four frames, and "
                   "16, 20, 24 .. are whole cycles",
                   request->frame_count);
}

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &operands,
    .check = check,
    .doc =
        "What each part of the real-time renderer buys: switch each off in a preset, and on alone "
        "in a pipeline that has none of them, and measure error, flicker, half-life and cost of "
        "both, with 95 % intervals over scenes.\v"
        "A change is that of the number with the part over that without it: -12 % says that the "
        "part lowers it. `in the preset` says what leaving it out would cost, with all others "
        "there; `alone` what it does by itself, with those it needs: where the two differ, parts "
        "do each other's work. Seeds of a scene are averaged, scenes are what is counted, and p "
        "is corrected for all numbers that are judged (S. Holm). A part of which nothing can be "
        "told could be left out, in scenes like these.\n\n"
        "Every configuration is held against one reference, the march of the same moment with 16 "
        "rays a pixel (neph study flicker --help). Evaluations and bytes are counted and exact; "
        "milliseconds are of NEPH_VULKAN_DEVICE, and of a machine at work if it is a processor. "
        "Small pictures have more edges than large ones. What is finished stays in DIR/store, and "
        "the same command goes on from there; runs may share DIR: start one for each scene, and "
        "then the whole, which only reads.\n\n"
        "Examples:\n"
        "  neph ablate --list\n"
        "  neph ablate fence_backlit foliage --only override,box,gradients\n"
        "  neph ablate --suite tuning -o tuning    # an hour on two cores\n"
        "  neph ablate --suite test --preset fixed --size 320x180 --frames 64 --seeds 3",
};

/* Sine and cut have no measure here. */
static enum neph_status choose_takes(char *text, bool takes[NEPH_STUDY_TAKES],
                                     struct neph_diag *diag)
{
    const char *words[NEPH_STUDY_TAKES];
    int count = 0;
    enum neph_status status = neph_cli_split(text, "takes", NEPH_STUDY_TAKES, words, &count, diag);
    for (int i = 0; i < count && !status; i++) {
        if (strcmp(words[i], neph_study_takes[NEPH_STUDY_FLICKER].name) == 0)
            takes[NEPH_STUDY_FLICKER] = true;
        else if (strcmp(words[i], neph_study_takes[NEPH_STUDY_STEP].name) == 0)
            takes[NEPH_STUDY_STEP] = true;
        else
            return neph_fail(diag, NEPH_ERR_USAGE,
                             "no measure is taken of '%s': takes are flicker and step", words[i]);
    }
    return status;
}

static enum neph_status write_text(const struct request *request, const char *name, char *text,
                                   struct neph_diag *diag)
{
    char *path = neph_path_join(request->shared.output, name);
    const enum neph_status status = path ? neph_file_write(path, text, strlen(text), diag)
                                         : neph_fail_memory(diag);
    free(path);
    free(text);
    return status;
}

static enum neph_status write_files(const struct request *request,
                                    const struct neph_ablation *ablation, json_t *json,
                                    struct neph_diag *diag)
{
    char *csv = NULL, *svg = NULL;
    char *text = json_dumps(json, JSON_INDENT(1));
    enum neph_status status = text ? write_text(request, "ablation.json", text, diag)
                                   : neph_fail_memory(diag);
    if (!status)
        status = neph_ablation_csv(ablation, &csv, diag);
    if (!status)
        status = write_text(request, "ablation.csv", csv, diag);
    if (!status)
        status = neph_ablation_plot(ablation, &svg, diag);
    return status ? status : write_text(request, "ablation.svg", svg, diag);
}

static enum neph_status print(const struct request *request, const struct neph_ablation *ablation,
                              json_t *json, struct neph_diag *diag)
{
    char *text = NULL;
    if (request->shared.json)
        return neph_json_print(json_incref(json), diag);
    const enum neph_status status = neph_ablation_text(ablation, &text, diag);
    if (!status)
        fputs(text, stdout);
    free(text);
    return status;
}

static enum neph_status show(const struct request *request, const struct neph_ablation *ablation,
                             struct neph_diag *diag)
{
    json_t *json = neph_ablation_json(ablation);
    enum neph_status status = neph_json_check(json, diag);
    if (!status)
        status = print(request, ablation, json, diag);
    if (!status)
        status = write_files(request, ablation, json, diag);
    json_decref(json);
    if (!status && ablation->study.failed_count > 0)
        status = neph_fail(diag, NEPH_ERR_ENGINE, "%d takes broke; their scenes have no number",
                           ablation->study.failed_count);
    return status;
}

static enum neph_status run(const struct request *request, struct neph_ablation *ablation,
                            struct neph_diag *diag)
{
    const struct neph_flicker_study_params *params = &ablation->params;
    struct neph_store *store = NULL;
    char *folder = neph_path_join(request->shared.output, "store");
    enum neph_status status = folder ? neph_data_check_scenes(params->scenes, params->scene_count,
                                                              diag)
                                     : neph_fail_memory(diag);
    if (!status)
        status = neph_store_open(folder, &store, diag);
    if (!status)
        status = neph_ablation_run(ablation, store, diag);
    if (!status)
        status = show(request, ablation, diag);
    neph_store_close(store);
    free(folder);
    return status;
}

static enum neph_status list(const struct neph_ablation *ablation, struct neph_diag *diag)
{
    char *text = NULL;
    const enum neph_status status = neph_ablation_list(ablation, &text, diag);
    if (!status)
        fputs(text, stdout);
    free(text);
    return status;
}

static enum neph_status ablate(const struct request *request,
                               const struct neph_flicker_study_params *params,
                               struct neph_ablation *ablation, struct neph_diag *diag)
{
    const char *only[NEPH_ABLATION_PARTS_MAX];
    int only_count = 0;
    char *words = request->only ? strdup(request->only) : NULL;
    enum neph_status status = words || !request->only ? NEPH_OK : neph_fail_memory(diag);
    if (!status && words)
        status = neph_cli_split(words, "parts", NEPH_ABLATION_PARTS_MAX, only, &only_count, diag);
    if (!status)
        status = neph_ablation_plan(request->preset, only, only_count, params, ablation, diag);
    if (!status)
        status = request->list ? list(ablation, diag) : run(request, ablation, diag);
    free(words);
    return status;
}

enum neph_status neph_cli_ablate(int argc, char **argv, struct neph_diag *diag)
{
    struct request request = {0};
    neph_cli_parse(&syntax, argc, argv, &request);
    const struct neph_cli_shared *shared = &request.shared;
    struct neph_ablation ablation = {.preset = NULL};
    char **suite = NULL, *take_words = strdup(request.takes);
    struct neph_shared_device device = {.open = NULL};
    struct neph_flicker_study_params params = {.scenes = shared->operands,
                                               .scene_count = shared->operand_count,
                                               .width_px = shared->size.width_px,
                                               .height_px = shared->size.height_px,
                                               .seed_count = request.seed_count,
                                               .frame_count = request.frame_count,
                                               .steps = request.steps,
                                               .brief = true,
                                               .device = &device,
                                               .quiet = shared->quiet};
    enum neph_status status = take_words ? choose_takes(take_words, params.takes, diag)
                                         : neph_fail_memory(diag);
    if (!status && shared->operand_count == 0) {
        status = neph_flicker_suite_find(request.suite ? request.suite : "tuning", &suite,
                                         &params.scene_count, diag);
        params.scenes = (const char *const *)suite;
    }
    if (!status)
        status = ablate(&request, &params, &ablation, diag);
    neph_shared_device_close(&device);
    neph_ablation_finish(&ablation);
    neph_data_free_names(suite);
    free(take_words);
    return status;
}
