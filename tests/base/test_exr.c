/* SPDX-License-Identifier: MIT
 *
 * Round trips are bit-exact, files of other kinds are refused with their name, and no broken file
 * crashes the reader (under the sanitizers). NEPH_TEST_SEED repeats a run of the random tests.
 */
#include "tests/base/scratch.h"

#include "base/exr.h"
#include "base/exr_header.h"

#include <OpenEXR/openexr.h>
#include <fcntl.h>
#include <unistd.h>

static uint64_t test_seed(void)
{
    const char *seed = getenv("NEPH_TEST_SEED");
    return seed ? strtoull(seed, NULL, 0) : 20240229;
}

/* All kinds of floats: random bits include NaNs with payloads, denormals and infinities. */
static void fill_with_random_bits(struct neph_image *image, uint64_t *random)
{
    static const float special[] = {0.0f, -0.0f,     1.0f,      -1.0f,    INFINITY,       -INFINITY,
                                    NAN,  0x1p-149f, 0x1p-126f, 65504.0f, 0x1.fffffep127f};
    size_t special_count = sizeof(special) / sizeof(special[0]);
    for (int c = 0; c < image->channel_count; c++) {
        for (size_t i = 0; i < neph_image_pixel_count(image); i++) {
            uint32_t bits = (uint32_t)neph_test_random(random);
            memcpy(&image->channels[c].samples[i], &bits, sizeof(bits));
            if (bits % 4 == 0)
                image->channels[c].samples[i] = special[(bits / 4) % special_count];
        }
    }
}

/* The channels of a frame, in a different order than the file's alphabetical one. */
static struct neph_image *make_frame(int width_px, int height_px, uint64_t *random)
{
    struct neph_image *image = NULL;
    float *rgb[3];
    struct neph_diag diag = {0};
    neph_assert_ok(neph_image_create(width_px, height_px, &image, &diag), &diag);
    neph_assert_ok(neph_image_add_rgb(image, NULL, rgb, &diag), &diag);
    neph_assert_ok(neph_image_add_rgb(image, "volume", rgb, &diag), &diag);
    neph_assert_ok(neph_image_add_rgb(image, "transmittance", rgb, &diag), &diag);
    neph_assert_ok(neph_image_add_channel(image, "Z", NULL, &diag), &diag);
    fill_with_random_bits(image, random);
    return image;
}

static void assert_same_image(const struct neph_image *a, const struct neph_image *b)
{
    assert_int_equal(a->width_px, b->width_px);
    assert_int_equal(a->height_px, b->height_px);
    assert_int_equal(a->channel_count, b->channel_count);
    for (int c = 0; c < a->channel_count; c++) {
        const float *samples = neph_image_channel(b, a->channels[c].name);
        assert_non_null(samples);
        assert_memory_equal(a->channels[c].samples, samples,
                            neph_image_pixel_count(a) * sizeof(float));
    }
    assert_int_equal(a->attribute_count, b->attribute_count);
    for (int i = 0; i < a->attribute_count; i++) {
        const char *value = neph_image_attribute(b, a->attributes[i].name);
        assert_non_null(value);
        assert_string_equal(a->attributes[i].value, value);
    }
}

static void assert_round_trip(const char *path, const struct neph_image *image)
{
    enum neph_status (*const write[])(const char *, const struct neph_image *,
                                      struct neph_diag *) = {neph_exr_write, neph_exr_write_plain};
    for (size_t i = 0; i < sizeof(write) / sizeof(write[0]); i++) {
        struct neph_image *back = NULL;
        struct neph_diag diag = {0};
        neph_assert_ok(write[i](path, image, &diag), &diag);
        neph_assert_ok(neph_exr_read(path, &back, &diag), &diag);
        assert_same_image(image, back);
        neph_image_destroy(back);
    }
}

static void assert_refused(const char *path, enum neph_status expected, const char *words)
{
    struct neph_image *image = NULL;
    struct neph_diag diag = {0};
    enum neph_status status = neph_exr_read(path, &image, &diag);
    if (status != expected || !strstr(diag.message, words))
        print_error("%s: '%s' instead of '%s'\n", neph_status_name(status), diag.message, words);
    assert_int_equal(status, expected);
    assert_non_null(strstr(diag.message, words));
    assert_null(image);
    assert_int_equal(neph_exr_read(path, &image, NULL), expected); /* also without a diag */
}

/* ---- round trips ----------------------------------------------------------------------------- */

/* ZIP packs 16 rows into a chunk: heights around this number, odd widths, and a single pixel. */
static void test_round_trip_is_bit_exact(void **state)
{
    static const int sizes[][2] = {{1, 1},   {1, 2},    {2, 1},   {3, 15},  {7, 16},   {5, 17},
                                   {31, 33}, {127, 48}, {1, 100}, {100, 1}, {641, 359}};
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "frame.exr");
    uint64_t random = test_seed();
    for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++) {
        struct neph_image *image = make_frame(sizes[i][0], sizes[i][1], &random);
        assert_round_trip(path, image);
        neph_image_destroy(image);
    }
    assert_int_equal(scratch_count(state), 1);
}

