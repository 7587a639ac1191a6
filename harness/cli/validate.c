/* SPDX-License-Identifier: MIT
 *
 * `neph validate`: the main job.
 */
#include "harness/cli/cli.h"
#include "harness/cli/validate_failure.h"

#include "base/files.h"
#include "base/interrupt.h"
#include "harness/data.h"
#include "harness/engines/vulkan_device.h"
#include "harness/physics/physics.h"
#include "harness/report/charts.h"
#include "harness/report/report.h"
#include "harness/report/validate.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct request {
    struct neph_cli_shared shared; /* operands: scenes */
    struct neph_cli_words engines, only, presets;
    const char *tier, *suite, *check, *pictures;
    int budget_s, samples, jobs, page_limit_mb, seed;
    bool no_charts, on_device;
};

/* ---- tiers ----------------------------------------------------------------------------------- */

/* How much of the main job is run. */
struct tier {
    const char *name;
    const char *const *scenes;  /* of the catalogue, NULL-terminated; NULL: all of it */
    const char *const *engines; /* NULL-terminated; NULL: every engine that is no shortcut */
    int width_px, height_px;    /* of the scenes' frames */
    double budget_s;            /* of each frame of an external renderer */
    const char *const *charts;  /* ids, NULL-terminated; NULL: all */
    int chart_repeats;          /* runs of each point of a chart */
};

/* A fog with lit ground, a slab, a cloud of optical depths of tens: every engine can do them, and
 * there is an exact answer to each. */
static const char *const quick_scenes[] = {"height_fog_down", "scattering_slab_above",
                                           "grid_cloud_single", NULL};
static const char *const quick_engines[] = {"exact",  "tracer", "march", "realtime",
                                            "cycles", "povray", NULL};
static const char *const quick_charts[] = {"slab", NULL};

enum { QUICK, FULL, TIER_COUNT };
static const struct tier tiers[TIER_COUNT] = {
    [QUICK] = {.name = "quick",
               .scenes = quick_scenes,
               .engines = quick_engines,
               .width_px = 128,
               .height_px = 72,
               .budget_s = 30.0,
               .charts = quick_charts,
               .chart_repeats = 1},
    [FULL] =
        {.name = "full", .width_px = 192, .height_px = 108, .budget_s = 300.0, .chart_repeats = 3},
};

/* NULL: there is none. */
static const struct tier *find_tier(const char *name)
{
    for (int i = 0; i < TIER_COUNT; i++)
        if (strcmp(tiers[i].name, name) == 0)
            return &tiers[i];
    return NULL;
}

/* ---- options --------------------------------------------------------------------------------- */

