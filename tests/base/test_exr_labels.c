/* SPDX-License-Identifier: MIT
 *
 * Metadata of an OpenEXR file: interpreted, preserved when the image is written again, or refused.
 */
#include "tests/base/scratch.h"

#include "base/colour_space.h"
#include "base/exr.h"
#include "base/exr_header.h"

/* An image of one channel with consecutive pixel values. */
static struct neph_image *make_image(int width_px, int height_px)
{
    struct neph_image *image = NULL;
    float *samples;
    neph_assert_ok(neph_image_create(width_px, height_px, &image, NULL), NULL);
    neph_assert_ok(neph_image_add_channel(image, "Y", &samples, NULL), NULL);
    for (int i = 0; i < width_px * height_px; i++)
        samples[i] = (float)i;
    return image;
}

static struct neph_image *read_image(const char *path)
{
    struct neph_image *image = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_exr_read(path, &image, &diag), &diag);
    return image;
}

/* Appends the bytes of an attribute after `used` others; returns the new size. */
static size_t put(char *bytes, size_t used, const char *name, const char *type, const void *value,
                  uint32_t value_bytes)
{
    char *end = stpcpy(bytes + used, name) + 1;
    end = stpcpy(end, type) + 1;
    for (int i = 0; i < 4; i++)
        *end++ = (char)(value_bytes >> 8 * i);
    memcpy(end, value, value_bytes);
    return (size_t)(end - bytes) + value_bytes;
}

/* A file of a small image with this attribute. */
static void write_with(const char *path, const char *name, const char *type, const void *value,
                       uint32_t value_bytes)
{
    char bytes[256];
    struct neph_image *image = make_image(3, 2);
    const size_t size = put(bytes, 0, name, type, value, value_bytes);
    image->header = calloc(1, sizeof(*image->header));
    *image->header = (struct neph_file_header){.display_px = {3, 2},
                                               .pixel_aspect = 1.0f,
                                               .screen_width = 1.0f,
                                               .attributes = malloc(size),
                                               .attribute_bytes = size};
    memcpy(image->header->attributes, bytes, size);
    neph_assert_ok(neph_exr_write(path, image, NULL), NULL);
    neph_image_destroy(image);
}

static void test_numbers_of_any_type_are_read(void **state)
{
    static const unsigned char rational[8] = {0xc0, 0x5d, 0, 0, 0xe9, 0x03, 0, 0}, /* 24000/1001 */
        nothing[8] = {24, 0, 0, 0, 0, 0, 0, 0}, negative[8] = {0xff, 0xff, 0xff, 0xff, 1, 0, 0, 0},
                               whole[4] = {25, 0, 0, 0}, real[4] = {0, 0, 0xc0, 0x41},
                               wide[8] = {0, 0, 0, 0, 0, 0, 0x3e, 0x40};
    static const struct {
        const char *type;
        const void *value;
        uint32_t bytes;
        double expected; /* NaN: not given */
    } cases[] = {
        {"rational", rational, 8, 24000.0 / 1001.0},
        {"rational", nothing, 8, NAN},
        {"rational", negative, 8, NAN},
        {"int", whole, 4, 25.0},
        {"float", real, 4, 24.0},
        {"double", wide, 8, 30.0},
        {"string", "23.976", 6, 23.976},
        {"string", "30000/1001", 10, 30000.0 / 1001.0},
        {"string", "24 fps", 6, NAN},
        {"string", "", 0, NAN},
        {"v2i", wide, 8, NAN},
    };
    static const char *const names[2][2] = {{"framesPerSecond", "frames_per_second"},
                                            {"whiteLuminance", "white_luminance"}};
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "frame.exr");
    for (size_t i = 0; i < 2 * COUNT(cases); i++) {
        const char *const *name = names[i % 2];
        write_with(path, name[0], cases[i / 2].type, cases[i / 2].value, cases[i / 2].bytes);
        struct neph_image *image = read_image(path);
        const char *text = neph_image_attribute(image, name[1]);
        if (isnan(cases[i / 2].expected))
            assert_null(text);
        else
            neph_assert_close(strtod(text, NULL), cases[i / 2].expected, 1e-14, 0.0); /* %.15g */
        neph_image_destroy(image);
    }
}