/* Chunks whose compressed size equals their plain size; only OpenEXRCore 3.1.5 writes these in a
 * way that no reader decodes correctly: five samples whose bits are small integers, found by this
 * project's test. */
static void test_chunks_that_do_not_shrink(void **state)
{
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "equal.exr");
    for (uint32_t first = 0; first < 64; first++) {
        struct neph_image *image = NULL;
        float *samples = NULL;
        neph_assert_ok(neph_image_create(5, 1, &image, NULL), NULL);
        neph_assert_ok(neph_image_add_channel(image, "Y", &samples, NULL), NULL);
        for (uint32_t x = 0; x < 5; x++) {
            uint32_t bits = first + x;
            memcpy(&samples[x], &bits, sizeof(bits));
        }
        assert_round_trip(path, image);
        neph_image_destroy(image);
    }
}

static void test_smooth_image_is_compressed(void **state)
{
    char path[SCRATCH_PATH_MAX], *data = NULL;
    size_t size = 0;
    struct neph_image *image = NULL;
    float *samples = NULL;
    neph_assert_ok(neph_image_create(256, 256, &image, NULL), NULL);
    neph_assert_ok(neph_image_add_channel(image, "Y", &samples, NULL), NULL);
    for (int i = 0; i < 256 * 256; i++)
        samples[i] = (float)(i / 256);
    neph_assert_ok(neph_exr_write(scratch_path(state, path, "smooth.exr"), image, NULL), NULL);
    neph_assert_ok(neph_file_read(path, SIZE_MAX, &data, &size, NULL), NULL);
    assert_true(size < 256 * 256 * sizeof(float) / 10);
    free(data);
    neph_image_destroy(image);
}

static void test_same_image_gives_same_bytes(void **state)
{
    char paths[2][SCRATCH_PATH_MAX], *data[2];
    size_t sizes[2];
    for (int i = 0; i < 2; i++) {
        uint64_t random = 5;
        struct neph_image *image = make_frame(40, 30, &random);
        scratch_path(state, paths[i], i ? "b.exr" : "a.exr");
        neph_assert_ok(neph_exr_write(paths[i], image, NULL), NULL);
        neph_assert_ok(neph_file_read(paths[i], SIZE_MAX, &data[i], &sizes[i], NULL), NULL);
        neph_image_destroy(image);
    }
    assert_int_equal(sizes[0], sizes[1]);
    assert_memory_equal(data[0], data[1], sizes[0]);
    free(data[0]);
    free(data[1]);
}

static void test_attributes_both_ways(void **state)
{
    char path[SCRATCH_PATH_MAX], long_name[NEPH_IMAGE_NAME_MAX], *long_value = NULL;
    memset(long_name, 'n', sizeof(long_name) - 1);
    long_name[sizeof(long_name) - 1] = '\0';
    long_value = calloc(1, 100001);
    memset(long_value, 'v', 100000);
    uint64_t random = 3;
    struct neph_image *image = make_frame(4, 4, &random);
    neph_assert_ok(neph_image_set_attribute(image, "neph.engine", NULL, "cycles %d", 3), NULL);
    neph_assert_ok(neph_image_set_attribute(image, "neph.empty", NULL, "%s", ""), NULL);
    neph_assert_ok(neph_image_set_attribute(image, "neph.text", NULL, "%s",
                                            "two\nlines, 100% \xc3\xbc \xe2\x88\x9e"),
                   NULL);
    assert_round_trip(scratch_path(state, path, "short.exr"), image);
    neph_assert_ok(neph_image_set_attribute(image, long_name, NULL, "%s", "x"), NULL);
    neph_assert_ok(neph_image_set_attribute(image, "neph.long", NULL, "%s", long_value), NULL);
    assert_round_trip(scratch_path(state, path, "long.exr"), image);
    neph_image_destroy(image);
    free(long_value);
}

static void test_long_channel_names(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_image *image = NULL;
    float *rgb[3];
    neph_assert_ok(neph_image_create(3, 3, &image, NULL), NULL);
    neph_assert_ok(
        neph_image_add_rgb(image, "a_layer_with_a_name_of_more_than_31_bytes", rgb, NULL), NULL);
    rgb[1][4] = 42.0f;
    char name[NEPH_IMAGE_NAME_MAX];
    memset(name, 'n', sizeof(name) - 1);
    name[sizeof(name) - 1] = '\0';
    neph_assert_ok(neph_image_add_channel(image, name, NULL, NULL), NULL);
    assert_round_trip(scratch_path(state, path, "names.exr"), image);
    neph_image_destroy(image);
}

