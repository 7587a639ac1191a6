/* SPDX-License-Identifier: MIT
 *
 * Code values by a fast table. Two powers for each pixel of each image would take longer than all
 * other measurements. So a curve is split into pieces of equal ratio (32 per octave); each piece is
 * a polynomial of degree 5 through the curve at Chebyshev nodes. Piece and position come from the
 * bits of a double.
 */
#include "metrics/extractors/code_value.h"

#include "metrics/vector_math.h"

#include <math.h>
#include <stdint.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_CODE_COUNT == 2, "a new kind");

enum {
    DEGREE = 5,
    PIECE_BITS = 5, /* bits of the mantissa that select the piece within its octave */
    MANTISSA_BITS = 52,
    OCTAVES_MAX = 22,
    PIECES_MAX = (OCTAVES_MAX << PIECE_BITS),
    CHUNK_PX = 256, /* pixels per step, so that intermediate values stay in the L1 cache */
};

struct curve {
    double low, high; /* values are clamped to this range */
    double peak;
    double (*of)(double value); /* defined on low .. high, and smooth one piece beyond */
};

/* ---- the curves ------------------------------------------------------------------------------ */

static double encode_pu21(double luminance_cd_per_m2)
{
    static const double p[7] = {0.353487901,   0.3734658629, 8.277049286e-05, 0.9062562627,
                                0.09150303166, 0.9099517204, 596.3148142};
    double power = pow(luminance_cd_per_m2, p[3]);
    return p[6] * (pow((p[0] + p[1] * power) / (1.0 + p[2] * power), p[4]) - p[5]);
}

/* Only the power segment of sRGB, which begins at the end of the linear segment. */
static double encode_srgb_power(double display_value)
{
    return 255.0 * (1.055 * pow(display_value, 1.0 / 2.4) - 0.055);
}

static const double srgb_break = 0.0031308;
static const double srgb_slope = 255.0 * 12.92;

static const struct curve curves[] = {
    [NEPH_CODE_PU21] = {0.005, 1e4, 256.0, encode_pu21},
    [NEPH_CODE_DISPLAY] = {0.0031308, 1.0, 255.0, encode_srgb_power},
};

double neph_code_peak(enum neph_code_kind kind)
{
    return curves[kind].peak;
}

/* ---- the table ------------------------------------------------------------------------------- */

struct neph_code {
    enum neph_code_kind kind;
    double gain; /* factor from the quantity to the curve's input */
    double low, high;
    uint64_t first_piece;
    double pieces[PIECES_MAX][DEGREE + 1]; /* in s = -1/2 .. 1/2 across the piece */
};

/* Interpolate by Newton's divided differences at Chebyshev nodes; returns the monomial
 * coefficients. */
static void fit_piece(double (*of)(double), double start, double end, double *coefficients)
{
    double node[DEGREE + 1], difference[DEGREE + 1];
    for (int i = 0; i <= DEGREE; i++) {
        node[i] = 0.5 * cos(M_PI * (i + 0.5) / (DEGREE + 1));
        difference[i] = of(start + (node[i] + 0.5) * (end - start));
    }
    for (int order = 1; order <= DEGREE; order++)
        for (int i = DEGREE; i >= order; i--)
            difference[i] = (difference[i] - difference[i - 1]) / (node[i] - node[i - order]);
    for (int i = 0; i <= DEGREE; i++)
        coefficients[i] = 0.0;
    for (int i = DEGREE; i >= 0; i--) { /* coefficients = coefficients (s - node) + difference */
        for (int k = DEGREE; k > 0; k--)
            coefficients[k] = coefficients[k - 1] - node[i] * coefficients[k];
        coefficients[0] = difference[i] - node[i] * coefficients[0];
    }
}

static void fit(struct neph_code *code, const struct curve *curve)
{
    enum { SHIFT = MANTISSA_BITS - PIECE_BITS };
    code->first_piece = neph_bits_from_double(curve->low) >> SHIFT;
    uint64_t last_piece = neph_bits_from_double(curve->high) >> SHIFT;
    for (uint64_t piece = code->first_piece; piece <= last_piece; piece++)
        fit_piece(curve->of, neph_double_from_bits(piece << SHIFT),
                  neph_double_from_bits((piece + 1) << SHIFT),
                  code->pieces[piece - code->first_piece]);
}

