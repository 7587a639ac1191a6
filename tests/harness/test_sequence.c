/* SPDX-License-Identifier: MIT
 *
 * Which files a user means by files, folders, patterns and globs; refused inputs; whether operands
 * are reference or test frames; and frame formats by content, whatever the file's name.
 */
#include "tests/base/scratch.h"
#include "tests/harness/image_test.h"

#include "base/png.h"
#include "harness/compare/frame.h"
#include "harness/compare/sequence.h"

#include <unistd.h>

enum { NAMES_MAX = 8 };

/* Empty files in the test's folder, which becomes the working folder: paths are short. */
static void make_files(void **state, const char *const names[NAMES_MAX])
{
    const struct scratch *scratch = *state;
    assert_int_equal(chdir(scratch->folder), 0);
    for (int i = 0; i < NAMES_MAX && names[i]; i++) {
        const char *slash = strrchr(names[i], '/');
        if (slash) {
            char *folder = strndup(names[i], (size_t)(slash - names[i]));
            neph_assert_ok(neph_dir_create(folder, NULL), NULL);
            free(folder);
        }
        if (!slash || slash[1])
            neph_assert_ok(neph_file_write(names[i], "", 0, NULL), NULL);
    }
}

static void remove_files(void **state)
{
    const struct scratch *scratch = *state;
    assert_int_equal(chdir("/"), 0);
    neph_assert_ok(neph_dir_remove(scratch->folder, NULL), NULL);
    neph_assert_ok(neph_dir_create(scratch->folder, NULL), NULL);
}

static int count_words(const char *const words[NAMES_MAX])
{
    int count = 0;
    while (count < NAMES_MAX && words[count])
        count++;
    return count;
}

static void assert_paths(const struct neph_sequence *sequence,
                         const char *const expected[NAMES_MAX])
{
    assert_int_equal(sequence->count, count_words(expected));
    for (int i = 0; i < sequence->count; i++)
        assert_string_equal(sequence->paths[i], expected[i]);
}