static void test_unwritable_images_are_refused(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_image *image = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_image_create(3, 3, &image, NULL), NULL);
    scratch_path(state, path, "x.exr");
    assert_int_equal(neph_exr_write(path, image, &diag), NEPH_ERR_INPUT);
    assert_non_null(strstr(diag.message, "no channels"));
    neph_assert_ok(neph_image_add_channel(image, "Y", NULL, NULL), NULL);
    neph_assert_ok(neph_image_set_attribute(image, "compression", NULL, "x"), NULL);
    assert_int_equal(neph_exr_write(path, image, &diag), NEPH_ERR_INPUT);
    assert_non_null(strstr(diag.message, "'compression'"));
    neph_image_destroy(image);
    assert_int_equal(scratch_count(state), 0);
}

static void test_failed_write_keeps_the_old_file(void **state)
{
    char path[SCRATCH_PATH_MAX];
    uint64_t random = 3;
    struct neph_image *image = make_frame(4, 4, &random);
    struct neph_diag diag = {0};
    assert_int_equal(neph_exr_write(scratch_path(state, path, "no/such.exr"), image, &diag),
                     NEPH_ERR_IO);
    assert_non_null(strstr(diag.message, path));
    neph_assert_ok(neph_dir_create(scratch_path(state, path, "taken.exr/x"), NULL), NULL);
    assert_int_equal(neph_exr_write(scratch_path(state, path, "taken.exr"), image, &diag),
                     NEPH_ERR_IO);
    assert_int_equal(scratch_count(state), 1);
    neph_image_destroy(image);
}

/* ---- files written by other programs --------------------------------------------------------- */

enum {
    OTHER_WIDTH = 32, /* with 5, OpenEXRCore 3.1.5 itself writes a broken ZIPS file, see below */
    OTHER_HEIGHT = 35,
    OTHER_TILE = 16,
};

struct other_file {
    exr_storage_t storage;
    exr_compression_t compression;
    exr_pixel_type_t type;
    int part_count;
    bool upwards; /* the last chunk first */
    exr_attr_box2i_t window;
};

/* Sample values that half, float and uint represent exactly. */
static float other_value(int x, int y)
{
    return (float)(x + 7 * y);
}

static void encode_other_chunk(exr_context_t context, int part, const exr_chunk_info_t *chunk,
                               const float *pixels)
{
    exr_encode_pipeline_t encoder = EXR_ENCODE_PIPELINE_INITIALIZER;
    assert_int_equal(exr_encoding_initialize(context, part, chunk, &encoder), EXR_ERR_SUCCESS);
    uint32_t whole[OTHER_WIDTH * OTHER_HEIGHT];
    for (int i = 0; i < OTHER_WIDTH * OTHER_HEIGHT; i++)
        whole[i] = (uint32_t)pixels[i];
    /* The library converts float to half, but needs integers as integers. */
    bool is_uint = encoder.channels[0].data_type == EXR_PIXEL_UINT;
    encoder.channels[0].encode_from_ptr = is_uint ? (const uint8_t *)whole
                                                  : (const uint8_t *)pixels;
    encoder.channels[0].user_data_type = is_uint ? EXR_PIXEL_UINT : EXR_PIXEL_FLOAT;
    encoder.channels[0].user_bytes_per_element = 4;
    encoder.channels[0].user_pixel_stride = 4;
    encoder.channels[0].user_line_stride = 4 * OTHER_WIDTH;
    assert_int_equal(exr_encoding_choose_default_routines(context, part, &encoder),
                     EXR_ERR_SUCCESS);
    assert_int_equal(exr_encoding_run(context, part, &encoder), EXR_ERR_SUCCESS);
    exr_encoding_destroy(context, &encoder);
}

static void write_other_scanlines(exr_context_t context, int part, const struct other_file *other)
{
    float pixels[OTHER_WIDTH * OTHER_HEIGHT];
    int32_t rows = 0;
    assert_int_equal(exr_get_scanlines_per_chunk(context, part, &rows), EXR_ERR_SUCCESS);
    int chunk_count = (OTHER_HEIGHT + rows - 1) / rows;
    for (int i = 0; i < chunk_count; i++) {
        int top = (other->upwards ? chunk_count - 1 - i : i) * rows;
        for (int y = 0; y < rows && top + y < OTHER_HEIGHT; y++)
            for (int x = 0; x < OTHER_WIDTH; x++)
                pixels[y * OTHER_WIDTH + x] = other_value(x, top + y);
        exr_chunk_info_t chunk;
        assert_int_equal(
            exr_write_scanline_chunk_info(context, part, other->window.min.y + top, &chunk),
            EXR_ERR_SUCCESS);
        encode_other_chunk(context, part, &chunk, pixels);
    }
}

