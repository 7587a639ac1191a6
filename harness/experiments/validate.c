/* SPDX-License-Identifier: MIT
 *
 * `neph validate`: the options of the catalogue, the physics suite and the stress tests.
 */
#include "harness/experiments/validate.h"
#include "harness/experiments/experiments.h"

#include "base/files.h"
#include "base/interrupt.h"
#include "renderer/realtime/options.h"

#include <stdlib.h>
#include <string.h>

/* ---- tiers ----------------------------------------------------------------------------------- */

/* The cloud scene uses engines with multiple scattering. Cycles renders its radiance only: the
 * transmittance would take most of its time. */
static const char *const cloud_engines[] = {"tracer",   "march_octaves", "march_octaves_fitted",
                                            "realtime", "cycles",        NULL};
static const char *const cloud_settings[] = {"tracer:samples=128", "realtime:lighting=traced",
                                             "cycles:samples=12", "cycles:step=0.25", NULL};
static const char *const cloud_light_only[] = {"cycles", NULL};

static const char *const fog_engines[] = {"exact",  "tracer", "march", "realtime",
                                          "cycles", "povray", NULL};

static const char *const shaft_settings[] = {"tracer:samples=128", NULL};

/* Large frames: the scenes that look best in a report, a cloud with multiple scattering and light
 * shafts in fog. Small frames: scenes that only contribute numbers, a fog and a slab with closed
 * forms. */
static const struct neph_scene_plan quick_scenes[] = {
    {"cumulus", 320, 180, cloud_engines, cloud_settings, cloud_light_only},
    {"colonnade", 320, 180, fog_engines, shaft_settings, NULL},
    {"height_fog_down", 96, 54, fog_engines, NULL, NULL},
    {"scattering_slab_above", 96, 54, fog_engines, NULL, NULL},
    {.name = NULL},
};
static const char *const quick_engines[] = {
    "exact",  "tracer", "march", "march_octaves", "march_octaves_fitted", "realtime",
    "cycles", "povray", NULL};
static const char *const quick_charts[] = {"slab", NULL};

enum { QUICK, FULL, TIER_COUNT };
static const struct neph_validate_tier tiers[TIER_COUNT] = {
    [QUICK] = {.name = "quick",
               .scenes = quick_scenes,
               .engines = quick_engines,
               .width_px = 320,
               .height_px = 180,
               .budget_s = 60.0,
               .charts = quick_charts,
               .chart_repeats = 3,
               .with_times = true},
    [FULL] = {.name = "full",
              .width_px = 192,
              .height_px = 108,
              .budget_s = 300.0,
              .chart_repeats = 3,
              .with_floors = true},
};

/* NULL: unknown tier. */
static const struct neph_validate_tier *find_tier(const char *name)
{
    for (int i = 0; i < TIER_COUNT; i++)
        if (strcmp(tiers[i].name, name) == 0)
            return &tiers[i];
    return NULL;
}

/* Without --tier, named scenes get all engines, as in the full tier. */
const struct neph_validate_tier *neph_validate_tier(const struct neph_validate_request *request)
{
    if (request->tier)
        return find_tier(request->tier);
    return &tiers[request->suite || request->shared.operand_count > 0 ? FULL : QUICK];
}

/* ---- options --------------------------------------------------------------------------------- */

