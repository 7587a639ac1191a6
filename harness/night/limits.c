/* SPDX-License-Identifier: MIT */
#include "harness/night/limits.h"

#include "harness/json_file.h"
#include "harness/night/readers.h"
#include "metrics/run_limit.h"

#include <math.h>
#include <string.h>

enum { FORMAT = 1 };

/* The contrast of a frame is no error: it may grow. */
static const char undirected[] = "contrast";

/* Relative differences below this are no change: another compiler or processor may cause them. */
static const double rounding = 1e-9;

static const size_t file_limit_bytes = 256 << 20;

void neph_night_limits_finish(struct neph_night_limits *limits)
{
    neph_arena_finish(&limits->arena);
    *limits = (struct neph_night_limits){.path = NULL};
}

/* ---- measuring ------------------------------------------------------------------------------- */

/* The numbers of all runs; the series are those of the first run. */
struct table {
    struct neph_night_limits *limits;
    int run_count;
    double *values; /* by series, then by run; NaN: the run has no such number */
};

static double *find_values(const struct table *table, int series)
{
    return table->values + (size_t)series * (size_t)table->run_count;
}

static enum neph_status read_report(const char *path, json_t **report, struct neph_diag *diag)
{
    const enum neph_status status = neph_json_read(path, file_limit_bytes, report, diag);
    if (status || (strcmp(neph_json_text(*report, "format"), "neph-nightly-1") == 0 &&
                   json_array_size(json_object_get(*report, "series")) > 0))
        return status;
    neph_fail(diag, NEPH_ERR_INPUT, "'%s' is no report of a nightly run with numbers", path);
    neph_hint(diag, "name DIR/nightly/nightly.json of each run");
    return NEPH_ERR_INPUT;
}

static enum neph_status begin_table(struct table *table, const json_t *report,
                                    struct neph_diag *diag)
{
    struct neph_night_limits *limits = table->limits;
    const json_t *rows = json_object_get(report, "series");
    const size_t count = json_array_size(rows);
    limits->list = neph_arena_allocate(&limits->arena, count, sizeof(*limits->list));
    table->values = neph_arena_allocate(&limits->arena, count * (size_t)table->run_count,
                                        sizeof(*table->values));
    limits->host = neph_arena_copy_text(&limits->arena, neph_json_text(report, "host"));
    for (size_t i = 0; i < count && !limits->arena.is_short; i++)
        limits->list[limits->count++].series = neph_arena_copy_text(
            &limits->arena, neph_json_text(json_array_get(rows, i), "series"));
    return neph_arena_check(&limits->arena, diag);
}

/* Rows are in the order of their names, as are the series; a run may lack some. */
static void take_run(struct table *table, int run, const json_t *report)
{
    const json_t *rows = json_object_get(report, "series");
    size_t row = 0;
    for (int i = 0; i < table->limits->count; i++) {
        const char *series = table->limits->list[i].series;
        while (row < json_array_size(rows) &&
               strcmp(neph_json_text(json_array_get(rows, row), "series"), series) < 0)
            row++;
        const json_t *found = json_array_get(rows, row);
        const bool is_it = found && strcmp(neph_json_text(found, "series"), series) == 0;
        find_values(table, i)[run] = is_it ? neph_json_real(found, "tonight") : NAN;
    }
}

static enum neph_status read_run(struct table *table, int run, const char *path,
                                 struct neph_diag *diag)
{
    json_t *report = NULL;
    enum neph_status status = read_report(path, &report, diag);
    if (!status && run == 0)
        status = begin_table(table, report, diag);
    if (!status && strcmp(table->limits->host, neph_json_text(report, "host")) != 0)
        status = neph_fail(diag, NEPH_ERR_INPUT,
                           "'%s' is of the host class '%s', the first run of '%s'", path,
                           neph_json_text(report, "host"), table->limits->host);
    if (!status)
        take_run(table, run, report);
    json_decref(report);
    return status;
}