static void write_other_tile(exr_context_t context, int part, int column, int row)
{
    float pixels[OTHER_WIDTH * OTHER_HEIGHT] = {0};
    exr_chunk_info_t chunk;
    for (int y = 0; y < OTHER_TILE; y++)
        for (int x = 0; x < OTHER_TILE; x++)
            pixels[y * OTHER_WIDTH + x] = other_value(OTHER_TILE * column + x,
                                                      OTHER_TILE * row + y);
    assert_int_equal(exr_write_tile_chunk_info(context, part, column, row, 0, 0, &chunk),
                     EXR_ERR_SUCCESS);
    encode_other_chunk(context, part, &chunk, pixels);
}

static void write_other_tiles(exr_context_t context, int part)
{
    for (int row = 0; OTHER_TILE * row < OTHER_HEIGHT; row++)
        for (int column = 0; OTHER_TILE * column < OTHER_WIDTH; column++)
            write_other_tile(context, part, column, row);
}

static void declare_other_part(exr_context_t context, int part, const struct other_file *other)
{
    const exr_attr_v2f_t centre = {0};
    exr_attr_box2i_t window = other->window;
    assert_int_equal(exr_initialize_required_attr(
                         context, part, &window, &window, 1.0f, &centre, 1.0f,
                         other->upwards ? EXR_LINEORDER_RANDOM_Y : EXR_LINEORDER_INCREASING_Y,
                         other->compression),
                     EXR_ERR_SUCCESS);
    assert_int_equal(
        exr_add_channel(context, part, "Y", other->type, EXR_PERCEPTUALLY_LINEAR, 1, 1),
        EXR_ERR_SUCCESS);
    if (other->storage == EXR_STORAGE_TILED)
        assert_int_equal(exr_set_tile_descriptor(context, part, OTHER_TILE, OTHER_TILE,
                                                 EXR_TILE_ONE_LEVEL, EXR_TILE_ROUND_DOWN),
                         EXR_ERR_SUCCESS);
}

/* A file as another program would write it; the default window is at the origin. */
static void write_other(const char *path, struct other_file other)
{
    if (other.window.max.x == 0) {
        other.window.max.x = OTHER_WIDTH - 1;
        other.window.max.y = OTHER_HEIGHT - 1;
    }
    exr_context_initializer_t setup = EXR_DEFAULT_CONTEXT_INITIALIZER;
    exr_context_t context = NULL;
    assert_int_equal(exr_start_write(&context, path, EXR_WRITE_FILE_DIRECTLY, &setup),
                     EXR_ERR_SUCCESS);
    int part_count = other.part_count ? other.part_count : 1;
    for (int i = 0; i < part_count; i++) {
        int part = -1;
        const char *name = i ? "second" : "first";
        assert_int_equal(exr_add_part(context, name, other.storage, &part), EXR_ERR_SUCCESS);
        declare_other_part(context, part, &other);
    }
    assert_int_equal(exr_write_header(context), EXR_ERR_SUCCESS);
    for (int part = 0; part < part_count; part++) {
        if (other.storage == EXR_STORAGE_TILED)
            write_other_tiles(context, part);
        else
            write_other_scanlines(context, part, &other);
    }
    exr_finish(&context);
}

/* Finds `name`, a NUL, `type` and a NUL in the header; the value starts 4 bytes later. */
static char *attribute_value(char *data, size_t size, const char *name, const char *type)
{
    char key[64];
    size_t length = (size_t)snprintf(key, sizeof(key), "%s%c%s", name, 0, type) + 1;
    char *at = memmem(data, size, key, length);
    assert_non_null(at);
    return at + length + 4;
}

static void put_32(char *at, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        at[i] = (char)(value >> (8 * i));
}

/* Changes the value of an attribute in a file. */
static void patch(const char *path, const char *name, const char *type, size_t offset, char value)
{
    char *data = NULL;
    size_t size = 0;
    neph_assert_ok(neph_file_read(path, SIZE_MAX, &data, &size, NULL), NULL);
    attribute_value(data, size, name, type)[offset] = value;
    neph_assert_ok(neph_file_write(path, data, size, NULL), NULL);
    free(data);
}

static void assert_reads_other(const char *path)
{
    struct neph_image *image = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_exr_read(path, &image, &diag), &diag);
    assert_int_equal(image->width_px, OTHER_WIDTH);
    assert_int_equal(image->height_px, OTHER_HEIGHT);
    const float *samples = neph_image_channel(image, "Y");
    assert_non_null(samples);
    for (int y = 0; y < OTHER_HEIGHT; y++)
        for (int x = 0; x < OTHER_WIDTH; x++)
            assert_true(samples[y * OTHER_WIDTH + x] == other_value(x, y));
    assert_int_equal(image->attribute_count, 0); /* "name" and "type" belong to the format */
    neph_image_destroy(image);
}