static const struct neph_cli_option options[] = {
    {"tier", 0, "NAME",
     "quick: a cloud, shafts in fog, a fog, a slab, a chart and a sequence, a few minutes on two "
     "cores (default); "
     "full: the whole catalogue, all engines, all charts",
     NEPH_CLI_WORD, .at = offsetof(struct neph_validate_request, tier)},
    {"suite", 0, "NAME",
     "catalog: the same as --tier full; physics: every engine against truth that needs no "
     "renderer; "
     "i3rc: fluxes of clouds against the consensus of radiation codes, whose files are in the "
     "folder NEPH_I3RC_DATA; "
     "iprt: radiance of a water cloud, doubling and oracle, against the results of radiation codes "
     "in the folder NEPH_IPRT_DATA; "
     "stress: presets of realtime where such methods fail, and engines in fog, with limits (tiers "
     "quick, full)",
     NEPH_CLI_WORD, .at = offsetof(struct neph_validate_request, suite)},
    {"samples", 0, "N",
     "Of the physics suite: paths per pixel and seed of our tracers (default: 256). Of i3rc: as of "
     "`neph fluxes` (default: 16000, 4000 and 512 in case 1, 2 and 3). Of iprt: the oracle's in "
     "each direction (default: 4000)",

     NEPH_CLI_INTEGER, .at = offsetof(struct neph_validate_request, samples), .minimum = 2,
     .maximum = 1000000},
    {"only", 0, NULL,
     "Of the stress tests: only these scenarios, whatever their tier. Of the physics suite and of "
     "i3rc: only checks with one of these texts in their name or group",

     NEPH_CLI_NAMES, .at = offsetof(struct neph_validate_request, only)},
    {"preset", 0, NULL,
     "Of the stress tests: only these presets, or PRESET+KEY=VALUE; without it, the full tier has "
     "more of them, and march, cycles and povray are beside them",
     NEPH_CLI_NAMES, .at = offsetof(struct neph_validate_request, presets),
     .presets = neph_rt_presets, .uses = NEPH_RT_STRESS_QUICK},
    {"on-device", 0, NULL,
     "Of the stress tests: only count bad values, in all images of every frame, on the device "
     "(preset off, which has none: in its frames); nothing is kept",
     NEPH_CLI_FLAG, .at = offsetof(struct neph_validate_request, on_device)},
    {.name = "jobs",
     .help = "Processes that render at the same time: scenes, checks of the physics suite, or "
             "trials of the stress tests; results do not depend on it",
     .otherwise = "1",
     .minimum = 1,
     .maximum = NEPH_STRESS_JOBS_MAX},
    {"pictures", 0, "WHICH",
     "Of the stress tests: results with images on the page: failed (default), changed, all, none",
     NEPH_CLI_WORD, .at = offsetof(struct neph_validate_request, pictures)},
    {"page-limit", 0, NULL,
     "Of the stress tests: the most that the page may take; the worst results get images first "
     "(default: 60)",
     NEPH_CLI_INTEGER, .at = offsetof(struct neph_validate_request, page_limit_mb), .minimum = 1,
     .maximum = 1000000},
    {"engine", 0, NULL, "Only these engines (default: all)", NEPH_CLI_NAMES,
     .at = offsetof(struct neph_validate_request, engines)},
    {"only-engine", 0, NULL,
     "Beside the engines of -e render only the reference of each scene: exact where it can, else "
     "surfaces or tracer",
     NEPH_CLI_FLAG, .at = offsetof(struct neph_validate_request, only_engine)},
    {.name = "set",
     .argument = "ENGINE:KEY=VALUE",
     .help = "A setting of an engine, in scenes and not in charts; may be given several times"},
    {.name = "size",
     .help = "Size in pixels (default: 192x108; quick: 320x180, its fog and its slab "
             "96x54)"},
    {"seed", 0, NULL, "Of scenes: the S-th seed of engines that draw paths (default: 1)",
     NEPH_CLI_INTEGER, .at = offsetof(struct neph_validate_request, seed), .minimum = 1,
     .maximum = 1000000},
    {.name = "output", .help = "Folder of the store and the report", .otherwise = "out/validate"},
    {"no-charts", 0, NULL,
     "Leave out the speed-against-accuracy charts and the sequence; so do named scenes and engines",
     NEPH_CLI_FLAG, .at = offsetof(struct neph_validate_request, no_charts)},
    {"budget", 0, "S",
     "Seconds that Blender or POV-Ray may take for one frame; a longer render gets fewer samples, "
     "or is reported as not fitting (default: 300; quick: 60)",
     NEPH_CLI_INTEGER, .at = offsetof(struct neph_validate_request, budget_s), .minimum = 1,
     .maximum = 1000000},
    {.name = "blender"},
    {.name = "json", .help = "The whole document as JSON on stdout"},
    {"junit", 0, "FILE",
     "JUnit XML: a test case for each frame and gate, each row of the physics suite, or each "
     "number "
     "of the stress tests",
     NEPH_CLI_FILE, .at = offsetof(struct neph_validate_request, junit)},
    {.name = "quiet"},
    {.name = NULL},
};

