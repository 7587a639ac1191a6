/* SPDX-License-Identifier: MIT */
#include "tests/base/scratch.h"

#include "base/image.h"
#include "base/png.h"

#include <png.h>

static uint64_t test_seed(void)
{
    const char *seed = getenv("NEPH_TEST_SEED");
    return seed ? strtoull(seed, NULL, 0) : 20240229;
}

static bool contains(const char *path, const char *chunk)
{
    char *data = NULL;
    size_t size = 0;
    neph_assert_ok(neph_file_read(path, SIZE_MAX, &data, &size, NULL), NULL);
    bool found = memmem(data, size, chunk, 4) != NULL;
    free(data);
    return found;
}

/* ---- writing --------------------------------------------------------------------------------- */

static void test_written_bytes_come_back(void **state)
{
    static const int sizes[][2] = {{1, 1}, {1, 7}, {7, 1}, {3, 5}, {253, 131}};
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "picture.png");
    uint64_t random = 1;
    for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++) {
        size_t count = (size_t)sizes[i][0] * (size_t)sizes[i][1] * 3;
        uint8_t *rgb = malloc(count), *back = malloc(count);
        for (size_t k = 0; k < count; k++)
            rgb[k] = (uint8_t)neph_test_random(&random);
        struct neph_diag diag = {0};
        neph_assert_ok(neph_png_write_rgb8(path, sizes[i][0], sizes[i][1], rgb, &diag), &diag);

        png_image picture = {.version = PNG_IMAGE_VERSION};
        assert_true(png_image_begin_read_from_file(&picture, path));
        assert_int_equal(picture.format, PNG_FORMAT_RGB); /* 8 bits, no alpha, no palette */
        assert_int_equal(picture.width, sizes[i][0]);
        assert_int_equal(picture.height, sizes[i][1]);
        assert_true(png_image_finish_read(&picture, NULL, back, 0, NULL));
        assert_memory_equal(rgb, back, count);
        assert_true(contains(path, "sRGB"));
        free(rgb);
        free(back);
    }
    assert_int_equal(scratch_count(state), 1);
}

static void test_what_cannot_be_written(void **state)
{
    static const int sizes[][2] = {{0, 1}, {1, 0}, {-1, 1}, {NEPH_IMAGE_SIDE_MAX_PX + 1, 1}};
    char path[SCRATCH_PATH_MAX];
    const uint8_t rgb[3] = {0};
    struct neph_diag diag = {0};
    scratch_path(state, path, "x.png");
    for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++)
        assert_int_equal(neph_png_write_rgb8(path, sizes[i][0], sizes[i][1], rgb, &diag),
                         NEPH_ERR_INPUT);
    scratch_path(state, path, "no/such.png");
    assert_int_equal(neph_png_write_rgb8(path, 1, 1, rgb, &diag), NEPH_ERR_IO);
    assert_non_null(strstr(diag.message, path));
    assert_int_equal(scratch_count(state), 0);
}

/* ---- reading --------------------------------------------------------------------------------- */

struct foreign {
    int width_px, height_px;
    int depth, colour_type;
    int interlace;
    double gamma; /* 0: no gAMA chunk */
};

/* A PNG as another program writes it. `bytes` holds its rows as they are in the file. */
static void write_foreign(const char *path, struct foreign foreign, const uint8_t *bytes)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, file);
    png_set_IHDR(png, info, (png_uint_32)foreign.width_px, (png_uint_32)foreign.height_px,
                 foreign.depth, foreign.colour_type, foreign.interlace, PNG_COMPRESSION_TYPE_BASE,
                 PNG_FILTER_TYPE_BASE);
    const png_color palette[2] = {{1, 2, 3}, {4, 5, 6}};
    if (foreign.colour_type == PNG_COLOR_TYPE_PALETTE)
        png_set_PLTE(png, info, palette, 2);
    if (foreign.gamma > 0.0)
        png_set_gAMA(png, info, foreign.gamma);
    png_write_info(png, info);
    int pass_count = png_set_interlace_handling(png);
    size_t row_bytes = png_get_rowbytes(png, info);
    for (int pass = 0; pass < pass_count; pass++)
        for (int y = 0; y < foreign.height_px; y++)
            png_write_row(png, bytes + (size_t)y * row_bytes);
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    fclose(file);
}

