/* SPDX-License-Identifier: MIT
 *
 * `neph study post SCENE...`.
 */
#include "harness/cli/study.h"

#include "base/files.h"
#include "harness/data.h"
#include "harness/engines/vulkan_device.h"
#include "harness/study/post_study.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct request {
    struct neph_cli_shared shared; /* operands: the scenes */
    const char *preset, *chains, *csv, *markdown;
    int frames, warm_up, steps, seed;
    double rate_hz;
};

static const struct neph_cli_option options[] = {
    {"preset", 0, "NAME", "Of realtime, whose frames they are; NAME+KEY=VALUE changes it",
     NEPH_CLI_WORD, .at = offsetof(struct request, preset), .otherwise = "ours"},
    {"frames", 0, "N", "That are measured, a multiple of 4", NEPH_CLI_INTEGER,
     .at = offsetof(struct request, frames), .otherwise = "32", .minimum = 16, .maximum = 1024},
    {"warm-up", 0, "N", "Before them, a multiple of 4", NEPH_CLI_INTEGER,
     .at = offsetof(struct request, warm_up), .otherwise = "32", .minimum = 0, .maximum = 1024},
    {"fps", 0, "HZ", "Frames a second", NEPH_CLI_REAL, .at = offsetof(struct request, rate_hz),
     .otherwise = "30", .minimum = 1, .maximum = 1000},
    {.name = "size", .otherwise = "96x54"},
    {"steps", 0, "N", "Of every view ray", NEPH_CLI_INTEGER, .at = offsetof(struct request, steps),
     .otherwise = "32", .minimum = 1, .maximum = 4096},
    {"seed", 0, "N", "Of the noise of frames and grain", NEPH_CLI_INTEGER,
     .at = offsetof(struct request, seed), .otherwise = "1", .minimum = 1, .maximum = 1 << 20},
    {"chains", 0, "A,B", "Those with A or B in their names, and the curve alone (default: all)",
     NEPH_CLI_WORD, .at = offsetof(struct request, chains)},
    {.name = "output", .help = "Folder of the store and of post.svg", .otherwise = "out"},
    {.name = "json", .help = "All numbers as JSON on stdout, instead of the tables"},
    {"csv", 0, "FILE", "A line for each chain and scene", NEPH_CLI_FILE,
     .at = offsetof(struct request, csv)},
    {"markdown", 0, "FILE", "The tables into a file, too", NEPH_CLI_FILE,
     .at = offsetof(struct request, markdown)},
    {.name = "quiet"},
    {.name = NULL},
};

static const struct neph_cli_operands operands = {.shown = "SCENE...",
                                                  .minimum = 1,
                                                  .maximum = NEPH_POST_SCENES_MAX,
                                                  .missing = "which scenes?",
                                                  .surplus = "too many scenes"};

static void check(const void *request_, const struct argp_state *state)
{
    const struct request *request = request_;
    if (request->frames % 4 != 0 || request->warm_up % 4 != 0)
        argp_error(state, "--frames and --warm-up are multiples of 4: cycles have so many");
}

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &operands,
    .check = check,
    .doc =
        "Put frames of the real-time renderer and their reference through the same picture chains, "
        "each stage alone and each taken out of the whole, and say what that makes of error and "
        "flicker: before the tone curve, and as a display shows it.\v"
        "The reference is the march of the same model, averaged over 16 rays a pixel. It gets no "
        "grain, which is noise and counts as such; chains without automatic exposure have the one "
        "that it would find for the reference. What is rendered of it stays in DIR/store; "
        "DIR/post.svg is the chart.\n\n"
        "Examples:\n"
        "  neph study post fence_backlit voxel_grid --markdown post.md\n"
        "  neph study post ridge_far --preset seed --frames 64 --csv post.csv\n"
        "  neph study post railings --chains whole,fxaa,sharpening --seed 2 --size 192x108",
};

static enum neph_status write_file(const char *path, const struct neph_post_study *study,
                                   enum neph_status (*print)(const struct neph_post_study *study,
                                                             char **text, struct neph_diag *diag),
                                   struct neph_diag *diag)
{
    char *text = NULL;
    enum neph_status status = path ? print(study, &text, diag) : NEPH_OK;
    if (!status && path)
        status = neph_file_write(path, text, strlen(text), diag);
    free(text);
    return status;
}

static enum neph_status print_results(const struct request *request,
                                      const struct neph_post_study *study, struct neph_diag *diag)
{
    char *text = NULL;
    enum neph_status status = neph_post_study_text(study, &text, diag);
    if (!status)
        status = write_file(request->markdown, study, neph_post_study_text, diag);
    if (!status)
        status = write_file(request->csv, study, neph_post_study_csv, diag);
    char *chart = status ? NULL : neph_path_join(request->shared.output, "post.svg");
    if (!status)
        status = chart ? write_file(chart, study, neph_post_study_plot, diag)
                       : neph_fail_memory(diag);
    free(chart);
    if (!status && request->shared.json)
        status = neph_cli_print_json(neph_post_study_json(study), diag);
    else if (!status)
        fputs(text, stdout);
    free(text);
    return status;
}

enum neph_status neph_cli_study_post(int argc, char **argv, struct neph_diag *diag)
{
    struct request request = {0};
    neph_cli_parse(&syntax, argc, argv, &request);
    const struct neph_cli_shared *shared = &request.shared;
    const char *chains[NEPH_POST_ROWS_MAX];
    struct neph_shared_device device = {.open = NULL};
    struct neph_post_study_params params = {.scenes = shared->operands,
                                            .scene_count = shared->operand_count,
                                            .preset = request.preset,
                                            .frame_count = request.frames,
                                            .warm_up = request.warm_up,
                                            .width_px = shared->size.width_px,
                                            .height_px = shared->size.height_px,
                                            .steps = request.steps,
                                            .seed = request.seed,
                                            .frame_rate_hz = request.rate_hz,
                                            .chains = chains,
                                            .device = &device,
                                            .quiet = shared->quiet};
    struct neph_store *store = NULL;
    struct neph_post_study *study = calloc(1, sizeof(*study));
    char *folder = neph_path_join(shared->output, "store");
    char *words = request.chains ? strdup(request.chains) : NULL;
    const bool has_memory = folder && study && (words || !request.chains);
    enum neph_status status = has_memory ? NEPH_OK : neph_fail_memory(diag);
    if (!status && words)
        status = neph_cli_split(words, "chains", NEPH_POST_ROWS_MAX, chains, &params.chain_count,
                                diag);
    if (!status)
        status = neph_store_open(folder, &store, diag);
    if (!status)
        status = neph_post_study_run(&params, store, study, diag);
    if (!status)
        status = print_results(&request, study, diag);
    if (study)
        neph_post_study_finish(study);
    neph_shared_device_close(&device);
    neph_store_close(store);
    free(study);
    free(words);
    free(folder);
    return status;
}
