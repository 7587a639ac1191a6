/* SPDX-License-Identifier: MIT
 *
 * `neph study flicker [SCENE...]`.
 */
#include "harness/cli/study.h"

#include "base/files.h"
#include "harness/data.h"
#include "harness/engines/vulkan_device.h"
#include "harness/study/flicker_study_output.h"
#include "harness/study/flicker_suites.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct request {
    struct neph_cli_shared shared; /* operands: scenes */
    const char *presets, *suite, *takes, *csv, *markdown;
    int seed_count, frame_count, steps;
};

static const struct neph_cli_option options[] = {
    {"presets", 0, "A,B", "Presets to hold against each other; PRESET+KEY=VALUE changes one",
     NEPH_CLI_WORD, .at = offsetof(struct request, presets),
     .otherwise = "seed,fixed,ue,c52e,unity,ours"},
    {"suite", 0, "NAME",
     "tuning: the scenes that presets were chosen by; test, test2: others; air: near fog, lamps, "
     "shafts, cirrus and shadows of clouds (default, without a SCENE: test)",
     NEPH_CLI_WORD, .at = offsetof(struct request, suite)},
    {"seeds", 0, "N", "Seeds of the dithers, for each scene", NEPH_CLI_INTEGER,
     .at = offsetof(struct request, seed_count), .otherwise = "3", .minimum = 1,
     .maximum = NEPH_STUDY_SEEDS_MAX},
    {"frames", 0, "N",
     "Frames that flicker is measured in, a multiple of 4; a scene that moves has as many as it "
     "has",
     NEPH_CLI_INTEGER, .at = offsetof(struct request, frame_count), .otherwise = "256",
     .minimum = 16, .maximum = 4096},
    {.name = "size", .otherwise = "320x180"},
    {"steps", 0, "N", "Steps of every ray, of the reference's too", NEPH_CLI_INTEGER,
     .at = offsetof(struct request, steps), .otherwise = "32", .minimum = 1, .maximum = 65536},
    {"takes", 0, "A,B",
     "What is rendered of a scene: flicker (as it is), step (of the sun), sine (of the sun), cut "
     "(of the camera)",
     NEPH_CLI_WORD, .at = offsetof(struct request, takes), .otherwise = "flicker,step,sine,cut"},
    {.name = "output", .help = "Folder of the store and of flicker_lag.svg", .otherwise = "out"},
    {.name = "json", .help = "All numbers as JSON on stdout, instead of the tables"},
    {"csv", 0, "FILE", "A line for each number", NEPH_CLI_FILE,
     .at = offsetof(struct request, csv)},
    {"markdown", 0, "FILE", "The tables into a file, too", NEPH_CLI_FILE,
     .at = offsetof(struct request, markdown)},
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
        argp_error(state, "%d frames are no multiple of 4", request->frame_count);
}

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &operands,
    .check = check,
    .doc =
        "Render scenes with presets of the real-time renderer, measure flicker, lag and error of "
        "each against one reference, and say which differ, with 95 % intervals over scenes.\v"
        "The reference is the march of the same moment with the same steps and lighting, 16 rays "
        "a pixel, without dither and without history, at rest and moving; the number against "
        "centre rays stands beside each. Seeds of a scene are averaged, scenes are what is "
        "counted. A ranking holds when it is the same at 24, 30 and 60 Hz and at 30 and 60 "
        "pixels a degree. NEPH_VULKAN_DEVICE names the device. What is finished stays in "
        "DIR/store, and the same command goes on from there. Runs may share DIR: on a machine with "
        "many cores start one for each scene, and then the whole, which only reads.\n\n"
        "Examples:\n"
        "  neph study flicker --suite test --markdown study.md\n"
        "  neph study flicker fence_pitch4 foliage --presets fixed,ours --seeds 1 --frames 64\n"
        "  neph study flicker --presets ours,ours+taa_jitter_length=8 --takes flicker",
};

static enum neph_status choose_takes(char *text, bool takes[NEPH_STUDY_TAKES],
                                     struct neph_diag *diag)
{
    const char *words[NEPH_STUDY_TAKES];
    int count = 0;
    enum neph_status status = neph_cli_split(text, "takes", NEPH_STUDY_TAKES, words, &count, diag);
    for (int i = 0; i < count && !status; i++) {
        int id = 0;
        while (id < NEPH_STUDY_TAKES && strcmp(words[i], neph_study_takes[id].name) != 0)
            id++;
        if (id == NEPH_STUDY_TAKES)
            return neph_fail(diag, NEPH_ERR_USAGE,
                             "there is no take '%s': takes are flicker, step, sine and cut",
                             words[i]);
        takes[id] = true;
    }
    return status;
}

