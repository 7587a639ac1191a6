/* SPDX-License-Identifier: MIT
 *
 * Files of every compression, type, number of channels and size, written by the OpenEXR library
 * (make_exr.cpp): neph reads the same bits as the library's own reader, or names the unsupported
 * feature.
 */
#include "tests/base/scratch.h"

#include <dirent.h>
#include <math.h>

#include "base/child.h"
#include "base/exr.h"
#include "base/oiio.h"

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

/* A part of a file, with its samples in another file. */
static bool reads_part_right(void **state, const char *name, const char *part, const char *raw_name)
{
    char path[SCRATCH_PATH_MAX], raw_path[SCRATCH_PATH_MAX], *raw = NULL;
    size_t raw_size = 0;
    struct neph_image *image = NULL;
    struct neph_diag diag = {0};
    scratch_path(state, path, name);
    scratch_path(state, raw_path, raw_name);
    neph_assert_ok(neph_file_read(raw_path, SIZE_MAX, &raw, &raw_size, &diag), &diag);
    const enum neph_status status = neph_exr_read_part(path, part, NULL, &image, &diag);
    if (status)
        print_error("%s: %s\n", name, diag.message);
    const bool right = !status && is_as_the_library_reads(image, name, raw, raw_size);
    neph_image_destroy(image);
    free(raw);
    return right;
}

/* A NAME.exr with its NAME.raw. */
static bool reads_right(void **state, const char *name)
{
    char raw_name[64];
    snprintf(raw_name, sizeof(raw_name), "%.*s.raw", (int)strlen(name) - 4, name);
    return reads_part_right(state, name, NULL, raw_name);
}

static void assert_refused(void **state, const char *name, const char *part, const char *words)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_image *image = NULL;
    struct neph_diag diag = {0};
    scratch_path(state, path, name);
    assert_int_equal(neph_exr_read_part(path, part, NULL, &image, &diag), NEPH_ERR_INPUT);
    if (!strstr(diag.message, words))
        fail_msg("%s: %s", name, diag.message);
    assert_null(image);
}

static const struct other_kind {
    const char *name, *part, *words;
} other_kinds[] = {
    {"parts.exr", NULL,
     "has more than one flat part with colour: 0 left (scanlineimage: A B G R), 1 right "
     "(scanlineimage: A B G R Z), 2 0 (tiledimage: A)"},
    {"parts.exr", "middle", "has no part 'middle'; its parts are: 0 left"},
    {"parts.exr", "3", "has no part '3'"},
    {"parts.exr", "-1", "has no part '-1'"},
    {"deep_part.exr", "deep", "is a deep OpenEXR file"},
    {"deep.exr", NULL, "is a deep OpenEXR file"},
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

/* Not bit for bit: test_luminance_and_chroma(). */
static bool is_chroma(const char *name)
{
    return strncmp(name, "chroma_", 7) == 0;
}

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
    const bool is_available = neph_oiio_is_available();
    for (int i = 0; i < names.count; i++) {
        const char *name = names.list[i];
        if (!strstr(name, ".exr") || has_no_samples_beside_it(name) || is_chroma(name))
            continue;
        if (strncmp(name, "dwa", 3) == 0) {
            setenv("NEPH_IMAGE", "/nowhere", 1);
            assert_refused(state, name, NULL, "has the compression DWA");
            unsetenv("NEPH_IMAGE");
            /* The helper program needs half a second of processor time to start. */
            if (is_available && refused_count % neph_test_by_day(32, 1) == 0)
                wrong_count += !reads_right(state, name);
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
        assert_refused(state, other_kinds[i].name, other_kinds[i].part, other_kinds[i].words);
}

/* Largest difference to the library's own reader. */
static double largest_difference(const struct neph_image *image, const float *raw)
{
    const size_t count = neph_image_pixel_count(image);
    double largest = 0.0;
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < count; i++)
            largest = fmax(largest,
                           fabs((double)(image->channels[c].samples[i] - raw[count * c + i])));
    return largest;
}

static void assert_chroma(void **state, const char *name)
{
    static const char *const colours[] = {"B", "R", "G"};
    char path[SCRATCH_PATH_MAX], *raw = NULL;
    size_t raw_size = 0;
    struct neph_image *image = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_exr_read(scratch_path(state, path, name), &image, &diag), &diag);
    strcpy(path + strlen(path) - 3, "raw");
    neph_assert_ok(neph_file_read(path, SIZE_MAX, &raw, &raw_size, &diag), &diag);
    assert_int_equal(image->channel_count, 3);
    assert_int_equal(raw_size, 3 * sizeof(float) * neph_image_pixel_count(image));
    for (int c = 0; c < 3; c++)
        assert_string_equal(image->channels[c].name, colours[c]);
    /* The library rounds values below 1 to half: chroma after each of two filters, and the colour,
     * each by up to 2^-12; G takes the errors of R and B times their share of the luminance. */
    const double difference = largest_difference(image, (const float *)(void *)raw);
    if (difference >= 4 * 0x1p-12)
        fail_msg("%s differs by %g", name, difference);
    free(raw);
    neph_image_destroy(image);
}

/* Chroma of half the width and height; in piz with the primaries of ACES. */
static void test_luminance_and_chroma(void **state)
{
    static const char *const names[] = {"chroma_none.exr", "chroma_rle.exr", "chroma_zips.exr",
                                        "chroma_zip.exr",  "chroma_piz.exr", "chroma_pxr24.exr",
                                        "chroma_b44.exr",  "chroma_b44a.exr"};
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++)
        assert_chroma(state, names[i]);
}

static void test_parts_by_name_and_number(void **state)
{
    static const struct {
        const char *name, *part, *raw_name;
    } cases[] = {
        {"parts.exr", "left", "parts_left.raw"},
        {"parts.exr", "right", "parts_right.raw"},
        {"parts.exr", "1", "parts_right.raw"},
        {"parts.exr", "2", "parts_0.raw"},
        {"parts.exr", "0", "parts_0.raw"},                   /* a name has priority */
        {"zip_half_4_7x5.exr", "any", "zip_half_4_7x5.raw"}, /* has no parts */
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++)
        assert_true(reads_part_right(state, cases[i].name, cases[i].part, cases[i].raw_name));
}

/* OpenEXRCore 3.1.5 reads no file that also has a deep part, 3.4 does. */
static void test_a_flat_part_beside_a_deep_one(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_image *image = NULL;
    struct neph_diag diag = {0};
    scratch_path(state, path, "deep_part.exr");
    if (neph_exr_read(path, &image, &diag))
        assert_non_null(strstr(diag.message, "is a partly deep OpenEXR file"));
    else
        assert_true(reads_part_right(state, "deep_part.exr", NULL, "deep_part.raw"));
    neph_image_destroy(image);
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
