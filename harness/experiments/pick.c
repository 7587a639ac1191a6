/* SPDX-License-Identifier: MIT
 *
 * `neph pick SCENE`: the cheapest configuration within given limits. `neph pick --preset A,B
 * [SCENE...]`: one of several presets, chosen over many scenes.
 */
#include "base/path.h"
#include "harness/experiments/experiments.h"

#include "base/files.h"
#include "harness/data.h"
#include "harness/study/flicker_plot.h"
#include "harness/study/floor_plan.h"
#include "harness/study/suites.h"
#include "harness/sweep/choice.h"
#include "harness/sweep/pick.h"
#include "harness/sweep/pick_answer.h"

#include <math.h>
#include <string.h>

/* Compiles only when this file handles every kind. */
_Static_assert(NEPH_CHOICE_NUMBERS == 6, "a new kind");
_Static_assert(NEPH_STUDY_CAPTURES == 4, "a new kind");

struct request {
    struct neph_cli_shared shared; /* operands: one scene; with presets several */
    struct neph_choice choice;     /* its limits apply to a single scene as well */
    struct neph_cli_list presets, engines, only;
    const char *suite, *least;
    int seed, seeds, frames, steps;
    struct neph_arena arena; /* for the suite's scenes */
    const char *const *scenes;
    int scene_count;
};

#define BUDGET(number) .at = offsetof(struct request, choice.budget[NEPH_CHOICE_##number])
#define AT(member) .at = offsetof(struct request, member)
static const struct neph_cli_option options[] = {
    {"error", 0, NULL, "The largest relative RMSE against the truth allowed, such as 0.05",
     NEPH_CLI_REAL, BUDGET(ERROR), .minimum = 1e-6, .maximum = 1e6},
    {"flicker", 0, "F", "The largest flicker allowed; 1 is the threshold of the eye", NEPH_CLI_REAL,
     BUDGET(FLICKER), .minimum = 1e-6, .maximum = 1e6},
    {"ms", 0, "T", "The largest time of a frame allowed on this device", NEPH_CLI_REAL,
     BUDGET(TIME), .minimum = 1e-6, .maximum = 1e9},
    {"engine", 0, NULL, "Only configurations of these engines; march has march_octaves and others",
     NEPH_CLI_NAMES, AT(engines), .maximum = NEPH_CLI_LIST_MAX},
    {"only", 0, NULL,
     "Only configurations with these names: a preset of realtime, march, or a lighting such as "
     "octaves",
     NEPH_CLI_NAMES, AT(only), .maximum = NEPH_CLI_LIST_MAX},
    {.name = "size", .otherwise = "192x108"},
    {"seed", 0, NULL, "Seed of all that is random; with --preset the first of --seeds (default: 1)",
     NEPH_CLI_INTEGER, AT(seed), .minimum = 1, .maximum = 1000000},
    {.name = "output", .help = "Folder of the store and of pick.json", .otherwise = "out/pick"},
    {.name = "time-limit", .otherwise = "3600"},
    {.name = "jobs",
     .help = "Processes that render at the same time; no result but the ms of --preset depends on "
             "it",
     .otherwise = "1"},
    {.name = "all", .help = "All numbers, and the effect of each part that is left out"},
    {.name = "json"},
    {.name = "quiet"},
    {"preset", 0, NULL,
     "One of these presets over many scenes in place of a configuration of one; PRESET+KEY=VALUE "
     "changes one, and command is a renderer of your own",
     NEPH_CLI_LIST, AT(presets), .maximum = NEPH_STUDY_PRESETS_MAX, .group = 1},
    {"suite", 0, NULL, "With --preset: the scenes of a suite (default, without a SCENE: tuning)",
     NEPH_CLI_WORD, AT(suite), .group = 1},
    {"least", 0, "NUMBER",
     "With --preset: the number that the choice minimizes within the given limits: flicker, "
     "half-life, lag, error, evaluations or ms (default: evaluations)",
     NEPH_CLI_WORD, AT(least), .group = 1},
    {"half-life", 0, "N", "With --preset: the most frames to half of a step of the sun",
     NEPH_CLI_REAL, BUDGET(HALF_LIFE), .minimum = 1e-6, .maximum = 1e6, .group = 1},
    {"lag", 0, "N", "With --preset: the most frames behind a sun that swings in 64", NEPH_CLI_REAL,
     BUDGET(LAG), .minimum = 1e-6, .maximum = 1e6, .group = 1},
    {"evaluations", 0, "N", "With --preset: the most evaluations of density a pixel", NEPH_CLI_REAL,
     BUDGET(WORK), .minimum = 1e-6, .maximum = 1e9, .group = 1},
    {"seeds", 0, NULL, "With --preset: seeds of each scene (default: 1)", NEPH_CLI_INTEGER,
     AT(seeds), .minimum = 1, .maximum = NEPH_STUDY_SEEDS_MAX, .group = 1},
    {"frames", 0, NULL,
     "With --preset: frames that flicker is measured in, a multiple of 4 (default: 32)",
     NEPH_CLI_INTEGER, AT(frames), .minimum = 16, .maximum = 4096, .group = 1},
    {"steps", 0, NULL, "With --preset: steps of every ray (default: 8)", NEPH_CLI_INTEGER,
     AT(steps), .minimum = 1, .maximum = 65536, .group = 1},
    {.name = NULL},
};
#undef AT

