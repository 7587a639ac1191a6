/* SPDX-License-Identifier: MIT
 *
 * The vectors are from the BLAKE2 authors' b2sum for a 256-bit digest (`printf abc | b2sum -l
 * 256`); "" and "abc" are also published with RFC 7693 implementations.
 */
#include "tests/base/scratch.h"

#include "base/hash.h"

static const struct {
    const char *text, *hex;
} vectors[] = {
    {"", "0e5751c026e543b2e8ab2eb06099daa1d1e5df47778f7787faab45cdf12fe3a8"},
    {"abc", "bddd813c634239723171ef3fee98579b94964e3bb1cb3e427262c8c068d52319"},
    {"The quick brown fox jumps over the lazy dog",
     "01718cec35cd3d796dd00020e0bfecb473ad23457d063b75eff29c0ffa2e58a9"},
};

static void test_published_vectors(void **state)
{
    for (size_t i = 0; i < sizeof(vectors) / sizeof(vectors[0]); i++) {
        char hex[NEPH_HASH_HEX_SIZE];
        struct neph_diag diag = {0};
        neph_assert_ok(neph_hash(vectors[i].text, strlen(vectors[i].text), hex, &diag), &diag);
        assert_string_equal(hex, vectors[i].hex);
    }
}

static void test_empty_data_may_be_null(void **state)
{
    char hex[NEPH_HASH_HEX_SIZE];
    neph_assert_ok(neph_hash(NULL, 0, hex, NULL), NULL);
    assert_string_equal(hex, vectors[0].hex);
}

/* Sizes around the block of BLAKE2b (128 bytes) and around the buffer for reading files. */
static void test_file_hashes_as_its_bytes(void **state)
{
    static const size_t sizes[] = {0, 1, 127, 128, 129, 262143, 262144, 262145, 1000003};
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "data");
    char *data = malloc(sizes[8]);
    uint64_t random = 7;
    for (size_t i = 0; i < sizes[8]; i++)
        data[i] = (char)neph_test_random(&random);
    for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++) {
        char of_data[NEPH_HASH_HEX_SIZE], of_file[NEPH_HASH_HEX_SIZE];
        struct neph_diag diag = {0};
        neph_assert_ok(neph_file_write(path, data, sizes[i], &diag), &diag);
        neph_assert_ok(neph_hash(data, sizes[i], of_data, &diag), &diag);
        neph_assert_ok(neph_hash_file(path, of_file, &diag), &diag);
        assert_string_equal(of_data, of_file);
    }
    free(data);
}

static void test_every_byte_counts(void **state)
{
    char data[300] = {0}, plain[NEPH_HASH_HEX_SIZE], changed[NEPH_HASH_HEX_SIZE];
    neph_assert_ok(neph_hash(data, sizeof(data), plain, NULL), NULL);
    for (size_t i = 0; i < sizeof(data); i++) {
        data[i] = 1;
        neph_assert_ok(neph_hash(data, sizeof(data), changed, NULL), NULL);
        assert_string_not_equal(plain, changed);
        data[i] = 0;
    }
}

static void test_missing_file_and_folder(void **state)
{
    char path[SCRATCH_PATH_MAX], hex[NEPH_HASH_HEX_SIZE] = "untouched";
    struct neph_diag diag = {0};
    assert_int_equal(neph_hash_file(scratch_path(state, path, "none"), hex, &diag),
                     NEPH_ERR_NOT_FOUND);
    assert_non_null(strstr(diag.message, "none"));
    assert_int_equal(neph_hash_file(scratch_path(state, path, ""), hex, &diag), NEPH_ERR_IO);
    assert_string_equal(hex, "untouched");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_published_vectors),    cmocka_unit_test(test_empty_data_may_be_null),
        scratch_test(test_file_hashes_as_its_bytes), cmocka_unit_test(test_every_byte_counts),
        scratch_test(test_missing_file_and_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
