/* SPDX-License-Identifier: MIT
 *
 * `neph pick SCENE`, and `neph pick --presets A,B [SCENE...]`.
 */
#include "harness/cli/cli.h"
#include "harness/cli/pick_presets.h"
#include "harness/engines/vulkan_device.h"

#include "base/files.h"
#include "harness/sweep/pick.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_CHOICE_NUMBERS == 6, "a new kind");

struct request {
    struct neph_cli_shared shared; /* operands: a scene; with presets, scenes */
    double error, flicker, ms, half_life, lag, evaluations;
    const char *presets, *suite, *least;
    int seed, seeds, frames, steps;
};

static const struct neph_cli_option options[] = {
    {"error", 0, "E", "The most that the relative RMSE against the truth may be, such as 0.05",
     NEPH_CLI_REAL, .at = offsetof(struct request, error), .minimum = 1e-6, .maximum = 1e6},
    {"flicker", 0, "F", "The most that flicker may be seen, 1 being the eye's threshold",
     NEPH_CLI_REAL, .at = offsetof(struct request, flicker), .minimum = 1e-6, .maximum = 1e6},
    {"ms", 0, "T", "The most that a picture may take on this device", NEPH_CLI_REAL,
     .at = offsetof(struct request, ms), .minimum = 1e-6, .maximum = 1e9},
    {.name = "size", .otherwise = "320x180"},
    {"seed", 0, "N", "Of all that is random (default: 1); --presets have --seeds", NEPH_CLI_INTEGER,
     .at = offsetof(struct request, seed), .minimum = 1, .maximum = 1000000},
    {.name = "output", .help = "Folder of the store and of pick.json", .otherwise = "out"},
    {.name = "time-limit", .otherwise = "3600"},
    {.name = "json"},
    {.name = "quiet"},
    {"presets", 0, "A,B,..",
     "One of these presets over many scenes in place of a configuration of one; PRESET+KEY=VALUE "
     "changes one, and command is a renderer of your own",
     NEPH_CLI_WORD, .at = offsetof(struct request, presets), .group = 1},
    {"suite", 0, "NAME", "With --presets: the scenes of a suite (default, without a SCENE: tuning)",
     NEPH_CLI_WORD, .at = offsetof(struct request, suite), .group = 1},
    {"least", 0, "NUMBER",
     "With --presets: what the choice has the least of, within what is given: flicker, half-life, "
     "lag, error, evaluations or ms (default: evaluations)",
     NEPH_CLI_WORD, .at = offsetof(struct request, least), .group = 1},
    {"half-life", 0, "N", "With --presets: the most frames to half of a step of the sun",
     NEPH_CLI_REAL, .at = offsetof(struct request, half_life), .minimum = 1e-6, .maximum = 1e6,
     .group = 1},
    {"lag", 0, "N", "With --presets: the most frames behind a sun that swings in 64", NEPH_CLI_REAL,
     .at = offsetof(struct request, lag), .minimum = 1e-6, .maximum = 1e6, .group = 1},
    {"evaluations", 0, "N", "With --presets: the most evaluations of density a pixel",
     NEPH_CLI_REAL, .at = offsetof(struct request, evaluations), .minimum = 1e-6, .maximum = 1e9,
     .group = 1},
    {"seeds", 0, "N", "With --presets: seeds of each scene (default: 1)", NEPH_CLI_INTEGER,
     .at = offsetof(struct request, seeds), .minimum = 1, .maximum = NEPH_STUDY_SEEDS_MAX,
     .group = 1},
    {"frames", 0, "N",
     "With --presets: frames that flicker is measured in, a multiple of 4 (default: 32)",
     NEPH_CLI_INTEGER, .at = offsetof(struct request, frames), .minimum = 16, .maximum = 4096,
     .group = 1},
    {"steps", 0, "N", "With --presets: steps of every ray (default: 8)", NEPH_CLI_INTEGER,
     .at = offsetof(struct request, steps), .minimum = 1, .maximum = 65536, .group = 1},
    {.name = NULL},
};