#undef BUDGET

static const struct neph_cli_operands operands = {.shown = "SCENE|[SCENE...]"};

static int given_or(int given, int otherwise)
{
    return given >= 0 ? given : otherwise;
}

/* An option that requires --preset, given without it; NULL: none. */
static const char *misplaced(const struct request *request)
{
    const double *budget = request->choice.budget;
    return request->suite                          ? "--suite"
           : request->least                        ? "--least"
           : !isnan(budget[NEPH_CHOICE_HALF_LIFE]) ? "--half-life"
           : !isnan(budget[NEPH_CHOICE_LAG])       ? "--lag"
           : !isnan(budget[NEPH_CHOICE_WORK])      ? "--evaluations"
           : request->seeds >= 0                   ? "--seeds"
           : request->frames >= 0                  ? "--frames"
           : request->steps >= 0                   ? "--steps"
                                                   : NULL;
}

static void check(const void *request_, const struct argp_state *state)
{
    const struct request *request = request_;
    const double *budget = request->choice.budget;
    const int scenes = request->shared.operand_count;
    if (request->presets.count) {
        if (request->engines.count || request->only.count)
            argp_error(state, "--engine and --only choose among the configurations of one scene, "
                              "--preset among presets");
        if (request->suite && scenes > 0)
            argp_error(state, "a suite or scenes by name, not both");
        if (request->suite && strcmp(request->suite, "test") == 0)
            argp_error(state, "the suite test evaluates a choice and does not make it: neph study "
                              "flicker --suite test");
        if (request->frames >= 0 && request->frames % 4 != 0)
            argp_error(state, "%d frames are no multiple of 4", request->frames);
        if (request->shared.jobs > 1 && (!isnan(budget[NEPH_CHOICE_TIME]) ||
                                         (request->least && strcmp(request->least, "ms") == 0)))
            argp_error(state, "--jobs: frame times are measured with one process at a time");
        return;
    }
    if (misplaced(request))
        argp_error(state, "%s is of a choice out of --preset", misplaced(request));
    if (scenes == 0)
        argp_error(state, "which scene? `neph scenes` lists the catalogue");
    if (scenes > 1)
        argp_error(state, "one scene, or --preset over several");
    if (isnan(budget[NEPH_CHOICE_ERROR]) && isnan(budget[NEPH_CHOICE_FLICKER]))
        argp_error(state, "give --error, --flicker, or both");
}

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &operands,
    .check = check,
    .doc = "Find the cheapest configuration of a scene that is good enough; or, with --preset, the "
           "best preset over many scenes.\v"
           "Closed forms are tried first, then the real-time presets and the ray marcher, with few "
           "steps and more, with single scattering and with all orders. All configurations are "
           "measured in small frames. Those that pass with room to spare are measured in larger "
           "ones, the cheapest first by density evaluations. The first that passes at full size is "
           "the choice. Errors are against engine exact, or the tracer. In a static scene the "
           "parts that only motion needs are left out.\n\n"
           "DIR/pick.json is a file for `neph render --config`. With --ms, times are measured once "
           "and kept in DIR/times.json. Exit code 1: nothing is good enough; the best is "
           "printed.\n\n"
           "With --preset, each preset is rendered over all scenes as they are, with a step of the "
           "sun and with a swinging sun. Numbers are geometric means over scenes; errors and lags "
           "are against the ray marcher with the same lighting, and stand beside their floors: "
           "every pixel marched in every frame (neph study flicker --help). Of the presets that no "
           "other preset beats in all numbers, the choice is within the limits and has the least "
           "of --least.\n\n"
           "Examples:\n"
           "  neph pick height_fog_level --error 0.01\n"
           "  neph pick voxel_grid --error 0.25 --ms 50\n"
           "  neph render voxel_grid --config out/pick/pick.json --frames 48\n"
           "  neph pick cloud_below --error 0.3 --flicker 2 --engine march\n"
           "  neph pick voxel_grid --error 0.25 --only ours,march\n"
           "  neph pick --preset ours,fixed --half-life 2 --least flicker --size 96x54",
};

