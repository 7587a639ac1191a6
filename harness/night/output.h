/* SPDX-License-Identifier: MIT
 *
 * The results of a nightly run as text: a paragraph for mail or chat, JSON, and JUnit XML for CI
 * systems.
 */
#ifndef NEPH_HARNESS_NIGHT_OUTPUT_H
#define NEPH_HARNESS_NIGHT_OUTPUT_H

#include "harness/json.h"
#include "harness/night/night.h"

/* One paragraph of plain text, to be freed by the caller. This function and the next one return
 * NEPH_ERR_MEMORY when memory is short. */
enum neph_status neph_night_summary(const struct neph_night *night, const char *tier, char **text,
                                    struct neph_diag *diag);

/* The command that renders a step's numbers again, to be freed by the caller; "" for an unknown
 * step. */
enum neph_status neph_night_command(const struct neph_night *night, const char *step, char **text,
                                    struct neph_diag *diag);

/* {"format": "neph-nightly-1", ...}; NULL when memory is short. */
json_t *neph_night_json(const struct neph_night *night, const char *tier);

/* Write OUTPUT/nightly/summary.txt, nightly.json and junit.xml. */
enum neph_status neph_night_write(const struct neph_night *night, const char *tier,
                                  const char *output, struct neph_diag *diag);

#endif
