/* SPDX-License-Identifier: MIT
 *
 * Results of the stress tests as text and JSON.
 */
#include "harness/stress/output.h"

#include "base/files.h"
#include "harness/document/table.h"
#include "harness/run/seed.h"
#include "harness/stress/floors.h"
#include "harness/stress/truth.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Fails to compile when a verdict is added, as its word and mark appear in the output. */
_Static_assert(NEPH_STRESS_VERDICTS == 12, "a new kind");

/* ---- text ------------------------------------------------------------------------------------ */

/* "0.12 (3.4)": a floor, and the value over it. */
static void add_floor(const struct neph_stress_floor *floor, struct neph_table *table)
{
    neph_table_word(table, "");
    if (floor->name && isnan(floor->times))
        neph_table_shown(table, "%.3g", floor->value);
    else if (floor->name)
        neph_table_shown(table, "%.3g (%.3g)", floor->value, floor->times);
}

static void add_row(const struct neph_stress_suite *suite, const struct neph_stress_row *row,
                    struct neph_table *table)
{
    neph_table_word(table, "");
    neph_table_shown(table, "%s %s", row->scene->name, row->point);
    neph_table_word(table, "");
    neph_table_shown(table, "%s/%s", neph_failing_measure_name(row->limit->measure),
                     row->limit->over);
    neph_table_number(table, row->limit->limit);
    for (int c = 0; c < suite->column_count; c++) {
        const double value = row->cells[c].value;
        const char *mark = neph_stress_verdicts[row->cells[c].verdict].mark;
        neph_table_word(table, mark);
        if (!isnan(value))
            neph_table_shown(table, "%.3g%s%s", value, *mark ? " " : "", mark);
        const struct neph_stress_floor floor = neph_stress_find_floor(suite, row, c);
        if (suite->has_floors && suite->columns[c].is_preset)
            add_floor(&floor, table);
    }
}

static bool is_first_of_row(const struct neph_stress_cell_id *spots, int index)
{
    for (int i = 0; i < index; i++)
        if (spots[i].row == spots[index].row)
            return false;
    return true;
}

/* Prints rows sorted by their worst cell. */
static enum neph_status print_table(const struct neph_stress_suite *suite,
                                    const struct neph_stress_cell_id *spots, int count, FILE *out,
                                    struct neph_diag *diag)
{
    const struct neph_column fixed[] = {
        {.title = "scenario, the worst first", .width = -36},
        {.title = "measure/over", .width = -20},
        {.title = "limit", .format = "%.4g", .width = -6},
    };
    struct neph_table table = {.cells = NULL};
    neph_table_columns(&table, fixed, 3);
    for (int c = 0; c < suite->column_count; c++) {
        neph_table_column(&table,
                          (struct neph_column){.title = suite->columns[c].name, .width = -16});
        if (suite->has_floors && suite->columns[c].is_preset)
            neph_table_column(&table, (struct neph_column){.title = "floor (times)", .width = -16});
    }
    for (int i = 0; i < count; i++)
        if (is_first_of_row(spots, i))
            add_row(suite, spots[i].row, &table);
    const enum neph_status status = neph_table_check(&table, diag);
    if (!status)
        neph_table_print_aligned(&table, out);
    fputc('\n', out);
    neph_table_finish(&table);
    return status;
}

static void print_value(const struct neph_stress_row *row, const struct neph_stress_cell *cell,
                        FILE *out)
{
    const char *verdict = neph_stress_verdicts[cell->verdict].name;
    const char *measure = neph_failing_measure_name(row->limit->measure);
    if (isnan(cell->value))
        fprintf(out, "%s/%s has %s, limit %.4g", measure, row->limit->over, verdict,
                row->limit->limit);
    else
        fprintf(out, "%s/%s is %.4g, limit %.4g: %s", measure, row->limit->over, cell->value,
                row->limit->limit, verdict);
}

/* Whether two cells are the same measure and verdict at different sweep points. */
static bool is_same_number(const struct neph_stress_cell_id *a, const struct neph_stress_cell_id *b)
{
    return a->column == b->column && a->row->scene == b->row->scene &&
           a->row->limit == b->row->limit &&
           a->row->cells[a->column].verdict == b->row->cells[b->column].verdict;
}

