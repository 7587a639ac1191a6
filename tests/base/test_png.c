/* SPDX-License-Identifier: MIT */
#include "tests/base/png_chunks.h"
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

/* Scaled to 16 bits, values are read back unchanged; the file has their colour space. */
static void test_16_bit_images_are_preserved(void **state)
{
    enum { wide = 37, high = 23, samples = 3 * wide * high };
    char path[SCRATCH_PATH_MAX];
    uint64_t random = 7;
    scratch_path(state, path, "deep.png");
    for (int bits = 10; bits <= 16; bits += 2)
        for (int hdr = 0; hdr < 2; hdr++) {
            static uint16_t rgb[samples];
            uint16_t *back;
            int width_px, height_px;
            struct neph_diag diag = {0};
            const uint32_t largest = (1u << bits) - 1;
            for (int i = 0; i < samples; i++)
                rgb[i] = (uint16_t)(neph_test_random(&random) & largest);
            neph_assert_ok(neph_png_write_rgb16(path, wide, high, bits,
                                                hdr ? NEPH_PNG_BT2020_PQ : NEPH_PNG_SRGB, rgb,
                                                &diag),
                           &diag);
            neph_assert_ok(neph_png_read_rgb16(path, &width_px, &height_px, &back, &diag), &diag);
            assert_int_equal(width_px * height_px, wide * high);
            for (int i = 0; i < samples; i++)
                assert_int_equal(((uint32_t)back[i] * largest + 32767) / 65535, rgb[i]);
            free(back);
            assert_true(contains(path, hdr ? "cICP" : "sRGB"));
            assert_true(contains(path, "sBIT"));
            /* Not an sRGB image: a reader of sRGB refuses it. */
            struct neph_image *image = NULL;
            assert_int_equal(neph_png_read_image(path, &image, &diag),
                             hdr ? NEPH_ERR_INPUT : NEPH_OK);
            neph_image_destroy(image);
        }
    assert_int_equal(scratch_count(state), 1);
}

static void test_unwritable_images_are_refused(void **state)
{
    static const int sizes[][2] = {{0, 1}, {1, 0}, {-1, 1}, {NEPH_IMAGE_SIDE_MAX_PX + 1, 1}};
    char path[SCRATCH_PATH_MAX];
    const uint8_t rgb[3] = {0};
    struct neph_diag diag = {0};
    scratch_path(state, path, "x.png");
    for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++) {
        assert_int_equal(neph_png_write_rgb8(path, sizes[i][0], sizes[i][1], rgb, &diag),
                         NEPH_ERR_INPUT);
        assert_int_equal(neph_png_write_rgb16(path, sizes[i][0], sizes[i][1], 10, NEPH_PNG_SRGB,
                                              (const uint16_t[3]){0}, &diag),
                         NEPH_ERR_INPUT);
    }
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
    double gamma;                                      /* 0: no gAMA chunk */
    void (*decorate)(png_structp png, png_infop info); /* adds chunks; NULL: none */
};

static void fill_palette(png_color palette[256])
{
    for (int i = 0; i < 256; i++)
        palette[i] = (png_color){(png_byte)(255 - i), (png_byte)(7 * i), (png_byte)(i ^ 0x55)};
}

/* A PNG as another program writes it. `bytes` are its rows as stored in the file. */
static void write_foreign(const char *path, struct foreign foreign, const uint8_t *bytes)
{
    png_color palette[256];
    fill_palette(palette);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, file);
    png_set_IHDR(png, info, (png_uint_32)foreign.width_px, (png_uint_32)foreign.height_px,
                 foreign.depth, foreign.colour_type, foreign.interlace, PNG_COMPRESSION_TYPE_BASE,
                 PNG_FILTER_TYPE_BASE);
    if (foreign.colour_type == PNG_COLOR_TYPE_PALETTE)
        png_set_PLTE(png, info, palette, 1 << foreign.depth);
    if (foreign.gamma > 0.0)
        png_set_gAMA(png, info, foreign.gamma);
    if (foreign.decorate)
        foreign.decorate(png, info);
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

/* For any gamma in the file, code values are returned unchanged. */
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
                path,
                (struct foreign){WIDTH, HEIGHT, 16, PNG_COLOR_TYPE_RGB, interlace, gammas[i], NULL},
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

