/* SPDX-License-Identifier: MIT
 *
 * The expectation list of the stress tests, scenes/studies/stress_expectations.json:
 *
 *   {"format": "neph-failure-expectations-1", "expectations": [
 *     {"scene": "fence_tiles", "presets": ["seed"], "measure": "period_4", "is": "fails",
 *      "reason": "all tiles override at once"}, ...]}
 *
 * "presets" may name engines, too. "over" (a mask) and "points" (names of points of the sweep, ""
 * the file as it is) narrow an entry down; without them it is of all. The first entry that fits
 * counts.
 */
#ifndef NEPH_HARNESS_STRESS_EXPECTATIONS_H
#define NEPH_HARNESS_STRESS_EXPECTATIONS_H

#include "harness/json.h"
#include "harness/stress/results.h"

/* The place of a number in the results. */
struct neph_stress_place {
    const char *scene, *point, *preset, *measure, *over;
};

/* The list of a file (NULL: of the project), for the caller to json_decref. NEPH_ERR_INPUT: it is
 * none, or an entry lacks a scene, presets, measure, reason, or says something else of itself than
 * fails, flakes or skips. */
enum neph_status neph_stress_expectations_load(const char *path, json_t **list,
                                               struct neph_diag *diag);

/* The expectation of a number; `*reason` is the entry's, borrowed, or "". */
enum neph_stress_expected neph_stress_expected_at(const json_t *list,
                                                  const struct neph_stress_place *place,
                                                  const char **reason);

#endif
