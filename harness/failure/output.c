/* SPDX-License-Identifier: MIT */
#include "harness/failure/output.h"

#include "harness/run/seed.h"

#include <math.h>
#include <string.h>

enum { COLUMN = 16 };

/* What stands behind a number. */
static const char *const marks[NEPH_FAILURE_VERDICTS] = {
    [NEPH_FAILURE_NOT_ASKED] = "",      [NEPH_FAILURE_PASS] = "",
    [NEPH_FAILURE_FAIL] = " FAIL",      [NEPH_FAILURE_KNOWN_FAIL] = " known",
    [NEPH_FAILURE_NEW_PASS] = " PASS!", [NEPH_FAILURE_FLAKE] = " flake",
    [NEPH_FAILURE_SKIP] = "skip",       [NEPH_FAILURE_NO_NUMBER] = "NONE",
};

static void print_cell(const struct neph_failure_cell *cell, FILE *out)
{
    char text[40];
    if (cell->verdict == NEPH_FAILURE_NOT_ASKED)
        snprintf(text, sizeof(text), "-");
    else if (isnan(cell->value))
        snprintf(text, sizeof(text), "%s", marks[cell->verdict]);
    else
        snprintf(text, sizeof(text), "%.3g%s", cell->value, marks[cell->verdict]);
    fprintf(out, " %-*s", COLUMN, text);
}

static void print_row(const struct neph_failure_suite *suite, const struct neph_failure_row *row,
                      FILE *out)
{
    char measure[64], name[80];
    snprintf(measure, sizeof(measure), "%s/%s", neph_failing_measure_name(row->limit->measure),
             row->limit->over);
    snprintf(name, sizeof(name), "%s %s", row->scene->name, row->point);
    fprintf(out, "%-36s %-20s %-6.4g", name, measure, row->limit->limit);
    for (int p = 0; p < suite->preset_count; p++)
        print_cell(&row->cells[p], out);
    fputc('\n', out);
}

static void print_news(const struct neph_failure_suite *suite, const struct neph_failure_row *row,
                       int preset, FILE *out)
{
    const struct neph_failure_cell *cell = &row->cells[preset];
    const struct neph_failing *failing = &row->scene->failing;
    const bool fails = cell->verdict == NEPH_FAILURE_FAIL;
    fprintf(out, "%s%s%s, %s: %s/%s is %.4g, limit %.4g: %s\n  %s\n", row->scene->name,
            row->point[0] ? " " : "", row->point, suite->presets[preset],
            neph_failing_measure_name(row->limit->measure), row->limit->over, cell->value,
            row->limit->limit, neph_failure_verdict_name(cell->verdict),
            cell->why[0] ? cell->why : row->limit->reason);
    if (fails)
        fprintf(out, "  symptom: %s\n", failing->symptom);
    if (!row->point[0] && !strchr(suite->presets[preset], '+'))
        fprintf(
            out,
            "  neph render %s -e realtime --preset %s -s steps=%d --seed %llu --frames %d --size "
            "%dx%d -o %s\n",
            row->scene->name, suite->presets[preset], failing->steps,
            (unsigned long long)neph_seed_of(row->scene, 1), failing->frame_count,
            failing->width_px, failing->height_px, row->scene->name);
}

static void print_counts(const struct neph_failure_suite *suite, FILE *out)
{
    const struct neph_failure_counts *counts = &suite->counts;
    fprintf(out, "%s\n%d comparisons in %d scenarios, %d frames:", suite->device, counts->compared,
            suite->scene_count, suite->frame_count);
    for (int v = NEPH_FAILURE_PASS; v < NEPH_FAILURE_VERDICTS; v++)
        if (counts->verdicts[v] > 0)
            fprintf(out, " %d %s", counts->verdicts[v],
                    neph_failure_verdict_name((enum neph_failure_verdict)v));
    fprintf(out, "\nverdict: %s\n", suite->passes ? "pass" : "fail");
}

void neph_failure_print(const struct neph_failure_suite *suite, FILE *out)
{
    fprintf(out, "%-36s %-20s %-6s", "scenario", "measure/over", "limit");
    for (int p = 0; p < suite->preset_count; p++)
        fprintf(out, " %-*s", COLUMN, suite->presets[p]);
    fputc('\n', out);
    for (int r = 0; r < suite->row_count; r++)
        print_row(suite, &suite->rows[r], out);
    fputc('\n', out);
    for (int r = 0; r < suite->row_count; r++)
        for (int p = 0; p < suite->preset_count; p++)
            if (neph_failure_is_news(suite->rows[r].cells[p].verdict))
                print_news(suite, &suite->rows[r], p, out);
    print_counts(suite, out);
}

static json_t *cell_json(const struct neph_failure_row *row, const char *preset,
                         const struct neph_failure_cell *cell)
{
    return json_pack("{s:s, s:s, s:s, s:s, s:f, s:s, s:s, s:o, s:s, s:s}", "scene",
                     row->scene->name, "point", row->point, "measure",
                     neph_failing_measure_name(row->limit->measure), "over", row->limit->over,
                     "limit", row->limit->limit, "reason", row->limit->reason, "preset", preset,
                     "value", neph_json_number(cell->value), "verdict",
                     neph_failure_verdict_name(cell->verdict), "why", cell->why);
}

static json_t *counts_json(const struct neph_failure_counts *counts)
{
    json_t *object = json_object();
    for (int v = NEPH_FAILURE_PASS; v < NEPH_FAILURE_VERDICTS; v++)
        neph_json_set(&object, neph_failure_verdict_name((enum neph_failure_verdict)v),
                      json_integer(counts->verdicts[v]));
    return object;
}

json_t *neph_failure_json(const struct neph_failure_suite *suite)
{
    json_t *presets = json_array(), *results = json_array();
    for (int p = 0; p < suite->preset_count; p++)
        neph_json_add(&presets, json_string(suite->presets[p]));
    for (int r = 0; r < suite->row_count; r++)
        for (int p = 0; p < suite->preset_count; p++)
            if (suite->rows[r].cells[p].verdict != NEPH_FAILURE_NOT_ASKED)
                neph_json_add(&results, cell_json(&suite->rows[r], suite->presets[p],
                                                  &suite->rows[r].cells[p]));
    return json_pack("{s:s, s:s, s:o, s:i, s:i, s:o, s:s, s:f, s:i, s:o}", "format",
                     "neph-failure-1", "device", suite->device, "presets", presets, "compared",
                     suite->counts.compared, "news", suite->counts.news, "counts",
                     counts_json(&suite->counts), "verdict", suite->passes ? "pass" : "fail",
                     "seconds", suite->seconds, "frames", suite->frame_count, "results", results);
}