static enum neph_status prepare(void *request_, struct neph_diag *diag)
{
    struct request *request = request_;
    enum neph_status status = NEPH_OK;
    request->scenes = request->shared.operands;
    request->scene_count = request->shared.operand_count;
    if (!request->presets.count)
        return NEPH_OK;
    const int least = request->least ? neph_choice_find(request->least) : NEPH_CHOICE_WORK;
    if (least < 0)
        return neph_fail(diag, NEPH_ERR_USAGE,
                         "--least '%s' is no number: flicker, half-life, lag, error, evaluations "
                         "or ms",
                         request->least);
    request->choice.least = (enum neph_choice_number)least;
    if (request->scene_count == 0)
        status = neph_flicker_suite_find(request->suite ? request->suite : "tuning", false,
                                         &request->arena, &request->scenes, &request->scene_count,
                                         diag);
    return status ? status : neph_data_check_scenes(request->scenes, request->scene_count, diag);
}

static void finish(void *request_)
{
    struct request *request = request_;
    neph_arena_finish(&request->arena);
}

/* With presets, a job for each scene. */
static bool part(void *request_, int index)
{
    struct request *request = request_;
    if (!request->presets.count || index >= request->scene_count)
        return false;
    request->scenes += index;
    request->scene_count = 1;
    return true;
}

/* ---- a configuration of a scene -------------------------------------------------------------- */

static void print_numbers(const struct neph_pick_point *point, FILE *out)
{
    fprintf(out, "error %.3g, flicker %.3g, ", point->error, point->flicker);
    if (!isnan(point->flicker_floor))
        fprintf(out, "floor %.3g and %.3g, ", point->error_floor, point->flicker_floor);
    if (point->is_closed)
        fprintf(out, "no marched samples");
    else if (isnan(point->evaluations))
        fprintf(out, "evaluations not counted");
    else
        fprintf(out, "%.3g evaluations/px", point->evaluations);
    if (!isnan(point->time.median))
        fprintf(out, ", %.3g ms", 1e3 * point->time.median);
}

static void print_asked(const struct neph_pick_params *params, FILE *out)
{
    const char *comma = "";
    const struct {
        const char *what;
        double most;
    } asked[] = {
        {"error", params->error}, {"flicker", params->flicker}, {"ms", 1e3 * params->time_s}};
    for (size_t i = 0; i < sizeof(asked) / sizeof(asked[0]); i++)
        if (!isnan(asked[i].most)) {
            fprintf(out, "%s%s %.3g", comma, asked[i].what, asked[i].most);
            comma = ", ";
        }
}

static void print_variants(const struct neph_pick *pick, bool kept, const char *title, FILE *out)
{
    for (int i = 0; i < pick->left_out_count; i++) {
        const struct neph_pick_variant *left = &pick->left_out[i];
        if (left->is_kept != kept)
            continue;
        if (title)
            fprintf(out, "\n%s:\n", title);
        title = NULL; /* print the title once */
        fprintf(out, "  %-34s ", left->what);
        if (isnan(left->with.error))
            fprintf(out, "cannot be rendered with this light");
        else
            print_numbers(&left->with, out);
        fprintf(out, "%s%s%s\n", left->because ? " (" : "", left->because ? left->because : "",
                left->because ? ")" : "");
    }
}