static enum neph_status write_plot(const struct request *request,
                                   const struct neph_flicker_study *study, struct neph_diag *diag)
{
    char *svg = NULL, *path = neph_path_join(request->shared.output, "flicker_lag.svg");
    enum neph_status status = path ? neph_flicker_study_plot(study, &svg, diag)
                                   : neph_fail_memory(diag);
    if (!status)
        status = neph_file_write(path, svg, strlen(svg), diag);
    free(svg);
    free(path);
    return status;
}

static enum neph_status write_csv(const char *path, const struct neph_flicker_study *study,
                                  struct neph_diag *diag)
{
    char *text = NULL;
    enum neph_status status = neph_flicker_study_csv(study, &text, diag);
    if (!status)
        status = neph_file_write(path, text, strlen(text), diag);
    free(text);
    return status;
}

static enum neph_status write_text(const struct request *request,
                                   const struct neph_flicker_study *study, struct neph_diag *diag)
{
    char *text = NULL;
    enum neph_status status = neph_flicker_study_text(study, &text, diag);
    if (!status && !request->shared.json)
        fputs(text, stdout);
    if (!status && request->markdown)
        status = neph_file_write(request->markdown, text, strlen(text), diag);
    free(text);
    return status;
}

static enum neph_status write_all(const struct request *request,
                                  const struct neph_flicker_study *study, struct neph_diag *diag)
{
    enum neph_status status = write_text(request, study, diag);
    if (!status && request->shared.json)
        status = neph_json_print(neph_flicker_study_json(study), diag);
    if (!status && request->csv)
        status = write_csv(request->csv, study, diag);
    if (!status)
        status = write_plot(request, study, diag);
    if (!status && study->failed_count > 0)
        status = neph_fail(diag, NEPH_ERR_ENGINE, "%d takes broke; their cells say why",
                           study->failed_count);
    return status;
}

static enum neph_status run(const struct request *request,
                            const struct neph_flicker_study_params *params, struct neph_diag *diag)
{
    struct neph_store *store = NULL;
    struct neph_flicker_study study = {.params = params};
    char *folder = neph_path_join(request->shared.output, "store");
    enum neph_status status = folder ? neph_data_check_scenes(params->scenes, params->scene_count,
                                                              diag)
                                     : neph_fail_memory(diag);
    if (!status)
        status = neph_store_open(folder, &store, diag);
    if (!status)
        status = neph_flicker_study_run(params, store, &study, diag);
    if (!status)
        status = write_all(request, &study, diag);
    neph_flicker_study_finish(&study);
    neph_store_close(store);
    free(folder);
    return status;
}

enum neph_status neph_cli_study_flicker(int argc, char **argv, struct neph_diag *diag)
{
    struct request request = {0};
    neph_cli_parse(&syntax, argc, argv, &request);
    const struct neph_cli_shared *shared = &request.shared;
    const char *presets[NEPH_STUDY_PRESETS_MAX];
    char **suite = NULL, *preset_words = strdup(request.presets),
         *take_words = strdup(request.takes);
    struct neph_shared_device device = {.open = NULL};
    struct neph_flicker_study_params params = {.presets = presets,
                                               .scenes = shared->operands,
                                               .scene_count = shared->operand_count,
                                               .width_px = shared->size.width_px,
                                               .height_px = shared->size.height_px,
                                               .seed_count = request.seed_count,
                                               .frame_count = request.frame_count,
                                               .steps = request.steps,
                                               .device = &device,
                                               .quiet = shared->quiet};
    enum neph_status status = preset_words && take_words ? NEPH_OK : neph_fail_memory(diag);
    if (!status)
        status = neph_cli_split(preset_words, "presets", NEPH_STUDY_PRESETS_MAX, presets,
                                &params.preset_count, diag);
    if (!status)
        status = choose_takes(take_words, params.takes, diag);
    if (!status && shared->operand_count == 0) {
        status = neph_flicker_suite_find(request.suite ? request.suite : "test", &suite,
                                         &params.scene_count, diag);
        params.scenes = (const char *const *)suite;
    }
    if (!status)
        status = run(&request, &params, diag);
    neph_shared_device_close(&device);
    neph_data_free_names(suite);
    free(preset_words);
    free(take_words);
    return status;
}
