/* SPDX-License-Identifier: MIT
 *
 * Files of every compression, type, number of channels and size, written by the OpenEXR library
 * (make_exr.cpp): neph reads the same bits as the library's own reader, or names the unsupported
 * feature.
 */
#include "tests/base/scratch.h"

#include <dirent.h>

#include "base/child.h"
#include "base/exr.h"

enum {
    /* In make_exr.cpp: 4 types, 1 to 5 channels, 4 sizes; one each linear, upwards, a window; 4
     * types in tiles of 3 sizes */
    FILES_PER_COMPRESSION = 4 * 5 * 4 + 3 + 4 * 3,
    FILES_OF_LEVELS = 4,   /* one level, mipmaps and ripmaps */
    READ_COMPRESSIONS = 8, /* none, rle, zips, zip, piz, pxr24, b44, b44a */
    REFUSED_COMPRESSIONS = 2,
};

static int make_files(void **state)
{
    if (scratch_setup(state) != 0)
        return -1;
    const struct scratch *scratch = *state;
    const char *const argv[] = {NEPH_MAKE_EXR, scratch->folder, NULL};
    const struct neph_child_params params = {.argv = argv};
    struct neph_child_result result;
    return neph_child_run(&params, &result, NULL) == NEPH_OK ? 0 : -1;
}

/* Compares bit for bit; returns false and prints the position of a difference. */
static bool is_as_the_library_reads(const struct neph_image *image, const char *name,
                                    const char *raw, size_t raw_size)
{
    const size_t plane_size = neph_image_pixel_count(image) * sizeof(float);
    if (raw_size != plane_size * (size_t)image->channel_count) {
        print_error("%s: %zu bytes of samples\n", name, raw_size);
        return false;
    }
    for (int c = 0; c < image->channel_count; c++)
        if (memcmp(image->channels[c].samples, raw + plane_size * (size_t)c, plane_size) != 0) {
            print_error("%s: channel %s differs\n", name, image->channels[c].name);
            return false;
        }
    return true;
}

/* A NAME.exr with its NAME.raw. */
static bool reads_right(void **state, const char *name)
{
    char path[SCRATCH_PATH_MAX], raw_path[SCRATCH_PATH_MAX], *raw = NULL;
    size_t raw_size = 0;
    struct neph_image *image = NULL;
    struct neph_diag diag = {0};
    scratch_path(state, path, name);
    snprintf(raw_path, sizeof(raw_path), "%.*s.raw", (int)strlen(path) - 4, path);
    neph_assert_ok(neph_file_read(raw_path, SIZE_MAX, &raw, &raw_size, &diag), &diag);
    const enum neph_status status = neph_exr_read(path, &image, &diag);
    if (status)
        print_error("%s: %s\n", name, diag.message);
    const bool right = !status && is_as_the_library_reads(image, name, raw, raw_size);
    neph_image_destroy(image);
    free(raw);
    return right;
}

static void assert_refused(void **state, const char *name, const char *words)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_image *image = NULL;
    struct neph_diag diag = {0};
    assert_int_equal(neph_exr_read(scratch_path(state, path, name), &image, &diag), NEPH_ERR_INPUT);
    if (!strstr(diag.message, words))
        fail_msg("%s: %s", name, diag.message);
    assert_null(image);
}

static const struct other_kind {
    const char *name, *words;
} other_kinds[] = {
    {"parts.exr", "is a multi-part OpenEXR"},
    {"deep.exr", "is a deep OpenEXR file"},
    {"chroma.exr", "'BY' is subsampled"},
};

/* Attributes in a file of another program; NULL: it has none. */
static const struct attribute_case {
    const char *name, *primaries, *pixel_aspect;
} attribute_cases[] = {
    {"rec709.exr", NULL, NULL},
    {"aces.exr",
     "red (0.7347, 0.2653), green (0, 1), blue (0.0001, -0.077), white (0.3217, 0.3377)", NULL},
    {"wide.exr", NULL, "2"},
    {"texts.exr", NULL, NULL},
};

static bool has_no_samples_beside_it(const char *name)
{
    for (size_t i = 0; i < sizeof(attribute_cases) / sizeof(attribute_cases[0]); i++)
        if (strcmp(name, attribute_cases[i].name) == 0)
            return true;
    for (size_t i = 0; i < sizeof(other_kinds) / sizeof(other_kinds[0]); i++)
        if (strcmp(name, other_kinds[i].name) == 0)
            return true;
    return false;
}

static void test_reads_as_the_library_does(void **state)
{
    const struct scratch *scratch = *state;
    struct neph_arena arena = {NULL};
    struct neph_names names;
    neph_assert_ok(neph_dir_list(scratch->folder, &arena, &names, NULL), NULL);
    int read_count = 0, wrong_count = 0, refused_count = 0;
    for (int i = 0; i < names.count; i++) {
        const char *name = names.list[i];
        if (!strstr(name, ".exr") || has_no_samples_beside_it(name))
            continue;
        if (strncmp(name, "dwa", 3) == 0) {
            assert_refused(state, name, "has DWA compression");
            refused_count++;
        } else {
            wrong_count += !reads_right(state, name);
            read_count++;
        }
    }
    neph_arena_finish(&arena);
    assert_int_equal(wrong_count, 0);
    assert_int_equal(read_count, READ_COMPRESSIONS * FILES_PER_COMPRESSION + FILES_OF_LEVELS);
    assert_int_equal(refused_count, REFUSED_COMPRESSIONS * FILES_PER_COMPRESSION);
}

static void test_other_kinds_are_refused_by_name(void **state)
{
    for (size_t i = 0; i < sizeof(other_kinds) / sizeof(other_kinds[0]); i++)
        assert_refused(state, other_kinds[i].name, other_kinds[i].words);
}

static void assert_attribute(const struct neph_image *image, const char *name, const char *expected)
{
    const char *value = neph_image_attribute(image, name);
    if (expected && value)
        assert_string_equal(value, expected);
    else
        assert_true(!expected && !value);
}

static void test_unusual_attributes_are_reported(void **state)
{
    for (size_t i = 0; i < sizeof(attribute_cases) / sizeof(attribute_cases[0]); i++) {
        char path[SCRATCH_PATH_MAX];
        struct neph_image *image = NULL;
        struct neph_diag diag = {0};
        scratch_path(state, path, attribute_cases[i].name);
        neph_assert_ok(neph_exr_read(path, &image, &diag), &diag);
        assert_attribute(image, "primaries", attribute_cases[i].primaries);
        assert_attribute(image, "pixel_aspect", attribute_cases[i].pixel_aspect);
        assert_attribute(image, "crop", NULL);
        assert_attribute(image, "encoding", NULL);
        neph_image_destroy(image);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
#include "cases/test_exr_library.inc"
    };
    return cmocka_run_group_tests(tests, make_files, scratch_teardown);
}
