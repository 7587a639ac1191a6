/* SPDX-License-Identifier: MIT
 *
 * `neph validate`: the main job.
 */
#include "harness/cli/cli.h"

#include "base/files.h"
#include "base/interrupt.h"
#include "harness/data.h"
#include "harness/physics/physics.h"
#include "harness/report/charts.h"
#include "harness/report/report.h"
#include "harness/report/tier.h"
#include "harness/report/validate.h"

#include <argp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    KEY_JSON = 1,
    KEY_SIZE,
    KEY_TIER,
    KEY_BUDGET,
    KEY_NO_CHARTS,
    KEY_SUITE,
    KEY_CHECK,
    KEY_SAMPLES,
    LIST_MAX = 256
};

struct request {
    const char *scenes[LIST_MAX], *engines[LIST_MAX];
    int scene_count, engine_count;
    const char *output, *size, *budget, *tier, *suite, *check, *samples;
    bool json, quiet, no_charts;
};

static const struct argp_option options[] = {
    {"tier", KEY_TIER, "NAME", 0,
     "quick: a fog, a slab, a cloud, a chart and a sequence, a few minutes on two cores (default); "
     "full: the whole catalogue, all engines, all charts",
     0},
    {"suite", KEY_SUITE, "NAME", 0,
     "catalog: the same as --tier full; physics: every engine against truth that needs no renderer",
     0},
    {"check", KEY_CHECK, "TEXT", 0,
     "Of the physics suite: only checks whose name or rung contains TEXT", 0},
    {"samples", KEY_SAMPLES, "N", 0,
     "Of the physics suite: paths per pixel and seed of our tracers (default: 256)", 0},
    {"engine", 'e', "NAME", 0, "Only this engine; may be given several times (default: all)", 0},
    {"size", KEY_SIZE, "WxH", 0, "Size in pixels (default: 192x108; quick: 128x72)", 0},
    {"output", 'o', "DIR", 0, "Folder of the store and the report (default: out)", 0},
    {"no-charts", KEY_NO_CHARTS, NULL, 0,
     "Leave out the speed-against-accuracy charts and the sequence; so do named scenes and engines",
     0},
    {"budget", KEY_BUDGET, "S", 0,
     "Seconds that Blender or POV-Ray may take for one picture; what needs more gets fewer "
     "samples, "
     "or is reported as not fitting (default: 300; quick: 30)",
     0},
    {"time-limit", KEY_BUDGET, NULL, OPTION_ALIAS, NULL, 0},
    {"json", KEY_JSON, NULL, 0, "The whole document as JSON on stdout", 0},
    {"quiet", 'q', NULL, 0, "No progress", 0},
    {0},
};

static bool is_physics(const struct request *request)
{
    return request->suite && strcmp(request->suite, "physics") == 0;
}

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct request *request = state->input;
    switch (key) {
    case 'e':
        if (request->engine_count == LIST_MAX)
            argp_error(state, "more than %d engines", LIST_MAX);
        request->engines[request->engine_count++] = argument;
        return 0;
    case 'o':
        request->output = neph_cli_output(state, "--output", argument);
        return 0;
    case 'q':
        request->quiet = true;
        return 0;
    case KEY_SUITE:
        if (strcmp(argument, "catalog") != 0 && strcmp(argument, "physics") != 0)
            argp_error(state, "there is no suite '%s'; there are catalog and physics", argument);
        request->suite = argument;
        return 0;
    case KEY_CHECK:
        if (argument[0] == '\0')
            argp_error(state, "--check needs a part of the name of a check or rung");
        request->check = argument;
        return 0;
    case KEY_SAMPLES:
        request->samples = argument;
        return 0;
    case KEY_SIZE:
        request->size = argument;
        return 0;
    case KEY_BUDGET:
        request->budget = argument;
        return 0;
    case KEY_TIER:
        if (!neph_tier_find(argument))
            argp_error(state, "there is no tier '%s'; there are quick and full", argument);
        request->tier = argument;
        return 0;
    case KEY_NO_CHARTS:
        request->no_charts = true;
        return 0;
    case KEY_JSON:
        request->json = true;
        return 0;
    case ARGP_KEY_ARG:
        if (request->scene_count == LIST_MAX)
            argp_error(state, "more than %d scenes", LIST_MAX);
        request->scenes[request->scene_count++] = argument;
        return 0;
    case ARGP_KEY_END:
        if (!is_physics(request) && (request->check || request->samples))
            argp_error(state, "--check and --samples belong to --suite physics");
        if (request->suite && request->tier)
            argp_error(state, "either --suite or --tier: the catalogue is --tier full");
        if (is_physics(request) && request->scene_count > 0)
            argp_error(state,
                       "the physics suite makes its own scenes; '%s' cannot be given, "
                       "--check chooses among them",
                       request->scenes[0]);
        return 0;
    }
    return ARGP_ERR_UNKNOWN;
}