static const struct neph_cli_option options[] = {
    {"tier", 0, "NAME",
     "quick: a fog, a slab, a cloud, a chart and a sequence, a few minutes on two cores (default); "
     "full: the whole catalogue, all engines, all charts",
     NEPH_CLI_WORD, .at = offsetof(struct request, tier)},
    {"suite", 0, "NAME",
     "catalog: the same as --tier full; physics: every engine against truth that needs no "
     "renderer; "
     "failure: presets of realtime where such methods fail, and engines in fog, with limits (tiers "
     "quick, full)",
     NEPH_CLI_WORD, .at = offsetof(struct request, suite)},
    {"check", 0, "TEXT", "Of the physics suite: only checks whose name or rung contains TEXT",
     NEPH_CLI_WORD, .at = offsetof(struct request, check)},
    {"samples", 0, "N",
     "Of the physics suite: paths per pixel and seed of our tracers (default: 256)",
     NEPH_CLI_INTEGER, .at = offsetof(struct request, samples), .minimum = 2, .maximum = 1000000},
    {"only", 0, "SCENARIO",
     "Of the failure suite: only this scenario, whatever its tier; may be given several times",
     NEPH_CLI_WORDS, .at = offsetof(struct request, only)},
    {"preset", 0, "NAME",
     "Of the failure suite: only this preset, or PRESET+KEY=VALUE; may be given several times "
     "(default: seed, fixed and ours, in the full tier all but ours1; march, cycles and povray "
     "beside them)",
     NEPH_CLI_WORDS, .at = offsetof(struct request, presets)},
    {"on-device", 0, NULL,
     "Of the failure suite: only count bad values, in all images of every frame, on the device "
     "(preset off, which has none: in its pictures); nothing is kept",
     NEPH_CLI_FLAG, .at = offsetof(struct request, on_device)},
    {"jobs", 'j', "N",
     "Processes that render at the same time: scenes, checks of the physics suite, or trials of "
     "the failure suite; results do not depend on it (default: 1)",
     NEPH_CLI_INTEGER, .at = offsetof(struct request, jobs), .minimum = 1,
     .maximum = NEPH_FAILURE_JOBS_MAX},
    {"pictures", 0, "WHICH",
     "Of the failure suite: results that the page has pictures of: failed (default), changed, all, "
     "none",
     NEPH_CLI_WORD, .at = offsetof(struct request, pictures)},
    {"page-limit", 0, "MB",
     "Of the failure suite: what the page may take; the worst results have their pictures first "
     "(default: 60)",
     NEPH_CLI_INTEGER, .at = offsetof(struct request, page_limit_mb), .minimum = 1,
     .maximum = 1000000},
    {"engine", 'e', "NAME", "Only this engine; may be given several times (default: all)",
     NEPH_CLI_WORDS, .at = offsetof(struct request, engines)},
    {.name = "set",
     .argument = "ENGINE:KEY=VALUE",
     .help = "A setting of an engine, in scenes and not in charts; may be given several times"},
    {.name = "size", .help = "Size in pixels (default: 192x108; quick: 128x72)"},
    {"seed", 0, "N", "Of scenes: the N-th seed of engines that draw paths (default: 1)",
     NEPH_CLI_INTEGER, .at = offsetof(struct request, seed), .minimum = 1, .maximum = 1000000},
    {.name = "output", .help = "Folder of the store and the report", .otherwise = "out"},
    {"no-charts", 0, NULL,
     "Leave out the speed-against-accuracy charts and the sequence; so do named scenes and engines",
     NEPH_CLI_FLAG, .at = offsetof(struct request, no_charts)},
    {"budget", 0, "S",
     "Seconds that Blender or POV-Ray may take for one picture; what needs more gets fewer "
     "samples, or is reported as not fitting (default: 300; quick: 30)",
     NEPH_CLI_INTEGER, .at = offsetof(struct request, budget_s), .minimum = 1, .maximum = 1000000},
    {.name = "time-limit", .kind = NEPH_CLI_ALIAS},
    {.name = "blender"},
    {.name = "json", .help = "The whole document as JSON on stdout"},
    {.name = "quiet"},
    {.name = NULL},
};

static const struct neph_cli_operands operands = {.shown = "[SCENE...]"};

static bool is_physics(const struct request *request)
{
    return request->suite && strcmp(request->suite, "physics") == 0;
}

static bool is_failure(const struct request *request)
{
    return request->suite && strcmp(request->suite, "failure") == 0;
}

/* What belongs to the failure suite, and what does not. */
static void check_failure(const struct request *request, const struct argp_state *state)
{
    const struct neph_cli_shared *shared = &request->shared;
    if (!is_failure(request)) {
        if (request->only.count > 0 || request->presets.count > 0 || request->pictures ||
            request->page_limit_mb >= 0 || request->on_device)
            argp_error(state, "--only, --preset, --pictures, --page-limit and --on-device belong "
                              "to --suite failure");
        return;
    }
    if (shared->operand_count > 0)
        argp_error(state, "the failure suite has scenarios of its own; --only chooses among them");
    if (shared->settings.count > 0)
        argp_error(state, "the failure suite has no --set; presets take settings: --preset "
                          "NAME+KEY=VALUE");
    if (request->pictures &&
        neph_cli_failure_pictures(request->pictures) == NEPH_FAILURE_PICTURES_COUNT)
        argp_error(state, "there are no pictures '%s'; there are failed, changed, all and none",
                   request->pictures);
}

