/* SPDX-License-Identifier: MIT
 *
 * `neph metrics`: lists metrics and masks with their definitions.
 */
#include "harness/cli/cli.h"

#include "metrics/extractors/extractors.h"
#include "metrics/mask.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

struct request {
    struct neph_cli_shared shared;
    bool masks;
};

static const struct neph_cli_option options[] = {
    {.name = "json"},
    {"masks", 0, NULL, "List the masks instead", NEPH_CLI_FLAG,
     .at = offsetof(struct request, masks)},
    {.name = "quiet", .help = "Accepted; this verb prints only results"},
    {.name = NULL},
};

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &neph_cli_one_name_or_none,
    .doc = "List metrics with definition, unit, range and source; or explain one extractor with "
           "its settings.\v"
           "Examples:\n"
           "  neph metrics\n"
           "  neph metrics flip\n"
           "  neph metrics a4_p95\n"
           "  neph metrics --masks",
};

static json_t *quantities_json(const struct neph_extractor *extractor)
{
    json_t *list = json_array();
    for (int q = 0; q < neph_quantity_count(); q++)
        if (extractor->quantities & (unsigned)neph_quantity_at(q)->bit)
            neph_json_add(&list, json_string(neph_quantity_at(q)->name));
    return list;
}

static json_t *extractor_json(const struct neph_extractor *extractor)
{
    json_t *metrics = json_array(), *maps = json_array();
    for (const struct neph_metric *metric = extractor->metrics; metric->name; metric++)
        neph_json_add(&metrics,
                      json_pack("{s:s, s:s?, s:o, s:o, s:s}", "name", metric->name, "unit",
                                metric->unit, "low", neph_json_number(metric->low), "high",
                                neph_json_number(metric->high), "help", metric->help));
    for (int m = 0; m < extractor->map_count; m++)
        if (extractor->maps[m].name)
            neph_json_add(&maps, json_string(extractor->maps[m].name));
    return json_pack("{s:s, s:s, s:s, s:s?, s:b, s:b, s:o, s:o, s:o, s:o}", "name", extractor->name,
                     "help", extractor->help, "source", extractor->source, "details",
                     extractor->details, "temporal", extractor->temporal, "costly",
                     extractor->costly, "quantities", quantities_json(extractor), "options",
                     neph_cli_options_json(extractor->options), "metrics", metrics, "maps", maps);
}

static void print_metric(const struct neph_metric *metric)
{
    char range[64] = "";
    if (isfinite(metric->low) || isfinite(metric->high))
        snprintf(range, sizeof(range), " %g..%g", metric->low, metric->high);
    printf("    %-24s %s  [%s%s]\n", metric->name, metric->help,
           metric->unit ? metric->unit : "unit of the quantity", range);
}

static void print_details(const char *lines)
{
    while (lines && *lines) {
        const size_t length = strcspn(lines, "\n");
        printf("    %.*s\n", (int)length, lines);
        lines += length + (lines[length] ? 1 : 0);
    }
}

static void print_extractor(const struct neph_extractor *extractor, bool fully)
{
    printf("%s: %s%s%s\n", extractor->name, extractor->help,
           extractor->temporal ? " (sequences)" : "",
           extractor->costly ? " (only on request)" : "");
    printf("    source: %s\n", extractor->source);
    if (fully) {
        print_details(extractor->details);
        neph_cli_print_options(extractor->options);
    }
    for (const struct neph_metric *metric = extractor->metrics; metric->name; metric++)
        print_metric(metric);
    for (int m = 0; m < extractor->map_count && fully; m++)
        if (extractor->maps[m].name)
            printf("    map %-20s shown %g..%g%s%s\n", extractor->maps[m].name,
                   extractor->maps[m].is_signed ? -extractor->maps[m].scale : 0.0,
                   extractor->maps[m].scale, extractor->maps[m].unit ? " " : " display values",
                   extractor->maps[m].unit ? extractor->maps[m].unit : "");
}

static enum neph_status list_masks(bool as_json, struct neph_diag *diag)
{
    json_t *list = json_array();
    for (int i = 0; i < neph_mask_kind_count(); i++) {
        const struct neph_mask_kind *kind = neph_mask_kind_at(i);
        neph_json_add(&list, json_pack("{s:s, s:s?, s:s}", "name", kind->name, "needs", kind->needs,
                                       "help", kind->help));
        if (!as_json)
            printf("%-14s %s%s%s%s\n", kind->name, kind->help, kind->needs ? " [needs " : "",
                   kind->needs ? kind->needs : "", kind->needs ? "]" : "");
    }
    if (!as_json)
        printf(
            "%-14s a channel mask.NAME of the reference, above 0.5 inside (mask.cloud, mask.fog, "
            "mask.sun)\n",
            "NAME");
    return neph_cli_give_json(list, as_json, diag);
}

static enum neph_status check_name(const char *name, const struct neph_extractor **extractor,
                                   struct neph_diag *diag)
{
    *extractor = neph_extractor_find(name);
    if (*extractor || neph_metric_find(name, extractor))
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_USAGE, "there is no extractor or metric '%s'", name);
    neph_hint(diag, "`neph metrics` lists them");
    return NEPH_ERR_USAGE;
}

enum neph_status neph_cli_metrics(int argc, char **argv, struct neph_diag *diag)
{
    struct request request = {0};
    neph_cli_parse(&syntax, argc, argv, &request);
    const struct neph_cli_shared *shared = &request.shared;
    const struct neph_extractor *only = NULL;
    enum neph_status status = shared->operand_count > 0
                                  ? check_name(shared->operands[0], &only, diag)
                                  : NEPH_OK;
    if (status)
        return status;
    if (request.masks)
        return list_masks(shared->json, diag);
    json_t *list = json_array();
    for (int i = 0; i < neph_extractor_count(); i++) {
        const struct neph_extractor *extractor = neph_extractor_at(i);
        if (only && extractor != only)
            continue;
        if (shared->json)
            neph_json_add(&list, extractor_json(extractor));
        else
            print_extractor(extractor, only != NULL);
    }
    return neph_cli_give_json(list, shared->json, diag);
}
