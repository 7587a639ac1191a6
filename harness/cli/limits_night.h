/* SPDX-License-Identifier: MIT
 *
 * `neph limits NIGHT/nightly.json...`: limits of the series of nightly runs.
 */
#ifndef NEPH_HARNESS_CLI_LIMITS_NIGHT_H
#define NEPH_HARNESS_CLI_LIMITS_NIGHT_H

#include "harness/options.h"

/* Whether the first operand is a report, not frames. */
bool neph_cli_are_nightly_runs(const struct neph_cli_shared *shared);

/* Measure the limits, write them to DIR/limits.json and print them. NEPH_ERR_USAGE: too few runs.
 * Other errors as of neph_night_limits_measure(). */
enum neph_status neph_cli_limit_nights(const struct neph_cli_shared *shared, double share,
                                       double confidence, struct neph_diag *diag);

#endif
