/* SPDX-License-Identifier: MIT
 *
 * Colour profiles that are sRGB, and that are not.
 */
#include "base/icc.h"
#include "base/srgb.h"
#include "tests/neph_test.h"

#include <string.h>

enum { ROOM = 16384, ENTRIES = 1024 };

/* A profile under construction. */
struct profile {
    uint8_t bytes[ROOM];
    size_t size;
};

static void put_u32(struct profile *profile, size_t at, uint32_t value)
{
    for (size_t i = 0; i < 4; i++)
        profile->bytes[at + i] = (uint8_t)(value >> (24 - 8 * i));
}

static void put_fixed(struct profile *profile, size_t at, double value)
{
    put_u32(profile, at, (uint32_t)(int32_t)lround(value * 65536.0));
}

static void begin(struct profile *profile)
{
    *profile = (struct profile){.size = 128 + 4 + 12 * 8};
    memcpy(profile->bytes + 12, "mntrRGB XYZ ", 12);
    memcpy(profile->bytes + 36, "acsp", 4);
}

/* Reserve a tag; returns its place. */
static size_t add_tag(struct profile *profile, const char *name, const char *type, size_t size)
{
    const uint32_t count = profile->bytes[131];
    const size_t at = profile->size, row = 132 + 12 * (size_t)count;
    assert_true(count < 8 && at + size <= ROOM);
    memcpy(profile->bytes + row, name, 4);
    put_u32(profile, row + 4, (uint32_t)at);
    put_u32(profile, row + 8, (uint32_t)size);
    memcpy(profile->bytes + at, type, 4);
    profile->bytes[131]++;
    profile->size += size;
    return at;
}

/* The columns as the ICC's sRGB profiles have them, rounded to s15Fixed16; `shift` is added to the
 * luminance of green. */
static void add_columns(struct profile *profile, double shift)
{
    static const char *const names[] = {"rXYZ", "gXYZ", "bXYZ"};
    static const double columns[3][3] = {
        {0.43607, 0.22249, 0.01392}, {0.38515, 0.71687, 0.09708}, {0.14307, 0.06061, 0.71410}};
    for (int c = 0; c < 3; c++) {
        const size_t at = add_tag(profile, names[c], "XYZ ", 20);
        for (size_t i = 0; i < 3; i++)
            put_fixed(profile, at + 8 + 4 * i, columns[c][i] + (c == 1 && i == 1 ? shift : 0.0));
    }
}

static const char *const curves[] = {"rTRC", "gTRC", "bTRC"};

static void add_formulas(struct profile *profile, double exponent)
{
    const double parameters[] = {exponent, 1.0 / 1.055, 0.055 / 1.055, 1.0 / 12.92, 0.04045};
    for (int c = 0; c < 3; c++) {
        const size_t at = add_tag(profile, curves[c], "para", 32);
        profile->bytes[at + 9] = 3;
        for (size_t i = 0; i < 5; i++)
            put_fixed(profile, at + 12 + 4 * i, parameters[i]);
    }
}

static void add_tables(struct profile *profile)
{
    for (int c = 0; c < 3; c++) {
        const size_t at = add_tag(profile, curves[c], "curv", 12 + 2 * ENTRIES);
        put_u32(profile, at + 8, ENTRIES);
        for (size_t i = 0; i < ENTRIES; i++) {
            const double y = neph_srgb_to_linear((double)i / (ENTRIES - 1));
            const long code = lround(y * 65535.0);
            profile->bytes[at + 12 + 2 * i] = (uint8_t)(code >> 8);
            profile->bytes[at + 13 + 2 * i] = (uint8_t)code;
        }
    }
}

static void add_gammas(struct profile *profile, double exponent)
{
    for (int c = 0; c < 3; c++) {
        const size_t at = add_tag(profile, curves[c], "curv", 14);
        put_u32(profile, at + 8, 1);
        profile->bytes[at + 12] = (uint8_t)exponent;
        profile->bytes[at + 13] = (uint8_t)(256.0 * (exponent - floor(exponent)));
    }
}

static bool is_srgb(const struct profile *profile)
{
    return neph_icc_is_srgb(profile->bytes, profile->size);
}

static void test_srgb_in_formulas_and_in_tables(void **state)
{
    (void)state;
    struct profile profile;
    begin(&profile);
    add_columns(&profile, 0.0);
    add_formulas(&profile, 2.4);
    assert_true(is_srgb(&profile));
    begin(&profile);
    add_tables(&profile);
    add_columns(&profile, 0.0);
    assert_true(is_srgb(&profile));
    add_tag(&profile, "A2B0", "mft2", 64);
    assert_false(is_srgb(&profile));
}

static void test_other_curves_and_primaries(void **state)
{
    (void)state;
    static const double shifts[] = {2e-3, -2e-3}, gammas[] = {2.2, 1.0, 2.4};
    struct profile profile;
    for (size_t i = 0; i < 2; i++) {
        begin(&profile);
        add_columns(&profile, shifts[i]);
        add_formulas(&profile, 2.4);
        assert_false(is_srgb(&profile));
    }
    begin(&profile);
    add_columns(&profile, 0.0);
    add_formulas(&profile, 2.5);
    assert_false(is_srgb(&profile));
    for (size_t i = 0; i < 3; i++) {
        begin(&profile);
        add_columns(&profile, 0.0);
        add_gammas(&profile, gammas[i]);
        assert_false(is_srgb(&profile));
    }
}

/* Each shorter file, and each changed byte of the table of tags and of the heads of tags. */
static void test_damaged_profiles(void **state)
{
    (void)state;
    struct profile profile;
    begin(&profile);
    add_columns(&profile, 0.0);
    add_formulas(&profile, 2.4);
    for (size_t size = 0; size < profile.size; size++)
        assert_false(neph_icc_is_srgb(profile.bytes, size));
    for (size_t at = 128; at < profile.size; at++)
        for (int value = 0; value < 256; value += 51) {
            struct profile damaged = profile;
            damaged.bytes[at] = (uint8_t)value;
            is_srgb(&damaged); /* under the sanitizers */
        }
}

#include "tests/main.h"
