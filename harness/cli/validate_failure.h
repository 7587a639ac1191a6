/* SPDX-License-Identifier: MIT
 *
 * `neph validate --suite failure`: the failure suite, its table and DIR/failure.json.
 */
#ifndef NEPH_HARNESS_CLI_VALIDATE_FAILURE_H
#define NEPH_HARNESS_CLI_VALIDATE_FAILURE_H

#include "harness/failure/suite.h"

/* NEPH_ERR_GATE: something is new, or nothing was compared. */
enum neph_status neph_cli_validate_failure(const struct neph_failure_params *params,
                                           const char *output, bool as_json,
                                           struct neph_diag *diag);

#endif