static void check(const void *request_, const struct argp_state *state)
{
    const struct request *request = request_;
    const struct neph_cli_shared *shared = &request->shared;
    if (request->suite && strcmp(request->suite, "catalog") != 0 && !is_physics(request) &&
        !is_failure(request))
        argp_error(state, "there is no suite '%s'; there are catalog, physics and failure",
                   request->suite);
    check_failure(request, state);
    if (request->tier && !find_tier(request->tier))
        argp_error(state, "there is no tier '%s'; there are quick and full", request->tier);
    if (request->check && request->check[0] == '\0')
        argp_error(state, "--check needs a part of the name of a check or rung");
    if (is_physics(request) && shared->settings.count > 0)
        argp_error(state, "the physics suite chooses its engines' settings itself: no --set");
    if (request->seed > 0 && (is_physics(request) || is_failure(request)))
        argp_error(state, "--seed is of scenes; the suites have their own");
    if (!is_physics(request) && (request->check || request->samples >= 0))
        argp_error(state, "--check and --samples belong to --suite physics");
    if (request->suite && request->tier && !is_failure(request))
        argp_error(state, "either --suite or --tier: the catalogue is --tier full");
    if (is_physics(request) && shared->operand_count > 0)
        argp_error(state,
                   "the physics suite makes its own scenes; '%s' cannot be given, "
                   "--check chooses among them",
                   shared->operands[0]);
}

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &operands,
    .check = check,
    .doc =
        "Run scenes (default: those of the quick tier) over engines, measure each against the "
        "highest rung of truth, check the gates, and write DIR/report/index.html: from the first "
        "scene on, so that it can be watched.\v"
        "Finished frames are kept in DIR/store and used again; an interrupted or killed run "
        "goes on where it stopped. Both folders are neph's own: one of that name that neph did "
        "not make is refused. Runs at the same time may share DIR: each frame is stored once, "
        "and the report is that of the run that wrote it last. A missing engine is reported as "
        "missing and the others go on. Exit code 1: a gate failed, an engine broke, or nothing "
        "could be compared.\n\n"
        "Examples:\n"
        "  neph validate\n"
        "  neph validate --tier full --budget 120\n"
        "  neph validate fence_backlit --size 320x180\n"
        "  neph validate my_fog.yaml -e exact -e march -s march:steps=256 -o /tmp/fog\n"
        "  neph validate --suite physics --jobs 4 -o out/physics\n"
        "  neph validate --suite physics --check slab -e oracle -e tracer --samples 4096\n"
        "  neph validate --suite failure --only fence_tiles --preset fixed+override=parallel\n"
        "  neph validate --suite failure --only fog_seam -e povray --pictures all",
};

/* ---- scenes, and the physics suite ----------------------------------------------------------- */

struct work {
    const struct request *request;
    const char *engines[NEPH_ENGINE_COUNT]; /* those of the tier */
    struct neph_validate_params params;
    struct neph_charts_params charts;
    struct neph_shared_device device;
    struct neph_store *store;
    struct neph_report *report;
    struct neph_validation validation;
    struct neph_physics physics;
};

/* The engines of a tier, and other Blenders beside `cycles`. */
static void choose_engines(const char *const *wanted, struct work *work)
{
    int known;
    const struct neph_engine *const *engines = neph_engines(&known);
    work->params.engines = work->engines;
    work->params.engine_count = 0;
    for (int i = 0; i < known; i++)
        for (const char *const *name = wanted; *name; name++)
            if (neph_engine_is(engines[i], *name))
                work->engines[work->params.engine_count++] = engines[i]->name;
}

/* The tier of a run without --tier: scenes that are named get all engines, as in the full tier. */
static const struct tier *tier_of(const struct request *request)
{
    if (request->tier)
        return find_tier(request->tier);
    return &tiers[request->suite || request->shared.operand_count > 0 ? FULL : QUICK];
}

static enum neph_status show_page(struct neph_validation *validation, void *context,
                                  struct neph_diag *diag)
{
    return neph_report_publish(context, validation, diag);
}

