/* SPDX-License-Identifier: MIT
 *
 * The table of keys in scenes/README.md is the one that the fields print. `test_keys --write`
 * writes it.
 */
#include "tests/printed_table.h"

#include "scenes/scene.h"

static char *printed_keys(void)
{
    char *keys = NULL;
    size_t size = 0;
    FILE *file = open_memstream(&keys, &size);
    assert_non_null(file);
    neph_scene_print_keys(file);
    assert_int_equal(fclose(file), 0);
    return keys;
}

static void test_readme_holds_the_keys(void **state)
{
    const struct printed_table table = {NEPH_SOURCE_DIR "/scenes/README.md",
                                        "<!-- written by tests/test_keys --write -->\n",
                                        "<!-- end -->\n", printed_keys};
    check_readme(&table, *state);
}

int main(int count, char **arguments)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_prestate(test_readme_holds_the_keys, writes_readme(count, arguments)),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
