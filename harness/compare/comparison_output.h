/* SPDX-License-Identifier: MIT
 *
 * The results of a comparison for people and for spreadsheets.
 */
#ifndef NEPH_HARNESS_COMPARE_COMPARISON_OUTPUT_H
#define NEPH_HARNESS_COMPARE_COMPARISON_OUTPUT_H

#include "harness/compare/comparison.h"

/* Print what came of a comparison on stdout. `details`: masks of which there are many too. `all`:
 * every number, else of flicker those that stand for the rest. */
void neph_comparison_print(const struct neph_compared *compared, bool details, bool all);

/* Write the numbers as CSV (RFC 4180), a line of names first; "-" is stdout. */
enum neph_status neph_comparison_write_csv(const char *path, const struct neph_compared *compared,
                                           struct neph_diag *diag);

#endif