static void test_reads_types_compressions_and_orders(void **state)
{
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "other.exr");
    for (int type = 0; type < EXR_PIXEL_LAST_TYPE; type++) {
        for (int compression = 0; compression <= EXR_COMPRESSION_PIZ; compression++) {
            for (int upwards = 0; upwards < 2; upwards++) {
                write_other(path, (struct other_file){.type = (exr_pixel_type_t)type,
                                                      .compression = (exr_compression_t)compression,
                                                      .upwards = upwards == 1});
                if (upwards) /* which 3.1.5 cannot write itself */
                    patch(path, "lineOrder", "lineOrder", 0, EXR_LINEORDER_DECREASING_Y);
                assert_reads_other(path);
            }
        }
    }
}

static void test_reads_tiles(void **state)
{
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "tiled.exr");
    for (int compression = 0; compression <= EXR_COMPRESSION_PIZ; compression++) {
        write_other(path, (struct other_file){.type = EXR_PIXEL_FLOAT,
                                              .storage = EXR_STORAGE_TILED,
                                              .compression = (exr_compression_t)compression});
        assert_reads_other(path);
    }
}

static void test_window_need_not_start_at_zero(void **state)
{
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "window.exr");
    struct other_file other = {.type = EXR_PIXEL_FLOAT, .compression = EXR_COMPRESSION_ZIP};
    other.window.min.x = -100; /* by name: OpenEXR 3.4 has no union here */
    other.window.min.y = -20;
    other.window.max.x = -100 + OTHER_WIDTH - 1;
    other.window.max.y = -20 + OTHER_HEIGHT - 1;
    write_other(path, other);
    assert_reads_other(path);
}

static void test_a_crop_says_where_it_lies(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_image *image = NULL;
    struct neph_diag diag = {0};
    scratch_path(state, path, "crop.exr");
    const struct other_file other = {.type = EXR_PIXEL_FLOAT, .compression = EXR_COMPRESSION_NONE};
    write_other(path, other);
    neph_assert_ok(neph_exr_read(path, &image, &diag), &diag);
    assert_null(neph_image_attribute(image, "crop"));
    neph_image_destroy(image);
    patch(path, "displayWindow", "box2i", 8, 119); /* max.x */
    neph_assert_ok(neph_exr_read(path, &image, &diag), &diag);
    char expected[64];
    snprintf(expected, sizeof(expected), "(0, 0) of 120x%d", OTHER_HEIGHT);
    assert_string_equal(neph_image_attribute(image, "crop"), expected);
    neph_image_destroy(image);
}

static void test_half_infinities_and_nan(void **state)
{
    char path[SCRATCH_PATH_MAX], *data = NULL;
    size_t size = 0;
    scratch_path(state, path, "half.exr");
    write_other(path,
                (struct other_file){.type = EXR_PIXEL_HALF, .compression = EXR_COMPRESSION_NONE});
    neph_assert_ok(neph_file_read(path, SIZE_MAX, &data, &size, NULL), NULL);
    /* The last row is at the end of an uncompressed file. */
    static const uint16_t halves[] = {0x7c00, 0xfc00, 0x7e01, 0x0001, 0x7bff};
    memcpy(data + size - sizeof(halves), halves, sizeof(halves));
    neph_assert_ok(neph_file_write(path, data, size, NULL), NULL);
    free(data);

    struct neph_image *image = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_exr_read(path, &image, &diag), &diag);
    const float *row = neph_image_channel(image, "Y") + OTHER_HEIGHT * OTHER_WIDTH - 5;
    assert_true(isinf(row[0]) && row[0] > 0.0f);
    assert_true(isinf(row[1]) && row[1] < 0.0f);
    assert_true(isnan(row[2]));
    assert_true(row[3] == 0x1p-24f);
    assert_true(row[4] == 65504.0f);
    neph_image_destroy(image);
}

static void test_other_kinds_are_refused_by_name(void **state)
{
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "kind.exr");
    write_other(path, (struct other_file){.part_count = 2, .type = EXR_PIXEL_FLOAT});
    assert_refused(path, NEPH_ERR_INPUT, "more than one flat part with colour");
    write_other(path, (struct other_file){.type = EXR_PIXEL_FLOAT});
    patch(path, "channels", "chlist", 2 + 8, 4); /* after "Y", its type and flags: x_sampling */
    assert_refused(path, NEPH_ERR_INPUT, "'Y' is subsampled by 4x1");
}

/* ---- broken files ---------------------------------------------------------------------------- */

/* A valid small file with attributes, as bytes. */
static char *good_file(void **state, size_t *size)
{
    char path[SCRATCH_PATH_MAX], *data = NULL;
    uint64_t random = 11;
    struct neph_image *image = make_frame(23, 37, &random);
    neph_assert_ok(neph_image_set_attribute(image, "neph.scene", NULL, "slab"), NULL);
    neph_assert_ok(neph_exr_write(scratch_path(state, path, "good.exr"), image, NULL), NULL);
    neph_assert_ok(neph_file_read(path, SIZE_MAX, &data, size, NULL), NULL);
    neph_image_destroy(image);
    return data;
}

