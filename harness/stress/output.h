/* SPDX-License-Identifier: MIT
 *
 * Results of the stress tests as text, JUnit and JSON.
 */
#ifndef NEPH_HARNESS_STRESS_OUTPUT_H
#define NEPH_HARNESS_STRESS_OUTPUT_H

#include "harness/document/junit.h"
#include "harness/json.h"
#include "harness/stress/results.h"

#include <stdio.h>

/* Prints a table with a line for each measure, worst first, then unexpected results with their
 * commands, and the counts. */
enum neph_status neph_stress_print(const struct neph_stress_suite *suite, FILE *out,
                                   struct neph_diag *diag);

/* The command that renders a column of a scenario again, for free(); NULL: out of memory. */
char *neph_stress_command(const struct neph_stress_suite *suite, const struct neph_stress_row *row,
                          int column);

/* Adds a test case for each measured value, and one for the verdict of the run. A known failure is
 * a skipped test case, with the reason of its expectation. */
void neph_stress_junit(const struct neph_stress_suite *suite, struct neph_junit *junit);

/* The results as JSON, worst first; NULL: out of memory.
 *
 *   {"format": "neph-failure-2", "device", "tier",
 *    "columns": [{"name", "engine", "preset": bool}],
 *    "floors": [{"column", "floors": [name, name]}], or null: not measured,
 *    "scenes": [{"name", "title", "fails", "known", "symptom", "truth", "width_px", "height_px",
 *                "frames", "steps", "moves": bool,
 *                "points": [names, "" for the scene file itself]}],
 *    "compared", "news", "counts": {verdict: n}, "verdict", "seconds", "frames",
 *    "results": [{"scene", "point", "measure", "over", "limit", "reason", "column",
 *                 "value" (null: none, or infinite), "infinite", "verdict", "why",
 *                 "floor_column" (null: no floor), "floor", "floor_infinite",
 *                 "times_floor"}, ...]} */
json_t *neph_stress_json(const struct neph_stress_suite *suite);

#endif
