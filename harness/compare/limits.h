/* SPDX-License-Identifier: MIT
 *
 * Limits for measured numbers: --fail-above and --fail-below.
 */
#ifndef NEPH_HARNESS_COMPARE_LIMITS_H
#define NEPH_HARNESS_COMPARE_LIMITS_H

#include "harness/compare/measure.h"
#include "harness/document/junit.h"

struct neph_limit {
    char quantity[32], metric[64], mask[NEPH_IMAGE_NAME_MAX];
    double value; /* >= 0; compared with |number| */
    bool below;   /* true: values below it fail; false: values above it */
};

/* Parse "[QUANTITY:]METRIC[@MASK]=LIMIT"; the defaults are radiance and all. NEPH_ERR_USAGE. */
enum neph_status neph_limit_parse(const char *text, bool below, struct neph_limit *limit,
                                  struct neph_diag *diag);

/* The number with the largest excess over the limit; NULL: none was measured, or all have no error.
 * Borrowed from the list. */
const struct neph_measurement *neph_limit_worst(const struct neph_measurements *list,
                                                const struct neph_limit *limit);

/* Check every number of the limit's metric, of all frames and of each frame; the error names the
 * worst. NEPH_ERR_GATE: beyond the limit, undefined, or a duration that exceeds the sequence.
 * NEPH_ERR_UNSUPPORTED: there is no such number. */
enum neph_status neph_limit_check(const struct neph_measurements *list,
                                  const struct neph_limit *limit, struct neph_diag *diag);

/* Add a test case for a limit; a failed case has the value and the limit. A list NULL, when nothing
 * was measured, fails with `because`. */
void neph_limit_add_case(const struct neph_measurements *list, const struct neph_limit *limit,
                         const char *group, const char *because, struct neph_junit *junit);

#endif
