/* SPDX-License-Identifier: MIT
 *
 * Is one test better than another? The sentence that says so, with its numbers.
 */
#ifndef NEPH_HARNESS_COMPARE_VERDICT_PAIR_H
#define NEPH_HARNESS_COMPARE_VERDICT_PAIR_H

#include "harness/compare/comparison.h"

#include <stdio.h>

/* What a difference comes to. */
struct neph_judged_difference {
    const char *word;    /* "better", "worse", "higher", "lower", "equal", "not told apart" */
    const char *because; /* why it is not told apart; NULL: chance could have made it */
    double p;            /* the larger one of the tests over tiles and over time; NaN: not known */
    int below, above;    /* values of a series in which the test is lower, is higher */
    int count;           /* of them; 0: there is no series */
    const char *what;    /* they are: "frames" or "cycles" */
};

extern const char *const neph_not_told_apart;

/* Better and worse need both: a 95 % interval without 0 over the picture's tiles, or over batches
 * of frames where each frame has the number; and of flicker p < 0.05 over time, too, for what moves
 * all tiles at once is one event, not one for each tile. */
struct neph_judged_difference neph_judge_difference(const struct neph_differences *versus,
                                                    const struct neph_difference *difference);

/* Write one line: "after: 4.40 times the threshold, before: 17.0; better, p < 0.001, in 63 of 64
 * frames; worst at (212, 40), period 4 frames". False: no number can be paired, and nothing is
 * written. */
bool neph_verdict_pair(const struct neph_compared *compared, const char *mask, const char *test,
                       const char *other, FILE *out);

/* Write a line for each headline, and with `shows_metrics` for each other number, with both values
 * and their difference; returns how many. */
int neph_verdict_pair_numbers(const struct neph_compared *compared, const char *mask,
                              const char *test, const char *other, bool shows_metrics,
                              int lines_max, FILE *out);

#endif
