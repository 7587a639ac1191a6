/* SPDX-License-Identifier: MIT */
#include "harness/cli/compare_sides.h"

#include "base/text.h"
#include "harness/compare/frame.h"
#include "harness/compare/frame_labels.h"

#include <stdlib.h>
#include <string.h>

static enum neph_status find(const struct neph_side_words *words, int count,
                             const char *const *list, struct neph_sequence *sequence,
                             struct neph_diag *diag)
{
    return neph_sequence_find(count, list, words->by_position, sequence, diag);
}

/* ---- sequences from words -------------------------------------------------------------------- */

/* Find two sequences. The first one consists of the `given` words and of the operands that belong
 * to them, the second one of the other operands. Needed because a shell that expands `-r PATTERN`
 * puts only the first file behind -r and the others among the operands. */
static enum neph_status find_split(const struct neph_side_words *words, int given,
                                   const char *const *first, int operand_count,
                                   const char *const *operands, struct neph_sequence sequences[2],
                                   struct neph_arena *arena, struct neph_diag *diag)
{
    const size_t room = (size_t)(given + operand_count) + 1;
    bool *is_first = neph_arena_allocate(arena, room, sizeof(*is_first));
    const char **lists[2];
    int counts[2] = {given, 0};
    for (int i = 0; i < 2; i++)
        lists[i] = neph_arena_allocate(arena, room, sizeof(*lists[i]));
    enum neph_status status = neph_arena_check(arena, diag);
    if (!status)
        status = neph_sequence_split(given, first, operand_count, operands, is_first, diag);
    if (status)
        return status;
    memcpy(lists[0], first, (size_t)given * sizeof(*first));
    for (int i = 0; i < operand_count; i++) {
        const int which = is_first[i] ? 0 : 1;
        lists[which][counts[which]++] = operands[i];
    }
    status = find(words, counts[0], lists[0], &sequences[0], diag);
    return status ? status : find(words, counts[1], lists[1], &sequences[1], diag);
}

/* Whether there are two operands, each a test of its own. For `neph flicker` two files are two
 * frames of one test. */
static bool are_two_tests(const struct neph_side_words *words)
{
    return words->operand_count == 2 &&
           !(words->is_flicker && neph_sequence_is_frame(words->operands[0]) &&
             neph_sequence_is_frame(words->operands[1]));
}

static enum neph_status find_pair(const struct neph_side_words *words, struct neph_sequence *first,
                                  struct neph_sequence *second, struct neph_diag *diag)
{
    const enum neph_status status = find(words, 1, words->operands, first, diag);
    return status ? status : find(words, 1, words->operands + 1, second, diag);
}

static enum neph_status find_with_reference(const struct neph_side_words *words,
                                            struct neph_sides *sides, struct neph_diag *diag)
{
    struct neph_sequence found[2] = {{.count = 0}, {.count = 0}};
    if (are_two_tests(words)) {
        const enum neph_status status = find(words, words->reference_count, words->references,
                                             &sides->reference, diag);
        return status ? status : find_pair(words, &sides->other, &sides->test, diag);
    }
    const enum neph_status status = find_split(words, words->reference_count, words->references,
                                               words->operand_count, words->operands, found,
                                               &sides->arena, diag);
    sides->reference = found[0];
    sides->test = found[1];
    return status;
}

/* Whether operands that a shell expanded from a pattern form one sequence: no operand is left for a
 * second one. */
static bool are_one_test(const struct neph_side_words *words, struct neph_arena *arena)
{
    const int others = words->operand_count - 1;
    bool *is_first = neph_arena_allocate(arena, (size_t)words->operand_count, sizeof(*is_first));
    bool all = others > 0 && is_first &&
               neph_sequence_split(1, words->operands, others, words->operands + 1, is_first, NULL);
    for (int i = 0; i < others && all; i++)
        all = is_first[i];
    return others == 0 || all;
}

static enum neph_status find_flicker_alone(const struct neph_side_words *words,
                                           struct neph_sides *sides, struct neph_diag *diag)
{
    struct neph_sequence found[2] = {{.count = 0}, {.count = 0}};
    enum neph_status status;
    sides->without_reference = true;
    if (are_two_tests(words))
        return find_pair(words, &sides->other, &sides->test, diag);
    if (are_one_test(words, &sides->arena))
        return find(words, words->operand_count, words->operands, &sides->test, diag);
    status = find_split(words, 1, words->operands, words->operand_count - 1, words->operands + 1,
                        found, &sides->arena, diag);
    sides->other = found[0];
    sides->test = found[1];
    return status;
}

static enum neph_status find_words(const struct neph_side_words *words, struct neph_sides *sides,
                                   struct neph_diag *diag)
{
    if (words->operand_count == 0)
        return neph_fail(diag, NEPH_ERR_USAGE, "no frames are named: %s",
                         words->is_flicker ? "[-r REFERENCE] [BEFORE] TEST"
                                           : "REFERENCE TEST, or -r REFERENCE [BEFORE] TEST");
    if (words->reference_count > 0)
        return find_with_reference(words, sides, diag);
    if (words->is_flicker)
        return find_flicker_alone(words, sides, diag);
    if (words->operand_count != 2) {
        neph_fail(diag, NEPH_ERR_USAGE, "a reference and a test are needed: %d operand%s given",
                  words->operand_count, words->operand_count == 1 ? " is" : "s are");
        neph_hint(diag, "put patterns in quotes, or name the reference by -r");
        return NEPH_ERR_USAGE;
    }
    sides->reference_word = words->operands[0];
    return find_pair(words, &sides->reference, &sides->test, diag);
}

