/* SPDX-License-Identifier: MIT
 *
 * Specialized shaders on disk: a file is complete or missing, in every state of the folder.
 */
#include "tests/base/scratch.h"

#include "renderer/shader_cache.h"
#include "tests/neph_test.h"

#include <fcntl.h>
#include <sys/stat.h>

enum { WORDS = 1000 };

static struct neph_shader_cache *open_cache(const char *folder)
{
    struct neph_shader_cache *cache = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_shader_cache_create(folder, &cache, &diag), &diag);
    return cache;
}

static void make_key(uint32_t number, char key[NEPH_HASH_HEX_SIZE])
{
    const uint32_t code[2] = {number, 3}, constants[2] = {5, 6};
    struct neph_diag diag = {0};
    neph_assert_ok(neph_shader_cache_key(code, sizeof(code), constants, 2, key, &diag), &diag);
}

static void fill(uint32_t number, uint32_t words[WORDS])
{
    for (uint32_t i = 0; i < WORDS; i++)
        words[i] = number * 7919 + i;
}

static void put(struct neph_shader_cache *cache, uint32_t number)
{
    char key[NEPH_HASH_HEX_SIZE];
    uint32_t words[WORDS];
    make_key(number, key);
    fill(number, words);
    neph_shader_cache_write(cache, key, words, sizeof(words));
}

/* Whether an entry exists; its content must be the one written. */
static bool has(struct neph_shader_cache *cache, uint32_t number)
{
    char key[NEPH_HASH_HEX_SIZE];
    uint32_t expected[WORDS], *words = NULL;
    size_t size_bytes = 0;
    make_key(number, key);
    fill(number, expected);
    if (!neph_shader_cache_read(cache, key, &words, &size_bytes))
        return false;
    assert_int_equal(size_bytes, sizeof(expected));
    assert_memory_equal(words, expected, sizeof(expected));
    free(words);
    return true;
}

static void make_cache_path(void **state, uint32_t number, char path[2 * SCRATCH_PATH_MAX])
{
    char key[NEPH_HASH_HEX_SIZE], folder[SCRATCH_PATH_MAX];
    make_key(number, key);
    snprintf(path, 2 * SCRATCH_PATH_MAX, "%s/%s", scratch_path(state, folder, "shaders"), key);
}

static void test_kept_for_the_next_run(void **state)
{
    const struct scratch *scratch = *state;
    struct neph_shader_cache *cache = open_cache(scratch->folder);
    assert_false(has(cache, 1));
    put(cache, 1);
    put(cache, 2);
    assert_true(has(cache, 1) && has(cache, 2) && !has(cache, 3));
    neph_shader_cache_destroy(cache);
    cache = open_cache(scratch->folder);
    assert_true(has(cache, 1) && has(cache, 2) && !has(cache, 3));
    neph_shader_cache_destroy(cache);
    neph_shader_cache_destroy(NULL);
}

/* Every input of a shader changes its key. */
static void test_the_key(void **state)
{
    enum { KEYS = 5 };
    char keys[KEYS][NEPH_HASH_HEX_SIZE];
    const uint32_t code[3] = {1, 2, 3}, constants[3] = {4, 5, 6}, others[3] = {4, 5, 7};
    assert_int_equal(neph_shader_cache_key(code, 12, constants, 3, keys[0], NULL), NEPH_OK);
    assert_int_equal(neph_shader_cache_key(code, 8, constants, 3, keys[1], NULL), NEPH_OK);
    assert_int_equal(neph_shader_cache_key(code, 12, others, 3, keys[2], NULL), NEPH_OK);
    assert_int_equal(neph_shader_cache_key(code, 12, constants, 2, keys[3], NULL), NEPH_OK);
    assert_int_equal(neph_shader_cache_key(code + 1, 8, constants, 3, keys[4], NULL), NEPH_OK);
    for (int i = 0; i < KEYS; i++)
        for (int j = 0; j < i; j++)
            assert_string_not_equal(keys[i], keys[j]);
}

/* Truncated at any place, with one byte changed, or a folder of that name: missing, and written
 * again. */
static void test_damaged_files(void **state)
{
    const struct scratch *scratch = *state;
    struct neph_shader_cache *cache = open_cache(scratch->folder);
    char path[2 * SCRATCH_PATH_MAX];
    make_cache_path(state, 1, path);
    static const off_t lengths[] = {0, 1, 63, 64, 65, 68, 4 * WORDS, 4 * WORDS + 63};
    for (size_t i = 0; i < sizeof(lengths) / sizeof(lengths[0]); i++) {
        put(cache, 1);
        assert_int_equal(truncate(path, lengths[i]), 0);
        assert_false(has(cache, 1));
    }
    for (off_t at = 0; at < 64 + 4 * WORDS; at += 333) {
        put(cache, 1);
        assert_true(has(cache, 1));
        const int file = open(path, O_RDWR);
        char byte = 0;
        assert_int_equal(pread(file, &byte, 1, at), 1);
        byte ^= 0x10;
        assert_int_equal(pwrite(file, &byte, 1, at), 1);
        close(file);
        assert_false(has(cache, 1));
    }
    unlink(path);
    assert_int_equal(mkdir(path, 0700), 0);
    put(cache, 1);
    assert_false(has(cache, 1));
    neph_shader_cache_destroy(cache);
}

/* A folder that cannot exist: nothing is cached, without a message. (Root can write to read-only
 * ones.) */
static void test_no_folder(void **state)
{
    struct neph_shader_cache *cache = open_cache("/dev/null/cache");
    put(cache, 1);
    assert_false(has(cache, 1));
    neph_shader_cache_destroy(cache);
    put(NULL, 1);
    assert_false(has(NULL, 1));
}

/* Beyond the limit the least recently used files are deleted; other files in the folder stay. */
static void test_the_limit(void **state)
{
    enum { FILES = 70, FILE_BYTES = 1 << 20 };
    const struct scratch *scratch = *state;
    struct neph_shader_cache *cache = open_cache(scratch->folder);
    char path[2 * SCRATCH_PATH_MAX], other[SCRATCH_PATH_MAX];
    put(cache, 0); /* creates the folder */
    scratch_write(scratch_path(state, other, "shaders/README"), "mine", 4);
    for (uint32_t i = 1; i <= FILES; i++) {
        make_cache_path(state, i, path);
        scratch_write(path, "", 0);
        assert_int_equal(truncate(path, FILE_BYTES), 0);
        const struct timespec used[2] = {{.tv_sec = 1000 + i}, {.tv_sec = 1000 + i}};
        assert_int_equal(utimensat(AT_FDCWD, path, used, 0), 0);
    }
    neph_shader_cache_destroy(cache);
    for (uint32_t i = 0; i <= FILES; i++) {
        make_cache_path(state, i, path);
        const bool is_old = i > 0 && i <= FILES - NEPH_SHADER_CACHE_MAX_BYTES / FILE_BYTES + 1;
        assert_int_equal(access(path, F_OK) == 0, !is_old);
    }
    assert_int_equal(access(other, F_OK), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        scratch_test(test_kept_for_the_next_run),
        cmocka_unit_test(test_the_key),
        scratch_test(test_damaged_files),
        cmocka_unit_test(test_no_folder),
        scratch_test(test_the_limit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
