/* SPDX-License-Identifier: MIT
 *
 * `neph baseline accept|list`.
 */
#include "harness/cli/cli.h"

#include "harness/night/accept.h"

#include <stdio.h>
#include <string.h>

struct request {
    struct neph_cli_shared shared;
    const char *why, *who;
    int night;
};

static const struct neph_cli_option options[] = {
    {"why", 0, "TEXT", "accept: the reason, recorded with the acceptance", NEPH_CLI_WORD,
     .at = offsetof(struct request, why)},
    {"who", 0, "NAME", "accept: name of the person who accepts (default: the user and the machine)",
     NEPH_CLI_WORD, .at = offsetof(struct request, who)},
    {"night", 0, "N", "accept: number of the nightly run (default: the last)", NEPH_CLI_INTEGER,
     .at = offsetof(struct request, night), .minimum = 1, .maximum = 1e9},
    {.name = "output", .help = "Folder of the store", .otherwise = "out/nightly"},
    {.name = "json"},
    {.name = "quiet", .help = "Accepted; this verb prints only results"},
    {.name = NULL},
};

static bool accepts(const struct request *request)
{
    return strcmp(request->shared.operands[0], "accept") == 0;
}

static void check_request(const void *request_, const struct argp_state *state)
{
    const struct request *request = request_;
    if (!accepts(request) && strcmp(request->shared.operands[0], "list") != 0)
        argp_error(state, "there is no 'baseline %s': accept or list", request->shared.operands[0]);
    if (!accepts(request) && request->shared.operand_count > 1)
        argp_error(state, "list has no further operands");
    if (accepts(request) && (!request->why || request->why[strspn(request->why, " ")] == '\0'))
        argp_error(state, "why is it accepted? --why \"the new phase function is right: see ...\"");
}

static const struct neph_cli_operands operands = {.shown = "accept|list [SERIES...]",
                                                  .minimum = 1,
                                                  .maximum = NEPH_CLI_WORDS_MAX,
                                                  .missing = "accept or list?",
                                                  .surplus = "1023 series"};

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &operands,
    .check = check_request,
    .doc =
        "Accept a nightly run as the baseline of later runs, or list the acceptances.\v"
        "accept makes a nightly run the baseline of all series, or only of each SERIES, a name in "
        "nightly.json. A SERIES that the run has lost is accepted as lost: later runs do not "
        "expect it. Acceptances are added and never changed: the last one counts, and its "
        "frames are kept by `neph store gc`.\n\n"
        "Examples:\n"
        "  neph baseline accept --why \"first night, looked at\"\n"
        "  neph baseline accept --night 12 catalog/voxel_grid@15da7c6d/march/\"radiance "
        "rel_rmse\"/exact --why \"steps halved on purpose\"\n"
        "  neph baseline list",
};

static enum neph_status accept(const struct request *request, struct neph_store *store,
                               struct neph_database *index, struct neph_diag *diag)
{
    const int count = request->shared.operand_count - 1;
    const struct neph_acceptance asked = {request->shared.operands + 1, count,
                                          request->night > 0 ? request->night : 0, request->who,
                                          request->why};
    struct neph_accepted accepted;
    const enum neph_status status = neph_accept(index, neph_store_folder(store), &asked, &accepted,
                                                diag);
    if (!status && !request->shared.json && count == 0)
        neph_accepted_print(&accepted, "*");
    for (int i = 0; i < count && !status && !request->shared.json; i++)
        neph_accepted_print(&accepted, asked.series[i]);
    return status;
}

static enum neph_status list(const struct request *request, struct neph_database *index,
                             struct neph_diag *diag)
{
    json_t *acceptances = NULL;
    size_t i;
    const json_t *row;
    enum neph_status status = neph_history_acceptances(index, &acceptances, diag);
    if (!status && request->shared.json)
        return neph_json_print(acceptances, diag);
    json_array_foreach(acceptances, i, row) printf(
        "%s  night %lld  %s  %s: %s\n", neph_json_text(row, "when_utc"),
        (long long)json_integer_value(json_object_get(row, "night")), neph_json_text(row, "series"),
        neph_json_text(row, "who"), neph_json_text(row, "why"));
    json_decref(acceptances);
    return status;
}

enum neph_status neph_cli_baseline(int argc, char **argv, struct neph_diag *diag)
{
    struct request request = {0};
    neph_cli_parse(&syntax, argc, argv, &request);
    struct neph_store *store = NULL;
    struct neph_database *index = NULL;
    enum neph_status status = neph_cli_open_store(request.shared.output, &store, diag);
    if (!status)
        status = neph_store_index(store, &index, diag);
    if (!status && accepts(&request))
        status = accept(&request, store, index, diag);
    if (!status && (!accepts(&request) || request.shared.json))
        status = list(&request, index, diag);
    neph_database_close(index);
    neph_store_close(store);
    return status;
}