/* Also of grey images, with a gamma and interlaced; those of colour are refused. */
static void test_grey_code_values_are_raw(void **state)
{
    enum { WIDTH = 13, HEIGHT = 7, COUNT = WIDTH * HEIGHT };
    char path[SCRATCH_PATH_MAX];
    uint8_t bytes[6 * COUNT];
    uint64_t random = 3;
    int width_px = 0, height_px = 0;
    uint16_t *grey = NULL;
    struct neph_diag diag = {0};
    scratch_path(state, path, "grey.png");
    for (int i = 0; i < 6 * COUNT; i++)
        bytes[i] = (uint8_t)neph_test_random(&random);
    write_foreign(path,
                  (struct foreign){WIDTH, HEIGHT, 16, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_ADAM7,
                                   0.45455, NULL},
                  bytes);
    neph_assert_ok(neph_png_read_grey16(path, &width_px, &height_px, &grey, &diag), &diag);
    assert_true(width_px == WIDTH && height_px == HEIGHT);
    for (int k = 0; k < COUNT; k++)
        assert_int_equal(grey[k], bytes[2 * k] << 8 | bytes[2 * k + 1]);
    free(grey);
    write_foreign(
        path,
        (struct foreign){
            .width_px = 2, .height_px = 2, .depth = 16, .colour_type = PNG_COLOR_TYPE_RGB},
        bytes);
    assert_int_equal(neph_png_read_grey16(path, &width_px, &height_px, &grey, &diag),
                     NEPH_ERR_INPUT);
    assert_non_null(strstr(diag.message, "a 16-bit RGB PNG; only 16-bit grey is read"));
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
    assert_refused(path, NEPH_ERR_INPUT, "damaged"); /* libpng's text follows */
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

/* A valid small file as bytes. */
static char *good_file(void **state, size_t *size)
{
    enum { WIDTH = 9, HEIGHT = 11 };
    char path[SCRATCH_PATH_MAX], *data = NULL;
    uint8_t bytes[WIDTH * HEIGHT * 6];
    uint64_t random = 4;
    for (size_t i = 0; i < sizeof(bytes); i++)
        bytes[i] = (uint8_t)neph_test_random(&random);
    write_foreign(
        scratch_path(state, path, "good.png"),
        (struct foreign){WIDTH, HEIGHT, 16, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, 0.5, NULL},
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

/* ---- images in linear light ------------------------------------------------------------------ */

/* The forward curve of IEC 61966-2-1:1999, 5.2, which the reader must invert. */
static double srgb_of_linear(double linear)
{
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1.0 / 2.4) - 0.055;
}

/* A float has 24 bits, and the curve is nowhere steeper than relative 1: 2^-24 of the value. The
 * standard's rounded constants join the two parts of the curve only to 3e-8. */
static void assert_linear(float linear, unsigned code, unsigned code_max)
{
    neph_assert_close(srgb_of_linear((double)linear), (double)code / code_max, 0x1p-23, 4e-8);
}

static struct neph_image *read_picture(const char *path, int width_px, int height_px)
{
    struct neph_image *image = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_png_read_image(path, &image, &diag), &diag);
    assert_int_equal(image->width_px, width_px);
    assert_int_equal(image->height_px, height_px);
    assert_int_equal(image->channel_count, 3);
    assert_string_equal(neph_image_attribute(image, "encoding"), "sRGB");
    return image;
}

static void assert_image_refused(const char *path, enum neph_status expected, const char *words)
{
    struct neph_image *image = NULL;
    struct neph_diag diag = {0};
    enum neph_status status = neph_png_read_image(path, &image, &diag);
    if (status != expected || !strstr(diag.message, words))
        print_error("%s: '%s' instead of '%s'\n", neph_status_name(status), diag.message, words);
    assert_int_equal(status, expected);
    assert_non_null(strstr(diag.message, words));
    assert_null(image);
    assert_int_equal(neph_png_read_image(path, &image, NULL), expected);
}

/* All codes of 8 and of 16 bits. */
static void test_every_code_is_undone(void **state)
{
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "ramp.png");
    uint8_t *bytes = malloc(65536 * 2);
    for (int depth = 8; depth <= 16; depth += 8) {
        const int side = 1 << (depth / 2);
        for (int code = 0; code < side * side; code++) {
            if (depth == 16)
                bytes[2 * code] = (uint8_t)(code >> 8);
            bytes[depth == 16 ? 2 * code + 1 : code] = (uint8_t)code;
        }
        write_foreign(path,
                      (struct foreign){.width_px = side,
                                       .height_px = side,
                                       .depth = depth,
                                       .colour_type = PNG_COLOR_TYPE_GRAY},
                      bytes);
        struct neph_image *image = read_picture(path, side, side);
        for (int c = 0; c < 3; c++)
            for (int code = 0; code < side * side; code++)
                assert_linear(image->channels[c].samples[code], (unsigned)code,
                              (unsigned)(side * side) - 1);
        assert_true(image->channels[0].samples[0] == 0.0f);
        assert_true(image->channels[0].samples[side * side - 1] == 1.0f);
        neph_image_destroy(image);
    }
    free(bytes);
}