static void print_pick(const struct neph_pick_params *params, const struct neph_pick *pick,
                       FILE *out)
{
    fprintf(out, "asked: ");
    print_asked(params, out);
    fprintf(out, ", at %d x %d; truth: %s, noise %.2g\n", params->width_px, params->height_px,
            pick->truth, pick->floor);
    fprintf(out, pick->found ? "%s: " : "none is good enough; best is %s: ", pick->chosen.name);
    print_numbers(&pick->chosen, out);
    fprintf(out, "\n");
    print_variants(pick, false, "left out, with the effect of adding each", out);
    print_variants(pick, true, "kept, with the effect of removing each", out);
    fprintf(out,
            "\n"
            "%d configurations considered, %d frames or sequences of them measured; %s\n",
            pick->candidate_total, pick->measured, pick->device);
    if (!isnan(params->error) && pick->floor > 0.5 * params->error)
        fprintf(out, "the truth's noise is more than half of the wanted error: statements about "
                     "errors are not certain\n");
}

static json_t *point_json(const struct neph_pick_point *point)
{
    json_t *json = neph_configuration_json(&point->configuration);
    neph_json_set(&json, "name", json_string(point->name));
    neph_json_set(&json, "error", neph_json_number(point->error));
    neph_json_set(&json, "flicker", neph_json_number(point->flicker));
    neph_json_set(&json, "error_floor", neph_json_number(point->error_floor));
    neph_json_set(&json, "flicker_floor", neph_json_number(point->flicker_floor));
    neph_json_set(&json, "evaluations", neph_json_number(point->evaluations));
    neph_json_set(&json, "seconds", neph_json_number(point->time.median));
    return json;
}

static json_t *pick_json(const struct neph_pick_params *params, const struct neph_pick *pick)
{
    json_t *json = point_json(&pick->chosen), *left_out = json_array(), *kept = json_array();
    for (int i = 0; i < pick->left_out_count; i++) {
        const struct neph_pick_variant *left = &pick->left_out[i];
        neph_json_add(left->is_kept ? &kept : &left_out,
                      json_pack("{s:s, s:s?, s:o}", "what", left->what, "because", left->because,
                                left->is_kept ? "without" : "with", point_json(&left->with)));
    }
    neph_json_set(&json, "found", json_boolean(pick->found));
    neph_json_set(&json, "scene", json_string(params->scene));
    neph_json_set(&json, "asked",
                  json_pack("{s:o, s:o, s:o}", "error", neph_json_number(params->error), "flicker",
                            neph_json_number(params->flicker), "seconds",
                            neph_json_number(params->time_s)));
    neph_json_set(&json, "width_px", json_integer(params->width_px));
    neph_json_set(&json, "height_px", json_integer(params->height_px));
    neph_json_set(&json, "truth", json_string(pick->truth));
    neph_json_set(&json, "truth_noise", neph_json_number(pick->floor));
    neph_json_set(&json, "device", json_string(pick->device));
    neph_json_set(&json, "left_out", left_out);
    neph_json_set(&json, "kept", kept);
    return json;
}

static enum neph_status pick_configuration(const struct request *request,
                                           const struct neph_experiment_run *run,
                                           struct neph_publication *publication,
                                           struct neph_diag *diag)
{
    const struct neph_cli_shared *shared = &request->shared;
    const double *budget = request->choice.budget;
    struct neph_times times = {NULL};
    const struct neph_pick_params params = {.scene = shared->operands[0],
                                            .error = budget[NEPH_CHOICE_ERROR],
                                            .flicker = budget[NEPH_CHOICE_FLICKER],
                                            .time_s = 1e-3 * budget[NEPH_CHOICE_TIME],
                                            .width_px = shared->size.width_px,
                                            .height_px = shared->size.height_px,
                                            .seed = given_or(request->seed, 1),
                                            .jobs = shared->jobs,
                                            .time_limit_s = shared->time_limit_s,
                                            .device = run->device,
                                            .quiet = shared->quiet || shared->json,
                                            .times = &times,
                                            .filter = {request->engines.words,
                                                       request->engines.count, request->only.words,
                                                       request->only.count}};
    struct neph_pick pick;
    enum neph_status status = neph_times_open_in(run->output, &times, diag);
    if (!status)
        status = neph_pick_run(&params, run->store, &pick, diag);
    if (!status) {
        publication->json = pick_json(&params, &pick);
        if (publication->text) {
            print_pick(&params, &pick, publication->text);
            fprintf(publication->text, "neph render %s --config %s\n", params.scene,
                    neph_path_in(run->output, "pick.json").text);
        }
        neph_pick_answer(&params, &pick, neph_path_in(run->output, "pick.json").text,
                         &publication->answer);
        if (!pick.found)
            publication->verdict = neph_fail(&publication->reason, NEPH_ERR_GATE,
                                             "no configuration is within the limits");
    }
    neph_times_close(&times);
    return status;
}

