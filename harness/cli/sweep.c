/* SPDX-License-Identifier: MIT
 *
 * `neph sweep SCENE`.
 */
#include "harness/cli/cli.h"
#include "harness/engines/vulkan_device.h"

#include "base/files.h"
#include "harness/progress.h"
#include "harness/report/report_folder.h"
#include "harness/run/store.h"
#include "harness/sweep/output.h"
#include "harness/sweep/page.h"
#include "harness/sweep/stability.h"
#include "harness/sweep/sweep.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SEEDS_MAX = 16 };

struct request {
    struct neph_cli_shared shared;
    const char *plan, *only, *csv, *against;
    int seed, seeds;
    bool untimed, retimes;
};

static const struct neph_cli_option options[] = {
    {"plan", 0, "FILE",
     "What is swept: a YAML file, or the name of one that comes with neph (scenes/studies)",
     NEPH_CLI_WORD, .at = offsetof(struct request, plan), .otherwise = "sweep"},
    {"only", 0, "A,B", "These series of the plan alone", NEPH_CLI_WORD,
     .at = offsetof(struct request, only)},
    {"against", 0, "NAME",
     "The series that others are held against at equal error and in equal time (default: the "
     "first)",
     NEPH_CLI_WORD, .at = offsetof(struct request, against)},
    {"untimed", 0, NULL, "No times: what a point costs is its evaluations of density",
     NEPH_CLI_FLAG, .at = offsetof(struct request, untimed)},
    {"retime", 0, NULL, "Time again what DIR/times.json has times of", NEPH_CLI_FLAG,
     .at = offsetof(struct request, retimes)},
    {"seed", 0, "N", "Of all that is random", NEPH_CLI_INTEGER,
     .at = offsetof(struct request, seed), .otherwise = "1", .minimum = 1, .maximum = 1000000},
    {"seeds", 0, "N",
     "So many sweeps with seeds from --seed on, each in a store of its own, DIR/seed_K: do the "
     "fronts hold?",
     NEPH_CLI_INTEGER, .at = offsetof(struct request, seeds), .minimum = 2, .maximum = SEEDS_MAX},
    {.name = "size", .help = "Pixels, in place of the plan's"},
    {.name = "output", .help = "Folder of the store and of sweep.json", .otherwise = "out"},
    {.name = "json", .help = "All numbers as JSON on stdout, instead of the table"},
    {"csv", 0, "FILE", "A line for each point", NEPH_CLI_FILE, .at = offsetof(struct request, csv)},
    {.name = "time-limit", .otherwise = "3600"},
    {.name = "quiet"},
    {.name = NULL},
};

static void check(const void *request_, const struct argp_state *state)
{
    const struct request *request = request_;
    if (request->seeds > 0 && request->csv)
        argp_error(state, "--csv is of one sweep, not of --seeds");
}

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &neph_cli_one_scene,
    .check = check,
    .doc =
        "Engines and their settings over one scene: what each costs, and what it is off by.\v"
        "Errors are against the truth: engine exact where it has the scene, else the tracer, "
        "whose noise is printed. What a shortcut is off by against the march of its own model, "
        "its flicker and its half-life after a step of the sun stand beside that, and are never "
        "mixed with it. Times are measured in rounds over all points, with nothing else going "
        "on: keep the machine quiet. Frames are kept in DIR/store and not rendered twice, times in "
        "DIR/times.json. "
        "NEPH_VULKAN_DEVICE names the device.\n\n"
        "Examples:\n"
        "  neph sweep voxel_grid\n"
        "  neph sweep cloud_below --only march,ours,tracer --size 192x108 --csv -\n"
        "  neph sweep my_fog.yaml --plan my_sweep.yaml --json\n"
        "  neph sweep voxel_grid --seeds 3 -o fronts    # exit code 1: a front has moved",
};

enum { ONLY_MAX = NEPH_SWEEP_SERIES_MAX };

