/* SPDX-License-Identifier: MIT
 *
 * The short answer of a verb: at most ten lines for people. The first line is the verdict: one
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
    const char *lines[NEPH_ANSWER_LINES_MAX - 1]; /* without the last line, which is made when it is
                                                   * printed */
    int count;
};

/* The content of the last line: how to print all numbers, and the files. */
struct neph_answer_rest {
    const char *flags;        /* "--all, --csv FILE or --json" */
    const char *folder;       /* of the files; NULL: the verb writes none */
    const char *const *files; /* names in the folder, ends with NULL; only existing files are
                               * printed */
};

/* Add a line, printf without "\n". Characters that act on a terminal are replaced. A tenth line and
 * those after it are dropped: the most important lines come first. */
void neph_answer_add(struct neph_answer *answer, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Print the lines, then the line about flags and files; `is_brief`: only the verdict. */
void neph_answer_print(const struct neph_answer *answer, const struct neph_answer_rest *rest,
                       bool is_brief, FILE *out);

void neph_answer_finish(struct neph_answer *answer);

/* "better" or "worse" from the 95 % interval of a difference where less is better; "not told apart"
 * if the interval contains 0 or is missing (NaN); "equal" if both ends are 0. */
const char *neph_answer_difference_word(double low, double high);

/* " (10.1 to 14.9)", or "" without an interval; written into the buffer of the caller. */
enum { NEPH_ANSWER_INTERVAL_SIZE = 64 };
const char *neph_answer_interval(double low, double high, char text[NEPH_ANSWER_INTERVAL_SIZE]);

#endif
