/* SPDX-License-Identifier: MIT
 *
 * Memory that is freed together: zeroed, non-overlapping, and a failed allocation that is reported
 * later.
 */
#include "tests/neph_test.h"

#include "base/arena.h"

#include <stdint.h>
#include <string.h>

static void test_pieces_are_zeroed_and_apart(void **state)
{
    struct neph_arena arena = {0};
    int *numbers = neph_arena_zeroed(&arena, 100, sizeof(*numbers));
    const char *text = neph_arena_format(&arena, "%d of %s", 7, "nine");
    const char *copy = neph_arena_text(&arena, text);
    for (int i = 0; i < 100; i++)
        assert_int_equal(numbers[i], 0);
    memset(numbers, 0xff, 100 * sizeof(*numbers));
    assert_string_equal(text, "7 of nine");
    assert_string_equal(copy, text);
    assert_ptr_not_equal(copy, text);
    assert_null(neph_arena_text(&arena, NULL));
    assert_int_equal(neph_arena_check(&arena, NULL), NEPH_OK);
    neph_arena_finish(&arena);
}

static void test_a_list_grows(void **state)
{
    struct neph_arena arena = {0};
    int *list = NULL, room = 0;
    for (int i = 0; i < 100; i++) {
        list = neph_arena_grown(&arena, list, i, &room, sizeof(*list));
        assert_true(list && room > i && list[i] == 0);
        list[i] = i + 1;
    }
    for (int i = 0; i < 100; i++)
        assert_int_equal(list[i], i + 1);
    neph_arena_finish(&arena);
}

static void test_a_shortage_is_remembered(void **state)
{
    struct neph_arena arena = {0};
    assert_null(neph_arena_zeroed(&arena, SIZE_MAX / 2, 16));
    assert_non_null(neph_arena_zeroed(&arena, 1, 1));
    assert_int_equal(neph_arena_check(&arena, NULL), NEPH_ERR_MEMORY);
    neph_arena_finish(&arena);
}

#include "tests/main.h"