static enum neph_status write_text(const char *path, const char *text, struct neph_diag *diag)
{
    if (strcmp(path, "-") == 0)
        return fputs(text, stdout) < 0 ? neph_fail(diag, NEPH_ERR_IO, "cannot write to stdout")
                                       : NEPH_OK;
    return neph_file_write(path, text, strlen(text), diag);
}

static enum neph_status write_json(const char *folder, const char *name, json_t *json,
                                   struct neph_diag *diag)
{
    char *path = neph_path_join(folder, name);
    char *text = json ? json_dumps(json, JSON_INDENT(1)) : NULL;
    enum neph_status status = path && text ? neph_file_write(path, text, strlen(text), diag)
                                           : neph_fail_memory(diag);
    free(text);
    json_decref(json);
    free(path);
    return status;
}

static enum neph_status write_page(const struct neph_report_folder *page,
                                   const struct neph_sweep *sweep, struct neph_diag *diag)
{
    char told[512] = "";
    const enum neph_status status = neph_sweep_page_write(sweep, page, told, diag);
    if (told[0])
        neph_progress_warn("%s", told);
    return status;
}

static enum neph_status write_files(const struct neph_report_folder *page, const char *folder,
                                    const struct neph_sweep *sweep, struct neph_diag *diag)
{
    enum neph_status status = write_json(folder, "sweep.json", neph_sweep_json(sweep), diag);
    if (!status)
        status = write_page(page, sweep, diag);
    if (!status && neph_sweep_measured_count(sweep) == 0)
        status = neph_fail(diag, NEPH_ERR_GATE, "no point could be measured");
    return status;
}

static enum neph_status open_times(const char *folder, struct neph_times *times,
                                   struct neph_diag *diag)
{
    char *path = neph_path_join(folder, "times.json");
    const enum neph_status status = path ? neph_times_open(path, times, diag)
                                         : neph_fail_memory(diag);
    free(path);
    return status;
}

/* One sweep in a folder; `sweep` is to be finished in any case. */
static enum neph_status run(const struct request *request, const struct neph_sweep_plan *plan,
                            const char *const *only, const char *output, int seed,
                            struct neph_sweep *sweep, struct neph_diag *diag)
{
    const struct neph_cli_shared *shared = &request->shared;
    struct neph_times times = {NULL};
    struct neph_shared_device device = {.open = NULL};
    const struct neph_sweep_params params = {.plan = plan,
                                             .scene = shared->operands[0],
                                             .only = only,
                                             .against = request->against,
                                             .time_limit_s = shared->time_limit_s,
                                             .seed = (uint64_t)seed,
                                             .device = &device,
                                             .quiet = shared->quiet,
                                             .untimed = request->untimed,
                                             .times = &times,
                                             .retimes = request->retimes};
    struct neph_store *store = NULL;
    struct neph_report_folder *page = NULL; /* open at once: whose it is, is told at once */
    char *folder = neph_path_join(output, "store"), *page_folder = neph_path_join(output, "sweep");
    enum neph_status status = folder && page_folder
                                  ? neph_report_folder_open(page_folder, &page, diag)
                                  : neph_fail_memory(diag);
    if (!status)
        status = neph_store_open(folder, &store, diag);
    if (!status)
        status = open_times(output, &times, diag);
    if (!status)
        status = neph_sweep_run(&params, store, sweep, diag);
    if (!status)
        status = write_files(page, output, sweep, diag);
    neph_times_close(&times);
    neph_shared_device_close(&device);
    neph_store_close(store);
    neph_report_folder_close(page);
    free(page_folder);
    free(folder);
    return status;
}

/* --- one, or several with other seeds ------------------------------------------------------- */

static enum neph_status tell(const struct request *request, const struct neph_sweep *sweep,
                             struct neph_diag *diag)
{
    char *csv = NULL;
    enum neph_status status = NEPH_OK;
    if (request->csv)
        status = neph_sweep_csv(sweep, &csv, diag);
    if (!status && csv)
        status = write_text(request->csv, csv, diag);
    free(csv);
    if (status || (request->csv && strcmp(request->csv, "-") == 0 && !request->shared.json))
        return status;
    if (request->shared.json)
        return neph_json_print(neph_sweep_json(sweep), diag);
    neph_sweep_print(sweep, stdout);
    neph_sweep_print_equals(sweep, stdout);
    printf("%s/sweep/index.html\n", request->shared.output);
    return NEPH_OK;
}