static const struct neph_cli_operands operands = {.shown = "[SCENE...]"};

static const struct {
    const char *name;
    const struct neph_experiment *experiment;
} suites[] = {
    {"catalog", &neph_experiment_catalog}, {"physics", &neph_experiment_physics},
    {"i3rc", &neph_experiment_i3rc},       {"iprt", &neph_experiment_iprt},
    {"stress", &neph_experiment_stress},   {"failure", &neph_experiment_stress_by_old_name}};

/* NULL: unknown suite. */
static const struct neph_experiment *choose(const void *request_)
{
    const struct neph_validate_request *request = request_;
    for (size_t i = 0; i < sizeof(suites) / sizeof(suites[0]); i++)
        if (!request->suite || strcmp(request->suite, suites[i].name) == 0)
            return suites[i].experiment;
    return NULL;
}

static bool is_physics(const struct neph_validate_request *request)
{
    return choose(request) == &neph_experiment_physics;
}

static bool is_i3rc(const struct neph_validate_request *request)
{
    return choose(request) == &neph_experiment_i3rc;
}

static bool is_iprt(const struct neph_validate_request *request)
{
    return choose(request) == &neph_experiment_iprt;
}

static bool is_stress(const struct neph_validate_request *request)
{
    const struct neph_experiment *chosen = choose(request);
    return chosen == &neph_experiment_stress || chosen == &neph_experiment_stress_by_old_name;
}

/* Reject options of the stress tests without that suite, and other options with it. */
static void check_stress(const struct neph_validate_request *request,
                         const struct argp_state *state)
{
    const struct neph_cli_shared *shared = &request->shared;
    if (!is_stress(request)) {
        if (request->presets.count > 0 || request->pictures || request->page_limit_mb >= 0 ||
            request->on_device)
            argp_error(state, "--preset, --pictures, --page-limit and --on-device belong to "
                              "--suite stress");
        return;
    }
    if (shared->operand_count > 0)
        argp_error(state,
                   "the stress tests have scenarios of their own; --only chooses among them");
    if (shared->settings.count > 0)
        argp_error(state, "the stress tests have no --set; presets take settings: --preset "
                          "NAME+KEY=VALUE");
    if (request->pictures &&
        neph_stress_images_parse(request->pictures) == NEPH_STRESS_IMAGES_COUNT)
        argp_error(state, "--pictures has no value '%s'; it has failed, changed, all and none",
                   request->pictures);
}

