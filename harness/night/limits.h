/* SPDX-License-Identifier: MIT
 *
 * Limits of a nightly run's series, measured by `neph limits` from the reports of repeated nightly
 * runs with different seeds (metrics/run_limit.h): a number beyond its limit is worse, also in a
 * run that has no baseline.
 */
#ifndef NEPH_HARNESS_NIGHT_LIMITS_H
#define NEPH_HARNESS_NIGHT_LIMITS_H

#include "harness/json.h"
#include "harness/night/compare.h"

struct neph_night_limit {
    const char *series;
    double value;           /* |number| above it is worse */
    double lowest, highest; /* of the runs */
    bool is_equal;          /* the runs are equal, and the limit is their number */
    const char *because;    /* why there is no limit; NULL: there is one */
};

/* Start from {0}; free with neph_night_limits_finish(). Texts are in the arena. */
struct neph_night_limits {
    struct neph_arena arena;
    const char *path; /* the file; NULL: not read from a file */
    const char *host; /* class of the host of the runs */
    int run_count;
    double share, confidence;
    struct neph_night_limit *list; /* those without a limit included */
    int count;
};

/* Measure limits from nightly.json files; share and confidence are set. NEPH_ERR_INPUT: a file is
 * no report of a nightly run, hosts differ, or two runs have the same numbers while others differ.
 * Other errors as of neph_file_read(). */
enum neph_status neph_night_limits_measure(const char *const *paths, int count,
                                           struct neph_night_limits *limits,
                                           struct neph_diag *diag);

/* An object of "neph_night_limits" (1), "version", "host", "runs", "share", "confidence", and
 * "limits": array of {"series", "limit" (null: none), "runs", "confidence" (null: all runs are
 * equal), "lowest", "highest", "because"}. */
json_t *neph_night_limits_json(const struct neph_night_limits *limits);

/* Read the file. NEPH_ERR_INPUT: not such a file. */
enum neph_status neph_night_limits_read(const char *path, struct neph_night_limits *limits,
                                        struct neph_diag *diag);

/* Add a finding for each number of a run that is beyond its limit, and count the series that have
 * a limit as compared. */
void neph_night_limits_apply(const struct neph_night_limits *limits,
                             struct neph_night_comparison *comparison);

void neph_night_limits_finish(struct neph_night_limits *limits);

#endif