/* Number of cells in a list that are the same measure as one. */
static int count_same_number(const struct neph_stress_cell_id *spots, int count,
                             const struct neph_stress_cell_id *spot)
{
    int same = 0;
    for (int i = 0; i < count; i++)
        same += is_same_number(&spots[i], spot);
    return same;
}

/* Prints an unexpected result at its worst point; `more` is the number of further points. */
static enum neph_status print_unexpected(const struct neph_stress_suite *suite,
                                         const struct neph_stress_cell_id *spot, int more,
                                         FILE *out, struct neph_diag *diag)
{
    const struct neph_stress_row *row = spot->row;
    const struct neph_stress_cell *cell = &row->cells[spot->column];
    char *command = neph_stress_command(suite, row, spot->column);
    if (!command)
        return neph_fail_memory(diag);
    fprintf(out, "%s%s%s, %s: ", row->scene->name, row->point[0] ? " " : "", row->point,
            suite->columns[spot->column].name);
    print_value(row, cell, out);
    const struct neph_stress_floor floor = neph_stress_find_floor(suite, row, spot->column);
    if (floor.name)
        fprintf(out, ", floor %.4g", floor.value);
    if (more > 0)
        fprintf(out, ", and at %d further points", more);
    fprintf(out, "\n  %s\n", cell->why[0] ? cell->why : row->limit->reason);
    if (cell->verdict == NEPH_STRESS_FAIL)
        fprintf(out, "  symptom: %s\n", row->scene->failing->symptom);
    fprintf(out, "  %s\n", command);
    free(command);
    return NEPH_OK;
}

static void print_counts(const struct neph_stress_suite *suite, FILE *out)
{
    const struct neph_stress_counts *counts = &suite->counts;
    fprintf(out, "%s\n%d comparisons in %d scenarios, %d frames:", suite->device, counts->compared,
            suite->scene_count, suite->frame_count);
    for (int v = NEPH_STRESS_PASS; v < NEPH_STRESS_VERDICTS; v++)
        if (counts->verdicts[v] > 0)
            fprintf(out, " %d %s", counts->verdicts[v], neph_stress_verdicts[v].name);
    fprintf(out, "\n%s\nverdict: %s\n",
            suite->has_floors ? "floor: the lower number of every pixel marched in every frame, "
                                "with the anti-aliasing of the\npreset and with the default one; "
                                "in brackets the preset over it; static scenes have none"
                              : "floor: not measured (--tier full, or --only NAME)",
            suite->passes ? "pass" : "fail");
}

enum neph_status neph_stress_print(const struct neph_stress_suite *suite, FILE *out,
                                   struct neph_diag *diag)
{
    int count = 0;
    struct neph_stress_cell_id *spots = neph_stress_worst(suite, &count);
    enum neph_status status = spots ? NEPH_OK : neph_fail_memory(diag);
    if (!status)
        status = print_table(suite, spots, count, out, diag);
    for (int i = 0; i < count && !status; i++)
        if (neph_stress_verdicts[spots[i].row->cells[spots[i].column].verdict].is_unexpected &&
            count_same_number(spots, i, &spots[i]) == 0)
            status = print_unexpected(suite, &spots[i],
                                      count_same_number(spots, count, &spots[i]) - 1, out, diag);
    if (!status)
        print_counts(suite, out);
    free(spots);
    return status;
}

/* The command that runs one column of the suite for a scenario. */
static char *suite_command(const struct neph_stress_suite *suite, const struct neph_stress_row *row,
                           const struct neph_stress_column *column)
{
    char size[64] = "";
    if (suite->width_px > 0)
        snprintf(size, sizeof(size), " --size %dx%d", suite->width_px, suite->height_px);
    return neph_format("neph validate --suite stress%s --only %s %s %s%s%s --pictures all -o %s",
                       row->point[0] ? " --tier full" : "", row->scene->name,
                       column->is_preset ? "--preset" : "--engine", column->name, size,
                       suite->on_device ? " --on-device" : "", row->scene->name);
}

char *neph_stress_command(const struct neph_stress_suite *suite, const struct neph_stress_row *row,
                          int column)
{
    const struct neph_failing *failing = row->scene->failing;
    const struct neph_stress_column *of = &suite->columns[column];
    const bool is_plain = of->is_preset && !of->engine->is_user_engine && !row->point[0] &&
                          !strchr(of->name, '+') && !suite->on_device;
    if (!is_plain)
        return suite_command(suite, row, of);
    return neph_format("neph render %s -e realtime --preset %s -s steps=%d --seed %llu --frames %d "
                       "--size %dx%d -o %s",
                       row->scene->name, of->name, failing->steps,
                       (unsigned long long)neph_seed_for_scene(row->scene, 1), failing->frame_count,
                       suite->width_px > 0 ? suite->width_px : failing->width_px,
                       suite->width_px > 0 ? suite->height_px : failing->height_px,
                       row->scene->name);
}

