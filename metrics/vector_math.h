/* SPDX-License-Identifier: MIT
 *
 * Branch-free elementary functions in double precision. The compiler vectorises loops that call
 * them at -O3, which calls of libm would prevent (with -fno-trapping-math and -fno-math-errno, as
 * metrics/CMakeLists.txt sets them; no value depends on either). They consist only of additions,
 * multiplications, divisions and bit moves, and are never contracted (-ffp-contract=off), so every
 * clone, vector width and machine gives the same bits. They set no errno, and expect round to
 * nearest. The polynomials interpolate at Chebyshev nodes, with an error of 1e-16 on their
 * intervals.
 */
#ifndef NEPH_METRICS_VECTOR_MATH_H
#define NEPH_METRICS_VECTOR_MATH_H

#include <math.h>
#include <stdint.h>
#include <string.h>

/* Mark a function with loops to vectorise: the compiler makes three versions, for AVX-512, for AVX2
 * and for any x86-64, and the loader chooses one. Not under sanitizers, which do not support its
 * resolver. Such a function must not be `inline`. */
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && __GNUC__ >= 12 &&           \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define NEPH_VECTOR __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define NEPH_VECTOR
#endif

/* Mark an inner loop over a few lanes: GCC would fully unroll it before vectorisation, and then
 * find few vectors. */
#if defined(__GNUC__) && !defined(__clang__)
#define NEPH_LANES _Pragma("GCC unroll 1")
#else
#define NEPH_LANES
#endif

/* x + 1.5 * 2^52 - 1.5 * 2^52 is x rounded to the nearest integer for |x| < 2^51; the low bits of
 * the sum are that integer. */
#define NEPH_ROUNDER 0x1.8p52

static inline uint64_t neph_bits_from_double(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof(bits));
    return bits;
}

static inline double neph_double_from_bits(uint64_t bits)
{
    double x;
    memcpy(&x, &bits, sizeof(x));
    return x;
}

/* 2^k for an integer -1022 <= k <= 1023. */
static inline double neph_power_of_two(double k)
{
    return neph_double_from_bits((neph_bits_from_double(k + NEPH_ROUNDER) + 1023u) << 52);
}

/* Base-2 logarithm, also of denormals. Relative error below 1e-15. log2(0) = -inf, log2(+inf) =
 * +inf; NaN for x < 0 and for NaN. */
static inline double neph_log2(double x)
{
    const uint64_t to_range = 0x3ff0000000000000u - 0x3fe6a09e667f3bcdu; /* 1 - sqrt(1/2) in bits */
    const double lifted = x < 0x1p-1022 ? x * 0x1p54 : x;
    const double lift = x < 0x1p-1022 ? 54.0 : 0.0;

    /* x = 2^k m with m in [sqrt(1/2), sqrt(2)], so that log2 is small near x = 1, not 1 - small. */
    const uint64_t bits = neph_bits_from_double(lifted) + to_range;
    const double k = (neph_double_from_bits((bits >> 52) | 0x4330000000000000u) - 0x1p52) - 1023.0 -
                     lift;
    const double m = neph_double_from_bits((bits & 0x000fffffffffffffu) + 0x3fe6a09e667f3bcdu);

    /* log m = 2 atanh s; atanh s = s + s^3 r(s^2) */
    const double s = (m - 1.0) / (m + 1.0);
    const double z = s * s;
    double r = 0.07308224842521703;
    r = r * z + 0.07665860800278021;
    r = r * z + 0.09091444562630861;
    r = r * z + 0.1111110556739754;
    r = r * z + 0.14285714312987743;
    r = r * z + 0.19999999999949752;
    r = r * z + 0.3333333333333335;
    const double value = k + (s + s * (z * r)) * 2.8853900817779268; /* 2 / ln 2 */

    const double low = x == 0.0 ? -INFINITY : x < 0.0 ? NAN : value;
    return x <= 0x1.fffffffffffffp1023 ? low : x; /* +inf, NaN */
}

/* 2^y. Relative error below 1e-15 (denormal results: plus half their last place); 0 and +inf beyond
 * the range; NaN for NaN. */
static inline double neph_exp2(double y)
{
    const double above = y < -1080.0 ? -1080.0 : y;
    const double clamped = above > 1025.0 ? 1025.0 : above;
    const double k = (clamped + NEPH_ROUNDER) - NEPH_ROUNDER;
    const double f = clamped - k; /* -1/2 .. 1/2 */
    double p = 2.5729324177362305e-11;
    p = p * f + 4.4558179083360645e-10;
    p = p * f + 7.0548973041554995e-09;
    p = p * f + 1.0178057087733941e-07;
    p = p * f + 1.3215486808705563e-06;
    p = p * f + 1.5252733841556773e-05;
    p = p * f + 0.00015403530393370734;
    p = p * f + 0.001333355814640647;
    p = p * f + 0.00961812910762848;
    p = p * f + 0.055504108664821625;
    p = p * f + 0.24022650695910072;
    p = p * f + 0.6931471805599453;
    /* In two steps: 2^k itself may not be a double. */
    const double half = (0.5 * k + NEPH_ROUNDER) - NEPH_ROUNDER;
    return (1.0 + f * p) * neph_power_of_two(half) * neph_power_of_two(k - half);
}

/* Cube root of any sign, also of denormals. Relative error below 1e-15. +-0, +-inf and NaN are
 * returned unchanged. Without divisions, which would cost as much as everything else together. */
static inline double neph_cbrt(double x)
{
    const double size = fabs(x);
    const double scaled = size < 0x1p-1022 ? size * 0x1p54 : size; /* the guess needs an exponent */
    const double unscale = size < 0x1p-1022 ? 0x1p-18 : 1.0;

    /* Minus a third of the exponent is a first guess of 1 / cbrt, with an error of 3.4 % [as Kahan
     * 1991]; the bits are divided as a double, because there is no vector division of integers. */
    const double upper =
        neph_double_from_bits((neph_bits_from_double(scaled) >> 32) | 0x4330000000000000u) - 0x1p52;
    const double third = 1430186011.0 - upper * (1.0 / 3.0);
    double r = neph_double_from_bits(neph_bits_from_double(third + 0x1p52) << 32);

    /* With e = 1 - x r^3, 1 / cbrt x is r (1 - e)^(-1/3) and cbrt x is x r^2 (1 - e)^(-2/3), as far
     * as their series are needed: |e| is at most 0.103, and then 5e-6. */
    const double e = 1.0 - scaled * r * r * r;
    r += r * e * (1.0 / 3.0 + e * (2.0 / 9.0 + e * (14.0 / 81.0 + e * (35.0 / 243.0))));
    const double y = scaled * r * r;
    const double left = 1.0 - y * r;
    const double root = y + y * left * (2.0 / 3.0 + left * (5.0 / 9.0));
    const double value = copysign(root * unscale, x);
    return size > 0.0 && size <= 0x1.fffffffffffffp1023 ? value : x;
}

#endif