static const struct neph_cli_operands operands = {.shown = "SCENE|[SCENE...]"};

static int given_or(int given, int otherwise)
{
    return given >= 0 ? given : otherwise;
}

/* Options of presets, given without any. */
static const char *misplaced(const struct request *request)
{
    return request->suite                 ? "--suite"
           : request->least               ? "--least"
           : !isnan(request->half_life)   ? "--half-life"
           : !isnan(request->lag)         ? "--lag"
           : !isnan(request->evaluations) ? "--evaluations"
           : request->seeds >= 0          ? "--seeds"
           : request->frames >= 0         ? "--frames"
           : request->steps >= 0          ? "--steps"
                                          : NULL;
}

static void check(const void *request_, const struct argp_state *state)
{
    const struct request *request = request_;
    const int scenes = request->shared.operand_count;
    if (request->presets) {
        if (request->seed >= 0)
            argp_error(state, "--seed is of one scene; --presets have --seeds");
        if (request->suite && scenes > 0)
            argp_error(state, "a suite or scenes by name, not both");
        if (request->suite && strcmp(request->suite, "test") == 0)
            argp_error(state, "the suite test is for what is reported of a choice, not for making "
                              "it: neph study flicker --suite test");
        if (request->frames >= 0 && request->frames % 4 != 0)
            argp_error(state, "%d frames are no multiple of 4", request->frames);
        return;
    }
    if (misplaced(request))
        argp_error(state, "%s is of a choice out of --presets", misplaced(request));
    if (scenes == 0)
        argp_error(state, "which scene? `neph scenes` lists the catalogue");
    if (scenes > 1)
        argp_error(state, "one scene, or --presets over several");
    if (isnan(request->error) && isnan(request->flicker))
        argp_error(state, "give --error, --flicker, or both: what is good enough?");
}

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &operands,
    .check = check,
    .doc = "The cheapest configuration of a scene that is good enough, and what was left out; or "
           "a preset out of several, over many scenes.\v"
           "Closed forms come first, then the real-time pipeline and the march, with few steps and "
           "more, with light scattered once and by all orders. All are looked at in small "
           "pictures; what passes there with room to spare goes on to larger ones, the cheapest "
           "first by density evaluations, and the first that passes at full size is the choice. "
           "Errors are against engine exact, or the tracer. Where nothing moves, the parts that "
           "only motion needs are left out. What each part that is left out would have bought is "
           "measured, too.\n\nDIR/pick.json is what `neph render --config` takes. With --ms, times "
           "are measured once and kept in DIR/times.json, so that the same command picks the same "
           "again. Exit code 1: nothing is good enough; the best is shown.\n\n"
           "With --presets, each is rendered as it is, with a step of the sun and with a sun that "
           "swings, over all scenes; numbers are geometric means over scenes, errors and lags "
           "those of the shortcut against the march of its own model. Out of those that no other "
           "beats in all numbers at once, the choice is within what is given and has the least of "
           "--least. docs/sweep.md has more.\n\n"
           "Examples:\n"
           "  neph pick height_fog_level --error 0.01\n"
           "  neph pick cloud_below --error 0.3 --flicker 2 --size 160x90\n"
           "  neph pick voxel_grid --error 0.25 --ms 50 -o out\n"
           "  neph render voxel_grid --config out/pick.json --frames 48\n"
           "  neph pick --suite tuning --presets ours,fixed,ours+taa_alpha=0.06 --half-life 2 "
           "--least flicker --size 96x54",
};

static enum neph_status write_json(const struct neph_pick_params *params,
                                   const struct neph_pick *pick, const char *path,
                                   struct neph_diag *diag)
{
    json_t *json = neph_pick_json(params, pick);
    char *text = json ? json_dumps(json, JSON_INDENT(1)) : NULL;
    const enum neph_status status = text ? neph_file_write(path, text, strlen(text), diag)
                                         : neph_fail_memory(diag);
    free(text);
    json_decref(json);
    return status;
}

