/* SPDX-License-Identifier: MIT
 *
 * The answer of a comparison in at most ten lines, for people: one sentence with its numbers, the
 * most important numbers, and the way to all the others.
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
    const char *mask;         /* the numbers are those over this mask; NULL: over all pixels */
    const char *test, *other; /* names of both tests, of which `versus` is the difference */
    const char *note;         /* a line behind the first one: the reference, or what is not known
                                 without one; NULL: none */
    int lines_used;           /* stand above, by neph_verdict_limit() */
    bool is_brief;            /* one line, and none where lines stand above */
    bool is_on_page;          /* the ways to the other numbers are not told */
    bool shows_metrics;       /* the user named metrics: they follow the most important ones */
};

void neph_verdict(const struct neph_compared *compared, const struct neph_verdict_form *form,
                  FILE *out);

#endif