/* With whatever gamma the file claims, the numbers come as they are. */
static void test_code_values_are_raw(void **state)
{
    static const double gammas[] = {0.0, 1.0, 0.45455};
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "codes.png");
    enum { WIDTH = 67, HEIGHT = 41, COUNT = WIDTH * HEIGHT * 3 };
    uint8_t *bytes = malloc(2 * COUNT);
    uint64_t random = 2;
    for (int i = 0; i < 2 * COUNT; i++)
        bytes[i] = (uint8_t)neph_test_random(&random);
    memcpy(bytes, "\x00\x00\xff\xff\x00\x01", 6);
    for (size_t i = 0; i < sizeof(gammas) / sizeof(gammas[0]); i++) {
        for (int interlace = PNG_INTERLACE_NONE; interlace <= PNG_INTERLACE_ADAM7; interlace++) {
            write_foreign(
                path, (struct foreign){WIDTH, HEIGHT, 16, PNG_COLOR_TYPE_RGB, interlace, gammas[i]},
                bytes);
            int width_px = 0, height_px = 0;
            uint16_t *rgb = NULL;
            struct neph_diag diag = {0};
            neph_assert_ok(neph_png_read_rgb16(path, &width_px, &height_px, &rgb, &diag), &diag);
            assert_int_equal(width_px, WIDTH);
            assert_int_equal(height_px, HEIGHT);
            for (int k = 0; k < COUNT; k++)
                assert_int_equal(rgb[k], bytes[2 * k] << 8 | bytes[2 * k + 1]);
            free(rgb);
        }
    }
    free(bytes);
}

static void assert_refused(const char *path, enum neph_status expected, const char *words)
{
    int width_px = -1, height_px = -2;
    uint16_t *rgb = NULL;
    struct neph_diag diag = {0};
    enum neph_status status = neph_png_read_rgb16(path, &width_px, &height_px, &rgb, &diag);
    if (status != expected || !strstr(diag.message, words))
        print_error("%s: '%s' instead of '%s'\n", neph_status_name(status), diag.message, words);
    assert_int_equal(status, expected);
    assert_non_null(strstr(diag.message, words));
    assert_int_equal(width_px, -1);
    assert_int_equal(height_px, -2);
    assert_null(rgb);
}

static void test_other_kinds_are_refused_by_name(void **state)
{
    static const struct {
        int depth, colour_type;
        const char *words;
    } kinds[] = {
        {8, PNG_COLOR_TYPE_RGB, "8-bit RGB PNG"},
        {16, PNG_COLOR_TYPE_RGB_ALPHA, "16-bit RGB and alpha PNG"},
        {16, PNG_COLOR_TYPE_GRAY, "16-bit grey PNG"},
        {8, PNG_COLOR_TYPE_GRAY_ALPHA, "8-bit grey and alpha PNG"},
        {1, PNG_COLOR_TYPE_PALETTE, "1-bit palette PNG"},
    };
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "kind.png");
    const uint8_t bytes[64] = {0};
    for (size_t i = 0; i < sizeof(kinds) / sizeof(kinds[0]); i++) {
        write_foreign(path,
                      (struct foreign){.width_px = 2,
                                       .height_px = 2,
                                       .depth = kinds[i].depth,
                                       .colour_type = kinds[i].colour_type},
                      bytes);
        assert_refused(path, NEPH_ERR_INPUT, kinds[i].words);
    }
}

