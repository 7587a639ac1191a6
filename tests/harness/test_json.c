/* SPDX-License-Identifier: MIT
 *
 * Values that jansson refuses are errors in all callers.
 */
#include "tests/neph_test.h"

#include "harness/json.h"

#include <math.h>

/* The three ways in which jansson returns NULL. */
static json_t *refused(int which)
{
    static const char latin1[] = "caf\xe9";
    return which == 0   ? json_string(latin1)
           : which == 1 ? json_pack("{s:s}", "path", latin1)
                        : json_pack("{s:f}", "error", NAN);
}

static void test_a_list_without_one_of_its_rows_is_none(void **state)
{
    for (int which = 0; which < 3; which++) {
        json_t *list = json_array(), *object = json_object();
        neph_json_add(&list, json_integer(1));
        assert_int_equal(json_array_size(list), 1);
        neph_json_add(&list, refused(which));
        neph_json_add(&list, json_integer(3)); /* after the error */
        assert_null(list);
        neph_json_set(&object, "a", json_integer(1));
        neph_json_set(&object, "b", refused(which));
        neph_json_set(&object, "c", json_integer(3));
        assert_null(object);
        assert_null(json_pack("{s:i, s:o}", "count", 3, "rows", list));
    }
}

static void test_foreign_lists_stay_with_an_error(void **state)
{
    json_t *list = json_array(), *object = json_object();
    for (int which = 0; which < 3; which++) {
        struct neph_diag diag = {.line = 0};
        assert_int_equal(neph_json_append(list, refused(which), &diag), NEPH_ERR_INTERNAL);
        assert_non_null(strstr(diag.message, "UTF-8"));
        assert_int_equal(neph_json_put(object, "key", refused(which), &diag), NEPH_ERR_INTERNAL);
        assert_int_equal(neph_json_check(refused(which), &diag), NEPH_ERR_INTERNAL);
    }
    assert_int_equal(json_array_size(list) + json_object_size(object), 0);
    struct neph_diag diag = {.line = 0};
    neph_assert_ok(neph_json_append(list, json_integer(1), &diag), &diag);
    neph_assert_ok(neph_json_put(object, "key", json_integer(1), &diag), &diag);
    assert_int_equal(json_object_size(object), 1);
    assert_int_equal(neph_json_append(NULL, json_integer(1), &diag), NEPH_ERR_INTERNAL);
    json_decref(list);
    json_decref(object);
}

static void test_texts_that_are_only_read_are_cleaned(void **state)
{
    json_t *text = neph_json_cleaned("caf\xe9\x1b[2J");
    assert_string_equal(json_string_value(text), "caf\\xe9\\x1b[2J");
    json_decref(text);
}

#include "tests/main.h"
