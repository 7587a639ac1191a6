/* SPDX-License-Identifier: MIT
 *
 * A run of the failure suite for people and for programs.
 */
#ifndef NEPH_HARNESS_FAILURE_OUTPUT_H
#define NEPH_HARNESS_FAILURE_OUTPUT_H

#include "harness/failure/results.h"
#include "harness/json.h"

#include <stdio.h>

/* A line for each number over the presets, then what is new and how to see it, then the counts. */
void neph_failure_print(const struct neph_failure_suite *suite, FILE *out);

/* {"format": "neph-failure-1", "device", "presets", "compared", "news", "counts": {verdict: n},
 * "verdict", "seconds", "frames", "results": [{"scene", "point", "measure", "over", "limit",
 * "reason", "preset", "value" (null: none, or infinite), "verdict", "why"}, ...]}; NULL when memory
 * is short. */
json_t *neph_failure_json(const struct neph_failure_suite *suite);

#endif
