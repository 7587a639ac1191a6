/* SPDX-License-Identifier: MIT */
#include "tests/neph_test.h"

#include "base/files.h"
#include "harness/document/junit.h"

#include <unistd.h>

static void test_a_suite_as_xml(void **state)
{
    char path[] = "/tmp/neph_junit_XXXXXX";
    const int file = mkstemp(path);
    OWNED(memory) char *text = NULL;
    size_t length = 0;
    struct neph_junit junit = {.name = "neph <compare>", .seconds = 1.25};
    assert_true(file >= 0);
    close(file);
    neph_junit_add(&junit, "radiance", "rmse <= 0.5", NEPH_JUNIT_PASSED, "");
    neph_junit_add(&junit, "a\nb", "\x1b[31m\xff", NEPH_JUNIT_FAILED, "\"1\" > 0.5 & more");
    neph_junit_add(&junit, "depth", "mae", NEPH_JUNIT_SKIPPED, "not measured");
    assert_int_equal(neph_junit_write(&junit, path, NULL), NEPH_OK);
    assert_int_equal(neph_file_read(path, 10000, &text, &length, NULL), NEPH_OK);
    assert_string_equal(
        text, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
              "<testsuite name=\"neph &lt;compare&gt;\" tests=\"3\" failures=\"1\" skipped=\"1\" "
              "time=\"1.250\">\n"
              "  <testcase classname=\"radiance\" name=\"rmse &lt;= 0.5\"></testcase>\n"
              "  <testcase classname=\"a b\" name=\"\\x1b[31m\\xff\"><failure "
              "message=\"&quot;1&quot; &gt; 0.5 &amp; more\"/></testcase>\n"
              "  <testcase classname=\"depth\" name=\"mae\"><skipped message=\"not "
              "measured\"/></testcase>\n"
              "</testsuite>\n");
    neph_junit_finish(&junit);
    unlink(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
#include "cases/test_junit.inc"
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
