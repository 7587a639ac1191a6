/* SPDX-License-Identifier: MIT
 *
 * `neph store check|gc|export`: checks, shrinks or exports the store of rendered frames.
 */
#include "harness/cli/cli.h"

#include "harness/run/record.h"
#include "harness/run/store_keep.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct request {
    struct neph_cli_shared shared;
    bool repairs;
    const char *limit;
    double spare_hours;
};

static const struct neph_cli_option options[] = {
    {.name = "output", .help = "Folder of a verb with a store, such as out/validate"},
    {"repair", 0, NULL,
     "check: remove damaged frames, which the next run renders again; restore damaged acceptances "
     "from their copies; rebuild a damaged database",
     NEPH_CLI_FLAG, .at = offsetof(struct request, repairs)},
    {"limit", 0, "SIZE", "gc: size limit of all frames, such as 500M, 20G", NEPH_CLI_WORD,
     .at = offsetof(struct request, limit)},
    {"spare-hours", 0, "H", "gc: frames that were used within so many hours stay", NEPH_CLI_REAL,
     .at = offsetof(struct request, spare_hours), .otherwise = "1", .minimum = 0, .maximum = 1e6},
    {.name = "json"},
    {.name = "quiet", .help = "Accepted; this verb prints only results"},
    {.name = NULL},
};

static void check_request(const void *request_, const struct argp_state *state)
{
    const struct request *request = request_;
    const char *verb = request->shared.operands[0];
    const bool is_gc = strcmp(verb, "gc") == 0;
    if (!is_gc && strcmp(verb, "check") != 0 && strcmp(verb, "export") != 0)
        argp_error(state, "there is no 'store %s': check, gc or export", verb);
    if (!request->shared.output)
        argp_error(state, "which store? -o names the folder of a verb, such as out/validate");
    if (is_gc && !request->limit)
        argp_error(state, "which size limit? --limit 20G");
    if (!is_gc && request->limit)
        argp_error(state, "--limit is for gc");
    if (request->repairs && strcmp(verb, "check") != 0)
        argp_error(state, "--repair is for check");
}

static const struct neph_cli_operands operands = {.shown = "check|gc|export",
                                                  .minimum = 1,
                                                  .maximum = 1,
                                                  .missing = "check, gc or export?",
                                                  .surplus = "one of check, gc and export"};

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &operands,
    .check = check_request,
    .doc = "Check, shrink or export the store of a folder.\v"
           "check compares every frame with its record, and the database with the frames, the "
           "finished nightly runs and the acceptances; exit code 1 when anything is damaged. A "
           "database that cannot even be opened is set aside and rebuilt from the files beside it, "
           "by any verb that opens the store.\n\n"
           "gc removes frames, the longest unused first, until the store fits into --limit. Frames "
           "of an accepted nightly run stay, whatever their age: exit code 1 if the limit cannot "
           "be met because of them.\n\n"
           "export prints environments, jobs, nightly runs and acceptances as JSON.\n\n"
           "Examples:\n"
           "  neph store check -o out/validate\n"
           "  neph store gc -o out/nightly --limit 20G\n"
           "  neph store export -o out/nightly > store.json",
};

/* ---- check ----------------------------------------------------------------------------------- */

static void tell_fault(const struct neph_store_fault *fault, void *context)
{
    json_t **list = context;
    if (list)
        neph_json_add(list,
                      json_pack("{s:s, s:s, s:b, s:b}", "key", fault->key, "why", fault->why,
                                "of_baseline", fault->of_baseline, "removed", fault->removed));
    else
        printf("%s  %s%s%s\n", fault->key[0] ? fault->key : "database", fault->why,
               fault->of_baseline ? "; used by an accepted nightly run" : "",
               !fault->removed      ? ""
               : fault->is_document ? "; restored"
               : fault->key[0]      ? "; removed"
                                    : "; made again");
}

/* Print a record as JSON, with one extra value. */
static enum neph_status print_record(const struct neph_record_form *form, const void *record,
                                     const char *key, json_t *value, struct neph_diag *diag)
{
    json_t *json = neph_record_json(form, record);
    neph_json_set(&json, key, value);
    return neph_json_print(json, diag);
}

#define SUMS(member) NEPH_RECORD_FIELD(struct neph_store_sums, member)
static const struct neph_record_form sums_form = {
    sizeof(struct neph_store_sums),
    {SUMS(frames), SUMS(bytes), SUMS(nights), SUMS(acceptances), SUMS(bad)}};