static void test_oversized_is_refused(void **state)
{
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "wide.png");
    int width_px = NEPH_IMAGE_SIDE_MAX_PX + 1;
    uint8_t *bytes = calloc((size_t)width_px, 6);
    write_foreign(
        path,
        (struct foreign){
            .width_px = width_px, .height_px = 1, .depth = 16, .colour_type = PNG_COLOR_TYPE_RGB},
        bytes);
    free(bytes);
    assert_refused(path, NEPH_ERR_INPUT, "damaged"); /* libpng's word for it follows */
}

static void test_missing_and_foreign_files(void **state)
{
    char path[SCRATCH_PATH_MAX];
    assert_refused(scratch_path(state, path, "none.png"), NEPH_ERR_NOT_FOUND, "none.png");
    assert_refused(scratch_path(state, path, ""), NEPH_ERR_IO, "cannot read");
    neph_assert_ok(neph_file_write(scratch_path(state, path, "x.png"), "", 0, NULL), NULL);
    assert_refused(path, NEPH_ERR_INPUT, "not a PNG");
    neph_assert_ok(neph_file_write(path, "P6 2 2 255 rest", 15, NULL), NULL);
    assert_refused(path, NEPH_ERR_INPUT, "not a PNG");
}

/* A good small file as bytes. */
static char *good_file(void **state, size_t *size)
{
    enum { WIDTH = 9, HEIGHT = 11 };
    char path[SCRATCH_PATH_MAX], *data = NULL;
    uint8_t bytes[WIDTH * HEIGHT * 6];
    uint64_t random = 4;
    for (size_t i = 0; i < sizeof(bytes); i++)
        bytes[i] = (uint8_t)neph_test_random(&random);
    write_foreign(scratch_path(state, path, "good.png"),
                  (struct foreign){WIDTH, HEIGHT, 16, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, 0.5},
                  bytes);
    neph_assert_ok(neph_file_read(path, SIZE_MAX, &data, size, NULL), NULL);
    return data;
}

static enum neph_status read_bytes(const char *path, const char *data, size_t size)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(data, 1, size, file), size);
    fclose(file);
    int width_px = 0, height_px = 0;
    uint16_t *rgb = NULL;
    struct neph_diag diag = {0};
    enum neph_status status = neph_png_read_rgb16(path, &width_px, &height_px, &rgb, &diag);
    assert_true((status == NEPH_OK) == (rgb != NULL));
    assert_true(status == NEPH_OK || diag.message[0] != '\0');
    free(rgb);
    return status;
}

static void test_truncated_at_every_length(void **state)
{
    char path[SCRATCH_PATH_MAX];
    size_t size = 0;
    char *data = good_file(state, &size);
    scratch_path(state, path, "cut.png");
    for (size_t length = 0; length < size; length++)
        assert_int_equal(read_bytes(path, data, length), NEPH_ERR_INPUT);
    free(data);
}

static void test_flipped_bytes_and_garbage(void **state)
{
    char path[SCRATCH_PATH_MAX];
    size_t size = 0;
    char *data = good_file(state, &size);
    char *broken = malloc(size);
    uint64_t random = test_seed();
    print_message("NEPH_TEST_SEED=%llu\n", (unsigned long long)random);
    scratch_path(state, path, "broken.png");
    for (int i = 0; i < 1000; i++) {
        memcpy(broken, data, size);
        size_t at = 8 + neph_test_random(&random) % (size - 8);
        broken[at] = (char)(broken[at] ^ (1 + neph_test_random(&random) % 255));
        read_bytes(path, broken, size);
        for (size_t k = 8; k < size; k++)
            broken[k] = (char)neph_test_random(&random);
        assert_int_equal(read_bytes(path, broken, size), NEPH_ERR_INPUT);
    }
    free(broken);
    free(data);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        scratch_test(test_written_bytes_come_back),
        scratch_test(test_what_cannot_be_written),
        scratch_test(test_code_values_are_raw),
        scratch_test(test_other_kinds_are_refused_by_name),
        scratch_test(test_oversized_is_refused),
        scratch_test(test_missing_and_foreign_files),
        scratch_test(test_truncated_at_every_length),
        scratch_test(test_flipped_bytes_and_garbage),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
