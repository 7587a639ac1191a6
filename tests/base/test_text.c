/* SPDX-License-Identifier: MIT */
#include "tests/neph_test.h"

#include "base/status.h"
#include "base/text.h"

#include <stdint.h>

/* `text` in a buffer of `size` bytes becomes `expected`. */
static void expect_clean(const char *text, size_t size, const char *expected)
{
    char *buffer = malloc(size); /* so that the sanitizers check its end */
    assert_non_null(buffer);
    assert_true(strlen(text) < size);
    strcpy(buffer, text);
    neph_text_clean(buffer, size);
    assert_string_equal(buffer, expected);
    free(buffer);
}

static void test_text_that_is_fit_stays(void **state)
{
    static const char text[] = "plain\n\ttext, Größe, 20°, 雲, ☁, 𝛔, e\xcc\x81";
    expect_clean(text, 200, text);
    expect_clean("", 1, "");
    expect_clean("abc", 4, "abc");
}

static void test_bytes_that_are_not_utf8_are_shown(void **state)
{
    expect_clean("caf\xe9", 100, "caf\\xe9");
    expect_clean("caf\xe9 au lait", 100, "caf\\xe9 au lait");
    expect_clean("\xc0\xaf", 100, "\\xc0\\xaf");                   /* an overlong '/' */
    expect_clean("\xe0\x80\xaf", 100, "\\xe0\\x80\\xaf");          /* the same, longer */
    expect_clean("\xed\xa0\x80", 100, "\\xed\\xa0\\x80");          /* a surrogate */
    expect_clean("\xf4\x90\x80\x80", 100, "\\xf4\\x90\\x80\\x80"); /* beyond U+10FFFF */
    expect_clean("\xf8\xff", 100, "\\xf8\\xff");
    expect_clean("\xe2\x82", 100, "\\xe2\\x82"); /* incomplete, although there is room */
}

static void test_characters_that_act_are_shown(void **state)
{
    expect_clean("\x1b[2J\a\r\x7f", 100, "\\x1b[2J\\x07\\x0d\\x7f");
    expect_clean("\xc2\x9b\x32J", 100, "\\u009b2J"); /* C1: CSI */
    expect_clean("\xe2\x80\xae"
                 "exe.txt",
                 100, "\\u202eexe.txt");
    expect_clean("\xe2\x81\xa6|\xe2\x81\xa9|\xe2\x80\x8e|\xe2\x80\x8f|\xd8\x9c", 100,
                 "\\u2066|\\u2069|\\u200e|\\u200f|\\u061c");
    expect_clean("\xe2\x80\xa8\xe2\x80\xa9\xef\xbb\xbf", 100, "\\u2028\\u2029\\ufeff");
    expect_clean("\xf3\xa0\x80\x81", 100, "\\U000e0001");
}

static void test_what_does_not_fit_is_cut_between_characters(void **state)
{
    expect_clean("aa\xe2\x82", 5, "aa");       /* snprintf had truncated a euro sign */
    expect_clean("aa\xf0\x9d\x9b", 6, "aa");   /* and a sigma */
    expect_clean("a\xc3", 3, "a");             /* and an umlaut */
    expect_clean("a\xc3\xa4", 4, "a\xc3\xa4"); /* but not this one */
    expect_clean("\xff"
                 "aaaa",
                 8, "\\xffaaa");
    expect_clean("\xff\xc3\xa4", 6, "\\xff");
    expect_clean("\xff\xff", 7, "\\xff");
    expect_clean("\xff", 4, "");
}

/* Any bytes and any buffer size: the result is UTF-8, without controls, within the buffer, and
 * idempotent. */
static void test_any_bytes_become_fit(void **state)
{
    static const unsigned char interesting[] = {0x1b, 0x80, 0x9b, 0xc2, 0xe2, 0x80,
                                                0xae, 0xf0, 0x9d, 0xff, 'a',  '\n',
                                                0xc3, 0xa4, 0xed, 0xa0, 0xf3, 0x81};
    uint64_t random = 1;
    for (int round = 0; round < 20000; round++) {
        const size_t size = 1 + (size_t)(round % 40);
        char *text = malloc(size);
        assert_non_null(text);
        for (size_t i = 0; i + 1 < size; i++) {
            random = random * 6364136223846793005u + 1442695040888963407u;
            text[i] = (char)interesting[(random >> 33) % sizeof(interesting)];
        }
        text[size - 1] = '\0';
        if (round % 3 == 0 && size > 2)
            text[size / 2] = '\0';
        neph_text_clean(text, size);
        const size_t length = strlen(text);
        assert_true(length < size);
        assert_true(neph_text_is_utf8(text, length));
        assert_int_equal(neph_text_first_unfit(text, length), length);
        free(text);
    }
}

static void test_a_copy_has_room_for_everything(void **state)
{
    char *copy = neph_text_clean_copy("\xff\xfe\x1b\xe2\x82");
    assert_string_equal(copy, "\\xff\\xfe\\x1b\\xe2\\x82");
    free(copy);
    assert_false(neph_text_is_utf8("a\0b", 3));
}

/* Arguments of neph_fail() and similar functions come from paths, logs and drivers. */
static void test_diags_are_fit_after_they_are_cut(void **state)
{
    struct neph_diag diag;
    char hostile[4000];
    for (size_t shift = 0; shift < 4; shift++) {
        memset(hostile, 'x', shift);
        for (size_t i = shift; i < sizeof(hostile) - 5; i += 4)
            memcpy(hostile + i, "\xf0\x9d\x9b\x94", 5);
        assert_int_equal(neph_fail(&diag, NEPH_ERR_IO, "%s", hostile), NEPH_ERR_IO);
        neph_hint(&diag, "%s", hostile);
        neph_locate(&diag, hostile, 1, 1);
        assert_true(neph_text_is_utf8(diag.message, strlen(diag.message)));
        assert_true(neph_text_is_utf8(diag.hint, strlen(diag.hint)));
        assert_true(neph_text_is_utf8(diag.file, strlen(diag.file)));
    }
    neph_fail(&diag, NEPH_ERR_IO, "cannot read '%s'", "caf\xe9\x1b[2J\xc2\x9b");
    assert_string_equal(diag.message, "cannot read 'caf\\xe9\\x1b[2J\\u009b'");
}

#include "tests/main.h"
