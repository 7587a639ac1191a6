/* SPDX-License-Identifier: MIT
 *
 * `neph scaling SCENE`.
 */
#include "harness/cli/cli.h"
#include "harness/engines/vulkan_device.h"

#include "base/files.h"
#include "harness/sweep/scaling.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct request {
    struct neph_cli_shared shared;
    const char *preset, *against;
    int seed;
    bool untimed, retimes;
};

static const struct neph_cli_option options[] = {
    {"preset", 'p', "NAME", "Of realtime, beside the march; PRESET+KEY=VALUE changes it",
     NEPH_CLI_WORD, .at = offsetof(struct request, preset), .otherwise = "ours"},
    {"against", 0, "FILE", "scaling.json of another device: times of the same pictures there",
     NEPH_CLI_WORD, .at = offsetof(struct request, against)},
    {"untimed", 0, NULL, "No times: evaluations of density alone", NEPH_CLI_FLAG,
     .at = offsetof(struct request, untimed)},
    {"retime", 0, NULL, "Time again what DIR/times.json has times of", NEPH_CLI_FLAG,
     .at = offsetof(struct request, retimes)},
    {"seed", 0, "N", "Of all that is random", NEPH_CLI_INTEGER,
     .at = offsetof(struct request, seed), .otherwise = "1", .minimum = 1, .maximum = 1000000},
    {.name = "size", .help = "Of the largest picture", .otherwise = "320x180"},
    {.name = "output", .help = "Folder of the store and of scaling.json", .otherwise = "out"},
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

static enum neph_status write_json(const char *folder, const struct neph_scaling *scaling,
                                   struct neph_diag *diag)
{
    char *path = neph_path_join(folder, "scaling.json");
    json_t *json = neph_scaling_json(scaling);
    char *text = json ? json_dumps(json, JSON_INDENT(1)) : NULL;
    const enum neph_status status = path && text ? neph_file_write(path, text, strlen(text), diag)
                                                 : neph_fail_memory(diag);
    free(text);
    json_decref(json);
    free(path);
    return status;
}

static enum neph_status tell(const struct request *request, const struct neph_scaling *scaling,
                             const json_t *there, struct neph_diag *diag)
{
    const enum neph_status status = write_json(request->shared.output, scaling, diag);
    if (status)
        return status;
    if (request->shared.json)
        return neph_json_print(neph_scaling_json(scaling), diag);
    neph_scaling_print(scaling, stdout);
    if (there)
        neph_scaling_print_against(scaling, there, stdout);
    return NEPH_OK;
}

enum neph_status neph_cli_scaling(int argc, char **argv, struct neph_diag *diag)
{
    struct request request = {0};
    neph_cli_parse(&syntax, argc, argv, &request);
    const struct neph_cli_shared *shared = &request.shared;
    char *folder = neph_path_join(shared->output, "store"),
         *times_path = neph_path_join(shared->output, "times.json");
    struct neph_store *store = NULL;
    struct neph_times times = {NULL};
    struct neph_shared_device device = {.open = NULL};
    const struct neph_scaling_params params = {.scene = shared->operands[0],
                                               .preset = request.preset,
                                               .width_px = shared->size.width_px,
                                               .height_px = shared->size.height_px,
                                               .seed = (uint64_t)request.seed,
                                               .untimed = request.untimed,
                                               .device = &device,
                                               .quiet = shared->quiet || shared->json,
                                               .times = &times,
                                               .retimes = request.retimes};
    struct neph_scaling scaling;
    json_t *there = NULL;
    enum neph_status status = folder && times_path ? NEPH_OK : neph_fail_memory(diag);
    if (!status && request.against)
        status = neph_scaling_load(request.against, &there, diag);
    if (!status)
        status = neph_store_open(folder, &store, diag);
    if (!status)
        status = neph_times_open(times_path, &times, diag);
    if (!status)
        status = neph_scaling_run(&params, store, &scaling, diag);
    if (!status && there)
        status = neph_scaling_check_against(&scaling, there, request.against, diag);
    if (!status)
        status = tell(&request, &scaling, there, diag);
    json_decref(there);
    neph_times_close(&times);
    neph_shared_device_close(&device);
    neph_store_close(store);
    free(times_path);
    free(folder);
    return status;
}
