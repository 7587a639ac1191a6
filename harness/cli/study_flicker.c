/* SPDX-License-Identifier: MIT
 *
 * `neph study flicker [SCENE...]`.
 */
#include "harness/cli/study.h"

#include "base/files.h"
#include "harness/data.h"
#include "harness/study/flicker_study_output.h"
#include "harness/study/flicker_suites.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    KEY_PRESETS = 1,
    KEY_SUITE,
    KEY_SEEDS,
    KEY_FRAMES,
    KEY_SIZE,
    KEY_STEPS,
    KEY_TAKES,
    KEY_JSON,
    KEY_CSV,
    KEY_MARKDOWN,
};

struct request {
    const char *presets, *suite, *seeds, *frames, *size, *steps, *takes;
    const char *output, *csv, *markdown;
    char **scenes; /* of argv */
    int scene_count;
    bool json, quiet;
};

static const struct argp_option options[] = {
    {"presets", KEY_PRESETS, "A,B", 0,
     "Presets to hold against each other; PRESET+KEY=VALUE changes one (default: "
     "seed,fixed,ue,c52e,unity,ours)",
     0},
    {"suite", KEY_SUITE, "NAME", 0,
     "tuning: the scenes that presets were chosen by; test: others (default, without a SCENE: "
     "test)",
     0},
    {"seeds", KEY_SEEDS, "N", 0, "Seeds of the dithers, for each scene (default: 3)", 0},
    {"frames", KEY_FRAMES, "N", 0,
     "Frames that flicker is measured in, a multiple of 4 (default: 256); a scene that moves has "
     "as many as it has",
     0},
    {"size", KEY_SIZE, "WxH", 0, "Size in pixels (default: 320x180)", 0},
    {"steps", KEY_STEPS, "N", 0, "Steps of every ray, of the reference's too (default: 32)", 0},
    {"takes", KEY_TAKES, "A,B", 0,
     "What is rendered of a scene: flicker (as it is), step (of the sun), sine (of the sun), cut "
     "(of "
     "the camera) (default: all)",
     0},
    {"output", 'o', "DIR", 0, "Folder of the store and of flicker_lag.svg (default: out)", 0},
    {"json", KEY_JSON, NULL, 0, "All numbers as JSON on stdout, instead of the tables", 0},
    {"csv", KEY_CSV, "FILE", 0, "A line for each number", 0},
    {"markdown", KEY_MARKDOWN, "FILE", 0, "The tables into a file, too", 0},
    {"quiet", 'q', NULL, 0, "No progress", 0},
    {0},
};

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct request *request = state->input;
    switch (key) {
    case KEY_PRESETS:
        request->presets = argument;
        return 0;
    case KEY_SUITE:
        request->suite = argument;
        return 0;
    case KEY_SEEDS:
        request->seeds = argument;
        return 0;
    case KEY_FRAMES:
        request->frames = argument;
        return 0;
    case KEY_SIZE:
        request->size = argument;
        return 0;
    case KEY_STEPS:
        request->steps = argument;
        return 0;
    case KEY_TAKES:
        request->takes = argument;
        return 0;
    case 'o':
        request->output = neph_cli_output(state, "--output", argument);
        return 0;
    case KEY_JSON:
        request->json = true;
        return 0;
    case KEY_CSV:
        request->csv = neph_cli_output(state, "--csv", argument);
        return 0;
    case KEY_MARKDOWN:
        request->markdown = neph_cli_output(state, "--markdown", argument);
        return 0;
    case 'q':
        request->quiet = true;
        return 0;
    case ARGP_KEY_ARGS:
        request->scenes = state->argv + state->next;
        request->scene_count = state->argc - state->next;
        return 0;
    case ARGP_KEY_END:
        if (request->suite && request->scene_count > 0)
            argp_error(state, "a suite or scenes by name, not both");
        return 0;
    }
    return ARGP_ERR_UNKNOWN;
}

