/* SPDX-License-Identifier: MIT
 *
 * A file of limits that `neph limits` measures from repeated runs, and `--limits FILE` of `neph
 * compare` and `neph flicker` checks.
 */
#ifndef NEPH_HARNESS_COMPARE_LIMITS_FILE_H
#define NEPH_HARNESS_COMPARE_LIMITS_FILE_H

#include "base/arena.h"
#include "harness/compare/comparison.h"
#include "harness/compare/limits.h"

#include <stdio.h>

struct neph_measured_limit {
    struct neph_limit limit;
    const char *unit;
    double lowest, highest; /* of the runs; signed where the metric is */
    bool is_equal;          /* all runs are equal, and the limit is their value */
};

struct neph_unlimited { /* a number without a limit */
    struct neph_limit limit;
    const char *because;
};

/* Start from {0}; free with neph_limits_finish(). Texts are in the arena. */
struct neph_limits {
    struct neph_arena arena;
    const char *path;             /* the file; NULL: not read from a file */
    const char *environment;      /* "VERSION, DEVICE", or the text of --environment; "": unknown */
    const char *reference;        /* first file of the reference; NULL: without a reference */
    const char *reference_digest; /* BLAKE2b of that file; NULL as above */
    int width_px, height_px, frame_count, warm_up_frames;
    int run_count;            /* measured runs, without the reference */
    double share, confidence; /* metrics/run_limit.h */
    struct neph_viewing viewing;
    const char *const *settings; /* EXTRACTOR:KEY=VALUE */
    int setting_count;
    struct neph_measured_limit *list;
    int count;
    struct neph_unlimited *unlimited;
    int unlimited_count;
};

void neph_limits_finish(struct neph_limits *limits);

/* Write the file: an object of
 *   "neph_limits"   1, the version of this format
 *   "version"       of neph
 *   "environment", "reference" ({"first", "digest"} or null), "size" ([width, height]), "frames",
 *   "warm_up_frames", "runs", "share", "confidence", "viewing", "settings"
 *   "alarm_rate"    probability that a further run is beyond any of the limits
 *   "limits"        array of {"quantity", "metric", "mask", "unit", "limit", "fails" ("above" or
 *                   "below"), "runs", "confidence" (null: all runs are equal), "lowest", "highest"}
 *   "left_out"      array of {"quantity", "metric", "mask", "because"} */
json_t *neph_limits_json(const struct neph_limits *limits);

/* The number of limits whose runs differ: only these have a chance of a false alarm. */
int neph_limits_count_noisy(const struct neph_limits *limits);
enum neph_status neph_limits_write(const struct neph_limits *limits, const char *path,
                                   struct neph_diag *diag);

/* Read the file. NEPH_ERR_INPUT: not such a file, or a value is not allowed; the diag names it.
 * Other errors as of neph_file_read(). */
enum neph_status neph_limits_read(const char *path, struct neph_limits *limits,
                                  struct neph_diag *diag);

/* What frames state about themselves. */
struct neph_frame_origin {
    char environment[512]; /* "VERSION, DEVICE": of neph's engines, or of the program that wrote the
                              file; "": the frame does not state it */
    int width_px, height_px;
};

enum neph_status neph_frame_origin_read(const char *path, const struct neph_frame_choice *choice,
                                        size_t negative_allowed, struct neph_frame_origin *origin,
                                        struct neph_diag *diag);

/* Check that limits may be applied to a comparison: NEPH_ERR_INPUT when frame size, number of
 * frames, warm-up or viewing conditions differ from those of the limits. Another environment or
 * reference is allowed, with a warning on stderr. */
enum neph_status neph_limits_check_use(const struct neph_limits *limits,
                                       const struct neph_compared *compared,
                                       struct neph_diag *diag);

/* One line, "PASS all 84 limits of FILE ...", or a line for each of the first failures and their
 * count. Returns the number of lines. */
int neph_limits_print(const struct neph_limits *limits, const struct neph_measurements *numbers,
                      FILE *out);

/* The result of all limits: an object of "file", "environment", "runs", "share", "confidence",
 * "count", and "failed": array of {"quantity", "metric", "mask", "limit", "value" (null: not
 * defined)}. */
json_t *neph_limits_result_json(const struct neph_limits *limits,
                                const struct neph_measurements *numbers);

#endif
