/* SPDX-License-Identifier: MIT
 *
 * Which files a user means: frames of a sequence from words of the command line. Names are looked
 * at, files are not opened.
 */
#ifndef NEPH_HARNESS_SEQUENCE_H
#define NEPH_HARNESS_SEQUENCE_H

#include "base/status.h"

#include <stdbool.h>

/* One line for the help of commands that take such words. */
#define NEPH_SEQUENCE_HELP                                                                         \
    "a file, a folder (its .exr files, else its .png files), a numbered pattern such as "          \
    "frame.%04d.exr, or a quoted glob such as 'frame.*.exr'; several are joined"

struct neph_sequence {
    int count;    /* >= 1 */
    char **paths; /* owned, as is each of them */
};

/* The files of the words, joined. A word is, in this order: a file or a folder that exists, a
 * pattern with one %d or %0Nd in its last part, a glob(7). The frame number of a file is the last
 * run of digits in its name before the extension; files that differ in nothing else are a series.
 * The files of a folder, pattern or glob are in natural order (9 before 10), and so is the whole
 * when it is one series; else the words keep their order.
 *
 * NEPH_ERR_NOT_FOUND: nothing matches a word. NEPH_ERR_INPUT: extensions differ; a series lacks a
 * frame between its first and its last (the message names it) or has a number twice; a folder or
 * glob holds a series and something else. NEPH_ERR_USAGE: a pattern that is none. NEPH_ERR_IO,
 * NEPH_ERR_MEMORY. Free with _finish. */
enum neph_status neph_sequence_find(int word_count, const char *const *words,
                                    struct neph_sequence *sequence, struct neph_diag *diag);

/* A zeroed sequence is fine. */
void neph_sequence_finish(struct neph_sequence *sequence);

/* Whose frames the operands are, after `--reference REFERENCE... TEST...`: a shell that expands a
 * glob behind --reference leaves only its first file there and the rest among the operands. So an
 * operand belongs to the reference when it is of the series of one of the references, by folder
 * and name; all others are the test. `is_reference` has operand_count elements; the order of the
 * operands is theirs.
 *
 * NEPH_ERR_USAGE, with the advice to quote patterns: no operand is left for the test, or the test
 * would be made of more than one series. */
enum neph_status neph_sequence_split(int reference_count, const char *const *references,
                                     int operand_count, const char *const *operands,
                                     bool *is_reference, struct neph_diag *diag);

#endif