static const struct found {
    const char *files[NAMES_MAX], *words[NAMES_MAX], *expected[NAMES_MAX];
} found[] = {
    /* files */
    {{"sky.exr"}, {"sky.exr"}, {"sky.exr"}},
    {{"a[1].exr", "a1.exr"}, {"a[1].exr"}, {"a[1].exr"}},
    {{"50%d.exr"}, {"50%d.exr"}, {"50%d.exr"}},
    {{"b.exr", "a.exr"}, {"b.exr", "a.exr"}, {"b.exr", "a.exr"}},
    {{"f9.exr", "f10.exr", "f11.exr"},
     {"f10.exr", "f11.exr", "f9.exr"}, /* the order of a shell */
     {"f9.exr", "f10.exr", "f11.exr"}},
    {{"a.EXR", "b.exr"}, {"a.EXR", "b.exr"}, {"a.EXR", "b.exr"}},
    {{"b1.exr", "b2.exr", "a1.exr", "a2.exr"},
     {"b1.exr", "b2.exr", "a1.exr", "a2.exr"},
     {"b1.exr", "b2.exr", "a1.exr", "a2.exr"}},
    {{"5.exr", "6.exr"}, {"6.exr", "5.exr"}, {"5.exr", "6.exr"}},
    {{"v2_0008.png", "v2_0009.png", "v2_0010.png"},
     {"v2_0010.png", "v2_0008.png", "v2_0009.png"},
     {"v2_0008.png", "v2_0009.png", "v2_0010.png"}},
    /* folders: .exr before .png, no hidden files, no folders, natural order */
    {{"d/f2.exr", "d/f10.exr", "d/f9.exr", "d/f3.png", "d/.f4.exr", "d/f7.exr/", "d/f8.txt"},
     {"d/f9.exr", "d/f10.exr"},
     {"d/f9.exr", "d/f10.exr"}},
    {{"d/f8.exr", "d/f10.exr", "d/f9.exr", "d/f1.png", "d/.f4.exr", "d/f7.exr/", "d/f6.txt"},
     {"d"},
     {"d/f8.exr", "d/f9.exr", "d/f10.exr"}},
    {{"d/f8.exr"}, {"d/"}, {"d/f8.exr"}},
    {{"d/b.png", "d/a.PNG"}, {"d"}, {"d/a.PNG", "d/b.png"}},
    {{"d/1.exr", "e/1.exr", "e/2.exr"}, {"d", "e"}, {"d/1.exr", "e/1.exr", "e/2.exr"}},
    /* patterns */
    {{"f.0001.exr", "f.0002.exr", "f.3.exr", "g.0003.exr", "f.0003.png"},
     {"f.%04d.exr"},
     {"f.0001.exr", "f.0002.exr"}},
    {{"f.9999.exr", "f.10000.exr", "f.010001.exr"}, {"f.%04d.exr"}, {"f.9999.exr", "f.10000.exr"}},
    {{"f.0.exr", "f.1.exr", "f.02.exr"}, {"f.%d.exr"}, {"f.0.exr", "f.1.exr"}},
    {{"d/7f.exr", "d/8f.exr", "d/f.exr"}, {"d/%df.exr"}, {"d/7f.exr", "d/8f.exr"}},
    {{"d/1.png", "d/2.png", "d/3.png", "d/4.png"},
     {"d/%01d.png"},
     {"d/1.png", "d/2.png", "d/3.png", "d/4.png"}},
    /* globs */
    {{"f10.exr", "f9.exr", "f8.exr", "g.exr"}, {"f*.exr"}, {"f8.exr", "f9.exr", "f10.exr"}},
    {{"x/f1.exr", "y/f1.exr", "y/f1.exr.txt"}, {"?/f1.exr"}, {"x/f1.exr", "y/f1.exr"}},
    {{"f1.exr", "f2.exr", "f3.exr"}, {"f[12].exr", "f3.exr"}, {"f1.exr", "f2.exr", "f3.exr"}},
    /* the number is the run of digits that changes, wherever it is */
    {{"b8_v2.exr", "b9_v2.exr", "b10_v2.exr"},
     {"b10_v2.exr", "b8_v2.exr", "b9_v2.exr"}, /* the order of a shell */
     {"b8_v2.exr", "b9_v2.exr", "b10_v2.exr"}},
    {{"d/s_0009_v2.exr", "d/s_0010_v2.exr", "d/s_0011_v2.exr"},
     {"d"},
     {"d/s_0009_v2.exr", "d/s_0010_v2.exr", "d/s_0011_v2.exr"}},
    {{"b8_v2.exr", "b9_v2.exr", "b10_v2.exr", "b10_v3.exr"},
     {"b%d_v2.exr"},
     {"b8_v2.exr", "b9_v2.exr", "b10_v2.exr"}},
    {{"9/f1.exr", "10/f1.exr", "11/f1.exr"}, {"*/f1.exr"}, {"9/f1.exr", "10/f1.exr", "11/f1.exr"}},
    {{"f1.0009", "f1.0010"}, {"f1.*"}, {"f1.0009", "f1.0010"}},
    /* of two numbers, the one that increases by one */
    {{"f9_t1.50.exr", "f10_t1.75.exr", "f11_t2.00.exr"},
     {"f*"},
     {"f9_t1.50.exr", "f10_t1.75.exr", "f11_t2.00.exr"}},
    {{"s1_f10.exr", "s2_f9.exr", "s1_f11.exr"}, {"s*"}, {"s2_f9.exr", "s1_f10.exr", "s1_f11.exr"}},
    /* a minus, of any width, with or without zeros */
    {{"f.-0002.exr", "f.-0001.exr", "f.0000.exr", "f.0001.exr"},
     {"f.*"},
     {"f.-0002.exr", "f.-0001.exr", "f.0000.exr", "f.0001.exr"}},
    {{"d/-10.exr", "d/-9.exr", "d/-8.exr"}, {"d"}, {"d/-10.exr", "d/-9.exr", "d/-8.exr"}},
    {{"f_-002.exr", "f_-1.exr", "f_0.exr"},
     {"f_0.exr", "f_-1.exr", "f_-002.exr"},
     {"f_-002.exr", "f_-1.exr", "f_0.exr"}},
    {{"s--2.exr", "s--1.exr", "s-0.exr"}, {"s*"}, {"s--2.exr", "s--1.exr", "s-0.exr"}},
    {{"f.-0002.exr", "f.-001.exr", "f.0000.exr", "f.-01.exr", "f.-00003.exr"},
     {"f.%04d.exr"},
     {"f.-0002.exr", "f.-001.exr", "f.0000.exr"}},
    {{"f.-2.exr", "f.-1.exr", "f.-01.exr"}, {"f.%d.exr"}, {"f.-2.exr", "f.-1.exr"}},
    {{"f.-11.exr", "f.-12.exr", "f.-10.exr"}, {"f.*"}, {"f.-12.exr", "f.-11.exr", "f.-10.exr"}},
    /* a hyphen after a letter or a digit is no minus, except where the numbers pass through 0 */
    {{"s-0001.exr", "s-0002.exr", "s-0003.exr"},
     {"s*"},
     {"s-0001.exr", "s-0002.exr", "s-0003.exr"}},
    {{"2026-11-09.exr", "2026-11-10.exr"}, {"2026*"}, {"2026-11-09.exr", "2026-11-10.exr"}},
    {{"f-002.exr", "f-001.exr", "f0000.exr", "f0001.exr"},
     {"f%04d.exr"},
     {"f-002.exr", "f-001.exr", "f0000.exr", "f0001.exr"}},
    {{"f-0001.exr", "f0000.exr"}, {"f0000.exr", "f-0001.exr"}, {"f-0001.exr", "f0000.exr"}},
    /* identifiers of letters and digits do not affect the order */
    {{"f.0001.9e3779b1.exr", "f.0002.1b54a32d.exr", "f.0003.c0ffee12.exr", "f.0010.7f4a7c15.exr"},
     {"f.000*"},
     {"f.0001.9e3779b1.exr", "f.0002.1b54a32d.exr", "f.0003.c0ffee12.exr"}},
    {{"f.-0001.9e3779b1.exr", "f.0000.deadbeef.exr", "f.0001.12345678.exr"},
     {"f.*"},
     {"f.-0001.9e3779b1.exr", "f.0000.deadbeef.exr", "f.0001.12345678.exr"}},
    {{"b7a9_9.exr", "a9c1_10.exr", "c1b7_11.exr"},
     {"*_*"},
     {"b7a9_9.exr", "a9c1_10.exr", "c1b7_11.exr"}},
    {{"d/f9-7a-e3b0c442.exr", "d/f10-c3-98fc1c14.exr", "d/f8-b1-9afbf4c8.exr"},
     {"d"},
     {"d/f8-b1-9afbf4c8.exr", "d/f9-7a-e3b0c442.exr", "d/f10-c3-98fc1c14.exr"}},
    {{"1/9e3779b1.exr", "2/1b54a32d.exr"},
     {"2/1b54a32d.exr", "1/9e3779b1.exr"},
     {"1/9e3779b1.exr", "2/1b54a32d.exr"}},
    /* but names with a digit are names */
    {{"sphere1a_5.png", "cube2b_9.png"}, {"*"}, {"cube2b_9.png", "sphere1a_5.png"}},
    {{"sh010a_v12.exr", "sh020b_v7.exr"}, {"sh*"}, {"sh010a_v12.exr", "sh020b_v7.exr"}},
    /* patterns of other programs */
    {{"f.0001.exr", "f.0002.exr", "f.3.exr", "f.00003.exr"},
     {"f.####.exr"},
     {"f.0001.exr", "f.0002.exr"}},
    {{"f.0001.exr", "f.0002.exr", "f.3.exr"}, {"f.$F4.exr"}, {"f.0001.exr", "f.0002.exr"}},
    {{"f.9.exr", "f.10.exr", "f.011.exr"}, {"f.$F.exr"}, {"f.9.exr", "f.10.exr"}},
    {{"f.9.exr", "f.10.exr", "f.011.exr"}, {"f.#.exr"}, {"f.9.exr", "f.10.exr", "f.011.exr"}},
    {{"f.-002.exr", "f.-001.exr", "f.0000.exr"},
     {"./f.####.exr"},
     {"./f.-002.exr", "./f.-001.exr", "./f.0000.exr"}},
    {{"f#.0001.exr", "f#.0002.exr"}, {"f#.%04d.exr"}, {"f#.0001.exr", "f#.0002.exr"}},
    {{"f.####.exr", "f.0001.exr"}, {"f.####.exr"}, {"f.####.exr"}}, /* a file of this name */
    /* more digits than any frame number has: a name */
    {{"20240229123456789012345.exr", "2.exr"},
     {"20240229123456789012345.exr", "2.exr"},
     {"20240229123456789012345.exr", "2.exr"}},
};

