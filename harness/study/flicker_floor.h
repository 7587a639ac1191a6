/* SPDX-License-Identifier: MIT
 *
 * The floors of a flicker study as tables: each preset over its floor (floor_plan.h).
 */
#ifndef NEPH_HARNESS_STUDY_FLICKER_FLOOR_H
#define NEPH_HARNESS_STUDY_FLICKER_FLOOR_H

#include "harness/document/table.h"
#include "harness/study/flicker_study.h"

/* The first preset with the same floor; `preset` itself where that is the first. */
int neph_flicker_floor_first(const struct neph_flicker_study *study, int preset);

/* "floor of fixed, svgf": the presets with the floor of `first`. */
const char *neph_flicker_floor_title(const struct neph_flicker_study *study, int first,
                                     struct neph_arena *arena);

/* Prints the definition and the configurations of each floor; a line if there are none. */
void neph_flicker_floor_print_list(const struct neph_flicker_study *study, struct neph_arena *arena,
                                   FILE *out);

/* A row for each preset: its value and its floor, their ratio with an interval, scenes. */
void neph_flicker_floor_begin_ratios(struct neph_table *table);
void neph_flicker_floor_add_ratios(const struct neph_flicker_study *study, int metric,
                                   int display_count, struct neph_table *table);

/* Columns of a table with a row for each number of the study: the floor's configuration, its number
 * with the same seed, and the ratio in the scene. */
void neph_flicker_floor_columns(struct neph_table *table);
void neph_flicker_floor_cells(const struct neph_flicker_study *study, int metric, int scene,
                              int preset, int seed, struct neph_table *table);

/* A list of {"preset", "floors": [..]} of all presets. NULL: memory was short. */
json_t *neph_flicker_floor_json(const struct neph_flicker_study *study);

#endif