static const struct kind {
    int depth, colour_type, channel_count;
} kinds[] = {
    {1, PNG_COLOR_TYPE_GRAY, 1},        {2, PNG_COLOR_TYPE_GRAY, 1},
    {4, PNG_COLOR_TYPE_GRAY, 1},        {8, PNG_COLOR_TYPE_GRAY, 1},
    {16, PNG_COLOR_TYPE_GRAY, 1},       {1, PNG_COLOR_TYPE_PALETTE, 1},
    {2, PNG_COLOR_TYPE_PALETTE, 1},     {4, PNG_COLOR_TYPE_PALETTE, 1},
    {8, PNG_COLOR_TYPE_PALETTE, 1},     {8, PNG_COLOR_TYPE_RGB, 3},
    {16, PNG_COLOR_TYPE_RGB, 3},        {8, PNG_COLOR_TYPE_GRAY_ALPHA, 2},
    {16, PNG_COLOR_TYPE_GRAY_ALPHA, 2}, {8, PNG_COLOR_TYPE_RGB_ALPHA, 4},
    {16, PNG_COLOR_TYPE_RGB_ALPHA, 4},
};

enum { KIND_COUNT = sizeof(kinds) / sizeof(kinds[0]) };

static size_t kind_row_bytes(struct kind kind, int width_px)
{
    return ((size_t)width_px * (size_t)(kind.depth * kind.channel_count) + 7) / 8;
}

/* Sample `index` of a row, in the packing of the PNG specification (7.2). */
static unsigned packed_sample(const uint8_t *row, int depth, int index)
{
    if (depth == 16)
        return (unsigned)(row[2 * index] << 8 | row[2 * index + 1]);
    const int bit = index * depth;
    return (unsigned)(row[bit / 8] >> (8 - depth - bit % 8)) & ((1u << depth) - 1);
}

static void set_alpha(struct kind kind, uint8_t *bytes, int pixel, unsigned alpha)
{
    const int sample_bytes = kind.depth / 8;
    const int at = (pixel * kind.channel_count + kind.channel_count - 1) * sample_bytes;
    for (int b = 0; b < sample_bytes; b++)
        bytes[at + b] = (uint8_t)(alpha >> (8 * (sample_bytes - 1 - b)));
}

static bool has_alpha(struct kind kind)
{
    return kind.colour_type & PNG_COLOR_MASK_ALPHA;
}

/* Random codes, but opaque. */
static uint8_t *random_rows(struct kind kind, int width_px, int height_px, uint64_t *random)
{
    const size_t size = kind_row_bytes(kind, width_px) * (size_t)height_px;
    uint8_t *bytes = malloc(size);
    for (size_t i = 0; i < size; i++)
        bytes[i] = (uint8_t)neph_test_random(random);
    for (int i = 0; has_alpha(kind) && i < width_px * height_px; i++)
        set_alpha(kind, bytes, i, 0xffff);
    return bytes;
}