static void test_words_become_files(void **state)
{
    for (size_t i = 0; i < sizeof(found) / sizeof(found[0]); i++) {
        struct neph_sequence sequence = {0};
        struct neph_diag diag = {0};
        make_files(state, found[i].files);
        neph_assert_ok(neph_sequence_find(count_words(found[i].words), found[i].words, false,
                                          &sequence, &diag),
                       &diag);
        assert_paths(&sequence, found[i].expected);
        neph_sequence_finish(&sequence);
        remove_files(state);
    }
}

static const struct refused {
    const char *files[NAMES_MAX], *words[NAMES_MAX];
    enum neph_status status;
    const char *message;
} refused[] = {
    {{NULL}, {NULL}, NEPH_ERR_USAGE, "no frames"},
    {{NULL}, {"none.exr"}, NEPH_ERR_NOT_FOUND, "no file 'none.exr'"},
    {{NULL}, {""}, NEPH_ERR_NOT_FOUND, "no file ''"},
    {{"d/x.txt"}, {"d"}, NEPH_ERR_NOT_FOUND, "'d' has no .exr"},
    {{NULL}, {"no/%d.exr"}, NEPH_ERR_NOT_FOUND, "'no/'"},
    {{"f.exr"}, {"f%d.exr"}, NEPH_ERR_NOT_FOUND, "matches 'f%d.exr'"},
    {{"f.exr"}, {"g*.exr"}, NEPH_ERR_NOT_FOUND, "matches 'g*.exr'"},
    {{NULL}, {"f%d_%d.exr"}, NEPH_ERR_USAGE, "f%d_%d.exr"},
    {{NULL}, {"f%s.exr"}, NEPH_ERR_USAGE, "f%s.exr"},
    {{NULL}, {"f%4d.exr"}, NEPH_ERR_USAGE, "f%4d.exr"},
    {{NULL}, {"f%n.exr"}, NEPH_ERR_USAGE, "f%n.exr"},
    {{NULL}, {"shot%d/f.exr"}, NEPH_ERR_USAGE, "shot%d/f.exr"},
    {{NULL}, {"shot%d/f%d.exr"}, NEPH_ERR_USAGE, "shot%d/f%d.exr"},
    {{"f.0001.exr", "f.0003.exr"}, {"f.%04d.exr"}, NEPH_ERR_INPUT, "'f.0002.exr' is missing"},
    {{"f1.exr", "f2.exr", "f5.exr"},
     {"f5.exr", "f1.exr", "f2.exr"},
     NEPH_ERR_INPUT,
     "'f3.exr' is missing (2 from 3 to 4)"},
    {{"f0.exr", "f1000000000.exr"}, {"f*.exr"}, NEPH_ERR_INPUT, "(999999999 from 1 to 999999999)"},
    {{"a1.exr", "b1.exr", "a3.exr"},
     {"a1.exr", "b1.exr", "a3.exr"},
     NEPH_ERR_INPUT,
     "'a2.exr' is missing"},
    {{"f1.exr"}, {"f1.exr", "f1.exr"}, NEPH_ERR_INPUT, "'f1.exr' is there twice"},
    {{"sky.exr"}, {"sky.exr", "sky.exr"}, NEPH_ERR_INPUT, "'sky.exr' is there twice"},
    {{"f1.exr", "f01.exr"}, {"f*.exr"}, NEPH_ERR_INPUT, "same frame number"},
    {{"b1_v2.exr", "b01_v2.exr", "b2_v2.exr"}, {"b*"}, NEPH_ERR_INPUT, "same frame number"},
    {{"b1_v2.exr", "b4_v2.exr"}, {"b*"}, NEPH_ERR_INPUT, "'b2_v2.exr' is missing (2 from 2 to 3)"},
    {{"b1_v2.exr", "b2_v2.exr", "b1_v3.exr", "b2_v3.exr"},
     {"b*"},
     NEPH_ERR_INPUT,
     "'1' or '2'? Both change: 'b2_v3.exr'"},
    {{"b1_v2.exr", "b2_v3.exr", "b3_v4.exr"}, {"b*"}, NEPH_ERR_INPUT, "'1' or '2'? Both change"},
    {{"1/f1.exr", "1/f2.exr", "2/f1.exr", "2/f2.exr"},
     {"1", "2"},
     NEPH_ERR_INPUT,
     "which number of '1/f1.exr'"},
    {{"f.-0003.exr", "f.-0001.exr"}, {"f.*"}, NEPH_ERR_INPUT, "'f.-0002.exr' is missing"},
    {{"f.-0001.exr", "f.0001.exr"}, {"f.*"}, NEPH_ERR_INPUT, "'f.0000.exr' is missing"},
    {{"f.-0001.exr", "f.-001.exr"}, {"f.*"}, NEPH_ERR_INPUT, "same frame number"},
    {{"f-001.exr", "f-002.exr"}, {"f%04d.exr"}, NEPH_ERR_NOT_FOUND, "but with a hyphen"},
    {{"f-1.exr", "f-2.exr", "f1.exr", "f2.exr"},
     {"f*"},
     NEPH_ERR_INPUT,
     "'f*' has more than one sequence"},
    {{"f.0001.9e3779b1.exr", "f.0003.1b54a32d.exr"},
     {"f.*"},
     NEPH_ERR_INPUT,
     "frame 2 is missing (1 from 2 to 2), the one behind 'f.0001.9e3779b1.exr'"},
    {{"f.0001.9e3779b1.exr", "f.0003.b54a32d.exr"}, {"f.*"}, NEPH_ERR_INPUT, "frame 2 is missing"},
    {{"f.0001.9e3779b1.exr", "f.0001.1b54a32d.exr", "f.0002.7f4a7c15.exr"},
     {"f.*"},
     NEPH_ERR_INPUT,
     "same frame number"},
    {{"f.exr"}, {"f.####.exr"}, NEPH_ERR_NOT_FOUND, "no file matches 'f.####.exr'"},
    {{"f.exr"}, {"f.$F4.exr"}, NEPH_ERR_NOT_FOUND, "no file matches 'f.$F4.exr'"},
    {{"f.exr"}, {"f.$FF.exr"}, NEPH_ERR_NOT_FOUND, "no file 'f.$FF.exr'"},
    {{"f.exr"}, {"f.##_##.exr"}, NEPH_ERR_USAGE, "f.##_##.exr"},
    {{"f.exr"}, {"f.$F_$F4.exr"}, NEPH_ERR_NOT_FOUND, "f.$F_$F4.exr"},
    {{"f.exr"}, {"f.$F4.$F4.exr"}, NEPH_ERR_USAGE, "f.$F4.$F4.exr"},
    {{"f1.exr", "f2.png"}, {"f1.exr", "f2.png"}, NEPH_ERR_INPUT, "different kinds"},
    {{"d/f1.exr", "e/f1.png"}, {"d", "e"}, NEPH_ERR_INPUT, "'d/f1.exr' and 'e/f1.png'"},
    {{"d/f1.exr", "d/f2.exr", "d/z1.exr"},
     {"d"},
     NEPH_ERR_INPUT,
     "'d' has more than one sequence: 'd/f1.exr' and 'd/z1.exr'"},
    {{"f1.exr", "f1_a.exr", "f2.exr", "f2_a.exr"},
     {"f*"},
     NEPH_ERR_INPUT,
     "'f*' has more than one sequence"},
};

