/* SPDX-License-Identifier: MIT
 *
 * What a number of the failure suite comes to, against its limit and what is expected of it:
 * failures that are known are written down with their reason, and a known failure that passes is
 * news as much as one that nobody knew of (as in dEQP).
 */
#ifndef NEPH_HARNESS_FAILURE_VERDICT_H
#define NEPH_HARNESS_FAILURE_VERDICT_H

#include <stdbool.h>

enum neph_failure_expected {
    NEPH_FAILURE_PASSES, /* what nothing is said of */
    NEPH_FAILURE_FAILS,
    NEPH_FAILURE_FLAKES, /* passes on some devices and fails on others */
    NEPH_FAILURE_SKIPS,  /* is not measured */
    NEPH_FAILURE_EXPECTED_COUNT,
};

enum neph_failure_verdict {
    NEPH_FAILURE_NOT_ASKED, /* no preset or engine of the scenario */
    NEPH_FAILURE_NOT_YET,   /* of a run that goes on */
    NEPH_FAILURE_PASS,
    NEPH_FAILURE_FAIL,
    NEPH_FAILURE_KNOWN_FAIL,
    NEPH_FAILURE_NEW_PASS, /* expected to fail, and does not */
    NEPH_FAILURE_FLAKE,    /* failed, as it may */
    NEPH_FAILURE_SKIP,
    NEPH_FAILURE_NO_NUMBER,    /* there is nothing to measure, or it broke */
    NEPH_FAILURE_CANNOT,       /* an engine that does not model the scene */
    NEPH_FAILURE_MISSING,      /* one that is not installed */
    NEPH_FAILURE_NOT_RENDERED, /* one that did not fit into its time */
    NEPH_FAILURE_VERDICTS,
};

/* `value` <= `limit` passes; NaN: there is no number. */
enum neph_failure_verdict neph_failure_judge(double value, double limit,
                                             enum neph_failure_expected expected);

/* Whether it is a failure that pictures are of, expected or not: a limit that is not held. */
bool neph_failure_is_failure(enum neph_failure_verdict verdict);

/* What comes first of several: the less, the worse. */
int neph_failure_rank(enum neph_failure_verdict verdict);

/* Whether it fails a run. */
bool neph_failure_is_news(enum neph_failure_verdict verdict);

/* Whether a number was held against a limit. */
bool neph_failure_is_compared(enum neph_failure_verdict verdict);

/* "fails", ..., of the expectation list; and "pass", "fail", ..., of results. */
const char *neph_failure_expected_name(enum neph_failure_expected expected);
const char *neph_failure_verdict_name(enum neph_failure_verdict verdict);

#endif