static void assert_pixel(const struct neph_image *image, struct kind kind, const uint8_t *bytes,
                         int x, int y)
{
    const uint8_t *row = bytes + (size_t)y * kind_row_bytes(kind, image->width_px);
    const int color_count = kind.channel_count >= 3 ? 3 : 1;
    png_color palette[256];
    fill_palette(palette);
    for (int c = 0; c < 3; c++) {
        const unsigned code = packed_sample(row, kind.depth,
                                            x * kind.channel_count + (color_count == 3 ? c : 0));
        const png_byte entry[3] = {palette[code & 255].red, palette[code & 255].green,
                                   palette[code & 255].blue};
        const bool is_palette = kind.colour_type == PNG_COLOR_TYPE_PALETTE;
        assert_linear(image->channels[c].samples[y * image->width_px + x],
                      is_palette ? entry[c] : code, is_palette ? 255 : (1u << kind.depth) - 1);
    }
}

static void test_every_kind_is_read(void **state)
{
    static const int sizes[][2] = {{1, 1}, {1, 9}, {9, 1}, {13, 7}, {37, 19}};
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "kind.png");
    uint64_t random = 5;
    for (int i = 0; i < KIND_COUNT * 10; i++) {
        const struct kind kind = kinds[i / 10];
        const int *size = sizes[i % 5];
        const int interlace = i % 10 < 5 ? PNG_INTERLACE_NONE : PNG_INTERLACE_ADAM7;
        uint8_t *bytes = random_rows(kind, size[0], size[1], &random);
        write_foreign(
            path, (struct foreign){size[0], size[1], kind.depth, kind.colour_type, interlace, 0, 0},
            bytes);
        struct neph_image *image = read_picture(path, size[0], size[1]);
        for (int y = 0; y < size[1]; y++)
            for (int x = 0; x < size[0]; x++)
                assert_pixel(image, kind, bytes, x, y);
        neph_image_destroy(image);
        free(bytes);
    }
}

static void test_translucent_pixels_are_refused(void **state)
{
    enum { WIDTH = 5, HEIGHT = 4, PIXEL = 2 * WIDTH + 3 };
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "alpha.png");
    uint64_t random = 6;
    for (int i = 0; i < KIND_COUNT; i++) {
        if (!has_alpha(kinds[i]))
            continue;
        uint8_t *bytes = random_rows(kinds[i], WIDTH, HEIGHT, &random);
        set_alpha(kinds[i], bytes, PIXEL, kinds[i].depth == 16 ? 0xfffe : 0xfe);
        write_foreign(
            path, (struct foreign){WIDTH, HEIGHT, kinds[i].depth, kinds[i].colour_type, 0, 0, 0},
            bytes);
        assert_image_refused(path, NEPH_ERR_INPUT, "translucent (first at pixel (3, 2))");
        free(bytes);
    }
}

static void clear_grey_3(png_structp png, png_infop info)
{
    png_set_tRNS(png, info, NULL, 0, &(png_color_16){.gray = 3});
}

static void clear_colour_3(png_structp png, png_infop info)
{
    png_set_tRNS(png, info, NULL, 0, &(png_color_16){.red = 3, .green = 3, .blue = 3});
}

static void clear_entry_3(png_structp png, png_infop info)
{
    static const png_byte alpha[4] = {255, 255, 255, 0};
    png_set_tRNS(png, info, alpha, 4, NULL);
}

/* A colour that is declared transparent matters only if a pixel has it. */
static void test_clear_colours(void **state)
{
    static const struct {
        int depth, colour_type;
        void (*decorate)(png_structp png, png_infop info);
    } cases[] = {
        {8, PNG_COLOR_TYPE_GRAY, clear_grey_3},     {16, PNG_COLOR_TYPE_GRAY, clear_grey_3},
        {2, PNG_COLOR_TYPE_GRAY, clear_grey_3},     {8, PNG_COLOR_TYPE_RGB, clear_colour_3},
        {16, PNG_COLOR_TYPE_RGB, clear_colour_3},   {8, PNG_COLOR_TYPE_PALETTE, clear_entry_3},
        {2, PNG_COLOR_TYPE_PALETTE, clear_entry_3},
    };
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "clear.png");
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        /* 2 bits: pixels 0 0 0 0, then 0 0 0 3; wider: 0, then 3 in the very last sample. */
        const uint8_t without[6] = {0}, wide[6] = {0, 3, 0, 3, 0, 3},
                      narrow[6] = {3, 3, 3, 3, 3, 3};
        struct foreign foreign = {
            .width_px = cases[i].depth == 2 ? 4 : 1,
            .height_px = 1,
            .depth = cases[i].depth,
            .colour_type = cases[i].colour_type,
            .decorate = cases[i].decorate,
        };
        write_foreign(path, foreign, without);
        neph_image_destroy(read_picture(path, foreign.width_px, 1));
        write_foreign(path, foreign, cases[i].depth == 16 ? wide : narrow);
        assert_image_refused(path, NEPH_ERR_INPUT, "translucent");
    }
}