/* ---- a preset over scenes -------------------------------------------------------------------- */

static enum neph_status judge(const struct neph_choice *choice, struct neph_diag *reason)
{
    if (choice->scene_counts[choice->least] == 0)
        return neph_fail(reason, NEPH_ERR_GATE,
                         "there is no scene in which all presets have a number of '%s'",
                         neph_choice_measures[choice->least].name);
    return choice->chosen >= 0 ? NEPH_OK
                               : neph_fail(reason, NEPH_ERR_GATE, "no preset is within the limits");
}

static enum neph_status publish(const struct neph_flicker_study *study,
                                const struct neph_choice *choice, const char *config,
                                struct neph_publication *publication, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    if (publication->chart)
        status = neph_flicker_study_plot(study, publication->chart, diag);
    if (!status && publication->text)
        status = neph_choice_print(choice, study, publication->text, diag);
    if (!status)
        status = neph_choice_answer(choice, study, config, &publication->answer, diag);
    publication->json = neph_choice_json(choice, study);
    publication->broken_count = study->failed_count;
    publication->broken_words = "sequences failed; their scenes have no number";
    publication->verdict = judge(choice, &publication->reason);
    return status ? status : neph_json_check(publication->json, diag);
}

static enum neph_status pick_preset(struct request *request, const struct neph_experiment_run *run,
                                    struct neph_publication *publication, struct neph_diag *diag)
{
    const struct neph_cli_shared *shared = &request->shared;
    struct neph_floor_plan plan;
    struct neph_flicker_study_params params = {
        .presets = request->presets.words,
        .preset_count = request->presets.count,
        .scenes = request->scenes,
        .scene_count = request->scene_count,
        .seed_count = given_or(request->seeds, 1),
        .seeds_before = given_or(request->seed, 1) - 1,
        .frame_count = given_or(request->frames, 32),
        .steps = given_or(request->steps, 8),
        .width_px = shared->size.width_px,
        .height_px = shared->size.height_px,
        .takes = {[NEPH_STUDY_FLICKER] = true, [NEPH_STUDY_STEP] = true, [NEPH_STUDY_SINE] = true},
        .brief = true,
        .device = run->device,
        .quiet = run->quiet || shared->json};
    struct neph_flicker_study study = {.params = NULL};
    enum neph_status status = neph_floor_plan_make(params.presets, params.preset_count,
                                                   params.steps, &request->arena, &plan, diag);
    params.presets = plan.words;
    params.floor_count = plan.floor_count;
    params.floors = plan.floors;
    if (!status)
        status = neph_flicker_study_run(&params, run->store, &study, diag);
    if (!status)
        status = neph_choice_make(&study, &request->choice, diag);
    if (!status)
        status = publish(&study, &request->choice, neph_path_in(run->output, "pick.json").text,
                         publication, diag);
    if (study.params)
        neph_flicker_study_finish(&study);
    return status;
}

static enum neph_status run(void *request, const struct neph_experiment_run *run,
                            struct neph_publication *publication, struct neph_diag *diag)
{
    return ((struct request *)request)->presets.count
               ? pick_preset(request, run, publication, diag)
               : pick_configuration(request, run, publication, diag);
}

const struct neph_experiment neph_experiment_pick = {.syntax = &syntax,
                                                     .request_size = sizeof(struct request),
                                                     .chart = "flicker_lag.svg",
                                                     .document = "pick.json",
                                                     .prepare = prepare,
                                                     .part = part,
                                                     .run = run,
                                                     .finish = finish};
