/* SPDX-License-Identifier: MIT
 *
 * `neph validate --suite failure`: the failure suite, its table, DIR/failure.json and
 * DIR/report/index.html.
 */
#ifndef NEPH_HARNESS_CLI_VALIDATE_FAILURE_H
#define NEPH_HARNESS_CLI_VALIDATE_FAILURE_H

#include "harness/failure/suite.h"

/* The word of an option; NEPH_FAILURE_PICTURES_COUNT: there is none such. */
enum neph_failure_pictures neph_cli_failure_pictures(const char *word);

/* NEPH_ERR_GATE: something is new, or nothing was compared. `params` gets what shows the page. */
enum neph_status neph_cli_validate_failure(struct neph_failure_params *params, const char *output,
                                           size_t page_limit_bytes, bool as_json,
                                           struct neph_diag *diag);

#endif
