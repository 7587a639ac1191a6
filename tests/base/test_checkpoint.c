/* SPDX-License-Identifier: MIT
 *
 * A checkpoint is restored to the bit, or not at all: every single damaged byte and every
 * truncation is refused, and so is a file of another computation.
 */
#include "tests/base/scratch.h"

#include "base/checkpoint.h"

static const double sums[] = {0.0,       -0.0, 1.0 / 3.0, 5e-324, 1.7976931348623157e308,
                              -INFINITY, 42.0};
enum { sum_count = sizeof(sums) / sizeof(sums[0]) };
static const char identity[] = "tracer 1 scene abc 3x2 seed 7";

static enum neph_status read_back(const char *path, const char *of, double *values, size_t count,
                                  struct neph_diag *diag)
{
    *diag = (struct neph_diag){.line = 0};
    return neph_checkpoint_read(path, of, values, count, diag);
}

static void test_same_bits_come_back(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_diag diag = {0};
    double values[sum_count];
    scratch_path(state, path, "sums");
    for (int again = 0; again < 2; again++) /* the second one over the first */
        neph_assert_ok(neph_checkpoint_write(path, identity, sums, sum_count, &diag), &diag);
    neph_assert_ok(read_back(path, identity, values, sum_count, &diag), &diag);
    assert_memory_equal(values, sums, sizeof(sums));
    assert_int_equal(scratch_count(state), 1);
}

static void test_no_numbers_and_no_identity(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_diag diag = {0};
    double none = 1.0;
    scratch_path(state, path, "none");
    neph_assert_ok(neph_checkpoint_write(path, "", NULL, 0, &diag), &diag);
    neph_assert_ok(read_back(path, "", &none, 0, &diag), &diag);
    assert_true(none == 1.0);
}

static void test_missing_file_is_not_found(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_diag diag;
    double values[sum_count];
    scratch_path(state, path, "missing");
    assert_int_equal(read_back(path, identity, values, sum_count, &diag), NEPH_ERR_NOT_FOUND);
}

static void test_another_computation_is_refused(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_diag diag = {0};
    double values[sum_count + 1] = {9.0};
    scratch_path(state, path, "sums");
    neph_assert_ok(neph_checkpoint_write(path, identity, sums, sum_count, &diag), &diag);
    assert_int_equal(read_back(path, "tracer 1 scene abc 3x2 seed 8", values, sum_count, &diag),
                     NEPH_ERR_INPUT);
    assert_non_null(strstr(diag.message, "seed 7"));
    assert_non_null(strstr(diag.message, "seed 8"));
    assert_int_equal(read_back(path, identity, values, sum_count - 1, &diag), NEPH_ERR_INPUT);
    assert_int_equal(read_back(path, identity, values, sum_count + 1, &diag), NEPH_ERR_INPUT);
    assert_true(values[0] == 9.0);
}

static void test_every_damaged_byte_and_every_cut_is_refused(void **state)
{
    char path[SCRATCH_PATH_MAX], damaged[SCRATCH_PATH_MAX], *data;
    struct neph_diag diag = {0};
    double values[sum_count] = {9.0};
    size_t size;
    scratch_path(state, path, "sums");
    scratch_path(state, damaged, "damaged");
    neph_assert_ok(neph_checkpoint_write(path, identity, sums, sum_count, &diag), &diag);
    neph_assert_ok(neph_file_read(path, 1 << 20, &data, &size, &diag), &diag);
    for (size_t i = 0; i < size; i++) {
        data[i] ^= 0x20;
        scratch_write(damaged, data, size);
        assert_int_equal(read_back(damaged, identity, values, sum_count, &diag), NEPH_ERR_INPUT);
        assert_non_null(strstr(diag.hint, "remove it"));
        data[i] ^= 0x20;
        scratch_write(damaged, data, i);
        assert_int_equal(read_back(damaged, identity, values, sum_count, &diag), NEPH_ERR_INPUT);
    }
    assert_true(values[0] == 9.0);
    free(data);
}

static void test_a_folder_is_no_checkpoint(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_diag diag;
    double values[sum_count];
    scratch_path(state, path, "");
    assert_int_equal(read_back(path, identity, values, sum_count, &diag), NEPH_ERR_IO);
    assert_int_equal(neph_checkpoint_write(path, identity, sums, sum_count, &diag), NEPH_ERR_IO);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        scratch_test(test_same_bits_come_back),
        scratch_test(test_no_numbers_and_no_identity),
        scratch_test(test_missing_file_is_not_found),
        scratch_test(test_another_computation_is_refused),
        scratch_test(test_every_damaged_byte_and_every_cut_is_refused),
        scratch_test(test_a_folder_is_no_checkpoint),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
