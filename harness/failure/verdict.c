/* SPDX-License-Identifier: MIT */
#include "harness/failure/verdict.h"

#include <math.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_FAILURE_EXPECTED_COUNT == 4, "a new kind");
_Static_assert(NEPH_FAILURE_VERDICTS == 12, "a new kind");

const struct neph_failure_verdict_info neph_failure_verdicts[NEPH_FAILURE_VERDICTS] = {
    [NEPH_FAILURE_FAIL] = {"fail", "FAIL", true, true, true, 0},
    [NEPH_FAILURE_NO_NUMBER] = {"no_number", "NONE", true, false, false, 1},
    [NEPH_FAILURE_NEW_PASS] = {"unexpected_pass", "PASS!", true, true, false, 2},
    [NEPH_FAILURE_FLAKE] = {"flake", "flake", false, true, true, 3},
    [NEPH_FAILURE_KNOWN_FAIL] = {"known_fail", "known", false, true, true, 4},
    [NEPH_FAILURE_NOT_RENDERED] = {"not_rendered", "not rendered", false, false, false, 5},
    [NEPH_FAILURE_PASS] = {"pass", "", false, true, false, 6},
    [NEPH_FAILURE_SKIP] = {"skip", "skip", false, false, false, 7},
    [NEPH_FAILURE_CANNOT] = {"cannot", "cannot", false, false, false, 8},
    [NEPH_FAILURE_MISSING] = {"missing", "missing", false, false, false, 9},
    [NEPH_FAILURE_NOT_YET] = {"not_yet", "not yet", false, false, false, 10},
    [NEPH_FAILURE_NOT_ASKED] = {"not_asked", "-", false, false, false, 11},
};

enum neph_failure_verdict neph_failure_judge(double value, double limit,
                                             enum neph_failure_expected expected)
{
    static const enum neph_failure_verdict table[NEPH_FAILURE_EXPECTED_COUNT][2] = {
        [NEPH_FAILURE_PASSES] = {NEPH_FAILURE_FAIL, NEPH_FAILURE_PASS},
        [NEPH_FAILURE_FAILS] = {NEPH_FAILURE_KNOWN_FAIL, NEPH_FAILURE_NEW_PASS},
        [NEPH_FAILURE_FLAKES] = {NEPH_FAILURE_FLAKE, NEPH_FAILURE_PASS},
        [NEPH_FAILURE_SKIPS] = {NEPH_FAILURE_SKIP, NEPH_FAILURE_SKIP},
    };
    if (isnan(value) && expected != NEPH_FAILURE_SKIPS)
        return NEPH_FAILURE_NO_NUMBER;
    return table[expected][value <= limit];
}
