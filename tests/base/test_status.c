/* SPDX-License-Identifier: MIT
 *
 * Messages for users: a prefix, or a moved path, leaves hint and position unchanged.
 */
#include "tests/neph_test.h"

static struct neph_diag told(const char *message, const char *hint)
{
    struct neph_diag diag = {.line = 0};
    neph_fail(&diag, NEPH_ERR_INPUT, "%s", message);
    neph_hint(&diag, "%s", hint);
    neph_locate(&diag, "scene.yaml", 3, 7);
    return diag;
}

static void test_a_prefix_keeps_hint_and_position(void **state)
{
    struct neph_diag diag = told("it is blue", "paint it");
    neph_prefix(&diag, "'%s': ", "f.exr");
    assert_string_equal(diag.message, "'f.exr': it is blue");
    assert_string_equal(diag.hint, "paint it");
    assert_string_equal(diag.file, "scene.yaml");
    assert_int_equal(diag.line, 3);
    neph_prefix(NULL, "'%s': ", "f.exr");
}

/* A text that is too long is truncated, and stays printable. */
static void test_a_prefix_of_any_length(void **state)
{
    char word[1200];
    for (size_t length = 0; length < sizeof(word); length += 37) {
        memset(word, 'a', length);
        word[length] = '\0';
        struct neph_diag diag = told("ends with \xc3\xa9", "hint");
        neph_prefix(&diag, "%s ", word);
        const size_t whole = length + strlen(" ends with \xc3\xa9");
        assert_int_equal(strlen(diag.message) == whole, whole < sizeof(diag.message));
        assert_string_equal(diag.hint, "hint");
    }
}

static void test_paths_move(void **state)
{
    struct neph_diag diag = told("see '/tmp/x1/log' and '/tmp/x1'", "its log is '/tmp/x1/log'");
    neph_move_paths(&diag, "/tmp/x1", "/store/failed/a/tmp/x1");
    assert_string_equal(diag.message,
                        "see '/store/failed/a/tmp/x1/log' and '/store/failed/a/tmp/x1'");
    assert_string_equal(diag.hint, "its log is '/store/failed/a/tmp/x1/log'");
    assert_int_equal(diag.column, 7);
    diag = told("it failed", "install it");
    neph_move_paths(&diag, "/tmp/x1", NULL);
    assert_string_equal(diag.hint, "install it");
    diag = told("it failed", "its log is '/tmp/x1/log'");
    neph_move_paths(&diag, "/tmp/x1", NULL);
    assert_string_equal(diag.hint, "");
    neph_move_paths(NULL, "/tmp/x1", NULL);
}

#include "tests/main.h"
