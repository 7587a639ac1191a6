/* SPDX-License-Identifier: MIT
 *
 * A run of the stress tests for people and for programs.
 */
#ifndef NEPH_HARNESS_STRESS_OUTPUT_H
#define NEPH_HARNESS_STRESS_OUTPUT_H

#include "harness/document/junit.h"
#include "harness/json.h"
#include "harness/stress/results.h"

#include <stdio.h>

/* A line for each number over the columns, the worst first, then new verdicts with commands, and
 * the counts. */
enum neph_status neph_stress_print(const struct neph_stress_suite *suite, FILE *out,
                                   struct neph_diag *diag);

/* The command that renders the frames of a column of a scenario, for the caller to free; NULL when
 * memory is short. */
char *neph_stress_command(const struct neph_stress_suite *suite, const struct neph_stress_row *row,
                          int column);

/* A test case for each number that was asked for, and for the verdict of the run. A known failure
 * is skipped, with the reason of its expectation. */
void neph_stress_junit(const struct neph_stress_suite *suite, struct neph_junit *junit);

/* {"format": "neph-failure-2", "device", "tier", "columns": [{"name", "engine", "preset": bool}],
 * "scenes": [{"name", "title", "fails", "known", "symptom", "truth", "width_px", "height_px",
 *   "frames", "steps", "points": [names, "" the file as it is]}],
 * "compared", "news", "counts": {verdict: n}, "verdict", "seconds", "frames",
 * "results": [{"scene", "point", "measure", "over", "limit", "reason", "column", "value" (null:
 *   none, or infinite), "infinite", "verdict", "why"}, ...], the worst first}; NULL when memory is
 * short. */
json_t *neph_stress_json(const struct neph_stress_suite *suite);

#endif