static const struct argp argp = {
    .options = options,
    .parser = parse,
    .args_doc = "[SCENE...]",
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

/* ---- lists ----------------------------------------------------------------------------------- */

/* Words of "A,B" into `words`, which point into `text`. */
static enum neph_status split(char *text, const char *what, int most, const char **words,
                              int *count, struct neph_diag *diag)
{
    for (*count = 0; text;) {
        if (*count == most)
            return neph_fail(diag, NEPH_ERR_USAGE, "more than %d %s", most, what);
        const char *word = strsep(&text, ",");
        for (int i = 0; i < *count; i++)
            if (strcmp(words[i], word) == 0)
                return neph_fail(diag, NEPH_ERR_USAGE, "'%s' is twice among the %s", word, what);
        words[(*count)++] = word;
    }
    return NEPH_OK;
}

static enum neph_status choose_takes(char *text, bool takes[NEPH_STUDY_TAKES],
                                     struct neph_diag *diag)
{
    const char *words[NEPH_STUDY_TAKES];
    int count = 0;
    enum neph_status status = split(text, "takes", NEPH_STUDY_TAKES, words, &count, diag);
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

/* ---- the study ------------------------------------------------------------------------------- */

static enum neph_status parse_numbers(const struct request *request,
                                      struct neph_flicker_study_params *params,
                                      struct neph_diag *diag)
{
    enum neph_status status = neph_cli_parse_size(request->size, &params->width_px,
                                                  &params->height_px, diag);
    if (!status)
        status = neph_cli_parse_int("number of seeds", request->seeds, 1, NEPH_STUDY_SEEDS_MAX,
                                    &params->seed_count, diag);
    if (!status)
        status = neph_cli_parse_int("number of steps", request->steps, 1, 65536, &params->steps,
                                    diag);
    if (!status)
        status = neph_cli_parse_int("number of frames", request->frames, 16, 4096,
                                    &params->frame_count, diag);
    if (!status && params->frame_count % 4 != 0)
        status = neph_fail(diag, NEPH_ERR_USAGE, "%d frames are no multiple of 4",
                           params->frame_count);
    return status;
}

static enum neph_status write_plot(const struct request *request,
                                   const struct neph_flicker_study *study, struct neph_diag *diag)
{
    char *svg = NULL, *path = neph_path_join(request->output, "flicker_lag.svg");
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
    if (!status && !request->json)
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
    if (!status && request->json)
        status = neph_cli_print_json(neph_flicker_study_json(study), diag);
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
    char *folder = neph_path_join(request->output, "store");
    enum neph_status status = folder ? neph_cli_check_output("-o", request->output, diag)
                                     : neph_fail_memory(diag);
    if (!status)
        status = neph_data_check_scenes(params->scenes, params->scene_count, diag);
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
    struct request request = {.presets = "seed,fixed,ue,c52e,unity,ours",
                              .seeds = "3",
                              .frames = "256",
                              .size = "320x180",
                              .steps = "32",
                              .takes = "flicker,step,sine,cut",
                              .output = "out"};
    neph_cli_parse(&argp, argc, argv, &request);
    const char *presets[NEPH_STUDY_PRESETS_MAX];
    char **suite = NULL, *preset_words = strdup(request.presets),
         *take_words = strdup(request.takes);
    struct neph_flicker_study_params params = {.presets = presets,
                                               .scenes = (const char *const *)request.scenes,
                                               .scene_count = request.scene_count,
                                               .quiet = request.quiet};
    enum neph_status status = preset_words && take_words ? parse_numbers(&request, &params, diag)
                                                         : neph_fail_memory(diag);
    if (!status)
        status = split(preset_words, "presets", NEPH_STUDY_PRESETS_MAX, presets,
                       &params.preset_count, diag);
    if (!status)
        status = choose_takes(take_words, params.takes, diag);
    if (!status && request.scene_count == 0) {
        status = neph_flicker_suite_find(request.suite ? request.suite : "test", &suite,
                                         &params.scene_count, diag);
        params.scenes = (const char *const *)suite;
    }
    if (!status)
        status = run(&request, &params, diag);
    neph_data_free_names(suite);
    free(preset_words);
    free(take_words);
    return status;
}