static const struct argp argp = {
    .options = options,
    .parser = parse,
    .args_doc = "[SCENE...]",
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
        "  neph validate my_fog.yaml -e exact -e march -o /tmp/fog\n"
        "  neph validate --suite physics -o out/physics\n"
        "  neph validate --suite physics --check slab -e oracle -e tracer --samples 4096",
};

/* The document of the physics suite: the frame of a validation without scenes, and the checks. */
static enum neph_status run_physics(const struct request *request, int time_limit_s,
                                    struct neph_store *store, json_t *document,
                                    struct neph_diag *diag)
{
    int samples = 0;
    enum neph_status status = neph_cli_parse_int(
        "samples", request->samples ? request->samples : "256", 2, 1000000, &samples, diag);
    if (status)
        return status;
    const struct neph_physics_params params = {.engines = request->engines,
                                               .engine_count = request->engine_count,
                                               .only = request->check,
                                               .samples = samples,
                                               .time_limit_s = time_limit_s,
                                               .quiet = request->quiet};
    json_t *physics = NULL;
    status = neph_physics_run(&params, store, &physics, diag);
    if (status)
        return status;
    return neph_json_merge(document,
                           json_pack("{s:O, s:O, s:O, s:s, s:o}", "verdict",
                                     json_object_get(physics, "verdict"), "counts",
                                     json_object_get(physics, "counts"), "seconds",
                                     json_object_get(physics, "seconds"), "title",
                                     "Nephelometer physics suite", "physics", physics),
                           diag);
}

/* What a run without words on it is: scenes that are named get all engines, as in the full tier. */
static const struct neph_tier *tier_of(const struct request *request)
{
    if (request->tier)
        return neph_tier_find(request->tier);
    return request->suite || request->scene_count > 0 ? neph_tier_find("full") : neph_tiers();
}

/* From the tier and what the command line says over it. */
static enum neph_status make_params(const struct request *request, const struct neph_tier *tier,
                                    struct neph_validate_params *params,
                                    struct neph_charts_params *charts, struct neph_diag *diag)
{
    const bool is_whole = request->scene_count == 0 && request->engine_count == 0;
    int budget_s = (int)tier->budget_s;
    *params = (struct neph_validate_params){.engines = request->engines,
                                            .engine_count = request->engine_count,
                                            .width_px = tier->width_px,
                                            .height_px = tier->height_px,
                                            .quiet = request->quiet,
                                            .skip_absent = request->scene_count == 0,
                                            .over_time = is_whole && !request->no_charts};
    if (request->engine_count == 0 && tier->engines && request->scene_count == 0)
        for (params->engines = tier->engines; tier->engines[params->engine_count];)
            params->engine_count++;
    enum neph_status status = NEPH_OK;
    if (request->size)
        status = neph_cli_parse_size(request->size, &params->width_px, &params->height_px, diag);
    if (!status && request->budget)
        status = neph_cli_parse_int("budget", request->budget, 1, 1000000, &budget_s, diag);
    params->budget_s = budget_s;
    *charts = (struct neph_charts_params){
        .ids = tier->charts, .repeats = tier->chart_repeats, .time_limit_s = budget_s};
    params->charts = is_whole && !request->no_charts ? charts : NULL;
    return status;
}