static void check(const void *request_, const struct argp_state *state)
{
    const struct neph_validate_request *request = request_;
    const struct neph_cli_shared *shared = &request->shared;
    if (!choose(request))
        argp_error(state,
                   "there is no suite '%s'; there are catalog, physics, i3rc, iprt and stress",
                   request->suite);
    check_stress(request, state);
    if (request->only_engine && request->engines.count == 0)
        argp_error(state, "--only-engine needs -e, which names the engines that it is about");
    const bool has_scenes = !is_physics(request) && !is_stress(request) && !is_i3rc(request) &&
                            !is_iprt(request);
    if (is_iprt(request) &&
        (shared->operand_count > 0 || shared->settings.count > 0 || request->engines.count > 0 ||
         request->only.count > 0 || request->junit))
        argp_error(state,
                   "the IPRT suite has its own scene: no scenes, --set, -e, --only, --junit");
    if (is_i3rc(request) &&
        (shared->operand_count > 0 || shared->settings.count > 0 || request->engines.count > 1))
        argp_error(state, "the I3RC suite has its own scenes, no --set, and one engine");
    if (request->only_engine && !has_scenes)
        argp_error(state, "--only-engine is of scenes: the suites render the engines of -e and no "
                          "others");
    if (request->tier && !find_tier(request->tier))
        argp_error(state, "there is no tier '%s'; there are quick and full", request->tier);
    for (int i = 0; i < request->only.count; i++)
        if (request->only.words[i][0] == '\0')
            argp_error(state, "--only needs a part of a name");
    if (is_physics(request) && shared->settings.count > 0)
        argp_error(state, "the physics suite chooses its engines' settings itself: no --set");
    if (request->seed > 0 && !has_scenes)
        argp_error(state, "--seed is of scenes; the suites have their own");
    if (!is_physics(request) && !is_i3rc(request) && !is_iprt(request) && request->samples >= 0)
        argp_error(state, "--samples belongs to --suite physics, i3rc and iprt");
    if (has_scenes && request->only.count > 0)
        argp_error(state, "--only chooses among the tests of --suite physics, i3rc and stress");
    if (request->suite && request->tier && !is_stress(request))
        argp_error(state, "either --suite or --tier: the catalogue is --tier full");
    if (is_physics(request) && shared->operand_count > 0)
        argp_error(state,
                   "the physics suite makes its own scenes; '%s' cannot be given, "
                   "--only chooses among them",
                   shared->operands[0]);
}

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &operands,
    .check = check,
    .doc =
        "Run scenes (default: the quick tier) with several engines, measure each against the "
        "highest level of truth, check the gates, and write DIR/report/index.html, which is "
        "updated after each scene.\vFinished frames are kept in DIR/store and used again; the "
        "same command continues an interrupted or killed run. neph creates both folders and "
        "refuses an existing folder of another origin. Runs at the same time may share DIR: "
        "each frame is stored once, and the report is from the last run that wrote it. A missing "
        "engine is reported as missing, and the run continues with the others. Exit code 1: a "
        "gate failed, an engine failed, or nothing could be compared. Exit code 0 covers only "
        "the compared frames: an engine that is missing or did not fit its budget does not "
        "change the code, and the verdict names it.\n"
        "\n"
        "Examples:\n"
        "  neph validate\n"
        "  neph validate --tier full --budget 120\n"
        "  neph validate fence_backlit --size 320x180\n"
        "  neph validate my_fog.yaml -e command --only-engine --junit out/junit.xml\n"
        "  neph validate my_fog.yaml -e exact,march -s march:steps=256 -o /tmp/fog\n"
        "  neph validate --suite physics --jobs 4 -o out/physics\n"
        "  neph validate --suite physics --only slab -e oracle,tracer --samples 4096\n"
        "  neph validate --suite i3rc --only case1_exp1 --samples 2000 -o out/i3rc\n"
        "  neph validate --suite iprt\n"
        "  neph validate --suite stress --only fence_tiles --preset fixed+override=parallel\n"
        "  neph validate --suite stress --only fog_seam -e povray --pictures all",
};

const struct neph_experiment neph_experiment_validate = {
    .syntax = &syntax, .request_size = sizeof(struct neph_validate_request), .choose = choose};

/* ---- report of the catalogue and the physics suite ------------------------------------------- */

enum neph_status neph_validate_open_report(void *request_, struct neph_diag *diag)
{
    struct neph_validate_request *request = request_;
    request->page_folder = neph_path_join(request->shared.output, "report");
    return request->page_folder ? neph_report_open(request->page_folder, &request->report, diag)
                                : neph_fail_memory(diag);
}

void neph_validate_close_report(void *request_)
{
    struct neph_validate_request *request = request_;
    neph_report_close(request->report);
    free(request->page_folder);
}

