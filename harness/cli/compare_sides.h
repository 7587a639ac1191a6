/* SPDX-License-Identifier: MIT
 *
 * What `neph compare` and `neph flicker` compare with what: the reference, the test, and another
 * test, from the words of the command line.
 */
#ifndef NEPH_HARNESS_CLI_COMPARE_SIDES_H
#define NEPH_HARNESS_CLI_COMPARE_SIDES_H

#include "base/arena.h"
#include "harness/compare/comparison.h"

struct neph_side_words {
    const char *const *references; /* of -r */
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
    struct neph_arena arena; /* of the names */
    struct neph_sequence reference, test, other;
    bool without_reference;             /* `reference` is the first frame of `other` or `test` */
    const char *reference_word;         /* an operand that is taken for the reference; or NULL */
    const char *test_name, *other_name; /* by what their paths differ in: "after", "before" */
};

/* Find the sequences. With two operands behind `-r REFERENCE`, and with two of `flicker` without a
 * reference, the first one is the other test: before and after. Files that a shell made of one
 * pattern are one test. The still frame in the place of a reference is the first one behind the
 * warm-up. NEPH_ERR_USAGE: the words do not say what to compare, or give another test twice;
 * NEPH_ERR_INPUT: both tests are not of as many frames, or of other numbers; errors of
 * neph_sequence_find() and neph_sequence_split(). */
enum neph_status neph_sides_find(const struct neph_side_words *words, int warm_up_frames,
                                 struct neph_sides *sides, struct neph_diag *diag);

/* Refuse before any work what would end it later: frames of several sizes, and tests of which one
 * is linear data and one a picture. `comparison` has the reference and the test. NEPH_ERR_INPUT;
 * errors of neph_frame_read(). */
enum neph_status neph_sides_check(const struct neph_sides *sides,
                                  const struct neph_comparison *comparison, struct neph_diag *diag);

void neph_sides_finish(struct neph_sides *sides);

#endif
