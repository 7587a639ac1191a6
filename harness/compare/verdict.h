/* SPDX-License-Identifier: MIT
 *
 * The answer of a comparison in at most ten lines, for people: one sentence with the numbers that
 * it rests on, the most important numbers, and the way to all the others.
 */
#ifndef NEPH_HARNESS_COMPARE_VERDICT_H
#define NEPH_HARNESS_COMPARE_VERDICT_H

#include "harness/compare/comparison.h"
#include "harness/compare/limits.h"

/* Print one line on stdout: "PASS flip_mean 0.031 <= 0.05" or "FAIL flip_mean 0.061 > 0.05". */
void neph_verdict_print_limit(const struct neph_measurements *list, const struct neph_limit *limit);

struct neph_verdict_form {
    const char *mask;   /* the numbers are those over this mask; NULL: over all pixels */
    int lines_used;     /* stand above, by neph_verdict_print_limit() */
    bool is_brief;      /* one line, and none where lines stand above */
    bool shows_metrics; /* the user named metrics: they follow the most important ones */
};

void neph_verdict_print(const struct neph_compared *compared, const struct neph_verdict_form *form);

#endif
