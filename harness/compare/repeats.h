/* SPDX-License-Identifier: MIT
 *
 * The numbers of repeated runs of a renderer, and the limits that follow (metrics/run_limit.h), for
 * `neph limits`.
 */
#ifndef NEPH_HARNESS_COMPARE_REPEATS_H
#define NEPH_HARNESS_COMPARE_REPEATS_H

#include "harness/compare/limits_file.h"

/* A number in all runs. */
struct neph_repeat {
    const struct neph_metric *metric;
    const struct neph_quantity *quantity;
    const char *unit;
    struct neph_limit limit; /* its names and direction; no value */
    double *values;          /* by run: of the worst frame; NaN: not defined */
};

/* Start from {0} with `run_count` set; free with neph_repeats_finish(). */
struct neph_repeats {
    struct neph_arena arena;
    int run_count, done_count;
    struct neph_repeat *list; /* as the first run has them */
    int count, room;
};

/* Add the numbers of the next run. NEPH_ERR_MEMORY. */
enum neph_status neph_repeats_add(struct neph_repeats *repeats,
                                  const struct neph_measurements *numbers, struct neph_diag *diag);
void neph_repeats_finish(struct neph_repeats *repeats);

/* Two runs whose numbers are all equal although other runs differ: copies, or runs with one seed.
 * False: there are none. */
bool neph_repeats_find_copies(const struct neph_repeats *repeats, int *first, int *second);

/* Fill the lists and the number of runs of `limits`, which has share and confidence. When all runs
 * are equal in all numbers of a quantity, these limits are the numbers themselves. */
enum neph_status neph_repeats_limit(const struct neph_repeats *repeats, struct neph_limits *limits,
                                    struct neph_diag *diag);

#endif