static enum neph_status show_page(json_t *document, void *context, struct neph_diag *diag)
{
    return neph_report_publish(context, document, diag);
}

static enum neph_status run_suite(const struct request *request, struct neph_report *report,
                                  const char *const *scenes, int scene_count,
                                  struct neph_store *store, json_t **document,
                                  struct neph_diag *diag)
{
    struct neph_validate_params params;
    struct neph_charts_params charts;
    enum neph_status status = make_params(request, tier_of(request), &params, &charts, diag);
    params.scenes = scenes;
    params.scene_count = scene_count;
    params.show = show_page;
    params.context = report;
    if (is_physics(request)) {
        params.scene_count = 0;
        params.charts = NULL;
        params.over_time = false;
    }
    if (!status)
        status = neph_validate(&params, store, document, diag);
    if (!status && is_physics(request))
        status = run_physics(request, (int)params.budget_s, store, *document, diag);
    return status;
}

static int count_of(const json_t *counts, const char *key)
{
    return (int)json_integer_value(json_object_get(counts, key));
}

static enum neph_status tell(const struct request *request, json_t *document,
                             const char *report_folder, struct neph_diag *diag)
{
    const json_t *physics = json_object_get(document, "physics");
    enum neph_status status = NEPH_OK;
    if (request->json)
        status = neph_cli_print_json(json_incref(document), diag);
    else if (physics)
        neph_physics_print(physics);
    else
        neph_validate_print(document);
    FILE *out = request->json ? stderr : stdout;
    const char *verdict = json_string_value(json_object_get(document, "verdict"));
    const json_t *counts = json_object_get(document, "counts");
    const int expected = count_of(counts, "expected"), reported = count_of(counts, "reported");
    const int compared = count_of(counts, "compared");
    fprintf(out, "%s: %d of %d in the report, %d compared with the truth\n",
            physics ? "rows" : "frames", reported, expected, compared);
    fprintf(out, "verdict: %s\nreport: %s/index.html\n", verdict, report_folder);
    if (status || strcmp(verdict, "pass") == 0)
        return status;
    if (reported != expected)
        return neph_fail(diag, NEPH_ERR_INTERNAL, "%d of %d results are not in the report",
                         expected - reported, expected);
    if (compared == 0) {
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
static enum neph_status publish(struct neph_report *report, json_t *document,
                                enum neph_status status, struct neph_diag *diag)
{
    if (!document)
        return status;
    if (status != NEPH_ERR_INTERRUPTED)
        return status ? status : neph_report_publish(report, document, diag);
    neph_interrupt_acknowledge();
    neph_report_publish(report, document, NULL);
    return status;
}

static enum neph_status run(const struct request *request, const char *const *scenes,
                            int scene_count, struct neph_diag *diag)
{
    struct neph_store *store = NULL;
    struct neph_report *report = NULL;
    json_t *document = NULL;
    char *store_folder = neph_path_join(request->output, "store");
    char *report_folder = neph_path_join(request->output, "report");
    enum neph_status status = store_folder && report_folder
                                  ? neph_report_open(report_folder, &report, diag)
                                  : neph_fail_memory(diag);
    if (!status)
        status = neph_store_open(store_folder, &store, diag);
    if (!status)
        status = run_suite(request, report, scenes, scene_count, store, &document, diag);
    status = publish(report, document, status, diag);
    if (!status)
        status = tell(request, document, report_folder, diag);
    json_decref(document);
    neph_store_close(store);
    neph_report_close(report);
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

enum neph_status neph_cli_validate(int argc, char **argv, struct neph_diag *diag)
{
    struct request request = {.output = "out"};
    neph_cli_parse(&argp, argc, argv, &request);
    const enum neph_status status = neph_cli_check_output("-o", request.output, diag);
    if (status)
        return status;
    if (request.scene_count > 0)
        return run(&request, request.scenes, request.scene_count, diag);
    const char *const *scenes = tier_of(&request)->scenes;
    int count = 0;
    while (scenes && scenes[count])
        count++;
    return scenes ? run(&request, scenes, count, diag) : run_catalog(&request, diag);
}
