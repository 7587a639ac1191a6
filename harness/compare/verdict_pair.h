/* SPDX-License-Identifier: MIT
 *
 * The verdict on two tests: whether one is better than the other, as a sentence with its numbers.
 */
#ifndef NEPH_HARNESS_COMPARE_VERDICT_PAIR_H
#define NEPH_HARNESS_COMPARE_VERDICT_PAIR_H

#include "harness/compare/comparison.h"

#include <stdio.h>

/* The verdict on a difference. */
struct neph_judged_difference {
    const char *word;    /* "better", "worse", "higher", "lower", "equal", "not told apart" */
    const char *because; /* reason for "not told apart"; NULL: not significant */
    double p;            /* the larger one of the tests over tiles and over time; NaN: unknown */
    int below, above;    /* numbers of values of a series in which the test is lower, or higher */
    int count;           /* number of values; 0: there is no series */
    const char *what;    /* their unit: "frames" or "cycles" */
};

extern const char *const neph_not_told_apart;

/* "better" and "worse" require a 95 % interval without 0: over the frame's tiles, or over batches
 * of frames when each frame has the number. Flicker metrics also require p < 0.05 over time,
 * because a movement of all tiles at once is one event, not one for each tile. */
struct neph_judged_difference neph_judge_difference(const struct neph_differences *versus,
                                                    const struct neph_difference *difference);

/* Write one line: "after: 4.40 times the threshold, before: 17.0; better, p < 0.001, in 63 of 64
 * frames; worst at (212, 40), period 4 frames". False, without output: there is no pair of
 * numbers. */
bool neph_verdict_pair(const struct neph_compared *compared, const char *mask, const char *test,
                       const char *other, FILE *out);

/* Write a line for each headline, and with `shows_metrics` for each other number, with both values
 * and their difference. Returns the number of lines. */
int neph_verdict_pair_numbers(const struct neph_compared *compared, const char *mask,
                              const char *test, const char *other, bool shows_metrics,
                              int lines_max, FILE *out);

#endif
