/* SPDX-License-Identifier: MIT
 *
 * `neph nightly`: measures a list of suites and compares the numbers with the accepted baseline.
 */
#include "harness/cli/cli.h"

#include "base/files.h"
#include "base/path.h"
#include "harness/night/output.h"
#include "harness/night/page.h"
#include "harness/night/send.h"
#include "harness/old_options.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const size_t report_limit_bytes = 256 << 20;

/* Size limit of the page's images: a report with its numbers has to stay under 60 MB. */
static const size_t pictures_limit_bytes = 50000000;

struct request {
    struct neph_cli_shared shared;
    const char *tier, *revision, *executor, *step, *limits;
    struct neph_cli_list only, engines;
    struct neph_cli_words slurm;
    double minutes;
    int against, seed;
    bool lists, once, reports, only_engine;
};

static const struct neph_cli_option options[] = {
    {"tier", 0, "NAME", "quick, or full: the whole catalogue, all checks and all scenarios",
     NEPH_CLI_WORD, .at = offsetof(struct request, tier), .otherwise = "quick"},
    {"only", 0, NULL, "Only steps with one of these texts in their name", NEPH_CLI_NAMES,
     .at = offsetof(struct request, only)},
    {"minutes", 0, "M", "No step begins that does not fit into so many (default: all steps)",
     NEPH_CLI_REAL, .at = offsetof(struct request, minutes), .minimum = 0.01, .maximum = 1e5},
    {"revision", 0, "TEXT", "Version of the sources; scripts/nightly takes it from git",
     NEPH_CLI_WORD, .at = offsetof(struct request, revision)},
    {"against", 0, "N", "Compare with nightly run N (default: the last accepted one)",
     NEPH_CLI_INTEGER, .at = offsetof(struct request, against), .minimum = 1, .maximum = 1e9},
    {"limits", 0, "FILE", "Numbers beyond their limit in a file of `neph limits` are worse, too",
     NEPH_CLI_WORD, .at = offsetof(struct request, limits)},
    {"seed", 0, NULL, "The S-th seed of engines that draw paths, in the catalogue (default: 1)",
     NEPH_CLI_INTEGER, .at = offsetof(struct request, seed), .minimum = 1, .maximum = 1000000},
    {"once", 0, NULL, "Run no step a second time", NEPH_CLI_FLAG,
     .at = offsetof(struct request, once)},
    {"executor", 0, "NAME",
     "Executor of the steps: local, one after the other, or slurm, as its jobs", NEPH_CLI_WORD,
     .at = offsetof(struct request, executor), .otherwise = "local"},
    {"slurm", 0, "KEY=VALUE",
     "Settings of Slurm: timing or gpu=FEATURE of the hosts that are for durations or have a GPU, "
     "partition=NAME, at_once=COUNT, arguments=\"WORDS for sbatch\"",
     NEPH_CLI_WORDS, .at = offsetof(struct request, slurm)},
    {"step", 0, "NAME", "For jobs of an executor: run only this step and leave its numbers",
     NEPH_CLI_WORD, .at = offsetof(struct request, step)},
    {"report", 0, NULL,
     "For the last job of an executor: end the run with the numbers of the other jobs",
     NEPH_CLI_FLAG, .at = offsetof(struct request, reports)},
    {"list", 0, NULL, "Print the steps and run none", NEPH_CLI_FLAG,
     .at = offsetof(struct request, lists)},
    {"engine", 0, NULL, "Further engines for the catalogue, such as command", NEPH_CLI_NAMES,
     .at = offsetof(struct request, engines)},
    {"only-engine", 0, NULL,
     "Only scenes of the catalogue; beside the engines of -e render only the reference of each",
     NEPH_CLI_FLAG, .at = offsetof(struct request, only_engine)},
    {.name = "set",
     .argument = "ENGINE:KEY=VALUE",
     .help = "A setting of an engine in the catalogue, as if it were the default"},
    {.name = "size", .help = "Of the catalogue, sweeps and speeds, in place of the plan's"},
    {.name = "output", .help = "Folder of the store and of nightly/", .otherwise = "out/nightly"},
    {.name = "json"},
    {.name = "quiet"},
    {.name = NULL},
};