static enum neph_status tell(const struct request *request, const struct neph_pick_params *params,
                             const struct neph_pick *pick, const char *path, struct neph_diag *diag)
{
    enum neph_status status = write_json(params, pick, path, diag);
    if (!status && request->shared.json)
        status = neph_json_print(neph_pick_json(params, pick), diag);
    if (!status && !request->shared.json) {
        neph_pick_print(params, pick, stdout);
        printf("neph render %s --config %s\n", params->scene, path);
    }
    if (!status && !pick->found)
        status = neph_fail(diag, NEPH_ERR_GATE, "nothing is good enough for what was asked");
    return status;
}

static enum neph_status run(const struct request *request, struct neph_pick_params *params,
                            struct neph_diag *diag)
{
    const char *output = request->shared.output;
    char *folder = neph_path_join(output, "store"), *path = neph_path_join(output, "pick.json"),
         *times_path = neph_path_join(output, "times.json");
    struct neph_store *store = NULL;
    struct neph_times times = {NULL};
    struct neph_pick pick;
    enum neph_status status = folder && path && times_path ? neph_store_open(folder, &store, diag)
                                                           : neph_fail_memory(diag);
    if (!status)
        status = neph_times_open(times_path, &times, diag);
    params->times = &times;
    if (!status)
        status = neph_pick_run(params, store, &pick, diag);
    if (!status)
        status = tell(request, params, &pick, path, diag);
    neph_times_close(&times);
    neph_store_close(store);
    free(times_path);
    free(path);
    free(folder);
    return status;
}

/* --- presets -------------------------------------------------------------------------------- */

static enum neph_status pick_preset(const struct request *request, struct neph_diag *diag)
{
    const struct neph_cli_pick_presets asked = {
        .presets = request->presets,
        .suite = request->suite,
        .least = request->least ? request->least : neph_choice_measures[NEPH_CHOICE_WORK].name,
        .scenes = request->shared.operands,
        .scene_count = request->shared.operand_count,
        .budget = {[NEPH_CHOICE_FLICKER] = request->flicker,
                   [NEPH_CHOICE_HALF_LIFE] = request->half_life,
                   [NEPH_CHOICE_LAG] = request->lag,
                   [NEPH_CHOICE_ERROR] = request->error,
                   [NEPH_CHOICE_WORK] = request->evaluations,
                   [NEPH_CHOICE_TIME] = request->ms},
        .seed_count = given_or(request->seeds, 1),
        .frame_count = given_or(request->frames, 32),
        .steps = given_or(request->steps, 8),
        .width_px = request->shared.size.width_px,
        .height_px = request->shared.size.height_px,
        .output = request->shared.output,
        .json = request->shared.json,
        .quiet = request->shared.quiet || request->shared.json};
    return neph_cli_pick_presets(&asked, diag);
}

enum neph_status neph_cli_pick(int argc, char **argv, struct neph_diag *diag)
{
    struct request request = {0};
    neph_cli_parse(&syntax, argc, argv, &request);
    if (request.presets)
        return pick_preset(&request, diag);
    const struct neph_cli_shared *shared = &request.shared;
    struct neph_shared_device device = {.open = NULL};
    struct neph_pick_params params = {.scene = shared->operands[0],
                                      .error = request.error,
                                      .flicker = request.flicker,
                                      .time_s = 1e-3 * request.ms,
                                      .width_px = shared->size.width_px,
                                      .height_px = shared->size.height_px,
                                      .seed = (uint64_t)given_or(request.seed, 1),
                                      .time_limit_s = shared->time_limit_s,
                                      .device = &device,
                                      .quiet = shared->quiet || shared->json};
    const enum neph_status status = run(&request, &params, diag);
    neph_shared_device_close(&device);
    return status;
}
