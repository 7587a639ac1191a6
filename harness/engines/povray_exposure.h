/* SPDX-License-Identifier: MIT
 *
 * Reads numbers from POV-Ray's 16-bit images. POV-Ray has no float output (its EXR is half). One
 * monochrome render shows the same value three times at rising gains; further renders raise the
 * gain for pixels that are still too coarse. Each pixel keeps its finest reading.
 */
#ifndef NEPH_HARNESS_ENGINES_POVRAY_EXPOSURE_H
#define NEPH_HARNESS_ENGINES_POVRAY_EXPOSURE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The channels R, G, B of a bracketed render show 1, 8 and 64 times gain * value. */
#define NEPH_POVRAY_BRACKETS 3
extern const double neph_povray_bracket_scales[NEPH_POVRAY_BRACKETS];

/* Codes from here on may be clamped: 0.98 of full scale. */
#define NEPH_POVRAY_CLAMP_CODE 64224

/* The largest expected value is rendered at this part of full scale. */
#define NEPH_POVRAY_HEADROOM 0.9

/* A value, and its error: half the quantization step of the bracket that it was read from. Both in
 * the unit of the value. */
struct neph_povray_reading {
    double value;
    double error; /* +inf: clamped in all brackets; `value` is a lower bound */
};

/* Read one pixel of a bracketed render: the finest bracket that is not clamped. */
struct neph_povray_reading neph_povray_read_brackets(const uint16_t codes[NEPH_POVRAY_BRACKETS],
                                                     double gain);

/* The better of two readings of one pixel: the one with the smaller error. */
struct neph_povray_reading neph_povray_finer_reading(struct neph_povray_reading a,
                                                     struct neph_povray_reading b);

/* The required accuracy: error <= max(relative * value, absolute). */
struct neph_povray_target {
    double relative;
    double absolute;         /* in the unit of the value */
    double absolute_of_peak; /* absolute error, as a part of the largest value */
    /* Absolute error, as a part of the median; used if it is the smaller one. It preserves the
     * accuracy of normal pixels beside one very bright pixel. 0: unused. */
    double absolute_of_median;
};

/* The gain of the next render, or 0 if all readings meet the target. It falls if a pixel is
 * clamped; otherwise the brightest pixel that misses the target becomes nearly full scale. */
double neph_povray_next_gain(const struct neph_povray_reading *readings, size_t count, double gain,
                             const struct neph_povray_target *target);

/* Read a depth. It is written as three digits of base 256: R is coarse (depth / range), G and B use
 * the wrap of POV-Ray's pigment functions at 1. False: the sky, which is white. */
bool neph_povray_read_depth(const uint16_t codes[3], double range_m, double *depth_m);
#define NEPH_POVRAY_DEPTH_BASE 256
#define NEPH_POVRAY_DEPTH_TOP 0.9 /* depths stay below this part of the range; the sky is 1 */

#endif
