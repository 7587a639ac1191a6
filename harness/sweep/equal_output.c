/* SPDX-License-Identifier: MIT
 *
 * Tables and JSON of the comparison of series.
 */
#include "harness/sweep/equal.h"

#include <math.h>
#include <string.h>

/* Fails to compile when a cost is added, as the table of costs needs a row for it. */
_Static_assert(NEPH_SWEEP_COSTS == 2, "a new kind");

static const struct {
    const char *name, *column; /* in JSON; in the table */
    double scale;
} costs[NEPH_SWEEP_COSTS] = {
    [NEPH_SWEEP_COST_TIME] = {"seconds", "ms", 1e3},
    [NEPH_SWEEP_COST_WORK] = {"evaluations", "evals/px", 1.0},
};

/* The compared values: model error, shortcut error, flicker, lag. */
static const enum neph_sweep_number numbers[] = {NEPH_SWEEP_ERROR, NEPH_SWEEP_SHORTCUT,
                                                 NEPH_SWEEP_FLICKER, NEPH_SWEEP_HALF_LIFE};
enum { NUMBERS = sizeof(numbers) / sizeof(numbers[0]) };

static const struct neph_sweep_series *
find_base_series(const struct neph_sweep *sweep, enum neph_sweep_cost cost,
                 enum neph_sweep_number number, struct neph_sweep_comparison *list, int *count)
{
    *count = 0;
    for (int s = 0; s < sweep->plan->series_count; s++) {
        const struct neph_sweep_series *series = &sweep->plan->series[s];
        if (sweep->against && strcmp(sweep->against, series->name) != 0)
            continue;
        *count = neph_sweep_compare_series(sweep, series, cost, number, list);
        if (*count > 0)
            return series;
    }
    return NULL;
}

/* --- the tables ----------------------------------------------------------------------------- */

/* "12.3", or "beyond" where the base has no such point. */
static void print_ratio(double value, FILE *out)
{
    if (isfinite(value))
        fprintf(out, " %14.3g", value);
    else
        fprintf(out, " %14s", "beyond");
}

static bool print_table(const struct neph_sweep *sweep, enum neph_sweep_cost cost,
                        enum neph_sweep_number number, FILE *out)
{
    struct neph_sweep_comparison list[NEPH_SWEEP_SERIES_MAX];
    const char *column = costs[cost].column, *name = neph_sweep_number_texts[number].name;
    char at_that[32], in_that[32];
    int count = 0;
    const struct neph_sweep_series *base = find_base_series(sweep, cost, number, list, &count);
    if (count == 0)
        return false;
    snprintf(at_that, sizeof(at_that), "%s at that", column);
    snprintf(in_that, sizeof(in_that), "%.9s in that", name);
    fprintf(out, "\n%s and %s: the best point of each series relative to %s\n", name, column,
            base->name);
    fprintf(out, "%-16s %11s %11s %14s %14s\n", "series", name, column, at_that, in_that);
    for (int i = 0; i < count; i++) {
        fprintf(out, "%-16s %11.3g %11.3g", list[i].series->name, list[i].at_number,
                costs[cost].scale * list[i].at_cost);
        print_ratio(list[i].cost_ratio, out);
        print_ratio(list[i].number_ratio, out);
        fprintf(out, "\n");
    }
    return true;
}

/* Names each device with timed points once: times of two machines do not compare two programs. */
static void print_machines(const struct neph_sweep *sweep, FILE *out)
{
    fprintf(out, "Times were measured for:");
    for (int i = 0; i < sweep->point_count; i++) {
        const struct neph_job *job = &sweep->points[i].job;
        bool is_first = sweep->points[i].timed > 0;
        for (int k = 0; k < i && is_first; k++)
            is_first = sweep->points[k].timed == 0 ||
                       strcmp(sweep->points[k].job.info->device, job->info->device) != 0;
        if (is_first)
            fprintf(out, " %s on %s;", job->engine->name, job->info->device);
    }
    fprintf(out, " in alternating rounds.\n");
}

void neph_sweep_print_equals(const struct neph_sweep *sweep, FILE *out)
{
    bool printed = false, is_timed = false;
    for (int n = 0; n < NUMBERS; n++)
        for (int cost = 0; cost < NEPH_SWEEP_COSTS; cost++)
            printed |= print_table(sweep, (enum neph_sweep_cost)cost, numbers[n], out);
    if (printed)
        fprintf(out, "\nbeyond: outside of the points of the compared series\n");
    else if (sweep->against)
        fprintf(out, "\n%s has no two points to compare with\n", sweep->against);
    for (int i = 0; i < sweep->point_count; i++)
        is_timed |= sweep->points[i].timed > 0;
    if (printed && is_timed)
        print_machines(sweep, out);
}

/* --- JSON ----------------------------------------------------------------------------------- */

json_t *neph_sweep_equals_json(const struct neph_sweep *sweep)
{
    struct neph_sweep_comparison list[NEPH_SWEEP_SERIES_MAX];
    json_t *json = json_array();
    for (int n = 0; n < NUMBERS; n++)
        for (int cost = 0; cost < NEPH_SWEEP_COSTS; cost++) {
            int count = 0;
            const struct neph_sweep_series *base = find_base_series(
                sweep, (enum neph_sweep_cost)cost, numbers[n], list, &count);
            for (int i = 0; i < count; i++)
                neph_json_add(&json,
                              json_pack("{s:s, s:s, s:s, s:s, s:f, s:f, s:o, s:o}", "cost",
                                        costs[cost].name, "number",
                                        neph_sweep_number_texts[numbers[n]].name, "against",
                                        base->name, "series", list[i].series->name, "at_cost",
                                        list[i].at_cost, "at_number", list[i].at_number,
                                        "cost_ratio", neph_json_number(list[i].cost_ratio),
                                        "number_ratio", neph_json_number(list[i].number_ratio)));
        }
    return json;
}
