/* SPDX-License-Identifier: MIT
 *
 * `neph study flicker [SCENE...]`: flicker and lag of real-time presets, compared in pairs.
 */
#include "harness/experiments/flicker.h"

#include "harness/data.h"
#include "harness/experiments/experiments.h"
#include "harness/study/floor_plan.h"
#include "harness/study/suites.h"
#include "renderer/realtime/options.h"

#include <math.h>

struct request {
    struct neph_flicker_request flicker;
    struct neph_cli_list presets;
    bool no_floor;
    struct neph_floor_plan plan; /* the presets, and unless `no_floor` their floors */
};

#define AT(member) .at = offsetof(struct request, member)
static const struct neph_cli_option options[] = {
    {"preset", 0, NULL, "Presets to compare with each other; PRESET+KEY=VALUE changes one",
     NEPH_CLI_LIST, AT(presets), .presets = neph_rt_presets, .uses = NEPH_RT_FLICKER,
     .maximum = NEPH_STUDY_PRESETS_MAX},
    {"suite", 0, NULL,
     "tuning: the scenes of the choice of presets; test, test2: other scenes; air: near fog, "
     "lamps, shafts, cirrus and shadows of clouds (default, without a SCENE: test)",
     NEPH_CLI_WORD, AT(flicker.suite)},
    {"open-shut-suite", 0, NULL,
     "Measure a suite that is shut until the settings are chosen by another one", NEPH_CLI_FLAG,
     AT(flicker.opens_shut_suite)},
    {"seed", 0, NULL, "The first seed of the dithers", NEPH_CLI_INTEGER, AT(flicker.first_seed),
     "1", 1, 1000000},
    {"seeds", 0, NULL, "Seeds of the dithers, for each scene", NEPH_CLI_INTEGER,
     AT(flicker.seed_count), "3", 1, NEPH_STUDY_SEEDS_MAX},
    {"frames", 0, NULL,
     "Frames that flicker is measured in, a multiple of 4; a scene that moves has as many as it "
     "has",
     NEPH_CLI_INTEGER, AT(flicker.frame_count), "256", 16, 4096},
    {"fps", 0, NULL,
     "Frame rate of all scenes and displays at the same motion per second; --frames are at 30 Hz, "
     "twice as many at 60 (default: each scene's own, and displays of 24, 30 and 60 Hz)",
     NEPH_CLI_REAL, AT(flicker.frame_rate_hz), .minimum = 15, .maximum = 240},
    {.name = "size", .otherwise = "192x108"},
    {"steps", 0, NULL, "Steps of every ray, of the reference's too", NEPH_CLI_INTEGER,
     AT(flicker.steps), "32", 1, 65536},
    {"takes", 0, NULL,
     "Sequences of a scene: flicker (the scene as it is), step (of the sun), sine (of the sun), "
     "cut (of the camera)",
     NEPH_CLI_LIST, AT(flicker.takes), "flicker,step,sine,cut", .maximum = NEPH_STUDY_CAPTURES},
    {"no-floor", 0, NULL,
     "Leave out the floors: each preset is otherwise compared with every pixel marched in every "
     "frame, with the preset's and with the default anti-aliasing",
     NEPH_CLI_FLAG, AT(no_floor)},
    {.name = "jobs", .otherwise = "1"},
    {.name = "output",
     .help = "Folder of the store and of flicker_lag.svg",
     .otherwise = "out/study"},
    {.name = "all"},
    {.name = "json", .help = "All numbers as JSON on stdout"},
    {.name = "csv", .help = "A line for each number"},
    {.name = "markdown"},
    {.name = "quiet"},
    {.name = NULL},
};
#undef AT

static const struct neph_cli_operands operands = {.shown = "[SCENE...]"};

/* As long in seconds at any rate, in whole cycles of four frames. */
static int count_frames(const struct neph_flicker_request *request)
{
    return request->frame_rate_hz > 0.0
               ? (int)(request->frame_count * request->frame_rate_hz / 30.0) / 4 * 4
               : request->frame_count;
}

static void check(const void *request_, const struct argp_state *state)
{
    const struct neph_flicker_request *request = request_;
    neph_flicker_check_scenes(request, state);
    if (request->frame_count % 4 != 0)
        argp_error(state, "%d frames are no multiple of 4", request->frame_count);
    if (count_frames(request) < 16)
        argp_error(state, "%d frames at 30 Hz are less than 16 at %g Hz", request->frame_count,
                   request->frame_rate_hz);
}

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &operands,
    .check = check,
    .doc = "Render scenes with presets of the real-time renderer, measure flicker, lag and error "
           "of each against one reference, and print which presets differ, with 95 % intervals "
           "over scenes.\vThe reference is the ray marcher at the same time with the same steps "
           "and lighting, 16 rays a pixel, without dither and without history. Each number against "
           "a reference with one centre ray a pixel follows in brackets. Seeds of a scene are "
           "averaged; scenes are the sample of the statistics. The floor of a preset marches every "
           "pixel in every frame, with the preset's or the default anti-aliasing, whichever has "
           "the lower number in a scene. A ranking is valid if it is the "
           "same at 24, 30 and 60 Hz and at 30 and 60 pixels a degree. NEPH_VULKAN_DEVICE names "
           "the device. Finished frames stay in DIR/store, and the same command continues from "
           "there. Use --jobs on a machine with many cores. Runs may share DIR.\n"
           "\n"
           "Examples:\n"
           "  neph study flicker --suite test --markdown study.md\n"
           "  neph study flicker fence_pitch4 foliage --preset fixed,ours --seeds 1 --frames 64\n"
           "  neph study flicker --preset ours,ours+taa_jitter_length=8 --takes flicker\n"
           "  neph study flicker --suite motion --fps 60",
};

