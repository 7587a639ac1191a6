/* SPDX-License-Identifier: MIT
 *
 * TIFF and JPEG files that are whole, all their beginnings, and headers that lie.
 */
#include "tests/base/scratch.h"

#include <fcntl.h>

#include "base/whole.h"

enum { FILE_MAX = 1200, PIXEL_BYTES = 6 * 4 * 3, FIELDS = 12 };

/* A file in memory, in one of both byte orders. */
struct bytes {
    unsigned char data[FILE_MAX];
    size_t size;
    bool is_big_endian, is_big;
};

static void put(struct bytes *bytes, uint64_t number, size_t size)
{
    for (size_t i = 0; i < size; i++)
        bytes->data[bytes->size++] = (unsigned char)(number >>
                                                     8 * (bytes->is_big_endian ? size - 1 - i : i));
}

/* One image of 6x4 pixels of 3x8 bits, in strips of two rows or in one tile of 16x16 pixels. */
struct kind {
    bool is_big_endian, is_big, is_tiled, directory_first;
};

struct lie {
    uint64_t tag, value; /* this field has another value; tag 0: none */
};

static void put_field(struct bytes *bytes, const struct lie *lie, uint64_t tag, uint64_t type,
                      uint64_t count, uint64_t value)
{
    const size_t word = bytes->is_big ? 8 : 4, size = type == 3 ? 2 : word;
    put(bytes, tag, 2);
    put(bytes, type, 2);
    put(bytes, count, word);
    if (lie && lie->tag == tag)
        value = lie->value;
    put(bytes, value, count == 1 ? size : word); /* several values: their place */
    if (count == 1)
        put(bytes, 0, word - size);
}

/* The pieces' places and lengths are after the directory. */
static void put_directory(struct bytes *bytes, const struct kind *kind, const struct lie *lie,
                          uint64_t pixels_at)
{
    const size_t word = bytes->is_big ? 8 : 4, entry = 4 + 2 * word;
    const uint64_t places = bytes->size + (bytes->is_big ? 8 : 2) + FIELDS * entry + word;
    const uint64_t piece = kind->is_tiled ? 16 * 16 * 3 : PIXEL_BYTES / 2;
    const uint64_t count = kind->is_tiled ? 1 : 2, integer = bytes->is_big ? 16 : 4;
    put(bytes, FIELDS, bytes->is_big ? 8 : 2);
    put_field(bytes, lie, 256, 3, 1, 6);
    put_field(bytes, lie, 257, 3, 1, 4);
    put_field(bytes, lie, 258, 3, 1, 8);
    put_field(bytes, lie, 259, 3, 1, 1);
    put_field(bytes, lie, 262, 3, 1, 2);
    put_field(bytes, lie, kind->is_tiled ? 324 : 273, integer, count,
              count == 1 ? pixels_at : places);
    put_field(bytes, lie, 277, 3, 1, 3);
    put_field(bytes, lie, 278, 3, 1, 2);
    put_field(bytes, lie, kind->is_tiled ? 325 : 279, integer, count,
              count == 1 ? piece : places + 2 * word);
    put_field(bytes, lie, 284, 3, 1, 1);
    put_field(bytes, lie, 322, 3, 1, 16);
    put_field(bytes, lie, 323, 3, 1, 16);
    put(bytes, 0, word);
    for (uint64_t i = 0; i < 2; i++)
        put(bytes, pixels_at + i * piece, word);
    for (uint64_t i = 0; i < 2; i++)
        put(bytes, piece, word);
}

static void make_tiff(struct bytes *bytes, const struct kind *kind, const struct lie *lie)
{
    const size_t pixels = kind->is_tiled ? 16 * 16 * 3 : PIXEL_BYTES;
    const size_t head = kind->is_big ? 16 : 8, directory = 8 + FIELDS * 20 + 8 + 32;
    const size_t word = kind->is_big ? 8 : 4;
    *bytes = (struct bytes){.is_big_endian = kind->is_big_endian, .is_big = kind->is_big};
    memcpy(bytes->data, kind->is_big_endian ? "MM" : "II", 2);
    bytes->size = 2;
    put(bytes, kind->is_big ? 43 : 42, 2);
    if (kind->is_big)
        put(bytes, 8, 4); /* bytes of an offset, in two; and zero */
    if (kind->is_big && kind->is_big_endian)
        memcpy(bytes->data + 4, "\0\10\0\0", 4);
    put(bytes, kind->directory_first ? head : head + pixels, word);
    if (kind->directory_first) {
        put_directory(bytes, kind, lie, head + directory);
        bytes->size = head + directory + pixels;
    } else {
        bytes->size = head + pixels;
        put_directory(bytes, kind, lie, head);
    }
}

static enum neph_status check(void **state, const void *data, size_t size, struct neph_diag *diag)
{
    char path[SCRATCH_PATH_MAX];
    scratch_path(state, path, "file");
    scratch_write(path, data, size);
    const int fd = open(path, O_RDONLY | O_CLOEXEC);
    assert_true(fd >= 0);
    const enum neph_status status = neph_whole_check("it", fd, size, diag);
    close(fd);
    return status;
}

static struct kind find_kind(int i)
{
    return (struct kind){i & 1, i & 2, i & 4, i & 8};
}

