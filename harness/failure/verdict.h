/* SPDX-License-Identifier: MIT
 *
 * The verdict on a number of the stress tests, by its limit and by the expectation for it: failures
 * that are known are written down with their reason, and a known failure that passes is as new as a
 * failure that was not known (as in dEQP).
 */
#ifndef NEPH_HARNESS_FAILURE_VERDICT_H
#define NEPH_HARNESS_FAILURE_VERDICT_H

#include <stdbool.h>

enum neph_failure_expected {
    NEPH_FAILURE_PASSES, /* without an expectation */
    NEPH_FAILURE_FAILS,
    NEPH_FAILURE_FLAKES, /* passes on some devices and fails on others */
    NEPH_FAILURE_SKIPS,  /* is not measured */
    NEPH_FAILURE_EXPECTED_COUNT,
};

enum neph_failure_verdict {
    NEPH_FAILURE_NOT_ASKED, /* no preset or engine of the scene */
    NEPH_FAILURE_NOT_YET,   /* of a run that goes on */
    NEPH_FAILURE_PASS,
    NEPH_FAILURE_FAIL,
    NEPH_FAILURE_KNOWN_FAIL,
    NEPH_FAILURE_NEW_PASS, /* expected to fail, and does not */
    NEPH_FAILURE_FLAKE,    /* failed, as it may */
    NEPH_FAILURE_SKIP,
    NEPH_FAILURE_NO_NUMBER,    /* there is nothing to measure, or it broke */
    NEPH_FAILURE_CANNOT,       /* an engine that does not model the scene */
    NEPH_FAILURE_MISSING,      /* an engine that is not installed */
    NEPH_FAILURE_NOT_RENDERED, /* an engine that took longer than its limit */
    NEPH_FAILURE_VERDICTS,
};

struct neph_failure_verdict_info {
    const char *name, *mark; /* of documents; behind a number of the table, or in its place */
    bool is_news;            /* it fails a run */
    bool is_compared;        /* a number was compared with a limit */
    bool is_failure;         /* the number is over its limit, expected or not: it is drawn */
    int rank;                /* the less, the worse */
};

extern const struct neph_failure_verdict_info neph_failure_verdicts[NEPH_FAILURE_VERDICTS];

/* `value` <= `limit` passes; NaN: there is no number. */
enum neph_failure_verdict neph_failure_judge(double value, double limit,
                                             enum neph_failure_expected expected);

#endif
