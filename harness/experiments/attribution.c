/* SPDX-License-Identifier: MIT
 *
 * `neph study attribution [SCENE...]`: the causes of the flicker of a real-time preset.
 */
#include "harness/experiments/attribution.h"

#include "base/path.h"
#include "harness/experiments/experiments.h"
#include "harness/experiments/flicker.h"

/* Fails to compile when a kind is added, as run() chooses sequences. */
_Static_assert(NEPH_STUDY_CAPTURES == 4, "a new kind");

struct request {
    struct neph_flicker_request flicker;
    const char *preset;
    struct neph_attribution_plan plan;
};

static const char maps_folder[] = "maps";

#define AT(member) .at = offsetof(struct request, member)
static const struct neph_cli_option options[] = {
    {"preset", 0, NULL, "Preset of which the flicker is divided; PRESET+KEY=VALUE changes it",
     NEPH_CLI_ONE, AT(preset), "ours"},
    {"suite", 0, "NAME", "A suite of `neph study flicker` (default without a SCENE: motion)",
     NEPH_CLI_WORD, AT(flicker.suite)},
    {"seed", 0, NULL, "The first seed of the dithers", NEPH_CLI_INTEGER, AT(flicker.first_seed),
     "1", 1, 1000000},
    {"seeds", 0, NULL, "Seeds of the dithers, for each scene", NEPH_CLI_INTEGER,
     AT(flicker.seed_count), "3", 1, NEPH_STUDY_SEEDS_MAX},
    {"frames", 0, NULL,
     "Frames that flicker is measured in, a multiple of 4; a scene that moves has as many as it "
     "has",
     NEPH_CLI_INTEGER, AT(flicker.frame_count), "64", 16, 4096},
    {.name = "size", .otherwise = "192x108"},
    {"steps", 0, NULL, "Steps of every ray, of the reference's too", NEPH_CLI_INTEGER,
     AT(flicker.steps), "32", 1, 65536},
    {.name = "jobs", .otherwise = "1"},
    {.name = "output",
     .help = "Folder of the store, of attribution.svg and of a map for each scene and each of the "
             "worst parts",
     .otherwise = "out/study"},
    {.name = "all"},
    {.name = "json", .help = "All numbers as JSON on stdout"},
    {.name = "csv", .help = "A line for each scene and part"},
    {.name = "markdown"},
    {.name = "quiet"},
    {.name = NULL},
};
#undef AT

static const struct neph_cli_operands operands = {.shown = "[SCENE...]"};

static void check(const void *request_, const struct argp_state *state)
{
    const struct neph_flicker_request *request = request_;
    neph_flicker_check_scenes(request, state);
    if (request->frame_count % 4 != 0)
        argp_error(state, "%d frames are no multiple of 4", request->frame_count);
}

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &operands,
    .check = check,
    .doc =
        "Divide the squared flicker seen of a preset of the real-time renderer among its parts: "
        "rays, reprojection, disocclusion, box, noise, upscale, blur, aliasing; print which part "
        "causes how much, with 95 % intervals over scenes.\vEvery set of parts is made ideal in "
        "turn, which takes 35 sequences for each scene and seed, and the flicker seen of each is "
        "measured against four references: the ray marcher with 16 rays a pixel (R), the sequence "
        "with all parts ideal but blur and aliasing (I), R with the Gaussian blur that fits I best "
        "(B), and I - B + R. The share of a part is its contribution, "
        "averaged over all orders in which the parts become real (Shapley value; rays before "
        "reprojection, disocclusion, box and noise, which act on the history of rays). The shares "
        "add up to the squared flicker. A negative share means that the part hides flicker of "
        "others. The interaction is the difference between the whole and the sum of parts that "
        "are real one at a time. Finished sequences stay in DIR/store, and the same command "
        "continues from there. A job of --jobs is a scene with a seed.\n"
        "\n"
        "Examples:\n"
        "  neph study attribution fence_pitch4 wind_cloud --seeds 1 --size 96x54\n"
        "  neph study attribution --suite motion --size 384x216 --markdown causes.md\n"
        "  neph study attribution --preset fixed --jobs 8",
};

static enum neph_status prepare(void *request_, struct neph_diag *diag)
{
    struct request *request = request_;
    const enum neph_status status = neph_flicker_prepare(&request->flicker, NEPH_STUDY_CAPTURES,
                                                         "motion", diag);
    return status ? status
                  : neph_attribution_plan_make(request->preset, request->flicker.steps,
                                               &request->flicker.arena, &request->plan, diag);
}

/* All scenes with the first seed come first, so that two workers seldom render the same reference.
 */
static bool part(void *request_, int index)
{
    struct neph_flicker_request *request = &((struct request *)request_)->flicker;
    const int scene_count = request->shared.operand_count;
    if (index >= scene_count * request->seed_count)
        return false;
    request->is_part = true;
    request->first_seed += index / scene_count;
    request->seed_count = 1;
    return neph_cli_only_operand(&request->shared, index % scene_count);
}

static enum neph_status publish(struct request *request, const struct neph_flicker_study *study,
                                const char *output, struct neph_publication *publication,
                                struct neph_diag *diag)
{
    struct neph_attribution_study attribution;
    enum neph_status status = neph_attribution_judge(&request->plan, study, &publication->arena,
                                                     &attribution, diag);
    if (!status && output)
        status = neph_attribution_draw_maps(&attribution, neph_path_in(output, maps_folder).text,
                                            diag);
    return status ? status : neph_attribution_publish(&attribution, publication, diag);
}

static enum neph_status run(void *request_, const struct neph_experiment_run *run,
                            struct neph_publication *publication, struct neph_diag *diag)
{
    struct request *request = request_;
    const struct neph_attribution_plan *plan = &request->plan;
    struct neph_flicker_study_params params = neph_flicker_params(&request->flicker, plan->words,
                                                                  plan->count, run);
    params.preset_count = plan->count;
    params.labels = plan->labels;
    params.takes[NEPH_STUDY_FLICKER] = true;
    params.brief = true;
    params.ideal = neph_attribution_find_ideal(plan);
    params.map_count = NEPH_ATTRIBUTION_MAPS;
    struct neph_flicker_study study = {.params = &params};
    enum neph_status status = neph_flicker_study_run(&params, run->store, &study, diag);
    if (!status && !request->flicker.is_part)
        status = publish(request, &study, run->output, publication, diag);
    neph_flicker_study_finish(&study);
    return status;
}

static void finish(void *request)
{
    neph_flicker_free(request);
}

static const char *const files[] = {maps_folder, NULL};
const struct neph_experiment neph_experiment_attribution = {.syntax = &syntax,
                                                            .request_size = sizeof(struct request),
                                                            .chart = "attribution.svg",
                                                            .files = files,
                                                            .prepare = prepare,
                                                            .part = part,
                                                            .run = run,
                                                            .finish = finish};