/* From the tier and what the command line says over it. */
static void make_params(struct work *work, const char *const *scenes, int scene_count)
{
    const struct request *request = work->request;
    const struct neph_cli_shared *shared = &request->shared;
    const struct tier *tier = tier_of(request);
    struct neph_validate_params *params = &work->params;
    const bool names_scenes = shared->operand_count > 0, names_engines = request->engines.count > 0;
    const bool is_whole = !names_scenes && !names_engines && !request->no_charts &&
                          !is_physics(request);
    const double budget_s = request->budget_s >= 0 ? request->budget_s : tier->budget_s;
    work->charts = (struct neph_charts_params){.ids = tier->charts,
                                               .repeats = tier->chart_repeats,
                                               .time_limit_s = budget_s,
                                               .device = &work->device};
    *params = (struct neph_validate_params){
        .scenes = scenes,
        .scene_count = is_physics(request) ? 0 : scene_count,
        .engines = request->engines.list,
        .engine_count = request->engines.count,
        .settings = shared->settings.list,
        .setting_count = shared->settings.count,
        .width_px = shared->size.width_px > 0 ? shared->size.width_px : tier->width_px,
        .height_px = shared->size.width_px > 0 ? shared->size.height_px : tier->height_px,
        .seed = request->seed > 0 ? request->seed : 1,
        .budget_s = budget_s,
        .device = &work->device,
        .jobs = request->jobs,
        .quiet = shared->quiet,
        .skip_absent = !names_scenes,
        .over_time = is_whole,
        .charts = is_whole ? &work->charts : NULL,
        .show = show_page,
        .context = work->report,
    };
    if (!names_engines && !names_scenes && tier->engines)
        choose_engines(tier->engines, work);
}

/* The physics suite: the frame of a validation without scenes, and the checks. */
static enum neph_status run_physics(struct work *work, struct neph_diag *diag)
{
    const struct request *request = work->request;
    struct neph_validation *validation = &work->validation;
    struct neph_physics *physics = &work->physics;
    const struct neph_physics_params params = {.engines = request->engines.list,
                                               .engine_count = request->engines.count,
                                               .only = request->check,
                                               .jobs = request->jobs < 0 ? 1 : request->jobs,
                                               .samples = request->samples < 0 ? 256
                                                                               : request->samples,
                                               .time_limit_s = (int)work->params.budget_s,
                                               .device = &work->device,
                                               .quiet = request->shared.quiet};
    const enum neph_status status = neph_physics_run(&params, work->store, physics, diag);
    if (status)
        return status;
    validation->title = "Nephelometer physics suite";
    validation->physics = physics;
    validation->verdict = physics->passes ? NEPH_VERDICT_PASS : NEPH_VERDICT_FAIL;
    validation->counts = (struct neph_counts){
        .expected = physics->expected, .reported = physics->row_count, .compared = physics->tests};
    validation->seconds = physics->seconds;
    return NEPH_OK;
}

static enum neph_status tell(const struct request *request,
                             const struct neph_validation *validation, const char *report_folder,
                             struct neph_diag *diag)
{
    const struct neph_physics *physics = validation->physics;
    const struct neph_counts *counts = &validation->counts;
    enum neph_status status = NEPH_OK;
    if (request->shared.json)
        status = neph_json_print(neph_validation_json(validation), diag);
    else if (physics)
        neph_physics_print(physics);
    else
        neph_validation_print(validation);
    FILE *out = request->shared.json ? stderr : stdout;
    fprintf(out, "%s: %d of %d in the report, %d compared with the truth\n",
            physics ? "rows" : "frames", counts->reported, counts->expected, counts->compared);
    if (counts->ungated > 0)
        fprintf(
            out,
            "gates: of %d no gate limits the radiance: its mean is to be within a factor of two "
            "of the truth's\n",
            counts->ungated);
    fprintf(out, "verdict: %s\nreport: %s/index.html\n", neph_verdict_name(validation->verdict),
            report_folder);
    if (status || validation->verdict == NEPH_VERDICT_PASS)
        return status;
    if (counts->reported != counts->expected)
        return neph_fail(diag, NEPH_ERR_INTERNAL, "%d of %d results are not in the report",
                         counts->expected - counts->reported, counts->expected);
    if (counts->compared == 0) {
        neph_fail(diag, NEPH_ERR_GATE, "nothing was compared with a truth: that is no verdict");
        neph_hint(diag, "a run needs an engine that is the truth of its scenes (exact, oracle, "
                        "tracer) and another; the report says why frames are missing");
        return NEPH_ERR_GATE;
    }
    return neph_fail(diag, NEPH_ERR_GATE,
                     physics ? "an engine that claims to be the truth is off, or an engine broke; "
                               "the report names it"
                             : "a gate failed or an engine broke; the report names it");
}

