/* SPDX-License-Identifier: MIT
 *
 * The build id against the output of readelf for the program's file.
 */
#include "tests/neph_test.h"

#include "base/build_id.h"

#include <unistd.h>

static void test_it_is_the_one_in_the_file(void **state)
{
    char command[64], line[256], hex[NEPH_BUILD_ID_SIZE];
    const char *found = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_build_id(hex, &diag), &diag);
    snprintf(command, sizeof(command), "readelf -n /proc/%d/exe", (int)getpid());
    FILE *notes = popen(command, "r");
    assert_non_null(notes);
    while (!found && fgets(line, sizeof(line), notes))
        found = strstr(line, "Build ID: ");
    assert_non_null(found);
    assert_memory_equal(found + strlen("Build ID: "), hex, NEPH_BUILD_ID_SIZE - 1);
    pclose(notes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_it_is_the_one_in_the_file),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