enum neph_status neph_code_create(enum neph_code_kind kind, const struct neph_viewing *viewing,
                                  struct neph_arena *memory, struct neph_code **code,
                                  struct neph_diag *diag)
{
    struct neph_code *created = neph_arena_allocate(memory, 1, sizeof(*created));
    if (!created)
        return neph_fail_memory(diag);
    created->kind = kind;
    created->gain = exp2(viewing->exposure_ev);
    if (kind == NEPH_CODE_PU21)
        created->gain *= viewing->white_cd_per_m2;
    created->low = curves[kind].low;
    created->high = curves[kind].high;
    fit(created, &curves[kind]);
    *code = created;
    return NEPH_OK;
}

/* ---- pixels ---------------------------------------------------------------------------------- */

/* Evaluate the table at values within low .. high. */
static void look_up(const struct neph_code *code, const double *values, size_t count, double *codes)
{
    const uint64_t one = (uint64_t)1023 << MANTISSA_BITS;
    const uint64_t mantissa = ((uint64_t)1 << MANTISSA_BITS) - 1;
    for (size_t i = 0; i < count; i++) {
        uint64_t bits = neph_bits_from_double(values[i]);
        const double *c = code->pieces[(bits >> (MANTISSA_BITS - PIECE_BITS)) - code->first_piece];
        double s = neph_double_from_bits(((bits << PIECE_BITS) & mantissa) | one) - 1.5;
        double s2 = s * s;
        codes[i] = (c[0] + c[1] * s) + s2 * ((c[2] + c[3] * s) + s2 * (c[4] + c[5] * s));
    }
}

NEPH_VECTOR static void scale_and_clamp(const struct neph_code *code, const float *plane,
                                        size_t count, double *values)
{
    const double gain = code->gain, low = code->low, high = code->high;
    for (size_t i = 0; i < count; i++) {
        double value = gain * (double)plane[i];
        value = value > low ? value : low;
        values[i] = value < high ? value : high;
    }
}

NEPH_VECTOR static void luminance_and_clamp(const struct neph_code *code, const float *r,
                                            const float *g, const float *b, size_t count,
                                            double *values)
{
    const double gain = code->gain, low = code->low, high = code->high;
    for (size_t i = 0; i < count; i++) {
        double value = gain * neph_luminance((double)r[i], (double)g[i], (double)b[i]);
        value = value > low ? value : low;
        values[i] = value < high ? value : high;
    }
}

static void pu21_pixels(const struct neph_code *code, const float *const planes[3], size_t first,
                        size_t count, double *codes)
{
    double values[CHUNK_PX];
    luminance_and_clamp(code, planes[0] + first, planes[1] + first, planes[2] + first, count,
                        values);
    look_up(code, values, count, codes);
    for (size_t i = 0; i < count; i++)
        codes[i] = codes[i] > 0.0 ? codes[i] : 0.0;
}

static void display_pixels(const struct neph_code *code, const float *const planes[3], size_t first,
                           size_t count, double *codes)
{
    static const double weight[3] = {0.2126, 0.7152, 0.0722};
    double values[CHUNK_PX], encoded[CHUNK_PX];
    for (size_t i = 0; i < count; i++)
        codes[i] = 0.0;
    for (int c = 0; c < 3; c++) {
        scale_and_clamp(code, planes[c] + first, count, values);
        look_up(code, values, count, encoded);
        for (size_t i = 0; i < count; i++) {
            double value = code->gain * (double)planes[c][first + i];
            double straight = srgb_slope * (value > 0.0 ? value : 0.0);
            codes[i] += weight[c] * (value <= srgb_break ? straight : encoded[i]);
        }
    }
}

void neph_code_pixels(const struct neph_code *code, const float *const planes[3], size_t first,
                      size_t count, double *codes)
{
    for (size_t done = 0; done < count; done += CHUNK_PX) {
        size_t part = count - done < CHUNK_PX ? count - done : CHUNK_PX;
        if (code->kind == NEPH_CODE_PU21)
            pu21_pixels(code, planes, first + done, part, codes + done);
        else
            display_pixels(code, planes, first + done, part, codes + done);
    }
}