static void test_invalid_sequences_are_refused(void **state)
{
    for (size_t i = 0; i < sizeof(refused) / sizeof(refused[0]); i++) {
        struct neph_sequence sequence = {.count = -1};
        struct neph_diag diag = {0};
        make_files(state, refused[i].files);
        const int count = count_words(refused[i].words);
        const enum neph_status status = neph_sequence_find(count, refused[i].words, false,
                                                           &sequence, &diag);
        if (status != refused[i].status || !strstr(diag.message, refused[i].message))
            fail_msg("case %zu: %s: %s", i, neph_status_name(status), diag.message);
        assert_int_equal(neph_sequence_find(count, refused[i].words, false, &sequence, NULL),
                         status);
        assert_int_equal(sequence.count, -1);
        remove_files(state);
    }
}

/* ---- by position ----------------------------------------------------------------------------- */

static const struct found by_position[] = {
    {{"f.0004.exr", "f.0000.exr", "f.0002.exr"},
     {"f.*"},
     {"f.0000.exr", "f.0002.exr", "f.0004.exr"}},
    {{"f.-8.exr", "f.-10.exr", "f.12.exr"}, {"f.*"}, {"f.-10.exr", "f.-8.exr", "f.12.exr"}},
    {{"f2.exr", "f02.exr", "f1.exr"}, {"f*"}, {"f1.exr", "f02.exr", "f2.exr"}},
    {{"f1.exr"}, {"f1.exr", "f1.exr"}, {"f1.exr", "f1.exr"}},
    {{"b1_v2.exr", "b2_v2.exr", "b1_v10.exr"}, {"b*"}, {"b1_v2.exr", "b1_v10.exr", "b2_v2.exr"}},
    {{"1/f9.exr", "1/f10.exr", "2/f9.exr"}, {"2", "1"}, {"2/f9.exr", "1/f9.exr", "1/f10.exr"}},
    {{"f.3.9e3779b1.exr", "f.7.1b54a32d.exr"}, {"f.*"}, {"f.3.9e3779b1.exr", "f.7.1b54a32d.exr"}},
};