/* The page of a run that was cut short holds what is there; the status says that it was. */
static enum neph_status publish(struct work *work, enum neph_status status, struct neph_diag *diag)
{
    if (!work->validation.title || (status && status != NEPH_ERR_INTERRUPTED))
        return status;
    if (!status)
        return neph_report_publish(work->report, &work->validation, diag);
    neph_interrupt_acknowledge();
    neph_report_publish(work->report, &work->validation, NULL);
    return status;
}

static enum neph_status run_in(struct work *work, const char *store_folder,
                               const char *report_folder, const char *const *scenes,
                               int scene_count, struct neph_diag *diag)
{
    enum neph_status status = neph_report_open(report_folder, &work->report, diag);
    if (!status)
        status = neph_store_open(store_folder, &work->store, diag);
    make_params(work, scenes, scene_count);
    if (!status)
        status = neph_validate(&work->params, work->store, &work->validation, diag);
    if (!status && is_physics(work->request))
        status = run_physics(work, diag);
    neph_shared_device_close(&work->device);
    status = publish(work, status, diag);
    return status ? status : tell(work->request, &work->validation, report_folder, diag);
}

static enum neph_status run(const struct request *request, const char *const *scenes,
                            int scene_count, struct neph_diag *diag)
{
    struct work work = {.request = request};
    char *store_folder = neph_path_join(request->shared.output, "store");
    char *report_folder = neph_path_join(request->shared.output, "report");
    const enum neph_status status = store_folder && report_folder
                                        ? run_in(&work, store_folder, report_folder, scenes,
                                                 scene_count, diag)
                                        : neph_fail_memory(diag);
    neph_validation_finish(&work.validation);
    neph_physics_finish(&work.physics);
    neph_store_close(work.store);
    neph_report_close(work.report);
    free(store_folder);
    free(report_folder);
    return status;
}

/* The whole catalogue, for tiers without a list. */
static enum neph_status run_catalog(const struct request *request, struct neph_diag *diag)
{
    char **names = NULL;
    int count = 0;
    enum neph_status status = neph_data_list_scenes(NEPH_DATA_CATALOG, &names, &count, diag);
    if (!status)
        status = run(request, (const char *const *)names, count, diag);
    neph_data_free_names(names);
    return status;
}

static enum neph_status run_failure(const struct request *request, struct neph_diag *diag)
{
    const struct neph_cli_shared *shared = &request->shared;
    struct neph_shared_device device = {.open = NULL};
    struct neph_failure_params params = {.full = request->tier &&
                                                 strcmp(request->tier, "full") == 0,
                                         .only = request->only.list,
                                         .only_count = request->only.count,
                                         .presets = request->presets.list,
                                         .preset_count = request->presets.count,
                                         .engines = request->engines.list,
                                         .engine_count = request->engines.count,
                                         .width_px = shared->size.width_px,
                                         .height_px = shared->size.height_px,
                                         .on_device = request->on_device,
                                         .jobs = request->jobs < 0 ? 1 : request->jobs,
                                         .device = &device,
                                         .quiet = shared->quiet};
    const size_t limit_mb = request->page_limit_mb < 0 ? 60 : (size_t)request->page_limit_mb;
    if (request->pictures)
        params.pictures = neph_cli_failure_pictures(request->pictures);
    const enum neph_status status = neph_cli_validate_failure(
        &params, shared->output, limit_mb * 1000000, shared->json, diag);
    neph_shared_device_close(&device);
    return status;
}

enum neph_status neph_cli_validate(int argc, char **argv, struct neph_diag *diag)
{
    struct request request = {0};
    neph_cli_parse(&syntax, argc, argv, &request);
    const struct neph_cli_shared *shared = &request.shared;
    if (is_failure(&request))
        return run_failure(&request, diag);
    if (shared->operand_count > 0)
        return run(&request, shared->operands, shared->operand_count, diag);
    const char *const *scenes = tier_of(&request)->scenes;
    int count = 0;
    while (scenes && scenes[count])
        count++;
    return scenes ? run(&request, scenes, count, diag) : run_catalog(&request, diag);
}
