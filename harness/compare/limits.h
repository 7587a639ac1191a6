/* SPDX-License-Identifier: MIT
 *
 * Limits that measured numbers are held to: --fail-above and --fail-below.
 */
#ifndef NEPH_HARNESS_COMPARE_LIMITS_H
#define NEPH_HARNESS_COMPARE_LIMITS_H

#include "harness/compare/measure.h"
#include "harness/document/junit.h"

struct neph_limit {
    char quantity[32], metric[64], mask[NEPH_IMAGE_NAME_MAX];
    double value; /* >= 0; |number| is held to it */
    bool below;   /* below it is a failure, else above */
};

/* "[QUANTITY:]METRIC[@MASK]=LIMIT"; radiance and all when left out. NEPH_ERR_USAGE. */
enum neph_status neph_limit_parse(const char *text, bool below, struct neph_limit *limit,
                                  struct neph_diag *diag);

/* The number of that name that is furthest beyond the limit, or nearest to it; NULL: none was
 * measured, or all are without an error. Borrowed of the list. */
const struct neph_measurement *neph_limit_worst(const struct neph_measurements *list,
                                                const struct neph_limit *limit);

/* Hold every number of that name in a list to the limit, of all frames and of
 * each; the error names the worst. NEPH_ERR_GATE: beyond it, or not defined, or a time that the
 * sequence is too short for. NEPH_ERR_UNSUPPORTED: there is no such number. */
enum neph_status neph_limit_check(const struct neph_measurements *list,
                                  const struct neph_limit *limit, struct neph_diag *diag);

/* Add a test case for a limit, which fails with the value and the limit; of a list NULL, where
 * nothing was measured, with `because`. */
void neph_limit_add_case(const struct neph_measurements *list, const struct neph_limit *limit,
                         const char *group, const char *because, struct neph_junit *junit);

#endif