static bool has_all(const struct table *table, int series)
{
    for (int run = 0; run < table->run_count; run++)
        if (!isfinite(find_values(table, series)[run]))
            return false;
    return true;
}

static bool is_equal(const struct table *table, int series)
{
    return neph_run_values_are_equal(find_values(table, series), table->run_count);
}

static void limit_series(const struct table *table, const struct neph_run_limit_family *family,
                         int series)
{
    struct neph_night_limit *limit = &table->limits->list[series];
    const double *values = find_values(table, series);
    if (strcmp(neph_night_split(&table->limits->arena, limit->series).metric, undirected) == 0)
        limit->because = "contrast is no error";
    else if (!has_all(table, series))
        limit->because = "not in all runs";
    if (limit->because)
        return;
    limit->lowest = limit->highest = values[0];
    for (int run = 1; run < table->run_count; run++) {
        limit->lowest = fmin(limit->lowest, values[run]);
        limit->highest = fmax(limit->highest, values[run]);
    }
    limit->is_equal = is_equal(table, series);
    limit->value = fabs(values[0]);
    if (!limit->is_equal)
        limit->because = neph_run_limit(
            family, values, table->run_count,
            limit->lowest < 0.0 ? NEPH_RUN_LIMIT_EITHER : NEPH_RUN_LIMIT_ABOVE, NAN, &limit->value);
}

/* Two runs with the same numbers, while others differ: copies, or runs with one seed. */
static enum neph_status check_copies(const struct table *table, const char *const *paths,
                                     struct neph_diag *diag)
{
    for (int b = 1; b < table->run_count; b++)
        for (int a = 0; a < b; a++) {
            int noisy = 0, same = 0;
            for (int i = 0; i < table->limits->count; i++) {
                if (!has_all(table, i) || is_equal(table, i))
                    continue;
                noisy++;
                same += find_values(table, i)[a] == find_values(table, i)[b];
            }
            if (noisy > 0 && same == noisy) {
                neph_fail(diag, NEPH_ERR_INPUT,
                          "'%s' and '%s' have the same numbers, others differ", paths[a], paths[b]);
                neph_hint(diag, "run `neph nightly --seed S` with another S each time");
                return NEPH_ERR_INPUT;
            }
        }
    return NEPH_OK;
}

static int count_noisy(const struct table *table)
{
    int count = 0;
    for (int i = 0; i < table->limits->count; i++)
        count += has_all(table, i) && !is_equal(table, i);
    return count;
}

enum neph_status neph_night_limits_measure(const char *const *paths, int count,
                                           struct neph_night_limits *limits, struct neph_diag *diag)
{
    struct table table = {limits, count, NULL};
    enum neph_status status = NEPH_OK;
    for (int run = 0; run < count && !status; run++)
        status = read_run(&table, run, paths[run], diag);
    if (!status)
        status = check_copies(&table, paths, diag);
    if (status)
        return status;
    const int noisy = count_noisy(&table);
    const struct neph_run_limit_family family = {limits->share, limits->confidence,
                                                 noisy > 0 ? noisy : 1};
    limits->run_count = count;
    for (int i = 0; i < limits->count; i++)
        limit_series(&table, &family, i);
    return NEPH_OK;
}

/* ---- the file -------------------------------------------------------------------------------- */

json_t *neph_night_limits_json(const struct neph_night_limits *limits)
{
    json_t *list = json_array();
    for (int i = 0; i < limits->count; i++) {
        const struct neph_night_limit *limit = &limits->list[i];
        neph_json_add(&list,
                      json_pack("{s:s, s:o, s:i, s:o, s:f, s:f, s:s}", "series", limit->series,
                                "limit", neph_json_number(limit->because ? NAN : limit->value),
                                "runs", limits->run_count, "confidence",
                                neph_json_number(limit->is_equal ? NAN : limits->confidence),
                                "lowest", limit->lowest, "highest", limit->highest, "because",
                                limit->because ? limit->because : ""));
    }
    return json_pack("{s:i, s:s, s:s, s:i, s:f, s:f, s:o}", "neph_night_limits", FORMAT, "version",
                     NEPH_VERSION, "host", limits->host, "runs", limits->run_count, "share",
                     limits->share, "confidence", limits->confidence, "limits", list);
}