static void say_srgb(png_structp png, png_infop info)
{
    png_set_sRGB_gAMA_and_cHRM(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
}

static void say_rec709_primaries(png_structp png, png_infop info)
{
    png_set_gAMA_fixed(png, info, 45455);
    png_set_cHRM_fixed(png, info, 31271, 32902, 64000, 33000, 30000, 60000, 15000, 6000);
}

static void say_p3_primaries(png_structp png, png_infop info)
{
    png_set_cHRM_fixed(png, info, 31270, 32900, 68000, 32000, 26500, 69000, 15000, 6000);
}

static void say_linear(png_structp png, png_infop info)
{
    png_set_gAMA_fixed(png, info, 100000);
}

/* A minimal profile that passes libpng's checks: header, no tags. */
static void embed_profile(png_structp png, png_infop info)
{
    uint8_t profile[132] = {
        [3] = 132,   [8] = 4,     [12] = 'm', [13] = 'n',  [14] = 't', [15] = 'r',
        [16] = 'R',  [17] = 'G',  [18] = 'B', [19] = ' ',  [20] = 'X', [21] = 'Y',
        [22] = 'Z',  [23] = ' ',  [36] = 'a', [37] = 'c',  [38] = 's', [39] = 'p',
        [70] = 0xf6, [71] = 0xd6, [73] = 1,   [78] = 0xd3, [79] = 0x2d};
    png_set_iCCP(png, info, "Display P3", 0, profile, sizeof(profile));
}

static void add_cicp(png_structp png, png_infop info, const uint8_t data[4])
{
    png_unknown_chunk chunk = {
        .name = "cICP", .data = (png_bytep)data, .size = 4, .location = PNG_HAVE_IHDR};
    png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_ALWAYS, NULL, 0);
    png_set_unknown_chunks(png, info, &chunk, 1);
}

static void say_cicp_srgb(png_structp png, png_infop info)
{
    add_cicp(png, info, (const uint8_t[4]){1, 13, 0, 1});
}

static void say_cicp_pq(png_structp png, png_infop info)
{
    add_cicp(png, info, (const uint8_t[4]){9, 16, 0, 1});
}

static void test_only_srgb_is_taken_for_srgb(void **state)
{
    static const struct {
        void (*decorate)(png_structp png, png_infop info);
        const char *refused; /* NULL: it can be read */
    } cases[] = {
        {NULL, NULL},
        {say_srgb, NULL},
        {say_rec709_primaries, NULL},
        {say_cicp_srgb, NULL},
        {say_p3_primaries, "cHRM"},
        {say_linear, "its gAMA is 1.00000, not 0.45455"},
        {embed_profile, "the colour profile 'Display P3'"},
        {say_cicp_pq, "cICP"},
    };
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "colour.png");
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        const uint8_t bytes[3] = {1, 2, 3};
        write_foreign(
            path, (struct foreign){1, 1, 8, PNG_COLOR_TYPE_RGB, 0, 0.0, cases[i].decorate}, bytes);
        if (cases[i].refused)
            assert_image_refused(path, NEPH_ERR_INPUT, cases[i].refused);
        else
            neph_image_destroy(read_picture(path, 1, 1));
    }
}

/* Programs round densities to unequal numbers. */
static void say_density(png_structp png, png_infop info)
{
    png_set_pHYs(png, info, 2834, 2835, PNG_RESOLUTION_METER);
}

static void test_the_density_has_no_effect(void **state)
{
    char path[SCRATCH_PATH_MAX];
    const uint8_t bytes[3] = {1, 2, 3};
    scratch_path(state, path, "density.png");
    write_foreign(path, (struct foreign){1, 1, 8, PNG_COLOR_TYPE_RGB, 0, 0.0, say_density}, bytes);
    struct neph_image *image = read_picture(path, 1, 1);
    assert_null(neph_image_attribute(image, "pixel_aspect"));
    neph_image_destroy(image);
}