/* ---- JSON ------------------------------------------------------------------------------------ */

/* All results, worst first. */
static json_t *results_json(const struct neph_stress_suite *suite)
{
    int count = 0;
    struct neph_stress_cell_id *spots = neph_stress_worst(suite, &count);
    json_t *results = spots ? json_array() : NULL;
    for (int i = 0; i < count; i++) {
        const struct neph_stress_row *row = spots[i].row;
        const struct neph_stress_cell *cell = &row->cells[spots[i].column];
        const struct neph_stress_floor floor = neph_stress_find_floor(suite, row, spots[i].column);
        neph_json_add(
            &results,
            json_pack("{s:s, s:s, s:s, s:s, s:f, s:s, s:s, s:o, s:b, s:s, s:s, s:s, s:s?, "
                      "s:o, s:b, s:o}",
                      "scene", row->scene->name, "point", row->point, "measure",
                      neph_failing_measure_name(row->limit->measure), "over", row->limit->over,
                      "limit", row->limit->limit, "reason", row->limit->reason, "column",
                      suite->columns[spots[i].column].name, "value", neph_json_number(cell->value),
                      "infinite", isinf(cell->value) != 0, "verdict",
                      neph_stress_verdicts[cell->verdict].name, "why", cell->why, "frame_key",
                      cell->frame_key ? cell->frame_key : "", "floor_column", floor.name, "floor",
                      neph_json_number(floor.value), "floor_infinite", isinf(floor.value) != 0,
                      "times_floor", neph_json_number(floor.times)));
    }
    free(spots);
    return results;
}

static json_t *scene_json(const struct neph_stress_suite *suite, const struct neph_scene *scene)
{
    const struct neph_failing *failing = scene->failing;
    const int count = suite->full ? neph_failing_point_count(failing) : 1;
    json_t *points = json_array();
    for (int point = 0; point < count; point++) {
        char name[NEPH_FAILING_POINT_SIZE];
        neph_failing_point_name(failing, point, name, sizeof(name));
        neph_json_add(&points, json_string(name));
    }
    return json_pack("{s:s, s:s, s:s, s:s, s:s, s:s, s:i, s:i, s:i, s:i, s:b, s:o}", "name",
                     scene->name, "title", scene->title, "fails", failing->fails, "known",
                     failing->known, "symptom", failing->symptom, "truth",
                     neph_failing_reference_name(failing->truth), "width_px", failing->width_px,
                     "height_px", failing->height_px, "frames", failing->frame_count, "steps",
                     failing->steps, "moves", !neph_stress_is_static(scene), "points", points);
}

json_t *neph_stress_json(const struct neph_stress_suite *suite)
{
    json_t *columns = json_array(), *scenes = json_array(), *counts = json_object();
    for (int c = 0; c < suite->column_count; c++)
        neph_json_add(&columns, json_pack("{s:s, s:s, s:b}", "name", suite->columns[c].name,
                                          "engine", suite->columns[c].engine->name, "preset",
                                          suite->columns[c].is_preset));
    for (int s = 0; s < suite->scene_count; s++)
        neph_json_add(&scenes, scene_json(suite, suite->scenes[s]));
    for (int v = NEPH_STRESS_PASS; v < NEPH_STRESS_VERDICTS; v++)
        neph_json_set(&counts, neph_stress_verdicts[v].name,
                      json_integer(suite->counts.verdicts[v]));
    return json_pack("{s:s, s:s, s:s, s:o, s:o, s:o, s:i, s:i, s:o, s:s, s:f, s:i, s:o}", "format",
                     "neph-failure-2", "device", suite->device, "tier",
                     suite->full ? "full" : "quick", "columns", columns, "floors",
                     neph_stress_floors_json(suite), "scenes", scenes, "compared",
                     suite->counts.compared, "news", suite->counts.news, "counts", counts,
                     "verdict", suite->passes ? "pass" : "fail", "seconds", suite->seconds,
                     "frames", suite->frame_count, "results", results_json(suite));
}