static bool read_limit(const json_t *row, struct neph_night_limits *limits,
                       struct neph_night_limit *limit)
{
    limit->series = neph_arena_copy_text(&limits->arena, neph_json_text(row, "series"));
    limit->value = neph_json_real(row, "limit");
    limit->is_equal = json_is_null(json_object_get(row, "confidence"));
    limit->because = json_is_null(json_object_get(row, "limit")) ? "no limit" : NULL;
    return limit->series[0] && (limit->because || limit->value >= 0.0);
}

static enum neph_status read_all(const char *path, const json_t *json,
                                 struct neph_night_limits *limits, struct neph_diag *diag)
{
    const json_t *list = json_object_get(json, "limits");
    const size_t count = json_array_size(list);
    bool is_valid = json_integer_value(json_object_get(json, "neph_night_limits")) == FORMAT &&
                    count > 0;
    limits->path = neph_arena_copy_text(&limits->arena, path);
    limits->host = neph_arena_copy_text(&limits->arena, neph_json_text(json, "host"));
    limits->run_count = (int)json_integer_value(json_object_get(json, "runs"));
    limits->share = neph_json_real(json, "share");
    limits->confidence = neph_json_real(json, "confidence");
    limits->list = neph_arena_allocate(&limits->arena, count + 1, sizeof(*limits->list));
    for (size_t i = 0; limits->list && i < count && is_valid; i++)
        is_valid = read_limit(json_array_get(list, i), limits, &limits->list[limits->count++]);
    if (is_valid)
        return neph_arena_check(&limits->arena, diag);
    neph_fail(diag, NEPH_ERR_INPUT, "'%s' is not a file of limits of nightly runs", path);
    neph_hint(diag, "`neph limits NIGHT/nightly.json...` writes such files");
    return NEPH_ERR_INPUT;
}

enum neph_status neph_night_limits_read(const char *path, struct neph_night_limits *limits,
                                        struct neph_diag *diag)
{
    json_t *json = NULL;
    enum neph_status status = neph_json_read(path, file_limit_bytes, &json, diag);
    if (!status)
        status = read_all(path, json, limits, diag);
    json_decref(json);
    return status;
}

/* ---- use ------------------------------------------------------------------------------------- */

static const struct neph_night_limit *find_limit(const struct neph_night_limits *limits,
                                                 const char *series)
{
    for (int i = 0; i < limits->count; i++)
        if (strcmp(limits->list[i].series, series) == 0)
            return limits->list[i].because ? NULL : &limits->list[i];
    return NULL;
}

static void report(const struct neph_night_limits *limits, const struct neph_night_limit *limit,
                   const struct neph_compared *row, struct neph_night_comparison *comparison)
{
    struct neph_finding finding = neph_finding(
        NEPH_FOUND_WORSE, row->series, row->step,
        neph_arena_format(&comparison->arena, "%.6g is beyond the limit %.6g of %d runs, %s",
                          row->tonight, limit->value, limits->run_count, limits->path));
    finding.tonight = row->tonight;
    finding.baseline = limit->highest;
    finding.example = row->series;
    neph_night_add_finding(comparison, &finding);
}

void neph_night_limits_apply(const struct neph_night_limits *limits,
                             struct neph_night_comparison *comparison)
{
    for (int i = 0; i < comparison->series_count; i++) {
        const struct neph_compared *row = &comparison->series[i];
        const struct neph_night_limit *limit = find_limit(limits, row->series);
        if (!limit)
            continue;
        comparison->compared += row->judgement.judged == NEPH_JUDGED_NOT;
        if (!(fabs(row->tonight) <= limit->value * (1.0 + rounding)))
            report(limits, limit, row, comparison);
    }
    neph_night_settle(comparison);
}