static enum neph_status run_one(const struct request *request, const struct neph_sweep_plan *plan,
                                const char *const *only, struct neph_diag *diag)
{
    struct neph_sweep sweep = {.plan = NULL};
    enum neph_status status = run(request, plan, only, request->shared.output, request->seed,
                                  &sweep, diag);
    if (!status)
        status = tell(request, &sweep, diag);
    neph_sweep_finish(&sweep);
    return status;
}

static enum neph_status judge_fronts(const struct request *request, const struct neph_sweep *sweeps,
                                     struct neph_diag *diag)
{
    const enum neph_sweep_cost cost = request->untimed ? NEPH_SWEEP_COST_WORK
                                                       : NEPH_SWEEP_COST_TIME;
    json_t *json = neph_stability_json(sweeps, request->seeds, cost);
    const json_int_t moved = json_integer_value(json_object_get(json, "moved"));
    enum neph_status status = write_json(request->shared.output, "stability.json",
                                         json_incref(json), diag);
    if (!status && request->shared.json)
        status = neph_json_print(json_incref(json), diag);
    else if (!status)
        neph_stability_print(sweeps, request->seeds, cost, stdout);
    json_decref(json);
    if (!status && moved > 0)
        status = neph_fail(diag, NEPH_ERR_GATE,
                           "%d points left a front by more than their intervals", (int)moved);
    return status;
}

static enum neph_status run_seeds(const struct request *request, const struct neph_sweep_plan *plan,
                                  const char *const *only, struct neph_diag *diag)
{
    struct neph_sweep sweeps[SEEDS_MAX] = {{.plan = NULL}};
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < request->seeds && !status; i++) {
        const int seed = request->seed + i;
        char *folder = neph_format("%s/seed_%d", request->shared.output, seed);
        status = folder ? run(request, plan, only, folder, seed, &sweeps[i], diag)
                        : neph_fail_memory(diag);
        free(folder);
    }
    if (!status)
        status = judge_fronts(request, sweeps, diag);
    for (int i = 0; i < request->seeds; i++)
        neph_sweep_finish(&sweeps[i]);
    return status;
}

static enum neph_status check_against(const char *name, const struct neph_sweep_plan *plan,
                                      struct neph_diag *diag)
{
    bool is_there = !name;
    for (int s = 0; s < plan->series_count; s++)
        is_there |= name && strcmp(plan->series[s].name, name) == 0;
    return is_there
               ? NEPH_OK
               : neph_fail(diag, NEPH_ERR_USAGE, "--against: the plan has no series '%s'", name);
}

static void set_size(const struct neph_cli_shared *shared, struct neph_sweep_plan *plan)
{
    if (shared->size.width_px > 0) {
        plan->width_px = shared->size.width_px;
        plan->height_px = shared->size.height_px;
    }
}

enum neph_status neph_cli_sweep(int argc, char **argv, struct neph_diag *diag)
{
    struct request request = {0};
    neph_cli_parse(&syntax, argc, argv, &request);
    const char *only[ONLY_MAX + 1] = {NULL};
    char *words = request.only ? strdup(request.only) : NULL;
    int count = 0;
    struct neph_sweep_plan plan = {.title = NULL};
    enum neph_status status = neph_sweep_plan_load(request.plan, &plan, diag);
    set_size(&request.shared, &plan);
    if (!status)
        status = check_against(request.against, &plan, diag);
    if (!status && words)
        status = neph_cli_split(words, "series", ONLY_MAX, only, &count, diag);
    if (!status)
        status = request.seeds > 0 ? run_seeds(&request, &plan, words ? only : NULL, diag)
                                   : run_one(&request, &plan, words ? only : NULL, diag);
    neph_sweep_plan_finish(&plan);
    free(words);
    return status;
}