static void check(const void *given, const struct argp_state *state)
{
    const struct request *request = given;
    if (strcmp(request->executor, "local") != 0 && strcmp(request->executor, "slurm") != 0)
        argp_error(state, "--executor %s: local or slurm", request->executor);
    if (request->slurm.count > 0 && strcmp(request->executor, "slurm") != 0)
        argp_error(state, "--slurm wants --executor slurm");
    if (request->only_engine && request->engines.count == 0)
        argp_error(state, "--only-engine needs -e, which names the engines that it is about");
    if (request->step && request->reports)
        argp_error(state, "--step and --report are two jobs");
}

static const struct neph_cli_syntax syntax = {
    .options = options,
    .check = check,
    .doc = "A nightly run: measure, compare with the accepted run, report changes.\v"
           "Steps run one after the other, first those that give the most numbers per second; "
           "steps that the time limit has left out come first in the next run. A killed run "
           "continues where it stopped. Results are printed as one paragraph, and written to "
           "DIR/nightly: summary.txt, nightly.json, junit.xml, and a log for each step.\n\n"
           "A number is worse when the change is more than chance and large enough to matter. "
           "Durations count when three runs in a row agree. Exit code 1: something is worse, "
           "missing or blank, a scene was edited, a series of the accepted run is lost, a step "
           "failed, or nothing was compared, as in the first run: `neph baseline accept` makes it "
           "the baseline. docs/nightly.md describes operation.\n\n"
           "Examples:\n"
           "  neph nightly\n"
           "  neph nightly --tier full --minutes 240 -o nights\n"
           "  neph nightly --only voxel_grid --against 12\n"
           "  neph nightly --executor slurm --slurm partition=render --slurm timing=quiet",
};

static bool is_by_slurm(const struct request *request)
{
    return strcmp(request->executor, "slurm") == 0 && !request->reports;
}

/* Check, before any work, that the plan exists; print it with `prints`. */
static enum neph_status validate_plan(const struct neph_night_plan_params *params, bool prints,
                                      struct neph_diag *diag)
{
    struct neph_arena arena = {NULL};
    struct neph_night_plan plan;
    const enum neph_status status = neph_night_plan_make(params, &arena, &plan, diag);
    for (int i = 0; !status && prints && i < plan.count; i++) {
        printf("%-36s neph", plan.steps[i].name);
        for (int w = 0; plan.steps[i].words[w]; w++)
            printf(" %s", plan.steps[i].words[w]);
        putchar('\n');
    }
    neph_arena_finish(&arena);
    return status;
}

static enum neph_status tell(const struct request *request, const struct neph_night *night,
                             struct neph_diag *diag)
{
    const char *output = request->shared.output;
    enum neph_status status = neph_night_write(night, request->tier, output, diag);
    if (!status && request->shared.json) {
        status = neph_json_print(neph_night_json(night, request->tier), diag);
    } else if (!status) {
        char *summary = NULL;
        status = neph_night_summary(night, request->tier, &summary, diag);
        if (!status)
            fputs(summary, stdout);
        free(summary);
    }
    if (!status && !request->shared.quiet)
        neph_cli_print_folder("nightly", neph_path_in(output, "nightly").text);
    if (status || night->comparison.passes)
        return status;
    return neph_fail(diag, NEPH_ERR_GATE, "the nightly run %s; details are in %s/nightly",
                     neph_night_verdict(&night->comparison).verb, output);
}

static enum neph_status run_here(const struct request *request, struct neph_night_params *params,
                                 struct neph_store *store, struct neph_diag *diag)
{
    struct neph_night_page *page = NULL;
    struct neph_night night = {.id = 0};
    enum neph_status status = neph_night_page_open(params->output, request->tier, store,
                                                   pictures_limit_bytes, &page, diag);
    params->show = neph_night_page_publish;
    params->context = page;
    if (!status)
        status = neph_night_run(params, store, &night, diag);
    if (!status)
        status = tell(request, &night, diag);
    neph_night_page_close(page);
    const bool is_told = status == NEPH_OK || status == NEPH_ERR_GATE;
    if (params->reports && is_told && neph_night_jobs_forget(params->output, NULL))
        neph_progress_warn("'%s/nightly/jobs' could not be removed", params->output);
    neph_night_finish(&night);
    return status;
}

