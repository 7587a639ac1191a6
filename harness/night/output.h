/* SPDX-License-Identifier: MIT
 *
 * What a night says: a paragraph for mail or chat, JSON, and JUnit's XML for what reads that.
 */
#ifndef NEPH_HARNESS_NIGHT_OUTPUT_H
#define NEPH_HARNESS_NIGHT_OUTPUT_H

#include "harness/json.h"
#include "harness/night/night.h"

/* One paragraph of plain text, for the caller to free. Here and below: NEPH_ERR_MEMORY. */
enum neph_status neph_night_summary(const struct neph_night *night, const char *tier, char **text,
                                    struct neph_diag *diag);

/* The command that renders a step's numbers again, for the caller to free; "" when there is no such
 * step. */
enum neph_status neph_night_command(const struct neph_night *night, const char *step, char **text,
                                    struct neph_diag *diag);

/* {"format": "neph-nightly-1", ...}; NULL when memory is short. */
json_t *neph_night_json(const struct neph_night *night, const char *tier);

/* OUTPUT/nightly/summary.txt, nightly.json, junit.xml. */
enum neph_status neph_night_write(const struct neph_night *night, const char *tier,
                                  const char *output, struct neph_diag *diag);

#endif