/* ---- requests of flicker studies ------------------------------------------------------------- */

void neph_flicker_check_scenes(const void *request_, const struct argp_state *state)
{
    const struct neph_flicker_request *request = request_;
    if (request->suite && request->shared.operand_count > 0)
        argp_error(state, "a suite or scenes by name, not both");
}

/* Takes must be among the first `take_count` of the table. */
static enum neph_status check_takes(const struct neph_cli_list *takes, int take_count,
                                    struct neph_diag *diag)
{
    for (int i = 0; i < takes->count; i++)
        if (neph_study_capture_find(takes->words[i]) >= take_count)
            return neph_fail(
                diag, NEPH_ERR_USAGE,
                take_count == NEPH_STUDY_CAPTURES
                    ? "there is no sequence '%s': the sequences are flicker, step, sine and cut"
                    : "'%s' has no measure here: use flicker or step",
                takes->words[i]);
    return NEPH_OK;
}

enum neph_status neph_flicker_prepare(struct neph_flicker_request *request, int take_count,
                                      const char *otherwise, struct neph_diag *diag)
{
    struct neph_cli_shared *shared = &request->shared;
    enum neph_status status = check_takes(&request->takes, take_count, diag);
    if (!status && shared->operand_count == 0)
        status = neph_flicker_suite_find(request->suite ? request->suite : otherwise,
                                         request->opens_shut_suite, &request->arena,
                                         &shared->operands, &shared->operand_count, diag);
    return status ? status : neph_data_check_scenes(shared->operands, shared->operand_count, diag);
}

struct neph_flicker_study_params neph_flicker_params(const struct neph_flicker_request *request,
                                                     const char *const *presets, int preset_count,
                                                     const struct neph_experiment_run *run)
{
    const struct neph_cli_shared *shared = &request->shared;
    struct neph_flicker_study_params params = {
        .presets = presets + request->part_preset,
        .preset_count = request->is_part ? 1 : preset_count,
        .scenes = shared->operands,
        .scene_count = shared->operand_count,
        .seed_count = request->seed_count,
        .seeds_before = request->first_seed - 1,
        .frame_rate_hz = fmax(request->frame_rate_hz, 0.0),
        .frame_count = count_frames(request),
        .steps = request->steps,
        .width_px = shared->size.width_px,
        .height_px = shared->size.height_px,
        .device = run->device,
        .quiet = run->quiet,
    };
    for (int i = 0; i < request->takes.count; i++)
        params.takes[neph_study_capture_find(request->takes.words[i])] = true;
    return params;
}

bool neph_flicker_part(struct neph_flicker_request *request, int preset_count, int index)
{
    const int scene_count = request->shared.operand_count;
    if (index >= scene_count * preset_count)
        return false;
    request->is_part = true;
    request->part_preset = index / scene_count;
    return neph_cli_only_operand(&request->shared, index % scene_count);
}

void neph_flicker_free(struct neph_flicker_request *request)
{
    neph_arena_finish(&request->arena);
}

/* ---- the experiment -------------------------------------------------------------------------- */

/* The configurations of the study: the presets, and their floors. */
static enum neph_status plan_configurations(struct request *request, struct neph_diag *diag)
{
    const struct neph_cli_list *presets = &request->presets;
    if (!request->no_floor)
        return neph_floor_plan_make(presets->words, presets->count, request->flicker.steps,
                                    &request->flicker.arena, &request->plan, diag);
    request->plan.preset_count = presets->count;
    for (int i = 0; i < presets->count; i++)
        request->plan.words[i] = presets->words[i];
    return NEPH_OK;
}

static enum neph_status prepare(void *request_, struct neph_diag *diag)
{
    struct request *request = request_;
    const enum neph_status status = neph_flicker_prepare(&request->flicker, NEPH_STUDY_CAPTURES,
                                                         "test", diag);
    return status ? status : plan_configurations(request, diag);
}

static bool part(void *request_, int index)
{
    struct request *request = request_;
    return neph_flicker_part(&request->flicker,
                             request->plan.preset_count + request->plan.floor_count, index);
}

static enum neph_status run(void *request_, const struct neph_experiment_run *run,
                            struct neph_publication *publication, struct neph_diag *diag)
{
    const struct request *request = request_;
    const struct neph_floor_plan *plan = &request->plan;
    struct neph_flicker_study_params params = neph_flicker_params(&request->flicker, plan->words,
                                                                  plan->preset_count, run);
    if (!request->flicker.is_part && !request->no_floor) {
        params.floor_count = plan->floor_count;
        params.floors = plan->floors;
    }
    struct neph_flicker_study study = {.params = &params};
    enum neph_status status = neph_flicker_study_run(&params, run->store, &study, diag);
    if (!status && !request->flicker.is_part)
        status = neph_flicker_publish(&study, publication, diag);
    neph_flicker_study_finish(&study);
    return status;
}

static void finish(void *request)
{
    neph_flicker_free(request);
}

const struct neph_experiment neph_experiment_flicker = {.syntax = &syntax,
                                                        .request_size = sizeof(struct request),
                                                        .chart = "flicker_lag.svg",
                                                        .prepare = prepare,
                                                        .part = part,
                                                        .run = run,
                                                        .finish = finish};
