/* SPDX-License-Identifier: MIT
 *
 * The verdict of a comparison in at most ten lines of text: one sentence with its numbers, the most
 * important numbers, and the options that show all others.
 */
#ifndef NEPH_HARNESS_COMPARE_VERDICT_H
#define NEPH_HARNESS_COMPARE_VERDICT_H

#include "harness/compare/comparison.h"
#include "harness/compare/limits.h"

#include <stdio.h>

/* Write one line: "PASS flip_mean 0.031 <= 0.05" or "FAIL flip_mean 0.061 > 0.05". */
void neph_verdict_limit(const struct neph_measurements *list, const struct neph_limit *limit,
                        FILE *out);

struct neph_verdict_form {
    const char *mask;         /* mask of the numbers; NULL: all pixels */
    const char *test, *other; /* names of the two tests that `versus` compares */
    const char *note;         /* second line: the reference, or the quantities unknown without one;
                                 NULL: none */
    int lines_used;           /* lines already written by neph_verdict_limit() */
    bool is_brief;            /* one line; no line when some are already written */
    bool is_on_page;          /* leave out the options that show other numbers */
    bool shows_metrics;       /* the user named metrics: they follow the most important ones */
};

void neph_verdict(const struct neph_compared *compared, const struct neph_verdict_form *form,
                  FILE *out);

#endif