struct neph_validate_params neph_validate_make_params(const struct neph_validate_request *request,
                                                      const struct neph_experiment_run *run)
{
    const struct neph_cli_shared *shared = &request->shared;
    const struct neph_validate_tier *tier = neph_validate_tier(request);
    const bool has_size = shared->size.width_px > 0;
    return (struct neph_validate_params){
        .engines = request->engines.words,
        .engine_count = request->engines.count,
        .only_engines = request->only_engine,
        .settings = shared->settings.list,
        .setting_count = shared->settings.count,
        .width_px = has_size ? shared->size.width_px : tier->width_px,
        .height_px = has_size ? shared->size.height_px : tier->height_px,
        .seed = request->seed > 0 ? request->seed : 1,
        .budget_s = request->budget_s >= 0 ? request->budget_s : tier->budget_s,
        .device = run->device,
        .jobs = shared->jobs,
        .quiet = run->quiet,
        .skip_absent = shared->operand_count == 0,
        .report = request->report,
    };
}

static void print_outcome(const struct neph_validation *validation, const char *folder, FILE *out)
{
    const struct neph_counts *counts = &validation->counts;
    fprintf(out, "%s: %d of %d in the report, %d compared with the truth\n",
            validation->physics ? "rows" : "frames", counts->reported, counts->expected,
            counts->compared);
    if (counts->ungated > 0)
        fprintf(out,
                "gates: of %d no gate limits the radiance: its mean must be within a factor of two "
                "of the truth\n",
                counts->ungated);
    fputs("verdict: ", out);
    neph_validation_print_verdict(validation, out);
    fprintf(out, "\nreport: %s/index.html\n", folder);
}

static enum neph_status judge(const struct neph_validation *validation, struct neph_diag *reason)
{
    const struct neph_counts *counts = &validation->counts;
    if (validation->verdict == NEPH_VERDICT_PASS)
        return NEPH_OK;
    if (counts->reported != counts->expected)
        return neph_fail(reason, NEPH_ERR_INTERNAL, "%d of %d results are not in the report",
                         counts->expected - counts->reported, counts->expected);
    if (counts->compared == 0) {
        neph_fail(reason, NEPH_ERR_GATE, "nothing was compared with a truth: there is no verdict");
        neph_hint(reason, "a run needs an engine that is the truth of its scenes (exact, oracle, "
                          "tracer) and another; the report says why frames are missing");
        return NEPH_ERR_GATE;
    }
    return neph_fail(reason, NEPH_ERR_GATE,
                     validation->physics ? "an engine that claims to be the truth deviates, or an "
                                           "engine failed; the report names it"
                                         : "a gate failed or an engine broke; the report names it");
}

static enum neph_status write_junit(const struct neph_validation *validation, const char *path,
                                    struct neph_diag *diag)
{
    struct neph_junit junit = {.name = "neph validate"};
    neph_validation_junit(validation, &junit);
    const enum neph_status status = neph_junit_write(&junit, path, diag);
    neph_junit_finish(&junit);
    return status;
}

enum neph_status neph_validate_publish(const struct neph_validate_request *request,
                                       struct neph_validation *validation,
                                       struct neph_publication *publication,
                                       enum neph_status status, struct neph_diag *diag)
{
    FILE *text = publication->text;
    if (status == NEPH_ERR_INTERRUPTED && validation->title) {
        neph_interrupt_acknowledge();
        neph_report_publish(request->report, validation, NULL);
    }
    if (!status)
        status = neph_report_publish(request->report, validation, diag);
    if (!status && request->junit)
        status = write_junit(validation, request->junit, diag);
    if (status)
        return status;
    if (text && validation->physics)
        neph_physics_print(validation->physics, text);
    else if (text)
        neph_validation_print(validation, text);
    else
        publication->json = neph_validation_json(validation);
    print_outcome(validation, request->page_folder, text ? text : stderr);
    publication->verdict = judge(validation, &publication->reason);
    return NEPH_OK;
}
