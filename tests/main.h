/* SPDX-License-Identifier: MIT
 *
 * The main() of a test: all cases of its file, from the list that the build makes
 * (tests/CMakeLists.txt). Included at the end of the file.
 */
int main(void)
{
    const struct CMUnitTest tests[] = {
#include NEPH_TEST_CASES
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
