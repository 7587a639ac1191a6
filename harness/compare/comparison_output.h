/* SPDX-License-Identifier: MIT
 *
 * The results of a comparison for people and for spreadsheets.
 */
#ifndef NEPH_HARNESS_COMPARE_COMPARISON_OUTPUT_H
#define NEPH_HARNESS_COMPARE_COMPARISON_OUTPUT_H

#include "base/status.h"
#include "harness/json.h"

#include <stdbool.h>

/* Print a document of neph_comparison_run() on stdout. `details`: masks of which there are many
 * too. `all`: every number, else of flicker those that stand for the rest. */
void neph_comparison_print(const json_t *document, bool details, bool all);

/* Write an array of measurements as CSV (RFC 4180), a line of names first; "-" is stdout. */
enum neph_status neph_comparison_write_csv(const char *path, const json_t *measurements,
                                           struct neph_diag *diag);

#endif
