/* SPDX-License-Identifier: MIT
 *
 * Floats packed for a page, unpacked as the page does it: bit-exact.
 */
#include "tests/neph_test.h"

#include "base/packed.h"

#include <sodium.h>
#include <zlib.h>

/* The page's side, only from the description in packed.h. */
static void open_packed(const char *text, size_t length, float *floats, size_t count)
{
    const size_t size = 4 * count;
    uint8_t *packed = malloc(length + 1), *bytes = malloc(size + 1);
    size_t packed_size = 0;
    uLongf opened = size + 1;
    assert_int_equal(sodium_base642bin(packed, length + 1, text, length, NULL, &packed_size, NULL,
                                       sodium_base64_VARIANT_ORIGINAL),
                     0);
    assert_int_equal(uncompress(bytes, &opened, packed, packed_size), Z_OK);
    assert_int_equal(opened, size);
    uint32_t bits = 0;
    for (size_t i = 0; i < count; i++) {
        bits += (uint32_t)bytes[i] << 24 | (uint32_t)bytes[count + i] << 16 |
                (uint32_t)bytes[2 * count + i] << 8 | (uint32_t)bytes[3 * count + i];
        memcpy(&floats[i], &bits, sizeof(bits));
    }
    free(packed);
    free(bytes);
}

/* Packs, unpacks, compares bits; returns the length of the text. */
static size_t there_and_back(const float *const *planes, int plane_count, size_t pixel_count)
{
    struct neph_diag diag = {0};
    char *text = NULL;
    size_t length = 0;
    const size_t count = (size_t)plane_count * pixel_count;
    float *floats = malloc(sizeof(float) * count);
    neph_assert_ok(neph_packed_floats(planes, plane_count, pixel_count, &text, &length, &diag),
                   &diag);
    assert_int_equal(strlen(text), length);
    open_packed(text, length, floats, count);
    for (int p = 0; p < plane_count; p++)
        assert_memory_equal(floats + (size_t)p * pixel_count, planes[p],
                            sizeof(float) * pixel_count);
    free(floats);
    free(text);
    return length;
}

static void test_all_bits_come_back(void **state)
{
    const float strange[] = {0.0f,     -0.0f, 1.0f,      -1.0f,    0x1p-149f, -0x1p-126f,
                             INFINITY, NAN,   -INFINITY, 0x1p127f, 1e-7f,     0.1f,
                             0.1f,     0.2f,  65504.0f,  1e30f,    -1e30f,    3.14159274f};
    const float *const planes[] = {strange, strange + COUNT(strange) / 2};
    there_and_back(planes, 2, COUNT(strange) / 2);
    there_and_back(planes, 1, 1);
}

/* The purpose of the byte order: a smooth image, and one of half floats. */
static void test_pictures_become_small(void **state)
{
    enum { PIXELS = 128 * 72 };
    static float smooth[PIXELS], halves[PIXELS];
    for (int i = 0; i < PIXELS; i++) {
        smooth[i] = 0.25f + 0.1f * sinf(0.03f * (float)(i % 128)) + 0.001f * (float)(i / 128);
        halves[i] = (float)((i * 7919) % 2048) / 1024.0f; /* noise, of 11 bits */
    }
    const float *const planes[] = {smooth, halves};
    const size_t raw = sizeof(smooth) * 4 / 3; /* as base64 */
    assert_true(there_and_back(&planes[0], 1, PIXELS) < raw * 3 / 4);
    assert_true(there_and_back(&planes[1], 1, PIXELS) < raw * 5 / 8);
}

#include "tests/main.h"