static void test_missing_and_foreign_files(void **state)
{
    char path[SCRATCH_PATH_MAX];
    assert_refused(scratch_path(state, path, "none.exr"), NEPH_ERR_NOT_FOUND, "none.exr");
    assert_refused(scratch_path(state, path, ""), NEPH_ERR_IO, "Is a directory");
    neph_assert_ok(neph_file_write(scratch_path(state, path, "empty.exr"), "", 0, NULL), NULL);
    assert_refused(path, NEPH_ERR_INPUT, "not an OpenEXR file");
    const char png[] = "\x89PNG\r\n\x1a\n and so on";
    neph_assert_ok(neph_file_write(path, png, sizeof(png), NULL), NULL);
    assert_refused(path, NEPH_ERR_INPUT, "not an OpenEXR file");
}

static void test_deep_flag_is_refused(void **state)
{
    char path[SCRATCH_PATH_MAX];
    size_t size = 0;
    char *data = good_file(state, &size);
    data[5] |= 0x08;
    neph_assert_ok(neph_file_write(scratch_path(state, path, "deep.exr"), data, size, NULL), NULL);
    assert_refused(path, NEPH_ERR_INPUT, "deep");
    free(data);
}

static void test_dwa_is_refused_without_openimageio(void **state)
{
    char path[SCRATCH_PATH_MAX];
    size_t size = 0;
    char *data = good_file(state, &size);
    *attribute_value(data, size, "compression", "compression") = EXR_COMPRESSION_DWAA;
    neph_assert_ok(neph_file_write(scratch_path(state, path, "dwa.exr"), data, size, NULL), NULL);
    setenv("NEPH_IMAGE", "/nowhere", 1);
    assert_refused(path, NEPH_ERR_INPUT, "DWAA (code 8)");
    unsetenv("NEPH_IMAGE");
    free(data);
}

static void test_oversized_is_refused(void **state)
{
    char path[SCRATCH_PATH_MAX];
    size_t size = 0;
    char *data = good_file(state, &size);
    char *window = attribute_value(data, size, "dataWindow", "box2i");
    put_32(window + 8, NEPH_IMAGE_SIDE_MAX_PX); /* max.x: one column too many */
    neph_assert_ok(neph_file_write(scratch_path(state, path, "big.exr"), data, size, NULL), NULL);
    assert_refused(path, NEPH_ERR_INPUT, "16385x37 pixels");
    /* The largest allowed image, declared by a file of a few kilobytes. */
    put_32(window + 8, NEPH_IMAGE_SIDE_MAX_PX - 1);
    put_32(window + 12, NEPH_IMAGE_SIDE_MAX_PX - 1);
    neph_assert_ok(neph_file_write(path, data, size, NULL), NULL);
    assert_refused(path, NEPH_ERR_INPUT, "truncated or damaged");
    free(data);
}

enum { MANY_CHANNELS = 1024 };

/* The header of a file of many channels and the largest size, from a file of one pixel. Returns the
 * place of the table of chunks. */
static off_t write_large_header(const char *path)
{
    char name[8], *data = NULL;
    size_t size = 0, at = NEPH_EXR_PREFIX_BYTES;
    struct neph_image *image = NULL;
    struct neph_exr_attribute attribute;
    neph_assert_ok(neph_image_create(1, 1, &image, NULL), NULL);
    for (int i = 0; i < MANY_CHANNELS; i++) {
        snprintf(name, sizeof(name), "c%04d", i);
        neph_assert_ok(neph_image_add_channel(image, name, NULL, NULL), NULL);
    }
    neph_assert_ok(neph_exr_write(path, image, NULL), NULL);
    neph_image_destroy(image);
    neph_assert_ok(neph_file_read(path, SIZE_MAX, &data, &size, NULL), NULL);
    for (int corner = 8; corner <= 12; corner += 4) {
        put_32(attribute_value(data, size, "dataWindow", "box2i") + corner,
               NEPH_IMAGE_SIDE_MAX_PX - 1);
        put_32(attribute_value(data, size, "displayWindow", "box2i") + corner,
               NEPH_IMAGE_SIDE_MAX_PX - 1);
    }
    while (neph_exr_next_attribute(data, size, &at, &attribute))
        ;
    scratch_write(path, data, at + 1);
    free(data);
    return (off_t)at + 1;
}

