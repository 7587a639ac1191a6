/* SPDX-License-Identifier: MIT
 *
 * The table of keys in scenes/README.md is printed from the fields. `test_keys --write` writes it.
 */
#include "tests/printed_table.h"

#include "scenes/scene.h"

static void test_readme_holds_the_keys(void **state)
{
    const struct printed_table table = {NEPH_SOURCE_DIR "/scenes/README.md",
                                        "<!-- written by tests/test_keys --write -->\n",
                                        "<!-- end -->\n", neph_scene_print_keys};
    check_readme(&table, *state);
}

/* Whether the rows of `media` have the keys at their position in scene files: inside a kind. */
static void test_keys_of_media_stand_in_a_kind(void **state)
{
    static const char start[] = "\n| `media[].";
    char *keys = printed(neph_scene_print_keys);
    int count = 0;
    for (const char *row = keys; (row = strstr(row, start)); row++, count++) {
        char kind[64], header[96];
        const char *name = row + strlen(start);
        snprintf(kind, sizeof(kind), "%.*s", (int)strcspn(name, ".`"), name);
        snprintf(header, sizeof(header), "%s%s` | ", start, kind);
        if (!strstr(keys, header))
            fail_msg("'%s' is no kind of a medium", kind);
    }
    assert_true(count > 20);
    assert_non_null(strstr(keys, "| `media[].KIND.albedo` |"));
    assert_null(strstr(keys, "| `media[].albedo` |"));
    free(keys);
}

int main(int count, char **arguments)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_prestate(test_readme_holds_the_keys, writes_readme(count, arguments)),
        cmocka_unit_test(test_keys_of_media_stand_in_a_kind),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
