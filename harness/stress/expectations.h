/* SPDX-License-Identifier: MIT
 *
 * The expectation list of the stress tests, scenes/studies/stress_expectations.json:
 *
 *   {"format": "neph-failure-expectations-1", "expectations": [
 *     {"scene": "fence_tiles", "presets": ["seed"], "measure": "period_4", "is": "fails",
 *      "reason": "all tiles override at once"}, ...]}
 *
 * "presets" may include engines. "over" (a mask) and "points" (names of sweep points, "" for the
 * scene file itself) restrict an entry; without them it matches all masks and points. The first
 * matching entry applies.
 */
#ifndef NEPH_HARNESS_STRESS_EXPECTATIONS_H
#define NEPH_HARNESS_STRESS_EXPECTATIONS_H

#include "harness/json.h"
#include "harness/stress/results.h"

/* The identity of a value in the results. */
struct neph_stress_place {
    const char *scene, *point, *preset, *measure, *over;
};

/* The entries of a file (NULL: the installed one), for json_decref(). NEPH_ERR_INPUT: another
 * format, or an entry without scene, presets, measure or reason, or whose "is" is not fails, flakes
 * or skips. */
enum neph_status neph_stress_expectations_load(const char *path, json_t **list,
                                               struct neph_diag *diag);

/* The expectation for a value. `*reason` is the entry's, borrowed, or "". */
enum neph_stress_expected neph_stress_expected_at(const json_t *list,
                                                  const struct neph_stress_place *place,
                                                  const char **reason);

#endif