/* Each chunk has the least size that the compression allows; the file is sparse. */
static void test_more_than_the_memory_is_refused(void **state)
{
    char path[SCRATCH_PATH_MAX];
    const int rows = 16, chunk_count = NEPH_IMAGE_SIDE_MAX_PX / rows;
    const int32_t chunk_bytes = NEPH_IMAGE_SIDE_MAX_PX / 2048 * MANY_CHANNELS * rows * 4;
    const off_t table = write_large_header(scratch_path(state, path, "large.exr"));
    const int fd = open(path, O_RDWR);
    for (int i = 0; i < chunk_count; i++) {
        const int64_t offset = table + 8 * chunk_count + (off_t)(chunk_bytes + 8) * i;
        const int32_t head[2] = {rows * i, chunk_bytes};
        assert_int_equal(pwrite(fd, &offset, 8, table + 8 * i), 8);
        assert_int_equal(pwrite(fd, head, 8, offset), 8);
        assert_int_equal(ftruncate(fd, offset + 8 + chunk_bytes), 0);
    }
    close(fd);
    assert_refused(path, NEPH_ERR_MEMORY, "needs 1024 GiB of memory");
}

/* No prefix of a valid file is accepted as valid. */
static void assert_prefixes_refused(void **state, const char *data, size_t size)
{
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "cut.exr");
    for (size_t length = 0; length < size; length += length < 1200 || length + 40 > size ? 1 : 97) {
        scratch_write(path, data, length);
        struct neph_image *image = NULL;
        struct neph_diag diag = {0};
        enum neph_status status = neph_exr_read(path, &image, &diag);
        if (status != NEPH_ERR_INPUT)
            print_error("%zu of %zu bytes: %s\n", length, size, neph_status_name(status));
        assert_int_equal(status, NEPH_ERR_INPUT);
        assert_non_null(strstr(diag.message, length < 8 ? "not an OpenEXR" : "is truncated"));
        assert_null(image);
    }
}

static void test_truncated_at_every_length(void **state)
{
    size_t size = 0;
    char *data = good_file(state, &size);
    assert_prefixes_refused(state, data, size);
    free(data);
}

static void test_truncated_tiles(void **state)
{
    char path[SCRATCH_PATH_MAX], *data = NULL;
    size_t size = 0;
    write_other(scratch_path(state, path, "tiled.exr"),
                (struct other_file){.type = EXR_PIXEL_HALF,
                                    .storage = EXR_STORAGE_TILED,
                                    .compression = EXR_COMPRESSION_ZIP});
    neph_assert_ok(neph_file_read(path, SIZE_MAX, &data, &size, NULL), NULL);
    assert_prefixes_refused(state, data, size);
    free(data);
}

/* Reads every sample, so that valgrind detects one that was never decoded. */
static size_t count_finite(const struct neph_image *image)
{
    size_t count = 0;
    for (int c = 0; c < image->channel_count; c++)
        for (size_t i = 0; i < neph_image_pixel_count(image); i++)
            count += isfinite(image->channels[c].samples[i]) ? 1 : 0;
    return count;
}

/* Reads arbitrary bytes, of several parts the second: no crash, and either an image or an error,
 * never both or neither. */
static void read_anything(const char *path, const char *data, size_t size)
{
    scratch_write(path, data, size);
    struct neph_image *image = NULL;
    struct neph_diag diag = {0};
    enum neph_status status = neph_exr_read_part(path, "second", NULL, &image, &diag);
    assert_true((status == NEPH_OK) == (image != NULL));
    assert_true(status == NEPH_OK || diag.message[0] != '\0');
    if (image)
        assert_true(count_finite(image) <=
                    neph_image_pixel_count(image) * (size_t)image->channel_count);
    neph_image_destroy(image);
}

static void test_random_garbage(void **state)
{
    char path[SCRATCH_PATH_MAX], data[4096];
    scratch_path(state, path, "garbage.exr");
    uint64_t random = test_seed();
    print_message("NEPH_TEST_SEED=%llu\n", (unsigned long long)random);
    for (int i = 0; i < 500; i++) {
        size_t size = neph_test_random(&random) % sizeof(data);
        for (size_t k = 0; k < size; k++)
            data[k] = (char)neph_test_random(&random);
        if (i % 2) /* passes the first check */
            memcpy(data, "\x76\x2f\x31\x01\x02\0\0\0", 8);
        read_anything(path, data, size);
    }
}

static void flip_bytes(const char *path, char *data, size_t size, size_t first, size_t last,
                       uint64_t *random)
{
    char *broken = malloc(size);
    memcpy(broken, data, size);
    int count = 1 + (int)(neph_test_random(random) % 4);
    for (int i = 0; i < count; i++) {
        size_t at = first + neph_test_random(random) % (last - first);
        broken[at] = (char)(broken[at] ^ (1 + neph_test_random(random) % 255));
    }
    read_anything(path, broken, size);
    free(broken);
}

static void test_flipped_bytes(void **state)
{
    char path[SCRATCH_PATH_MAX];
    size_t size = 0;
    char *data = good_file(state, &size);
    uint64_t random = test_seed();
    print_message("NEPH_TEST_SEED=%llu\n", (unsigned long long)random);
    scratch_path(state, path, "flipped.exr");
    for (int i = 0; i < 1500; i++) /* header and table of chunks */
        flip_bytes(path, data, size, 8, 700, &random);
    for (int i = 0; i < 500; i++)
        flip_bytes(path, data, size, 8, size, &random);
    free(data);
}

