/* SPDX-License-Identifier: MIT
 *
 * Tables of a flicker study: presets over their floors.
 */
#include "harness/study/flicker_floor.h"

#include "harness/study/flicker_pairs.h"

#include <math.h>
#include <string.h>

/* ---- which floor ----------------------------------------------------------------------------- */

int neph_flicker_floor_first(const struct neph_flicker_study *study, int preset)
{
    const struct neph_study_floor *floors = study->params->floors;
    int first = 0;
    while (memcmp(&floors[first], &floors[preset], sizeof(floors[first])) != 0)
        first++;
    return first;
}

const char *neph_flicker_floor_title(const struct neph_flicker_study *study, int first,
                                     struct neph_arena *arena)
{
    const char *title = NULL;
    for (int preset = first; preset < study->params->preset_count; preset++)
        if (neph_flicker_floor_first(study, preset) == first)
            title = neph_arena_format(arena, "%s %s",
                                      title ? neph_arena_format(arena, "%s,", title) : "floor of",
                                      study->params->presets[preset]);
    return title;
}

void neph_flicker_floor_print_list(const struct neph_flicker_study *study, struct neph_arena *arena,
                                   FILE *out)
{
    const struct neph_flicker_study_params *params = study->params;
    if (!params->floors) {
        fprintf(out, "\nWithout floors (--no-floor).\n");
        return;
    }
    fprintf(out, "\nThe floor of a preset marches every pixel in every frame. In each scene it is "
                 "the lower number of two:\nwith the anti-aliasing of the preset, and with the "
                 "default one.\n\n");
    for (int preset = 0; preset < params->preset_count; preset++) {
        const int *candidates = params->floors[preset].candidates;
        if (neph_flicker_floor_first(study, preset) != preset)
            continue;
        fprintf(out, "- %s: %s", neph_flicker_floor_title(study, preset, arena),
                params->presets[candidates[0]]);
        if (candidates[1] != candidates[0])
            fprintf(out, " or %s", params->presets[candidates[1]]);
        fprintf(out, "\n");
    }
}

/* ---- ratios over all scenes ------------------------------------------------------------------ */

void neph_flicker_floor_begin_ratios(struct neph_table *table)
{
    static const struct neph_column columns[] = {
        {.key = "metric"},
        {.key = "mask"},
        {.key = "rate_hz"},
        {.key = "pixels_per_degree"},
        {.key = "preset", .title = "preset"},
        {.key = "value", .title = "value", .format = "%g"},
        {.key = "floor", .title = "floor", .format = "%g"},
        {.key = "times", .title = "times", .format = "%.3g"},
        {.key = "interval", .title = "interval", .format = "%g"},
        {.key = "scenes", .title = "scenes", .format = "%g"},
        {.key = "below"},
        {.key = "above"},
        {.key = "alike"},
        {.title = "below, above, alike", .format = "%g"},
        {.key = "p_sign", .title = "p of signs", .format = "%.2g"},
    };
    neph_table_columns(table, columns, sizeof(columns) / sizeof(columns[0]));
}

/* Adds a geometric mean, shown in the unit of the metric's title. */
static void add_level(double decades, int metric, struct neph_table *table)
{
    const double value = pow(10.0, decades);
    neph_table_number(table, value);
    if (!isnan(value))
        neph_table_shown(table, "%.3g", neph_study_metrics[metric].scale * value);
}

static void add_ratio(const struct neph_flicker_study *study, int metric, int display, int preset,
                      struct neph_table *table)
{
    const struct neph_study_metric *of = &neph_study_metrics[metric];
    const struct neph_study_display at = neph_study_display_at(study->params->frame_rate_hz,
                                                               display);
    struct neph_study_gap gap = {.preset = NAN, .floor = NAN, .pair = {.mean = NAN}};
    const struct neph_study_pair *pair = &gap.pair;
    table->arena.is_short |= neph_study_gap(study, metric, display, preset, &gap, NULL) != NEPH_OK;
    const double low = pow(10.0, pair->low), high = pow(10.0, pair->high);
    neph_table_word(table, of->metric);
    neph_table_word(table, of->mask);
    neph_table_numbers(table, 2, (const double[]){at.frame_rate_hz, at.pixels_per_degree});
    neph_table_word(table, study->params->presets[preset]);
    add_level(gap.preset, metric, table);
    add_level(gap.floor, metric, table);
    neph_table_number(table, pow(10.0, pair->mean));
    neph_table_value(table, pair->has_interval ? json_pack("[f,f]", low, high) : json_null());
    neph_table_shown(table, pair->has_interval ? "%.3g to %.3g" : "-", low, high);
    neph_table_count(table, pair->scene_count);
    neph_table_count(table, pair->better);
    neph_table_count(table, pair->worse);
    neph_table_count(table, pair->alike);
    neph_table_word(table, NULL);
    neph_table_shown(table, "%d, %d, %d", pair->better, pair->worse, pair->alike);
    neph_table_number(table, pair->p_sign);
}

void neph_flicker_floor_add_ratios(const struct neph_flicker_study *study, int metric,
                                   int display_count, struct neph_table *table)
{
    for (int display = 0; display < display_count; display++)
        for (int preset = 0; preset < study->params->preset_count; preset++)
            add_ratio(study, metric, display, preset, table);
}

/* ---- each number ----------------------------------------------------------------------------- */

void neph_flicker_floor_columns(struct neph_table *table)
{
    static const struct neph_column columns[] = {
        {.key = "is_floor"},
        {.key = "floor_preset"},
        {.key = "floor"},
        {.key = "scene_times_floor"},
    };
    neph_table_columns(table, columns, sizeof(columns) / sizeof(columns[0]));
}

void neph_flicker_floor_cells(const struct neph_flicker_study *study, int metric, int scene,
                              int preset, int seed, struct neph_table *table)
{
    const bool is_floor = preset >= study->params->preset_count;
    struct neph_study_scene_gap gap = {NAN, NAN, -1};
    if (!is_floor)
        gap = neph_study_scene_gap(study, metric, 0, preset, scene);
    neph_table_flag(table, is_floor);
    neph_table_word(table, gap.lower < 0 ? NULL : study->params->presets[gap.lower]);
    neph_table_number(
        table,
        gap.lower < 0 ? NAN : neph_study_cell_at(study, scene, gap.lower, seed, metric)->value);
    neph_table_number(table, pow(10.0, gap.preset - gap.floor));
}

/* ---- documents ------------------------------------------------------------------------------- */

json_t *neph_flicker_floor_json(const struct neph_flicker_study *study)
{
    const struct neph_flicker_study_params *params = study->params;
    json_t *list = json_array();
    for (int preset = 0; params->floors && preset < params->preset_count; preset++) {
        const int *candidates = params->floors[preset].candidates;
        neph_json_add(&list,
                      json_pack("{s:s, s:[s,s], s:[s,s]}", "preset", params->presets[preset],
                                "floors", params->presets[candidates[0]],
                                params->presets[candidates[1]], "settings",
                                study->settings[candidates[0]], study->settings[candidates[1]]));
    }
    return list;
}
