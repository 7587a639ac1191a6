/* SPDX-License-Identifier: MIT
 *
 * Sequences of frame files from the words of a command line. Names are examined; only files that
 * are named by themselves are opened, because they may have several frames.
 */
#ifndef NEPH_HARNESS_COMPARE_SEQUENCE_H
#define NEPH_HARNESS_COMPARE_SEQUENCE_H

#include "base/status.h"

#include <stdbool.h>

/* One help line for commands with such words. */
#define NEPH_SEQUENCE_HELP                                                                         \
    "a file (of an animated PNG or a video all frames), a folder (its .exr files, else its .png "  \
    "files), a "                                                                                   \
    "numbered pattern such as "                                                                    \
    "frame.%04d.exr, 'frame.####.exr' or 'frame.$F4.exr', or a quoted glob such as "               \
    "'frame.*.exr'; "                                                                              \
    "several are joined"

struct neph_sequence {
    int count;          /* >= 1 */
    char **paths;       /* owned, as is each string */
    long long *numbers; /* frame numbers first, first + 1, ...; owned; NULL for a single file,
                           several series, or gaps */
};

/* Whether a word is a frame: an existing file of a single one, or one of a file of several. */
bool neph_sequence_is_frame(const char *word);

/* The files of all words, joined. A word is, in this order of precedence: an existing file or
 * folder, or a file of several frames, which are listed (harness/compare/clips.h); a pattern with
 * one %d or %0Nd in its last part; a glob(7); a pattern with one $F, $FN or run of # in its last
 * part (N digits, or as many as there are #; one # is any number of digits).
 *
 * Files with paths that differ only in numbers (harness/compare/frame_number.h) are a series; so
 * are files that also contain a unique identifier each. The frame number is the run that changes;
 * when several change, the only one that increases by one from file to file. The files of a folder,
 * pattern or glob are sorted by it (-1 before 9 before 10), and so is the whole list when it is one
 * series; otherwise the words keep their order. `by_position`: the numbers only sort the files, and
 * may have gaps, steps and duplicates; when several runs change, all of them sort the files, from
 * the left.
 *
 * - NEPH_ERR_NOT_FOUND: nothing matches a word.
 * - NEPH_ERR_INPUT: extensions differ; a folder or glob contains a series and other files; without
 *   `by_position`: the frame number is ambiguous (the message names two), a series lacks a frame
 *   between its first and its last (the message names it) or has a number twice.
 * - NEPH_ERR_USAGE: an invalid pattern.
 * - NEPH_ERR_IO, NEPH_ERR_MEMORY.
 *
 * Free with neph_sequence_finish(). */
enum neph_status neph_sequence_find(int word_count, const char *const *words, bool by_position,
                                    struct neph_sequence *sequence, struct neph_diag *diag);

/* A zeroed sequence is allowed. */
void neph_sequence_finish(struct neph_sequence *sequence);

/* Check that the frames of two sequences of equal length may be paired by position: NEPH_ERR_INPUT
 * when both are numbered and their numbers differ. `what` and `other_what` name them in the
 * message: "the reference". */
enum neph_status neph_sequence_check_numbers(const struct neph_sequence *one, const char *what,
                                             const struct neph_sequence *other,
                                             const char *other_what, struct neph_diag *diag);

/* Assign the operands after `--reference REFERENCE... TEST...`. A shell that expands a glob after
 * --reference leaves only its first file there; the other files become operands. So an operand
 * belongs to the reference when its path equals that of a reference except for the frame number;
 * all others are the test.
 *
 * The frame number is the last run of digits with which the test is one series, preferably one that
 * gives one reference or as many references as tests. Files that already are one series, different
 * from the reference's, are the test. `is_reference` has operand_count elements in the order of the
 * operands.
 *
 * NEPH_ERR_USAGE, with the advice to quote patterns: no operand is left for the test, or the test
 * would consist of more than one series. */
enum neph_status neph_sequence_split(int reference_count, const char *const *references,
                                     int operand_count, const char *const *operands,
                                     bool *is_reference, struct neph_diag *diag);

#endif