/* A damaged gAMA, even one that libpng would drop with a warning, is not accepted as sRGB. */
static void test_damaged_colour_chunk_is_refused(void **state)
{
    char path[SCRATCH_PATH_MAX], *data = NULL;
    size_t size = 0;
    const uint8_t bytes[3] = {1, 2, 3};
    scratch_path(state, path, "colour.png");
    write_foreign(path, (struct foreign){1, 1, 8, PNG_COLOR_TYPE_RGB, 0, 0.45455, NULL}, bytes);
    neph_assert_ok(neph_file_read(path, SIZE_MAX, &data, &size, NULL), NULL);
    char *gamma = memmem(data, size, "gAMA", 4);
    assert_non_null(gamma);
    gamma[7] = 0; /* the checksum is wrong now */
    scratch_write(path, data, size);
    assert_image_refused(path, NEPH_ERR_INPUT, "damaged");
    free(data);
}

/* Some hundred bytes that declare 16384x16384 pixels: refused before memory is allocated. */
static void test_small_file_of_a_huge_image(void **state)
{
    char path[SCRATCH_PATH_MAX], *data = NULL;
    size_t size = 0;
    uint8_t *bytes = calloc(NEPH_IMAGE_SIDE_MAX_PX, 3);
    scratch_path(state, path, "huge.png");
    write_foreign(path,
                  (struct foreign){NEPH_IMAGE_SIDE_MAX_PX, 1, 8, PNG_COLOR_TYPE_RGB, 0, 0, NULL},
                  bytes);
    free(bytes);
    neph_image_destroy(read_picture(path, NEPH_IMAGE_SIDE_MAX_PX, 1));
    neph_assert_ok(neph_file_read(path, SIZE_MAX, &data, &size, NULL), NULL);
    memcpy(data + 20, "\0\0\x40\0", 4); /* the height: 16384 */
    png_mend_checksums((uint8_t *)data, size);
    scratch_write(path, data, size);
    assert_image_refused(path, NEPH_ERR_INPUT, "cannot hold 16384x16384 pixels");
    free(data);
}

static void test_damaged_images(void **state)
{
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "broken.png");
    uint64_t random = test_seed();
    for (int i = 0; i < KIND_COUNT; i++) {
        char *data = NULL;
        size_t size = 0;
        uint8_t *bytes = random_rows(kinds[i], 11, 5, &random);
        write_foreign(path,
                      (struct foreign){11, 5, kinds[i].depth, kinds[i].colour_type, i % 2, 0, 0},
                      bytes);
        neph_assert_ok(neph_file_read(path, SIZE_MAX, &data, &size, NULL), NULL);
        for (size_t length = 0; length < size; length++) {
            scratch_write(path, data, length);
            assert_image_refused(path, NEPH_ERR_INPUT, path);
        }
        for (size_t at = 0; at < size; at++) {
            const char good = data[at];
            data[at] = (char)(good ^ (1 << neph_test_random(&random) % 8));
            scratch_write(path, data, size);
            assert_image_refused(path, NEPH_ERR_INPUT, path); /* every byte has a checksum */
            data[at] = good;
        }
        free(data);
        free(bytes);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        scratch_test(test_written_bytes_come_back),
        scratch_test(test_16_bit_images_are_preserved),
        scratch_test(test_unwritable_images_are_refused),
        scratch_test(test_code_values_are_raw),
        scratch_test(test_grey_code_values_are_raw),
        scratch_test(test_other_kinds_are_refused_by_name),
        scratch_test(test_oversized_is_refused),
        scratch_test(test_missing_and_foreign_files),
        scratch_test(test_truncated_at_every_length),
        scratch_test(test_flipped_bytes_and_garbage),
        scratch_test(test_every_code_is_undone),
        scratch_test(test_every_kind_is_read),
        scratch_test(test_translucent_pixels_are_refused),
        scratch_test(test_clear_colours),
        scratch_test(test_only_srgb_is_taken_for_srgb),
        scratch_test(test_the_density_has_no_effect),
        scratch_test(test_damaged_colour_chunk_is_refused),
        scratch_test(test_small_file_of_a_huge_image),
        scratch_test(test_damaged_images),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
