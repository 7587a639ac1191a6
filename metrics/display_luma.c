/* SPDX-License-Identifier: MIT */
#include "metrics/display_luma.h"

#include "metrics/metric.h"
#include "metrics/vector_math.h"

/* The step of IEC 61966-2-1 from a line to a power. */
static const double step = 0.0031308;

/* c^(1/2.4) for step <= c <= 1, to 4e-14 of itself. With s the eighth root of c it is s^(10/3):
 * smooth over the little more than an octave that s has, so that a polynomial of degree 13 does (it
 * meets the power at the Chebyshev nodes; u is s brought to -1 .. 1). Half the time of a logarithm.
 */
static inline double power(double c)
{
    const double s = sqrt(sqrt(sqrt(c)));
    const double u = 3.8937698126915965 * s - 2.8937698126915965;
    double p = -3.257062658187779e-11;
    p = p * u + 1.3951269179818796e-10;
    p = p * u - 5.085789500783201e-10;
    p = p * u + 2.434981332241103e-09;
    p = p * u - 1.2626018947211306e-08;
    p = p * u + 7.045410012065006e-08;
    p = p * u - 4.4466302569423707e-07;
    p = p * u + 3.377733074338181e-06;
    p = p * u - 3.518786870006947e-05;
    p = p * u + 0.0007636919350467158;
    p = p * u + 0.02651938396196613;
    p = p * u + 0.17266723371046325;
    p = p * u + 0.42827933875935015;
    p = p * u + 0.3718025465703988;
    return p;
}

/* Both sides of the step are worked out, so that the loop around has no branch. */
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

void neph_display_luma(const float *const rgb[3], size_t count, double gain, double *luma,
                       double *luminance)
{
    convert(rgb[0], rgb[1], rgb[2], count, gain, luma, luminance);
}