static enum neph_status print_file(const char *output, const char *name, struct neph_diag *diag)
{
    char *text = NULL;
    size_t size;
    const enum neph_status status = neph_file_read(
        neph_path_format("%s/nightly/%s", output, name).text, report_limit_bytes, &text, &size,
        diag);
    if (!status)
        fputs(text, stdout);
    free(text);
    return status;
}

/* Read the report that the last job of the nightly run has written. */
static enum neph_status read_report(const char *output, int64_t night, json_t **report,
                                    struct neph_diag *diag)
{
    json_t *read = json_load_file(neph_path_format("%s/nightly/nightly.json", output).text, 0,
                                  NULL);
    if (read && json_integer_value(json_object_get(read, "night")) == night) {
        *report = read;
        return NEPH_OK;
    }
    json_decref(read);
    return neph_fail(
        diag, NEPH_ERR_IO,
        "nightly run %lld has ended and is in the store, but its report was not written",
        (long long)night);
}

static enum neph_status send(const struct request *request, const struct neph_night_params *params,
                             const char *const *words, struct neph_store *store,
                             struct neph_diag *diag)
{
    struct neph_slurm_settings settings = {NULL};
    int64_t night = 0;
    json_t *report = NULL;
    enum neph_status status = neph_slurm_read_settings(request->slurm.list, request->slurm.count,
                                                       &settings, diag);
    if (!status)
        status = neph_night_send(params, &settings, words, store, &night, diag);
    if (!status)
        status = read_report(params->output, night, &report, diag);
    if (!status)
        status = print_file(params->output, request->shared.json ? "nightly.json" : "summary.txt",
                            diag);
    if (!status && !json_is_true(json_object_get(report, "passes")))
        status = neph_fail(diag, NEPH_ERR_GATE,
                           "the nightly run does not pass; details are in %s/nightly",
                           params->output);
    json_decref(report);
    return status;
}

static enum neph_status run(const struct request *request, struct neph_night_params *params,
                            const char *const *words, struct neph_diag *diag)
{
    struct neph_store *store = NULL;
    neph_old_output_warn(params->output);
    enum neph_status status = neph_store_open(neph_path_in(params->output, "store").text, &store,
                                              diag);
    if (!status)
        status = is_by_slurm(request) ? send(request, params, words, store, diag)
                                      : run_here(request, params, store, diag);
    neph_store_close(store);
    return status;
}

enum neph_status neph_cli_nightly(int argc, char **argv, struct neph_diag *diag)
{
    struct request request = {0};
    struct neph_arena arena = {NULL};
    struct neph_night_limits limits = {.path = NULL};
    /* A copy of the words for the jobs: parsing reorders argv, and splits lists in it. */
    const char **words = neph_arena_allocate(&arena, (size_t)argc + 1, sizeof(*words));
    for (int i = 1; i < argc && words; i++)
        words[i - 1] = neph_arena_copy_text(&arena, argv[i]);
    enum neph_status status = neph_arena_check(&arena, diag);
    if (status) {
        neph_arena_finish(&arena);
        return status;
    }
    neph_cli_parse(&syntax, argc, argv, &request);
    const struct neph_cli_shared *shared = &request.shared;
    struct neph_night_params params = {.plan = {.tier = request.tier,
                                                .only = request.only.words,
                                                .only_count = request.only.count,
                                                .seed = request.seed > 0 ? request.seed : 1,
                                                .engines = request.engines.words,
                                                .engine_count = request.engines.count,
                                                .only_engines = request.only_engine,
                                                .settings = shared->settings.list,
                                                .setting_count = shared->settings.count,
                                                .width_px = shared->size.width_px,
                                                .height_px = shared->size.height_px},
                                       .output = shared->output,
                                       .revision = request.revision ? request.revision : "",
                                       .budget_s = isnan(request.minutes) ? INFINITY
                                                                          : 60.0 * request.minutes,
                                       .against = request.against > 0 ? request.against : 0,
                                       .once = request.once,
                                       .reports = request.reports,
                                       .quiet = shared->quiet || shared->json};
    status = validate_plan(&params.plan, request.lists, diag);
    if (!status && request.limits) {
        status = neph_night_limits_read(request.limits, &limits, diag);
        params.limits = &limits;
    }
    if (!status && request.step)
        status = neph_night_run_step(&params, request.step, diag);
    else if (!status && !request.lists)
        status = run(&request, &params, words, diag);
    neph_night_limits_finish(&limits);
    neph_arena_finish(&arena);
    return status;
}
