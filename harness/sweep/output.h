/* SPDX-License-Identifier: MIT
 *
 * A sweep as a table for people, as JSON and as CSV.
 */
#ifndef NEPH_HARNESS_SWEEP_OUTPUT_H
#define NEPH_HARNESS_SWEEP_OUTPUT_H

#include "harness/json.h"
#include "harness/sweep/results.h"

/* The command line that renders a point by hand; for the caller to free, NULL when memory is
 * short. */
char *neph_sweep_command(const struct neph_sweep *sweep, const struct neph_sweep_point *point);

/* The device of our own renderer, by the first of its points that was rendered; "" when there is
 * none. */
const char *neph_sweep_device(const struct neph_sweep *sweep);

/* How many points were rendered. */
int neph_sweep_measured_count(const struct neph_sweep *sweep);

void neph_sweep_print(const struct neph_sweep *sweep, FILE *out);

/* As in scripts/report/README.md; for the caller to json_decref, NULL when it could not be made. */
json_t *neph_sweep_json(const struct neph_sweep *sweep);

/* A line for each point. */
void neph_sweep_print_csv(const struct neph_sweep *sweep, FILE *out);

#endif
