/* SPDX-License-Identifier: MIT */
#include "base/icc.h"

#include "base/chromaticities.h"
#include "base/srgb.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

/* Layout: ICC.1:2022, 7.2 (header), 7.3 (table of tags). */
enum {
    COLOUR_SPACE_AT = 16,
    CONNECTION_SPACE_AT = 20,
    SIGNATURE_AT = 36,
    HEADER_BYTES = 128,
    TAG_BYTES = 12,
    TAGS_MAX = 256,
};

static const double tolerance = 1e-3;

struct bytes {
    const uint8_t *start;
    size_t size;
};

static uint32_t read_u32(const uint8_t *b)
{
    return (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | (uint32_t)b[3];
}

static double read_u16(const uint8_t *b)
{
    return b[0] << 8 | b[1];
}

/* s15Fixed16Number, 4.6. */
static double read_fixed(const uint8_t *b)
{
    return (double)(int32_t)read_u32(b) / 65536.0;
}

/* The row of a tag in the table; NULL: there is none. */
static const uint8_t *find_row(struct bytes profile, const char *signature)
{
    const uint32_t count = read_u32(profile.start + HEADER_BYTES);
    const uint8_t *table = profile.start + HEADER_BYTES + 4;
    if (count > TAGS_MAX || count * TAG_BYTES > profile.size - HEADER_BYTES - 4)
        return NULL;
    for (uint32_t i = 0; i < count; i++)
        if (memcmp(table + (size_t)TAG_BYTES * i, signature, 4) == 0)
            return table + (size_t)TAG_BYTES * i;
    return NULL;
}

/* The data of a tag; size 0: there is none, or it is not inside the profile. */
static struct bytes find_tag(struct bytes profile, const char *signature)
{
    const uint8_t *row = find_row(profile, signature);
    const size_t at = row ? read_u32(row + 4) : 0, size = row ? read_u32(row + 8) : 0;
    if (at > profile.size || size > profile.size - at)
        return (struct bytes){NULL, 0};
    return (struct bytes){profile.start + at, size};
}

/* ---- the matrix ------------------------------------------------------------------------------ */

/* The matrix from linear sRGB to XYZ under the white of profiles. */
static void find_srgb_matrix(double matrix[3][3])
{
    double white[3], adapted[3][3];
    neph_xyz_from_xy(neph_rec709_chromaticities + 6, white);
    neph_matrix_adapt(white, neph_icc_white_xyz, adapted);
    neph_matrix_to_xyz(neph_rec709_chromaticities, matrix);
    neph_matrix_multiply(adapted, matrix, matrix);
}

static bool is_column(struct bytes tag, double matrix[3][3], int column)
{
    if (tag.size < 20 || memcmp(tag.start, "XYZ ", 4) != 0)
        return false;
    bool is_equal = true;
    for (int i = 0; i < 3; i++)
        is_equal &= fabs(read_fixed(tag.start + 8 + 4 * i) - matrix[i][column]) <= tolerance;
    return is_equal;
}

/* ---- curves ---------------------------------------------------------------------------------- */

/* Type curv, 10.6: a gamma, or a table with linear interpolation. */
static double evaluate_table(struct bytes tag, double x)
{
    const uint32_t count = tag.size >= 12 ? read_u32(tag.start + 8) : 0;
    const uint8_t *values = tag.start + 12;
    if (tag.size < 12 || count > (tag.size - 12) / 2)
        return NAN;
    if (count == 0)
        return x;
    if (count == 1)
        return pow(x, read_u16(values) / 256.0);
    const double place = x * (count - 1);
    const uint32_t below = (uint32_t)fmin(floor(place), count - 2.0);
    const double low = read_u16(values + 2 * (size_t)below),
                 high = read_u16(values + 2 * (size_t)below + 2);
    return (low + (high - low) * (place - below)) / 65535.0;
}

/* Type para, 10.18: Y = (a X + b)^g + e from X = d on, below it c X + f. */
static double evaluate_formula(struct bytes tag, double x)
{
    static const int counts[] = {1, 3, 4, 5, 7};
    double p[7] = {1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0}; /* g a b c d e f */
    const uint32_t type = tag.size >= 12 ? (uint32_t)read_u16(tag.start + 8) : 5;
    if (type > 4 || tag.size < 12 + 4 * (size_t)counts[type])
        return NAN;
    for (int i = 0; i < counts[type]; i++)
        p[i] = read_fixed(tag.start + 12 + 4 * i);
    if (type == 1 || type == 2) { /* the threshold is where a X + b is 0; below, Y = c */
        const double c = type == 2 ? p[3] : 0.0;
        return p[1] * x + p[2] >= 0.0 ? pow(p[1] * x + p[2], p[0]) + c : c;
    }
    return x >= p[4] ? pow(p[1] * x + p[2], p[0]) + p[5] : p[3] * x + p[6];
}

static bool is_srgb_curve(struct bytes tag)
{
    enum { SAMPLES = 1021 }; /* not on the nodes of tables of 1024 */
    static const double half_code = 0.5 / 255.0;
    const bool is_table = tag.size >= 4 && memcmp(tag.start, "curv", 4) == 0,
               is_formula = tag.size >= 4 && memcmp(tag.start, "para", 4) == 0;
    bool is_equal = is_table || is_formula;
    for (int i = 0; i <= SAMPLES && is_equal; i++) {
        const double x = (double)i / SAMPLES;
        const double y = is_table ? evaluate_table(tag, x) : evaluate_formula(tag, x);
        is_equal = fabs(y - neph_srgb_to_linear(x)) <= tolerance &&
                   fabs(neph_srgb_from_linear(y) - x) <= half_code; /* false for NaN */
    }
    return is_equal;
}

bool neph_icc_is_srgb(const void *data, size_t size)
{
    static const char *const columns[] = {"rXYZ", "gXYZ", "bXYZ"}, *const curves[] = {
                                                                       "rTRC", "gTRC", "bTRC"};
    const struct bytes profile = {data, size};
    if (size < HEADER_BYTES + 4 || memcmp(profile.start + SIGNATURE_AT, "acsp", 4) != 0 ||
        memcmp(profile.start + COLOUR_SPACE_AT, "RGB ", 4) != 0 ||
        memcmp(profile.start + CONNECTION_SPACE_AT, "XYZ ", 4) != 0 || find_row(profile, "A2B0"))
        return false;
    double matrix[3][3];
    bool is_srgb = true;
    find_srgb_matrix(matrix);
    for (int c = 0; c < 3 && is_srgb; c++)
        is_srgb = is_column(find_tag(profile, columns[c]), matrix, c) &&
                  is_srgb_curve(find_tag(profile, curves[c]));
    return is_srgb;
}
