/* SPDX-License-Identifier: MIT
 *
 * `neph scaling SCENE`: how cost grows with pixels, steps, voxels, density and frames in a row.
 */
#include "harness/experiments/experiments.h"

#include "harness/sweep/scaling.h"

struct request {
    struct neph_cli_shared shared;
    struct neph_scaling_params params;
    const char *against;
    json_t *there; /* what `against` holds; owned */
};

static const struct neph_cli_option options[] = {
    {"preset", 'p', "NAME", "Of realtime, beside the march; PRESET+KEY=VALUE changes it",
     NEPH_CLI_WORD, .at = offsetof(struct request, params.preset), .otherwise = "ours"},
    {"against", 0, "FILE", "scaling.json of another device: times of the same pictures there",
     NEPH_CLI_WORD, .at = offsetof(struct request, against)},
    {"untimed", 0, NULL, "No times: evaluations of density alone", NEPH_CLI_FLAG,
     .at = offsetof(struct request, params.untimed)},
    {"retime", 0, NULL, "Time again what DIR/times.json has times of", NEPH_CLI_FLAG,
     .at = offsetof(struct request, params.retimes)},
    {"seed", 0, "N", "Of all that is random", NEPH_CLI_INTEGER,
     .at = offsetof(struct request, params.seed), .otherwise = "1", .minimum = 1,
     .maximum = 1000000},
    {.name = "size", .help = "Of the largest picture", .otherwise = "320x180"},
    {.name = "output", .help = "Folder of the store and of scaling.json", .otherwise = "out"},
    {.name = "jobs", .otherwise = "1"},
    {.name = "json"},
    {.name = "quiet"},
    {.name = NULL},
};

static void check(const void *request_, const struct argp_state *state)
{
    const struct request *request = request_;
    if (request->against && request->shared.json)
        argp_error(state, "--against is of the table, not of --json");
}

static const struct neph_cli_syntax syntax = {
    .options = options,
    .check = check,
    .operands = &neph_cli_one_scene,
    .doc =
        "How cost grows with pixels, steps, voxels, density and pictures in a row, and whether it "
        "grows as it ought to.\v"
        "Each is changed by itself, for the march and a preset of realtime at 32 steps. Density "
        "evaluations are counted and the same everywhere; milliseconds are of the device that "
        "NEPH_VULKAN_DEVICE names, in rounds that take turns: keep the machine quiet. The exponent "
        "of each cost has a 95 % interval, stands beside that which it ought to have, and the "
        "reason.\n\n"
        "Examples:\n"
        "  neph scaling cloud_below --untimed\n"
        "  neph scaling voxel_grid -o here\n"
        "  NEPH_VULKAN_DEVICE=nvidia neph scaling voxel_grid -o there --against here/scaling.json",
};

static enum neph_status prepare(void *request_, struct neph_diag *diag)
{
    struct request *request = request_;
    const struct neph_cli_shared *shared = &request->shared;
    struct neph_scaling_params *params = &request->params;
    params->scene = shared->operands[0];
    params->width_px = shared->size.width_px;
    params->height_px = shared->size.height_px;
    params->quiet = shared->quiet || shared->json;
    params->jobs = shared->jobs;
    return request->against ? neph_scaling_load(request->against, &request->there, diag) : NEPH_OK;
}

static enum neph_status run(void *request_, const struct neph_experiment_run *run,
                            struct neph_publication *publication, struct neph_diag *diag)
{
    struct request *request = request_;
    struct neph_times times = {NULL};
    struct neph_scaling scaling;
    request->params.device = run->device;
    request->params.times = &times;
    enum neph_status status = neph_times_open_in(run->output, &times, diag);
    if (!status)
        status = neph_scaling_run(&request->params, run->store, &scaling, diag);
    if (!status && request->there)
        status = neph_scaling_check_against(&scaling, request->there, request->against, diag);
    neph_times_close(&times);
    if (status)
        return status;
    publication->json = neph_scaling_json(&scaling);
    if (publication->text)
        neph_scaling_print(&scaling, publication->text);
    if (publication->text && request->there)
        neph_scaling_print_against(&scaling, request->there, publication->text);
    return NEPH_OK;
}

static void finish(void *request_)
{
    struct request *request = request_;
    json_decref(request->there);
}

const struct neph_experiment neph_experiment_scaling = {.syntax = &syntax,
                                                        .request_size = sizeof(struct request),
                                                        .document = "scaling.json",
                                                        .prepare = prepare,
                                                        .run = run,
                                                        .finish = finish};
