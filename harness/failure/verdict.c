/* SPDX-License-Identifier: MIT */
#include "harness/failure/verdict.h"

#include <math.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_FAILURE_EXPECTED_COUNT == 4, "a new kind");
_Static_assert(NEPH_FAILURE_VERDICTS == 12, "a new kind");

static const char *const expected_names[NEPH_FAILURE_EXPECTED_COUNT] = {
    [NEPH_FAILURE_PASSES] = "passes",
    [NEPH_FAILURE_FAILS] = "fails",
    [NEPH_FAILURE_FLAKES] = "flakes",
    [NEPH_FAILURE_SKIPS] = "skips",
};

static const struct {
    const char *name;
    bool is_news, is_compared, is_failure;
    int rank;
} verdicts[NEPH_FAILURE_VERDICTS] = {
    [NEPH_FAILURE_FAIL] = {"fail", true, true, true, 0},
    [NEPH_FAILURE_NO_NUMBER] = {"no_number", true, false, false, 1},
    [NEPH_FAILURE_NEW_PASS] = {"unexpected_pass", true, true, false, 2},
    [NEPH_FAILURE_FLAKE] = {"flake", false, true, true, 3},
    [NEPH_FAILURE_KNOWN_FAIL] = {"known_fail", false, true, true, 4},
    [NEPH_FAILURE_NOT_RENDERED] = {"not_rendered", false, false, false, 5},
    [NEPH_FAILURE_PASS] = {"pass", false, true, false, 6},
    [NEPH_FAILURE_SKIP] = {"skip", false, false, false, 7},
    [NEPH_FAILURE_CANNOT] = {"cannot", false, false, false, 8},
    [NEPH_FAILURE_MISSING] = {"missing", false, false, false, 9},
    [NEPH_FAILURE_NOT_YET] = {"not_yet", false, false, false, 10},
    [NEPH_FAILURE_NOT_ASKED] = {"not_asked", false, false, false, 11},
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

bool neph_failure_is_failure(enum neph_failure_verdict verdict)
{
    return verdicts[verdict].is_failure;
}

int neph_failure_rank(enum neph_failure_verdict verdict)
{
    return verdicts[verdict].rank;
}

bool neph_failure_is_news(enum neph_failure_verdict verdict)
{
    return verdicts[verdict].is_news;
}

bool neph_failure_is_compared(enum neph_failure_verdict verdict)
{
    return verdicts[verdict].is_compared;
}

const char *neph_failure_expected_name(enum neph_failure_expected expected)
{
    return expected_names[expected];
}

const char *neph_failure_verdict_name(enum neph_failure_verdict verdict)
{
    return verdicts[verdict].name;
}