static void test_colour_spaces_by_name(void **state)
{
    static const struct {
        const char *name, *id; /* NULL: as if not given */
    } cases[] = {
        {"lin_rec709_scene", NULL},
        {"lin_rec709", NULL},
        {"Linear", NULL},
        {"scene_linear", NULL}, /* a role of a configuration */
        {"unknown", NULL},
        {"", NULL},
        {"lin_ap1_scene", "lin_ap1_scene"},
        {"ACEScg", "lin_ap1_scene"},
        {"acescg", "lin_ap1_scene"},
        {"sRGB", "srgb_rec709_scene"},
        {"srgb_rec709_display", "srgb_rec709_display"},
        {"Studio Space", "studio space"},
    };
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "frame.exr");
    for (size_t i = 0; i < 2 * COUNT(cases); i++) {
        const char *name = cases[i / 2].name, *id = cases[i / 2].id;
        write_with(path, i % 2 ? "colorInteropID" : "oiio:ColorSpace", "string", name,
                   (uint32_t)strlen(name));
        struct neph_image *image = read_image(path);
        const char *found = neph_image_attribute(image, "colour_space");
        if (id ? !found || strcmp(found, id) != 0 : found != NULL)
            fail_msg("'%s' is '%s'", name, found ? found : "");
        neph_image_destroy(image);
    }
}

/* Windows, pixels and attributes of any type are preserved with their rows, in both modes of
 * writing and over several chunks. */
static void test_a_file_written_again_keeps_its_header(void **state)
{
    static const float white = 203.0f;
    char path[SCRATCH_PATH_MAX], bytes[512];
    size_t size = put(bytes, 0, "owner_of_a_name_with_more_than_31_bytes", "timecode", "12345678",
                      8);
    size = put(bytes, size, "whiteLuminance", "float", &white, 4);
    size = put(bytes, size, "view", "string", "left", 4);
    size = put(bytes, size, "custom", "no type of the library's", "\0\1\2", 3);
    const struct neph_file_header header = {.data_min_px = {-4, 13},
                                            .display_min_px = {-10, 3},
                                            .display_px = {100, 60},
                                            .pixel_aspect = 2.0f,
                                            .screen_center = {0.25f, -1.0f},
                                            .screen_width = 3.0f,
                                            .attributes = bytes,
                                            .attribute_bytes = size};
    scratch_path(state, path, "frame.exr");
    for (int plain = 0; plain < 2; plain++) {
        struct neph_image *image = make_image(17, 35), *copy = NULL;
        struct neph_diag diag = {0};
        neph_assert_ok(neph_image_set_attribute(image, "text", NULL, "kept"), NULL);
        struct neph_file_header own = header;
        own.attributes = malloc(size);
        memcpy(own.attributes, bytes, size);
        image->header = malloc(sizeof(own));
        *image->header = own;
        for (int round = 0; round < 2; round++) {
            neph_assert_ok(
                (plain ? neph_exr_write_plain : neph_exr_write)(path, round ? copy : image, &diag),
                &diag);
            neph_image_destroy(copy);
            copy = read_image(path);
            const struct neph_file_header *read = copy->header;
            assert_memory_equal(read, &header, offsetof(struct neph_file_header, attributes));
            assert_int_equal(read->attribute_bytes, size);
            assert_memory_equal(read->attributes, bytes, size);
            assert_string_equal(neph_image_attribute(copy, "text"), "kept");
            assert_string_equal(neph_image_attribute(copy, "crop"), "(6, 10) of 100x60");
            assert_string_equal(neph_image_attribute(copy, "white_luminance"), "203");
            assert_memory_equal(copy->channels[0].samples, image->channels[0].samples,
                                17 * 35 * sizeof(float));
        }
        neph_image_destroy(copy);
        neph_image_destroy(image);
    }
}

