/* SPDX-License-Identifier: MIT
 *
 * The floors of presets in stress scenes that move (harness/study/floor_plan.h). A floor is a
 * column after the columns of the suite: it is rendered and measured like a preset, and has no
 * verdict.
 */
#ifndef NEPH_HARNESS_STRESS_FLOORS_H
#define NEPH_HARNESS_STRESS_FLOORS_H

#include "harness/json.h"
#include "harness/stress/results.h"

/* Adds the floors of all presets to the columns. Errors as of neph_floor_plan_make(). */
enum neph_status neph_stress_add_floors(struct neph_stress_suite *suite, struct neph_diag *diag);

/* Plans the cells of a row in the columns of floors, from its cells in the columns of presets.
 * Static scenes have no floors, and neither has the count of bad values. */
void neph_stress_plan_floor_cells(const struct neph_stress_suite *suite,
                                  struct neph_stress_row *row);

/* The lower of the two configurations of a preset's floor. */
struct neph_stress_floor {
    double value; /* NaN: none; can be infinite */
    double times; /* the preset's value over the floor; NaN: one is infinite, or the floor is 0 */
    const char *name; /* of the configuration; NULL: no floor */
};

struct neph_stress_floor neph_stress_find_floor(const struct neph_stress_suite *suite,
                                                const struct neph_stress_row *row, int column);

/* [{"column", "floors": [name, name]}] of all presets; null: floors are not measured. */
json_t *neph_stress_floors_json(const struct neph_stress_suite *suite);

#endif