static void test_gaps_and_doubles_by_position(void **state)
{
    for (size_t i = 0; i < sizeof(by_position) / sizeof(by_position[0]); i++) {
        struct neph_sequence sequence = {0};
        struct neph_diag diag = {0};
        const struct found *row = &by_position[i];
        make_files(state, row->files);
        const int count = count_words(row->words);
        assert_int_equal(neph_sequence_find(count, row->words, false, &sequence, &diag),
                         NEPH_ERR_INPUT);
        neph_assert_ok(neph_sequence_find(count, row->words, true, &sequence, &diag), &diag);
        assert_paths(&sequence, row->expected);
        assert_null(sequence.numbers);
        neph_sequence_finish(&sequence);
        remove_files(state);
    }
}

/* Random names: whatever surrounds the number, files are in numerical order. */
static void test_numbers_order_random_names(void **state)
{
    static const char *const heads[] = {"f.", "shot_", "", "v2-a_", "take 3 "}, *const tails[] = {
                                                                                    "", ".", "_v7.",
                                                                                    "-b."};
    uint64_t seed = 20261128;
    print_message("seed %llu\n", (unsigned long long)seed);
    for (int trial = 0; trial < neph_test_by_day(20, 200); trial++) {
        const char *head = heads[neph_test_random(&seed) % 5],
                   *tail = tails[neph_test_random(&seed) % 4];
        const int width = 1 + (int)(neph_test_random(&seed) % 5),
                  first = (int)(neph_test_random(&seed) % 41) - 30;
        const bool has_ids = tail[0] && neph_test_random(&seed) % 2;
        char names[NAMES_MAX][96];
        const char *files[NAMES_MAX] = {NULL}, *word = ".";
        for (int i = 0; i < NAMES_MAX; i++) {
            const int number = first + i;
            const unsigned id = (unsigned)neph_test_random(&seed);
            snprintf(names[i], sizeof(names[i]), "%s%s%0*d%s%.*x%s", head, number < 0 ? "-" : "",
                     width, abs(number), tail, has_ids ? 8 : 0, has_ids ? id : 0,
                     has_ids || !tail[0] ? ".exr" : "exr");
            files[i] = names[i];
        }
        make_files(state, files);
        struct neph_sequence sequence = {0};
        struct neph_diag diag = {0};
        neph_assert_ok(neph_sequence_find(1, &word, false, &sequence, &diag), &diag);
        for (int i = 0; i < NAMES_MAX; i++) {
            assert_string_equal(strrchr(sequence.paths[i], '/') + 1, names[i]);
            assert_int_equal(sequence.numbers[i], first + i);
        }
        neph_sequence_finish(&sequence);
        remove_files(state);
    }
}

