/* SPDX-License-Identifier: MIT */
#include "metrics/extractors/display_luma.h"

#include "metrics/metric.h"
#include "metrics/vector_math.h"

/* The threshold of IEC 61966-2-1 between its linear and its power segment. */
static const double step = 0.0031308;

/* c^(1/2.4) for step <= c <= 1, with relative error 1e-15: a guess y in single precision, then one
 * iteration on y^12 = c^5 in double precision. With s the eighth root of c the power is s^(10/3),
 * which is smooth over the little more than one octave of s. The polynomial interpolates it at
 * Chebyshev nodes, with error 2e-6; the iteration leaves the third power of twelve times that. A
 * third of the time of 2^(log2 / 2.4).
 */
static inline double power(double c)
{
    const float s = sqrtf(sqrtf(sqrtf((float)c)));
    float guess = -0.03211209798f;
    guess = guess * s + 0.296067642f;
    guess = guess * s + 0.8628263416f;
    guess = guess * s - 0.1551761795f;
    guess = guess * s + 0.03148311212f;
    guess = guess * s - 0.00308891466f;
    const double y = (double)guess;
    const double y3 = y * y * y, y6 = y3 * y3, c2 = c * c;
    const double h = c2 * c2 * c / (y6 * y6) - 1.0; /* (1 + h)^(1/12) = 1 + h/12 - 11/288 h^2 .. */
    return y + y * (h * (1.0 / 12.0 - 11.0 / 288.0 * h));
}

/* Compute both segments, so that the surrounding loop has no branch. */
static inline double encoded(double c)
{
    const double line = 12.92 * c;
    const double curve = 1.055 * power(c > step ? c : step) - 0.055;
    return c > step ? curve : line;
}

static inline double displayed(float channel, double gain)
{
    const double scaled = gain * (double)channel;
    const double positive = scaled > 0.0 ? scaled : 0.0;
    return positive < 1.0 ? positive : 1.0;
}

NEPH_VECTOR
static void convert(const float *restrict r, const float *restrict g, const float *restrict b,
                    size_t count, double gain, double *restrict luma, double *restrict luminance)
{
    for (size_t i = 0; i < count; i++) {
        const double red = displayed(r[i], gain);
        const double green = displayed(g[i], gain);
        const double blue = displayed(b[i], gain);
        luminance[i] = neph_luminance(red, green, blue);
        luma[i] = neph_luminance(encoded(red), encoded(green), encoded(blue));
    }
}

NEPH_VECTOR
static void convert_to_luma(const float *restrict r, const float *restrict g,
                            const float *restrict b, size_t count, double gain,
                            double *restrict luma)
{
    for (size_t i = 0; i < count; i++)
        luma[i] = neph_luminance(encoded(displayed(r[i], gain)), encoded(displayed(g[i], gain)),
                                 encoded(displayed(b[i], gain)));
}

void neph_display_luma(const float *const rgb[3], size_t count, double gain, double *luma,
                       double *luminance)
{
    if (luminance)
        convert(rgb[0], rgb[1], rgb[2], count, gain, luma, luminance);
    else
        convert_to_luma(rgb[0], rgb[1], rgb[2], count, gain, luma);
}

NEPH_VECTOR
static void encode_channel(const float *restrict channel, size_t count, double gain,
                           double *restrict codes)
{
    for (size_t i = 0; i < count; i++)
        codes[i] = encoded(displayed(channel[i], gain));
}

void neph_display_codes(const float *channel, size_t count, double gain, double *codes)
{
    encode_channel(channel, count, gain, codes);
}