static void test_tiff_and_all_its_beginnings(void **state)
{
    static struct bytes file;
    struct neph_diag diag = {0};
    for (int i = 0; i < 16; i++) {
        const struct kind kind = find_kind(i);
        make_tiff(&file, &kind, NULL);
        neph_assert_ok(check(state, file.data, file.size, &diag), &diag);
        /* The places and lengths after the last directory are used by strips. */
        const size_t unused = kind.directory_first || !kind.is_tiled ? 0 : kind.is_big ? 32 : 16;
        const size_t whole = file.size - unused;
        for (size_t size = 4; size < whole; size++)
            if (check(state, file.data, size, &diag) != NEPH_ERR_INPUT)
                fail_msg("kind %d: %zu of %zu bytes are accepted", i, size, file.size);
    }
}

static void test_tiff_that_lies(void **state)
{
    static const struct {
        struct lie lie;
        const char *words;
    } lies[] = {
        {{256, 16384}, "6384x4 pixels are 196608 bytes, and its strips have 72"},
        {{257, 5}, "6x5 pixels need 3 strips, and it has 2"},
        {{256, 20000}, "has a size of 20000x4 pixels; allowed are 1 to 16384 per side"},
        {{257, 0}, "has a size of 6x0 pixels"},
        {{277, 0}, "is damaged: 0 channels of 8 bits"},
        {{278, 0}, "is damaged: 3 channels of 8 bits in strips of 6x0 pixels"},
        {{258, 16}, "6x4 pixels are 144 bytes, and its strips have 72, compression 1"},
        {{273, 100000}, "its directory ends at byte"},
        {{279, 8}, "has no pixels in strip 0"},
    };
    static struct bytes file;
    for (size_t i = 0; i < COUNT(lies); i++) {
        struct neph_diag diag = {0};
        make_tiff(&file, &(struct kind){.is_big_endian = false}, &lies[i].lie);
        assert_int_equal(check(state, file.data, file.size, &diag), NEPH_ERR_INPUT);
        if (!strstr(diag.message, lies[i].words))
            fail_msg("'%s' is not in '%s'", lies[i].words, diag.message);
    }
    /* Deflate can hold 1,032 bytes in one, and JPEG any number. */
    static const struct {
        uint64_t width, compression;
        bool is_possible;
    } compressed[] = {{6000, 8, true}, {7000, 8, false}, {300, 32773, true}, {400, 32773, false}};
    for (size_t i = 0; i < COUNT(compressed); i++) {
        make_tiff(&file, &(struct kind){.is_big_endian = false},
                  &(struct lie){256, compressed[i].width});
        file.data[8 + PIXEL_BYTES + 2 + 3 * 12 + 8] = (unsigned char)compressed[i].compression;
        file.data[8 + PIXEL_BYTES + 2 + 3 * 12 + 9] = (unsigned char)(compressed[i].compression >>
                                                                      8);
        assert_int_equal(check(state, file.data, file.size, NULL),
                         compressed[i].is_possible ? NEPH_OK : NEPH_ERR_INPUT);
    }
}

/* A directory that is its own next one ends. */
static void test_tiff_in_a_circle(void **state)
{
    static struct bytes file;
    make_tiff(&file, &(struct kind){.is_big_endian = false}, NULL);
    const size_t next = 8 + PIXEL_BYTES + 2 + FIELDS * 12;
    file.data[next] = 8 + PIXEL_BYTES;
    assert_int_equal(check(state, file.data, file.size, NULL), NEPH_OK);
    file.data[next + 3] = 1; /* beyond the file */
    assert_int_equal(check(state, file.data, file.size, NULL), NEPH_ERR_INPUT);
}

/* An end-of-image marker in a thumbnail does not count, nor do codes that look like one. */
static void test_jpeg_and_all_its_beginnings(void **state)
{
    static const unsigned char file[] = {
        0xff, 0xd8, 0xff, 0xe1, 0,    6,    0xff, 0xda, 0xff, 0xd9, /* a segment with markers */
        0xff, 0xff, 0xda, 0,    4,    1,    2,    0x12, 0xff, 0,    /* fill byte; scan */
        0xff, 0xd0, 0xd9, 0xff, 0xc4, 0,    2,    0xff, 0xda, 0,    /* restart; second scan */
        2,    0x7f, 0xff, 0,    0xff, 0xd9,
    };
    struct neph_diag diag = {0};
    neph_assert_ok(check(state, file, sizeof(file), &diag), &diag);
    for (size_t size = 3; size < sizeof(file); size++)
        assert_int_equal(check(state, file, size, &diag), NEPH_ERR_INPUT);
    assert_non_null(strstr(diag.message, "'it' is truncated or damaged: its 35 bytes have no end"));
    static const unsigned char large[] = {0xff, 0xd8, 0xff, 0xc1, 0,    8, 8, 0x40, 0,
                                          0x40, 1,    0,    0xff, 0xda, 0, 2, 0xff, 0xd9};
    assert_int_equal(check(state, large, sizeof(large), &diag), NEPH_ERR_INPUT);
    assert_non_null(strstr(diag.message, "16385x16384 pixels in 18 bytes"));
    neph_assert_ok(check(state, "\x89PNG", 4, &diag), &diag); /* is not checked */
    neph_assert_ok(check(state, "", 0, &diag), &diag);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
#include "cases/test_whole.inc"
    };
    return cmocka_run_group_tests(tests, scratch_setup, scratch_teardown);
}