/* ---- numbers --------------------------------------------------------------------------------- */

static void test_frames_belong_together_by_number(void **state)
{
    static const char *const files[NAMES_MAX] = {"a0_v2.exr", "a1_v2.exr", "b1.exr", "b2.exr",
                                                 "c_1_.exr",  "c_0_.exr",  "d.exr",  "e.exr"};
    make_files(state, files);
    static const struct {
        const char *words[2];
        long long first; /* -1: it has no numbers */
        bool together;   /* with the sequence a */
    } cases[] = {
        {{"a*", NULL}, 0, true},        {{"b*", NULL}, 1, false},     {{"c*", NULL}, 0, true},
        {{"d.exr", "e.exr"}, -1, true}, {{"b2.exr", NULL}, -1, true}, /* one for all */
    };
    struct neph_sequence first = {0};
    const char *word = "a*";
    neph_assert_ok(neph_sequence_find(1, &word, false, &first, NULL), NULL);
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        struct neph_sequence other = {0};
        struct neph_diag diag = {0};
        neph_assert_ok(
            neph_sequence_find(cases[i].words[1] ? 2 : 1, cases[i].words, false, &other, &diag),
            &diag);
        assert_int_equal(other.numbers ? other.numbers[0] : -1, cases[i].first);
        const enum neph_status status = neph_sequence_check_numbers(&first, "the reference", &other,
                                                                    "the test", &diag);
        assert_int_equal(status, cases[i].together ? NEPH_OK : NEPH_ERR_INPUT);
        if (status)
            assert_non_null(strstr(diag.message, "the frames 0 to 1, the test 1 to 2"));
        neph_sequence_finish(&other);
    }
    neph_sequence_finish(&first);
    assert_int_equal(chdir("/"), 0);
}

/* ---- reference and test operands ------------------------------------------------------------- */

static const struct split {
    const char *references[NAMES_MAX], *operands[NAMES_MAX];
    const char *mine; /* R or T for each operand; otherwise a part of the message */
} splits[] = {
    {{"r/f1.exr"}, {"t/f1.exr", "t/f2.exr"}, "TT"},
    {{"r/f1.exr"}, {"r/f2.exr", "r/f3.exr", "t/f1.exr", "t/f2.exr"}, "RRTT"},
    {{"r/f1.exr"}, {"t/f1.exr", "r/f2.exr"}, "TR"},
    {{"x1.exr"}, {"x2.exr", "y1.exr", "y2.exr"}, "RTT"},
    {{"v1.1.exr"}, {"v1.2.exr", "v2.1.exr"}, "RT"}, /* only the last digits are the frame's */
    {{"s1_v1.exr"}, {"s2_v1.exr", "s3_v1.exr", "s1_v2.exr", "s2_v2.exr", "s3_v2.exr"}, "RRTTT"},
    {{"1/f1.exr"}, {"1/f2.exr", "1/f3.exr", "2/f1.exr", "2/f2.exr", "2/f3.exr"}, "RRTTT"},
    {{"1/f1.exr"}, {"2/f1.exr", "2/f2.exr", "2/f3.exr", "2/f4.exr"}, "TTTT"},
    {{"r/f1.exr", "q/f1.exr"}, {"r/f2.exr", "q/f2.exr", "t/f1.exr"}, "RRT"},
    {{"r"}, {"t"}, "T"},
    {{"r/f%d.exr"}, {"r/f2.exr"}, "T"}, /* a quoted pattern has all of its frames */
    {{"r/f1.exr"}, {"t/f%d.exr"}, "T"},
    {{"r/f1.exr"}, {"none.exr"}, "T"}, /* refused later, as a missing file */
    {{"r/f1.exr"}, {"r/f2.exr", "r/f3.exr"}, "no frames are left to be tested: 'r/f2.exr'"},
    {{"r/f1.exr"}, {NULL}, "no frames to be tested are named"},
    {{"r/f1.exr"}, {"t/f1.exr", "x1.exr"}, "more than one sequence: 't/f1.exr' and 'x1.exr'"},
    {{"r/f1.exr"}, {"t", "r"}, "more than one sequence: 't' and 'r'"},
    {{"r/f1.exr"}, {"t/f1.exr", "t"}, "more than one sequence"},
};

