/* SPDX-License-Identifier: MIT */
#include "harness/packages.h"

#include "tests/neph_test.h"

static const struct neph_packages blender = {"blender python3-numpy", "blender", "blender-arch"};

static void assert_line(const char *os_release, const char *expected)
{
    char line[256];
    neph_install_line_on(os_release, &blender, line, sizeof(line));
    assert_string_equal(line, expected);
}

static void test_the_command_is_the_distributions(void **state)
{
    assert_line("PRETTY_NAME=\"Debian GNU/Linux 13 (trixie)\"\nID=debian\n",
                "apt-get install blender python3-numpy");
    assert_line("ID=ubuntu\nID_LIKE=debian\n", "apt-get install blender python3-numpy");
    assert_line("NAME=Mint\nID=linuxmint\nID_LIKE=\"ubuntu debian\"",
                "apt-get install blender python3-numpy");
    assert_line("ID=\"fedora\"\n", "dnf install blender");
    assert_line("ID=rocky\nID_LIKE=\"rhel centos fedora\"\n", "dnf install blender");
    assert_line("ID=arch\n", "pacman -S blender-arch");
    assert_line("ID=nixos\nHOME_URL=\"https://debian\"\n",
                "install blender python3-numpy (the names of Debian's packages)");
    assert_line("", "install blender python3-numpy (the names of Debian's packages)");
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_the_command_is_the_distributions)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
