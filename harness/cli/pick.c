/* SPDX-License-Identifier: MIT
 *
 * `neph pick SCENE`.
 */
#include "harness/cli/cli.h"

#include "base/files.h"
#include "harness/sweep/pick.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct request {
    struct neph_cli_shared shared;
    double error, flicker, ms;
    int seed;
};

static const struct neph_cli_option options[] = {
    {"error", 0, "E", "The most that the relative RMSE against the truth may be, such as 0.05",
     NEPH_CLI_REAL, .at = offsetof(struct request, error), .minimum = 1e-6, .maximum = 1e6},
    {"flicker", 0, "F", "The most that flicker may be seen, 1 being the eye's threshold",
     NEPH_CLI_REAL, .at = offsetof(struct request, flicker), .minimum = 1e-6, .maximum = 1e6},
    {"ms", 0, "T", "The most that a picture may take on this device", NEPH_CLI_REAL,
     .at = offsetof(struct request, ms), .minimum = 1e-6, .maximum = 1e9},
    {.name = "size", .otherwise = "320x180"},
    {"seed", 0, "N", "Of all that is random", NEPH_CLI_INTEGER,
     .at = offsetof(struct request, seed), .otherwise = "1", .minimum = 1, .maximum = 1000000},
    {.name = "output", .help = "Folder of the store and of pick.json", .otherwise = "out"},
    {.name = "time-limit"},
    {.name = "json"},
    {.name = "quiet"},
    {.name = NULL},
};

static void check(const void *request_, const struct argp_state *state)
{
    const struct request *request = request_;
    if (isnan(request->error) && isnan(request->flicker))
        argp_error(state, "give --error, --flicker, or both: what is good enough?");
}

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &neph_cli_one_scene,
    .check = check,
    .doc = "The cheapest configuration of a scene that is good enough, and what was left out.\v"
           "Closed forms come first, then the real-time pipeline and the march, with few steps and "
           "more, with light scattered once and by all orders. All are looked at in small "
           "pictures; what passes there with room to spare goes on to larger ones, the cheapest "
           "first by density evaluations, and the first that passes at full size is the choice. "
           "Errors are against engine exact, or the tracer. Where nothing moves, the parts that "
           "only motion needs are left out. What each part that is left out would have bought is "
           "measured, too.\n\nDIR/pick.json is what `neph render --config` takes. With --ms, times "
           "are measured once and kept in DIR/times.json, so that the same command picks the same "
           "again. Exit code 1: nothing is good enough; the best is shown.\n\n"
           "Examples:\n"
           "  neph pick height_fog_level --error 0.01\n"
           "  neph pick cloud_below --error 0.3 --flicker 2 --size 160x90\n"
           "  neph pick voxel_grid --error 0.25 --ms 50 -o out\n"
           "  neph render voxel_grid --config out/pick.json --frames 48",
};

static enum neph_status write_json(const struct neph_pick_params *params,
                                   const struct neph_pick *pick, const char *path,
                                   struct neph_diag *diag)
{
    json_t *json = neph_pick_json(params, pick);
    char *text = json ? json_dumps(json, JSON_INDENT(1)) : NULL;
    const enum neph_status status = text ? neph_file_write(path, text, strlen(text), diag)
                                         : neph_fail_memory(diag);
    free(text);
    json_decref(json);
    return status;
}

static enum neph_status tell(const struct request *request, const struct neph_pick_params *params,
                             const struct neph_pick *pick, const char *path, struct neph_diag *diag)
{
    enum neph_status status = write_json(params, pick, path, diag);
    if (!status && request->shared.json)
        status = neph_cli_print_json(neph_pick_json(params, pick), diag);
    if (!status && !request->shared.json) {
        neph_pick_print(params, pick, stdout);
        printf("neph render %s --config %s\n", params->scene, path);
    }
    if (!status && !pick->found)
        status = neph_fail(diag, NEPH_ERR_GATE, "nothing is good enough for what was asked");
    return status;
}

static enum neph_status run(const struct request *request, struct neph_pick_params *params,
                            struct neph_diag *diag)
{
    const char *output = request->shared.output;
    char *folder = neph_path_join(output, "store"), *path = neph_path_join(output, "pick.json"),
         *times_path = neph_path_join(output, "times.json");
    struct neph_store *store = NULL;
    struct neph_times times = {NULL};
    struct neph_pick pick;
    enum neph_status status = folder && path && times_path ? neph_store_open(folder, &store, diag)
                                                           : neph_fail_memory(diag);
    if (!status)
        status = neph_times_open(times_path, &times, diag);
    params->times = &times;
    if (!status)
        status = neph_pick_run(params, store, &pick, diag);
    if (!status)
        status = tell(request, params, &pick, path, diag);
    neph_times_close(&times);
    neph_store_close(store);
    free(times_path);
    free(path);
    free(folder);
    return status;
}

enum neph_status neph_cli_pick(int argc, char **argv, struct neph_diag *diag)
{
    struct request request = {0};
    neph_cli_parse(&syntax, argc, argv, &request);
    const struct neph_cli_shared *shared = &request.shared;
    struct neph_pick_params params = {.scene = shared->operands[0],
                                      .error = request.error,
                                      .flicker = request.flicker,
                                      .time_s = 1e-3 * request.ms,
                                      .width_px = shared->size.width_px,
                                      .height_px = shared->size.height_px,
                                      .seed = (uint64_t)request.seed,
                                      .time_limit_s = shared->time_limit_s,
                                      .quiet = shared->quiet || shared->json};
    return run(&request, &params, diag);
}
