/* SPDX-License-Identifier: MIT
 *
 * `neph validate --suite stress`: the stress tests, its table, DIR/stress.json and
 * DIR/report/index.html.
 */
#ifndef NEPH_HARNESS_CLI_VALIDATE_STRESS_H
#define NEPH_HARNESS_CLI_VALIDATE_STRESS_H

#include "harness/stress/suite.h"

/* The word of an option; NEPH_STRESS_PICTURES_COUNT: there is none such. */
enum neph_stress_pictures neph_cli_stress_pictures(const char *word);

/* `document` is the name of the JSON in `output`. NEPH_ERR_GATE: something is new, or nothing was
 * compared. `params` gets what shows the page. */
enum neph_status neph_cli_validate_stress(struct neph_stress_params *params, const char *output,
                                          const char *document, size_t page_limit_bytes,
                                          bool as_json, struct neph_diag *diag);

#endif