/* ---- names ----------------------------------------------------------------------------------- */

static const char *cleaned(struct neph_arena *arena, const char *text, size_t length)
{
    char *copy = strndup(text, length), *clean = copy ? neph_text_clean_copy(copy) : NULL;
    const char *kept = neph_arena_copy_text(arena, clean ? clean : "");
    arena->is_short |= !clean;
    free(clean);
    free(copy);
    return kept;
}

/* Name both tests by the part of their paths that differs: without the leading folders and the
 * trailing parts that both have in common. */
static void name_both(struct neph_sides *sides)
{
    const char *a = sides->test.paths[0], *b = sides->other.paths[0];
    size_t first = 0, last_a = strlen(a), last_b = strlen(b), behind = 0;
    if (strcmp(a, b) == 0) {
        sides->test_name = "test";
        sides->other_name = "other";
        return;
    }
    for (size_t i = 0; a[i] && a[i] == b[i]; i++)
        if (a[i] == '/')
            first = i + 1;
    for (size_t i = 1; i <= last_a - first && i <= last_b - first && a[last_a - i] == b[last_b - i];
         i++)
        if (a[last_a - i] == '/')
            behind = i;
    sides->test_name = cleaned(&sides->arena, a + first, last_a - first - behind);
    sides->other_name = cleaned(&sides->arena, b + first, last_b - first - behind);
}

/* ---- all of it ------------------------------------------------------------------------------- */

static enum neph_status add_versus(const struct neph_side_words *words, struct neph_sides *sides,
                                   struct neph_diag *diag)
{
    if (!words->versus)
        return NEPH_OK;
    if (sides->other.count > 0) {
        neph_fail(diag, NEPH_ERR_USAGE, "'%s' and --versus both name another test",
                  words->operands[0]);
        neph_hint(diag, "leave one of them out");
        return NEPH_ERR_USAGE;
    }
    return find(words, 1, &words->versus, &sides->other, diag);
}

static enum neph_status check_both(const struct neph_side_words *words,
                                   const struct neph_sides *sides, struct neph_diag *diag)
{
    if (sides->other.count == 0)
        return NEPH_OK;
    if (sides->other.count != sides->test.count) {
        neph_fail(diag, NEPH_ERR_INPUT, "%d frames of '%s', %d of '%s': as many are needed",
                  sides->other.count, sides->other_name, sides->test.count, sides->test_name);
        neph_hint(diag, "name the frames that both have by a pattern, such as 'f.00??.exr'");
        return NEPH_ERR_INPUT;
    }
    return words->by_position ? NEPH_OK
                              : neph_sequence_check_numbers(&sides->test, sides->test_name,
                                                            &sides->other, sides->other_name, diag);
}

/* Without a reference: put the first measured frame in its place, as a static frame. */
static enum neph_status put_still(struct neph_sides *sides, int warm_up_frames,
                                  struct neph_diag *diag)
{
    const struct neph_sequence *from = sides->other.count > 0 ? &sides->other : &sides->test;
    const char *word = from->paths[warm_up_frames < from->count ? warm_up_frames : 0];
    return neph_sequence_find(1, &word, true, &sides->reference, diag);
}

enum neph_status neph_sides_find(const struct neph_side_words *words, int warm_up_frames,
                                 struct neph_sides *sides, struct neph_diag *diag)
{
    enum neph_status status = find_words(words, sides, diag);
    if (!status)
        status = add_versus(words, sides, diag);
    if (!status && sides->other.count > 0)
        name_both(sides);
    if (!status)
        status = check_both(words, sides, diag);
    if (!status && sides->without_reference)
        status = put_still(sides, warm_up_frames, diag);
    return status ? status : neph_arena_check(&sides->arena, diag);
}

enum neph_status neph_sides_check(const struct neph_sides *sides, const char *window,
                                  struct neph_comparison *comparison, struct neph_diag *diag)
{
    const struct neph_sequence *const sequences[] = {&comparison->reference, &comparison->second,
                                                     &comparison->test, &sides->other};
    struct neph_image *test = NULL, *other = NULL;
    const int first = comparison->warm_up_frames;
    enum neph_status status = neph_windows_find(sequences, 4, window, &comparison->frame_choice,
                                                &comparison->windows, diag);
    if (status || first >= comparison->test.count || sides->other.count == 0)
        return status;
    const char *path = sides->other.paths[first];
    status = neph_frame_read(comparison->test.paths[first], &comparison->frame_choice,
                             comparison->negative_allowed, &test, diag);
    if (!status)
        status = neph_frame_read(path, &comparison->frame_choice, comparison->negative_allowed,
                                 &other, diag);
    if (!status)
        status = neph_frame_check_pair(test, other, diag);
    if (!status &&
        !neph_image_attribute(test, "encoding") != !neph_image_attribute(other, "encoding"))
        status = neph_fail(diag, NEPH_ERR_INPUT,
                           "one of '%s' and '%s' has display values, the other linear data: they "
                           "have no common scale",
                           comparison->test.paths[first], path);
    neph_image_destroy(test);
    neph_image_destroy(other);
    return status;
}

void neph_sides_finish(struct neph_sides *sides)
{
    neph_sequence_finish(&sides->reference);
    neph_sequence_finish(&sides->test);
    neph_sequence_finish(&sides->other);
    neph_arena_finish(&sides->arena);
    *sides = (struct neph_sides){.without_reference = false};
}