static void test_a_plain_file_has_no_header(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_image *image = make_image(3, 2);
    neph_assert_ok(neph_image_set_attribute(image, "crop", NULL, "a text that is ours"), NULL);
    neph_assert_ok(neph_exr_write(scratch_path(state, path, "frame.exr"), image, NULL), NULL);
    neph_image_destroy(image);
    image = read_image(path);
    assert_null(image->header);
    assert_int_equal(image->attribute_count, 0);
    neph_image_destroy(image);
}

/* Scaled with the image, or refused if the result is between pixels. */
static void test_a_window_grows_with_its_image(void **state)
{
    static const struct {
        int width_px, height_px;
        int32_t expected[6]; /* {0}: refused */
    } cases[] = {
        {12, 6, {4, 3, 0, 0, 20, 12}},
        {24, 12, {8, 6, 0, 0, 40, 24}},
        {6, 6, {2, 3, 0, 0, 10, 12}},
        {18, 6, {6, 3, 0, 0, 30, 12}},
        {12, 3, {0}},
        {13, 6, {0}},
    };
    struct neph_image *image = make_image(12, 6);
    image->header = calloc(1, sizeof(*image->header));
    *image->header = (struct neph_file_header){
        .data_min_px = {4, 3}, .display_px = {20, 12}, .pixel_aspect = 1.0f, .screen_width = 1.0f};
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct neph_image *other = make_image(cases[i].width_px, cases[i].height_px);
        struct neph_diag diag = {0};
        const enum neph_status status = neph_image_copy_labels(image, other, &diag);
        assert_int_equal(status, cases[i].expected[5] ? NEPH_OK : NEPH_ERR_INPUT);
        if (status)
            assert_non_null(strstr(diag.message, "on whole pixels"));
        else
            assert_memory_equal(other->header, cases[i].expected, sizeof(cases[i].expected));
        neph_image_destroy(other);
    }
    neph_image_destroy(image);
}

/* The library treats an unknown code as ZIP. */
static void test_unknown_compressions_are_named(void **state)
{
    static const struct {
        int code;
        const char *words;
    } cases[] = {{10, "the compression HTJ2K (code 10), which OpenEXR 3.1 does not know"},
                 {11, "the compression HTJ2K of 32 lines (code 11)"},
                 {42, "the compression unknown (code 42)"},
                 {255, "the compression unknown (code 255)"}};
    static const char name[] = "compression\0compression\0\1\0\0";
    char path[SCRATCH_PATH_MAX], *file = NULL;
    size_t size = 0;
    struct neph_image *image = make_image(3, 40);
    neph_assert_ok(neph_exr_write(scratch_path(state, path, "frame.exr"), image, NULL), NULL);
    neph_image_destroy(image);
    neph_assert_ok(neph_file_read(path, 1 << 20, &file, &size, NULL), NULL);
    char *code = memmem(file, size, name, sizeof(name));
    assert_non_null(code);
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct neph_diag diag = {0};
        code[sizeof(name)] = (char)cases[i].code;
        scratch_write(path, file, size);
        assert_int_equal(neph_exr_read(path, &image, &diag), NEPH_ERR_INPUT);
        if (!strstr(diag.message, cases[i].words) || !strstr(diag.hint, "ZIP"))
            fail_msg("%s: %s", diag.message, diag.hint);
    }
    free(file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        scratch_test(test_numbers_of_any_type_are_read),
        scratch_test(test_colour_spaces_by_name),
        scratch_test(test_a_file_written_again_keeps_its_header),
        scratch_test(test_a_plain_file_has_no_header),
        cmocka_unit_test(test_a_window_grows_with_its_image),
        scratch_test(test_unknown_compressions_are_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
