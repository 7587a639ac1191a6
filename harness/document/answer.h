/* SPDX-License-Identifier: MIT
 *
 * The answer of a verb in at most ten lines, for people. The first line is the verdict: one
 * sentence that answers the question, with the numbers that it is based on. The last line says how
 * to print all numbers, and where the files are.
 */
#ifndef NEPH_HARNESS_DOCUMENT_ANSWER_H
#define NEPH_HARNESS_DOCUMENT_ANSWER_H

#include "base/arena.h"

#include <stdbool.h>
#include <stdio.h>

enum { NEPH_ANSWER_LINES_MAX = 10 };

/* Start from {0}; free with neph_answer_finish(). */
struct neph_answer {
    struct neph_arena arena;
    const char *lines[NEPH_ANSWER_LINES_MAX - 1]; /* the last line is made when it is printed */
    int count;
};

/* Where everything else is. */
struct neph_answer_rest {
    const char *flags;        /* "--all, --csv FILE or --json" */
    const char *folder;       /* of the files; NULL: the verb writes none */
    const char *const *files; /* names in the folder, of which those that exist are printed; ends
                                 with NULL */
};

/* Add a line, printf without "\n". Characters that act on a terminal are replaced. A tenth line and
 * those after it are dropped: the most important lines come first. */
void neph_answer_add(struct neph_answer *answer, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Print the lines and the last one; `is_brief`: only the verdict. */
void neph_answer_print(const struct neph_answer *answer, const struct neph_answer_rest *rest,
                       bool is_brief, FILE *out);

void neph_answer_finish(struct neph_answer *answer);

/* "better" or "worse" by a 95 % interval of a difference for which less is better; "not told apart"
 * where 0 is in the interval or there is no interval (NaN); "equal" where all of it is 0. */
const char *neph_answer_difference_word(double low, double high);

/* " (10.1 to 14.9)", or "" without an interval; in a buffer of the caller. */
enum { NEPH_ANSWER_INTERVAL_SIZE = 64 };
const char *neph_answer_interval(double low, double high, char text[NEPH_ANSWER_INTERVAL_SIZE]);

#endif