static void test_operands_are_split(void **state)
{
    static const char *const some[NAMES_MAX] = {"r/f1.exr", "r/f2.exr", "r/f3.exr", "t/f1.exr",
                                                "t/f2.exr", "q/f1.exr", "q/f2.exr", "x1.exr"};
    static const char *const more[NAMES_MAX] = {"x2.exr",   "y1.exr",   "y2.exr",
                                                "v1.1.exr", "v1.2.exr", "v2.1.exr"};
    static const char *const versions[NAMES_MAX] = {"s1_v1.exr", "s2_v1.exr", "s3_v1.exr",
                                                    "s1_v2.exr", "s2_v2.exr", "s3_v2.exr"};
    static const char *const folders[NAMES_MAX] = {"1/f1.exr", "1/f2.exr", "1/f3.exr", "2/f1.exr",
                                                   "2/f2.exr", "2/f3.exr", "2/f4.exr"};
    make_files(state, some);
    make_files(state, more);
    make_files(state, versions);
    make_files(state, folders);
    for (size_t i = 0; i < sizeof(splits) / sizeof(splits[0]); i++) {
        bool is_reference[NAMES_MAX] = {false};
        struct neph_diag diag = {0};
        const int count = count_words(splits[i].operands);
        const enum neph_status status = neph_sequence_split(
            count_words(splits[i].references), splits[i].references, count, splits[i].operands,
            is_reference, &diag);
        char mine[NAMES_MAX + 1] = "";
        for (int k = 0; k < count; k++)
            mine[k] = is_reference[k] ? 'R' : 'T';
        if (status ? !strstr(diag.message, splits[i].mine) : strcmp(mine, splits[i].mine) != 0)
            fail_msg("case %zu: %s: %s %s", i, neph_status_name(status), mine, diag.message);
        assert_true(!status || (status == NEPH_ERR_USAGE && strstr(diag.hint, "quotes")));
    }
    assert_int_equal(chdir("/"), 0);
}

/* ---- frames ---------------------------------------------------------------------------------- */

static void write_exr(const char *path, float value)
{
    struct neph_image *image = grey_image(2, 1, 0.0);
    neph_image_channel(image, "G")[1] = value;
    write_image(path, image);
}

static void assert_frame_refused(const char *path, size_t negative_allowed,
                                 enum neph_status expected, const char *words)
{
    struct neph_image *image = NULL;
    struct neph_diag diag = {0};
    const enum neph_status status = neph_frame_read(path, NULL, negative_allowed, &image, &diag);
    if (status != expected || !strstr(diag.message, words))
        fail_msg("%s: %s", neph_status_name(status), diag.message);
    assert_null(image);
    assert_int_equal(neph_frame_read(path, NULL, negative_allowed, &image, NULL), status);
}

static void test_frames_by_content(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_image *image = NULL;
    scratch_path(state, path, "frame.png"); /* the message has the name */
    write_exr(path, 3.0f);
    neph_assert_ok(neph_frame_read(path, NULL, 0, &image, NULL), NULL);
    assert_true(image->channels[1].samples[1] == 3.0f);
    assert_null(neph_image_attribute(image, "encoding"));
    neph_image_destroy(image);

    scratch_path(state, path, "frame.exr");
    neph_assert_ok(neph_png_write_rgb8(path, 1, 1, (const uint8_t[3]){255, 0, 255}, NULL), NULL);
    neph_assert_ok(neph_frame_read(path, NULL, 0, &image, NULL), NULL);
    assert_string_equal(neph_image_attribute(image, "encoding"), "sRGB");
    assert_true(image->channels[0].samples[0] == 1.0f && image->channels[1].samples[0] == 0.0f);
    neph_image_destroy(image);
}

static void test_frames_that_are_none(void **state)
{
    char path[SCRATCH_PATH_MAX];
    assert_frame_refused(scratch_path(state, path, "none.exr"), 0, NEPH_ERR_NOT_FOUND, "none.exr");
    assert_frame_refused(scratch_path(state, path, ""), 0, NEPH_ERR_IO, "cannot read");
    scratch_path(state, path, "frame.exr");
    neph_assert_ok(neph_file_write(path, "", 0, NULL), NULL);
    assert_frame_refused(path, 0, NEPH_ERR_INPUT, "frame.exr' is no image");
    neph_assert_ok(neph_file_write(path, "GIF89a\n", 7, NULL), NULL);
    assert_frame_refused(path, 0, NEPH_ERR_INPUT, "frame.exr' is no image");
    neph_assert_ok(neph_file_write(path, "\x89PNG", 4, NULL), NULL);
    assert_frame_refused(path, 0, NEPH_ERR_INPUT, "frame.exr' is not a PNG");
    write_exr(path, NAN);
    assert_frame_refused(path, SIZE_MAX, NEPH_ERR_GATE, "frame.exr': 1 values");
    write_exr(path, INFINITY);
    assert_frame_refused(path, SIZE_MAX, NEPH_ERR_GATE, "pixel (1, 0)");
    write_exr(path, -1.0f);
    assert_frame_refused(path, 0, NEPH_ERR_GATE,
                         "frame.exr': 1 values in 1 of 3 channels are negative");
    struct neph_image *image = NULL;
    neph_assert_ok(neph_frame_read(path, NULL, 1, &image, NULL), NULL);
    neph_image_destroy(image);
}

/* A frame with these channels; each is 1 everywhere, except the first, which is 2. */
static void write_channels(const char *path, const char *const *names)
{
    struct neph_image *image = NULL;
    neph_assert_ok(neph_image_create(2, 1, &image, NULL), NULL);
    for (int c = 0; names[c]; c++) {
        float *samples;
        neph_assert_ok(neph_image_add_channel(image, names[c], &samples, NULL), NULL);
        samples[0] = samples[1] = c == 0 ? 2.0f : 1.0f;
    }
    write_image(path, image);
}

