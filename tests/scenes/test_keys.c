/* SPDX-License-Identifier: MIT
 *
 * The table of keys in scenes/README.md is the one that the fields print. `test_keys --write`
 * writes it.
 */
#include "tests/neph_test.h"

#include "base/files.h"
#include "scenes/scene.h"

static const char readme[] = NEPH_SOURCE_DIR "/scenes/README.md";
static const char before[] = "<!-- written by tests/test_keys --write -->\n";
static const char after[] = "<!-- end -->\n";

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

/* README.md as it should be. */
static char *wanted_text(const char *text)
{
    const char *start = strstr(text, before), *end = strstr(text, after);
    assert_true(start && end && start < end);
    char *keys = printed_keys();
    char *wanted = neph_format("%.*s%s%s", (int)(start - text + (ptrdiff_t)strlen(before)), text,
                               keys, end);
    free(keys);
    return wanted;
}

static void test_readme_holds_the_keys(void **state)
{
    char *text = NULL;
    size_t size = 0;
    neph_assert_ok(neph_file_read(readme, 1 << 20, &text, &size, NULL), NULL);
    char *wanted = wanted_text(text);
    if (*state)
        neph_assert_ok(neph_file_write(readme, wanted, strlen(wanted), NULL), NULL);
    else
        assert_string_equal(text, wanted);
    free(wanted);
    free(text);
}

int main(int count, char **arguments)
{
    const bool writes = count > 1 && !strcmp(arguments[1], "--write");
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_prestate(test_readme_holds_the_keys, writes ? arguments : NULL),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