static void flip_other(const char *path, struct other_file other, uint64_t *random)
{
    char *data = NULL;
    size_t size = 0;
    write_other(path, other);
    neph_assert_ok(neph_file_read(path, SIZE_MAX, &data, &size, NULL), NULL);
    for (int i = 0; i < 400; i++)
        flip_bytes(path, data, size, 8, size, random);
    free(data);
}

static void test_flipped_bytes_in_every_compression(void **state)
{
    char path[SCRATCH_PATH_MAX];
    uint64_t random = test_seed();
    print_message("NEPH_TEST_SEED=%llu\n", (unsigned long long)random);
    scratch_path(state, path, "flipped.exr");
    for (int compression = 0; compression <= EXR_COMPRESSION_B44A; compression++)
        flip_other(path,
                   (struct other_file){.type = EXR_PIXEL_HALF,
                                       .compression = (exr_compression_t)compression},
                   &random);
}

static void test_flipped_bytes_of_tiles(void **state)
{
    char path[SCRATCH_PATH_MAX];
    uint64_t random = test_seed();
    print_message("NEPH_TEST_SEED=%llu\n", (unsigned long long)random);
    flip_other(scratch_path(state, path, "flipped.exr"),
               (struct other_file){.type = EXR_PIXEL_HALF,
                                   .storage = EXR_STORAGE_TILED,
                                   .compression = EXR_COMPRESSION_ZIP},
               &random);
}

static void test_flipped_bytes_of_parts(void **state)
{
    char path[SCRATCH_PATH_MAX];
    uint64_t random = test_seed();
    print_message("NEPH_TEST_SEED=%llu\n", (unsigned long long)random);
    flip_other(scratch_path(state, path, "flipped.exr"),
               (struct other_file){
                   .type = EXR_PIXEL_HALF, .part_count = 2, .compression = EXR_COMPRESSION_ZIP},
               &random);
}

/* The writer of a file chooses channel names, and messages display them. */
static void test_names_of_channels_are_fit_to_be_shown(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_image *written = NULL, *read = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_image_create(2, 1, &written, &diag), &diag);
    float *samples;
    neph_assert_ok(neph_image_add_channel(written, "mask.a\x1b[2J\xc2\x9b\xff", &samples, &diag),
                   &diag);
    samples[1] = 3.0f;
    neph_assert_ok(neph_exr_write(scratch_path(state, path, "named.exr"), written, &diag), &diag);
    neph_assert_ok(neph_exr_read(path, &read, &diag), &diag);
    const float *found = neph_image_channel(read, "mask.a\\x1b[2J\\u009b\\xff");
    assert_non_null(found);
    assert_true(found[1] == 3.0f);
    char controls[NEPH_IMAGE_NAME_MAX] = {0}; /* four times as long with escapes */
    memset(controls, '\x01', sizeof(controls) - 1);
    neph_assert_ok(neph_image_add_channel(written, controls, NULL, &diag), &diag);
    neph_assert_ok(neph_exr_write(path, written, &diag), &diag);
    assert_refused(path, NEPH_ERR_INPUT, "named.exr': channel name '\\x01");
    neph_image_destroy(written);
    neph_image_destroy(read);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        scratch_test(test_round_trip_is_bit_exact),
        scratch_test(test_chunks_that_do_not_shrink),
        scratch_test(test_smooth_image_is_compressed),
        scratch_test(test_same_image_gives_same_bytes),
        scratch_test(test_attributes_both_ways),
        scratch_test(test_long_channel_names),
        scratch_test(test_unwritable_images_are_refused),
        scratch_test(test_failed_write_keeps_the_old_file),
        scratch_test(test_reads_types_compressions_and_orders),
        scratch_test(test_reads_tiles),
        scratch_test(test_window_need_not_start_at_zero),
        scratch_test(test_a_crop_says_where_it_lies),
        scratch_test(test_half_infinities_and_nan),
        scratch_test(test_other_kinds_are_refused_by_name),
        scratch_test(test_missing_and_foreign_files),
        scratch_test(test_deep_flag_is_refused),
        scratch_test(test_dwa_is_refused_without_openimageio),
        scratch_test(test_oversized_is_refused),
        scratch_test(test_more_than_the_memory_is_refused),
        scratch_test(test_truncated_at_every_length),
        scratch_test(test_truncated_tiles),
        scratch_test(test_random_garbage),
        scratch_test(test_flipped_bytes),
        scratch_test(test_names_of_channels_are_fit_to_be_shown),
        scratch_test(test_flipped_bytes_in_every_compression),
        scratch_test(test_flipped_bytes_of_tiles),
        scratch_test(test_flipped_bytes_of_parts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