static void test_colours_that_are_none_of_ours(void **state)
{
    static const struct {
        const char *channels[7], *layer;
        const char *has[4], *lacks[4];
        const char *refused; /* NULL: it can be read */
    } cases[] = {
        {{"X", "Y", "Z"}, NULL, {NULL}, {NULL}, "channels X Y Z and no R G B"},
        {{"N.X", "N.Y", "N.Z", "R", "G", "B"}, "N", {NULL}, {NULL}, "channels X Y Z"},
        {{"R", "G", "B", "X", "Y", "Z"}, NULL, {"R", "vector.Z"}, {"Y", "Z"}, NULL},
        {{"Y", "Z"}, NULL, {"R", "G", "B", "Z"}, {NULL}, NULL},
        {{"R", "G", "B", "Z"}, NULL, {"R", "G", "B", "Z"}, {NULL}, NULL},
        {{"R", "G", "B", "Z", "diffuse.r"}, "diffuse", {"r", "Z"}, {"R", "G", "B"}, NULL},
        {{"r", "g", "b", "Z"}, NULL, {"R", "G", "B", "Z"}, {"r", "g", "b"}, NULL},
        {{"red", "green", "blue"}, NULL, {"R", "G", "B"}, {"red"}, NULL},
        {{"rgba.R", "rgba.G", "rgba.B"}, NULL, {"R", "G", "B"}, {"rgba.R"}, NULL},
        {{"rgba.R", "rgba.G", "rgba.B", "r"}, "rgba", {"R", "G", "B"}, {"rgba.R"}, NULL},
        {{"R", "G", "B", "r", "g", "b"}, NULL, {"R", "r", "g", "b"}, {NULL}, NULL},
        {{"r", "g", "b", "left.Z"}, "left", {"Z"}, {"R", "r"}, NULL},
        {{"R", "Z"}, NULL, {"R", "G", "B"}, {NULL}, NULL},
        {{"L"}, NULL, {"R", "G", "B", "L"}, {NULL}, NULL},
        {{"R", "Y"}, NULL, {"R", "Y"}, {"G", "B"}, NULL},
        {{"r", "g", "b", "X", "Y", "Z"}, NULL, {"R", "vector.Z"}, {"Z"}, NULL},
        {{"R", "G"}, NULL, {"R", "G"}, {"B"}, NULL},
        {{"r", "g"}, NULL, {"r", "g"}, {"R"}, NULL},
        {{"Y", "RY", "BY"}, NULL, {"R", "G", "B"}, {"Y", "RY"}, NULL},
        {{"Y", "RY"}, NULL, {"Y", "RY"}, {"R"}, NULL},
        {{"R", "G", "B", "A", "Z", "left.Y"}, "left", {"R", "G", "Z"}, {"A"}, NULL},
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        char path[SCRATCH_PATH_MAX];
        struct neph_image *image = NULL;
        struct neph_diag diag = {0};
        write_channels(scratch_path(state, path, "frame.exr"), cases[i].channels);
        const enum neph_status status = neph_frame_read(
            path, &(struct neph_frame_choice){.layer = cases[i].layer}, 0, &image, &diag);
        if (status != (cases[i].refused ? NEPH_ERR_INPUT : NEPH_OK) ||
            (status && !strstr(diag.message, cases[i].refused)))
            fail_msg("case %zu: %s: %s", i, neph_status_name(status), diag.message);
        for (int c = 0; c < 4 && image && cases[i].has[c]; c++)
            assert_non_null(neph_image_channel(image, cases[i].has[c]));
        for (int c = 0; c < 4 && image && cases[i].lacks[c]; c++)
            assert_null(neph_image_channel(image, cases[i].lacks[c]));
        neph_image_destroy(image);
    }
}

/* As Blender writes it. */
static void test_a_depth_of_1e10_is_the_sky(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_image *image = NULL;
    float *depth;
    neph_assert_ok(neph_image_create(3, 1, &image, NULL), NULL);
    neph_assert_ok(neph_image_add_channel(image, "Z", &depth, NULL), NULL);
    depth[0] = 1e10f;
    depth[1] = 9.9e9f;
    depth[2] = INFINITY;
    write_image(scratch_path(state, path, "frame.exr"), image);
    neph_assert_ok(neph_frame_read(path, NULL, 0, &image, NULL), NULL);
    depth = neph_image_channel(image, "Z");
    assert_true(isinf(depth[0]) && depth[1] == 9.9e9f && isinf(depth[2]));
    neph_image_destroy(image);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        scratch_test(test_words_become_files),
        scratch_test(test_invalid_sequences_are_refused),
        scratch_test(test_gaps_and_doubles_by_position),
        scratch_test(test_numbers_order_random_names),
        scratch_test(test_frames_belong_together_by_number),
        scratch_test(test_operands_are_split),
        scratch_test(test_frames_by_content),
        scratch_test(test_frames_that_are_none),
        scratch_test(test_colours_that_are_none_of_ours),
        scratch_test(test_a_depth_of_1e10_is_the_sky),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
