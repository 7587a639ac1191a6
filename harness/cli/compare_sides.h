/* SPDX-License-Identifier: MIT
 *
 * Finds the operands of `neph compare` and `neph flicker` from the words of the command line: the
 * reference, the test, and an optional other test.
 */
#ifndef NEPH_HARNESS_CLI_COMPARE_SIDES_H
#define NEPH_HARNESS_CLI_COMPARE_SIDES_H

#include "base/arena.h"
#include "harness/compare/comparison.h"

struct neph_side_words {
    const char *const *references; /* words of -r */
    int reference_count;
    const char *const *operands;
    int operand_count;
    const char *versus; /* NULL: not given */
    bool by_position;
    bool is_flicker; /* without -r `compare A B` takes A for the reference, `flicker A B` compares
                        the two with each other */
};

/* Start from {0}; free with neph_sides_finish(). */
struct neph_sides {
    struct neph_arena arena; /* owns the names */
    struct neph_sequence reference, test, other;
    bool without_reference;             /* `reference` is the first measured frame of `other` or
                                         * `test` */
    const char *reference_word;         /* an operand that is used as the reference; or NULL */
    const char *test_name, *other_name; /* the differing part of their paths: "after", "before" */
};

/* Find the sequences.
 * - With two operands and `-r REFERENCE`, and with two operands of `flicker` without a reference,
 *   the first operand is the other test: before and after.
 * - Files that a shell expanded from one pattern are one test.
 * - Without a reference, the first frame after the warm-up stands in its place.
 *
 * NEPH_ERR_USAGE: the words do not say what to compare, or name the other test twice.
 * NEPH_ERR_INPUT: the two tests differ in their number of frames or in their frame numbers. Other
 * errors as of neph_sequence_find() and neph_sequence_split(). */
enum neph_status neph_sides_find(const struct neph_side_words *words, int warm_up_frames,
                                 struct neph_sides *sides, struct neph_diag *diag);

/* Find the data window of all frames by the mode `window` (neph_windows_find()), and errors before
 * any measurement that would otherwise end it later: frames of several sizes; one test with linear
 * data and one with display values. `comparison` has the reference and the test. NEPH_ERR_INPUT;
 * errors of neph_windows_find() and neph_frame_read(). */
enum neph_status neph_sides_check(const struct neph_sides *sides, const char *window,
                                  struct neph_comparison *comparison, struct neph_diag *diag);

void neph_sides_finish(struct neph_sides *sides);

#endif
