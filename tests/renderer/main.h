/* SPDX-License-Identifier: MIT
 *
 * main() of a test on a Vulkan device. It runs all cases of its file, as listed by the build
 * (tests/CMakeLists.txt). Included at the end of the file.
 */
int main(void)
{
    const struct CMUnitTest tests[] = {
#include NEPH_TEST_CASES
    };
    return cmocka_run_group_tests(tests, test_vulkan_setup, test_vulkan_teardown);
}
