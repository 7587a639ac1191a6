/* SPDX-License-Identifier: MIT
 *
 * Which files a user means: frames of a sequence from words of the command line. Names are looked
 * at, files are not opened.
 */
#ifndef NEPH_HARNESS_COMPARE_SEQUENCE_H
#define NEPH_HARNESS_COMPARE_SEQUENCE_H

#include "base/status.h"

#include <stdbool.h>

/* One line for the help of commands that take such words. */
#define NEPH_SEQUENCE_HELP                                                                         \
    "a file, a folder (its .exr files, else its .png files), a numbered pattern such as "          \
    "frame.%04d.exr, 'frame.####.exr' or 'frame.$F4.exr', or a quoted glob such as "               \
    "'frame.*.exr'; "                                                                              \
    "several are joined"

struct neph_sequence {
    int count;          /* >= 1 */
    char **paths;       /* owned, as is each of them */
    long long *numbers; /* of the frames, first, first + 1, ...; owned; NULL when it is not one
                           series of two files or more, or has gaps */
};

/* The files of the words, joined. A word is, in this order: a file or a folder that exists, a
 * pattern with one %d or %0Nd in its last part, a glob(7), a pattern with one $F, $FN or run of #
 * in its last part (N digits, or as many as there are #; one # is any number of digits). Files
 * whose paths differ in nothing but numbers (harness/compare/frame_number.h) are a series, and so
 * are files with one identifier each beside their number. The frame number is the run that changes;
 * when several do, the one that counts up by one from file to file, if exactly one does. The files
 * of a folder, pattern or glob are in the order of it (-1 before 9 before 10), and so is the whole
 * when it is one series; else the words keep their order. `by_position`: the numbers only order the
 * files, with gaps, steps and doubles; where several change, they all order them, from the left.
 *
 * NEPH_ERR_NOT_FOUND: nothing matches a word. NEPH_ERR_INPUT: extensions differ; a folder or glob
 * holds a series and something else; not `by_position`: which run is the frame number cannot be
 * told (the message names two), a series lacks a frame between its first and its last (the message
 * names it) or has a number twice. NEPH_ERR_USAGE: a pattern that is none. NEPH_ERR_IO,
 * NEPH_ERR_MEMORY. Free with _finish. */
enum neph_status neph_sequence_find(int word_count, const char *const *words, bool by_position,
                                    struct neph_sequence *sequence, struct neph_diag *diag);

/* A zeroed sequence is fine. */
void neph_sequence_finish(struct neph_sequence *sequence);

/* Whether frames of two sequences of one length may be paired by position: NEPH_ERR_INPUT when both
 * are numbered, and their numbers are not the same. `what` names each: "the reference". */
enum neph_status neph_sequence_check_numbers(const struct neph_sequence *one, const char *what,
                                             const struct neph_sequence *other,
                                             const char *other_what, struct neph_diag *diag);

/* Whose frames the operands are, after `--reference REFERENCE... TEST...`: a shell that expands a
 * glob behind --reference leaves only its first file there and the rest among the operands. So an
 * operand belongs to the reference when its path is that of one of the references but for the frame
 * number; all others are the test. The frame number is the last run of digits with which the test
 * is one series, and rather one with which there is one reference, or as many as tests; files that
 * are one series as they are, and not that of the reference, are the test. `is_reference` has
 * operand_count elements; the order of the operands is theirs.
 *
 * NEPH_ERR_USAGE, with the advice to quote patterns: no operand is left for the test, or the test
 * would be made of more than one series. */
enum neph_status neph_sequence_split(int reference_count, const char *const *references,
                                     int operand_count, const char *const *operands,
                                     bool *is_reference, struct neph_diag *diag);

#endif