static enum neph_status run_check(const struct request *request, struct neph_store *store,
                                  struct neph_diag *diag)
{
    struct neph_store_sums sums;
    const bool json = request->shared.json;
    json_t *faults = json_array();
    enum neph_status status = neph_store_check(store, request->repairs, tell_fault,
                                               json ? &faults : NULL, &sums, diag);
    if (!status && json)
        status = print_record(&sums_form, &sums, "faults", json_incref(faults), diag);
    else if (!status)
        printf("%lld frames, %.1f MB, %lld nights, %lld acceptances; %lld damaged\n",
               (long long)sums.frames, 1e-6 * (double)sums.bytes, (long long)sums.nights,
               (long long)sums.acceptances, (long long)sums.bad);
    json_decref(faults);
    if (status || sums.bad == 0)
        return status;
    neph_fail(diag, NEPH_ERR_GATE, "damaged: %lld; the lines above name them", (long long)sums.bad);
    if (!request->repairs)
        neph_hint(diag, "--repair removes damaged frames, which the next run renders again, "
                        "restores damaged acceptances, and rebuilds a damaged database");
    return NEPH_ERR_GATE;
}

/* ---- gc -------------------------------------------------------------------------------------- */

/* Parse a size such as "500M" to bytes; NaN: not a size. */
static double bytes_of(const char *text)
{
    static const char units[] = "KMGT";
    char *end;
    const double number = strtod(text, &end);
    const char *unit = *end ? strchr(units, *end) : NULL;
    if (end == text || !(number >= 0.0) || (*end && (!unit || end[1])) || number > 1e15)
        return NAN;
    return number * (unit ? pow(1000.0, 1.0 + (double)(unit - units)) : 1.0);
}

#define GC(member) NEPH_RECORD_FIELD(struct neph_store_gc, member)
static const struct neph_record_form gc_form = {
    sizeof(struct neph_store_gc),
    {GC(frames_before), GC(bytes_before), GC(frames_removed), GC(bytes_removed),
     GC(bytes_of_baselines), GC(bytes_in_use), GC(frames_that_stayed)}};

static enum neph_status run_gc(const struct request *request, struct neph_store *store,
                               struct neph_diag *diag)
{
    struct neph_store_gc gc;
    const double limit = bytes_of(request->limit);
    if (!isfinite(limit) || limit > 1e18)
        return neph_fail(diag, NEPH_ERR_USAGE,
                         "--limit '%s' is no size: a number of bytes, or of K, M, G or T",
                         request->limit);
    enum neph_status status = neph_store_gc(store, (int64_t)limit, 3600.0 * request->spare_hours,
                                            &gc, diag);
    if (!status && request->shared.json)
        status = print_record(&gc_form, &gc, "fits", json_boolean(gc.fits), diag);
    else if (!status)
        printf("removed %lld of %lld frames, %.1f of %.1f MB; of accepted nights %.1f MB, in use "
               "%.1f MB\n",
               (long long)gc.frames_removed, (long long)gc.frames_before,
               1e-6 * (double)gc.bytes_removed, 1e-6 * (double)gc.bytes_before,
               1e-6 * (double)gc.bytes_of_baselines, 1e-6 * (double)gc.bytes_in_use);
    if (status || gc.fits)
        return status;
    neph_fail(diag, NEPH_ERR_GATE, "the limit of %.1f MB cannot be kept: %.1f MB are left",
              1e-6 * limit, 1e-6 * (double)(gc.bytes_before - gc.bytes_removed));
    if (gc.frames_that_stayed > 0)
        neph_hint(diag, "%lld frames could not be removed; the lines above say why",
                  (long long)gc.frames_that_stayed);
    else
        neph_hint(diag,
                  "frames of accepted nightly runs and frames used within --spare-hours stay");
    return NEPH_ERR_GATE;
}

/* ---- all ------------------------------------------------------------------------------------- */

enum neph_status neph_cli_store(int argc, char **argv, struct neph_diag *diag)
{
    struct request request = {0};
    struct neph_store *store = NULL;
    json_t *document = NULL;
    neph_cli_parse(&syntax, argc, argv, &request);
    const char *verb = request.shared.operands[0];
    enum neph_status status = neph_cli_open_store(request.shared.output, &store, diag);
    if (!status && strcmp(verb, "check") == 0)
        status = run_check(&request, store, diag);
    else if (!status && strcmp(verb, "gc") == 0)
        status = run_gc(&request, store, diag);
    else if (!status && !(status = neph_store_export(store, &document, diag)))
        status = neph_json_print(document, diag);
    neph_store_close(store);
    return status;
}
