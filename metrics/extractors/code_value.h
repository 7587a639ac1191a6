/* SPDX-License-Identifier: MIT
 *
 * Code values: pixels on a scale with perceptually similar steps, for metrics designed for display
 * codes (PSNR, SSIM).
 *   pu21     PU21 of absolute luminance, variant banding_glare (Mantiuk and Azimi, PU21: A novel
 *            perceptually uniform encoding for adapting existing quality metrics for HDR, PCS
 *            2021): Y = white_cd_per_m2 * 2^exposure_ev * luminance in cd/m2, clamped to
 *            0.005 .. 10000; 100 cd/m2 has the code 256.4, and 256 counts as the peak
 *   display  luma of the sRGB display (IEC 61966-2-1) on the 8-bit scale, not rounded:
 *            255 (0.2126 R' + 0.7152 G' + 0.0722 B'), X' the encoded 2^exposure_ev X clamped to
 *            0 .. 1; peak 255
 */
#ifndef NEPH_METRICS_EXTRACTORS_CODE_VALUE_H
#define NEPH_METRICS_EXTRACTORS_CODE_VALUE_H

#include "metrics/extractor.h"

enum neph_code_kind {
    NEPH_CODE_PU21,
    NEPH_CODE_DISPLAY,
    NEPH_CODE_COUNT,
};

struct neph_code;

/* Create a table in the arena. NEPH_ERR_MEMORY. */
enum neph_status neph_code_create(enum neph_code_kind kind, const struct neph_viewing *viewing,
                                  struct neph_arena *memory, struct neph_code **code,
                                  struct neph_diag *diag);

/* The peak of PSNR: 256 (pu21) or 255 (display). */
double neph_code_peak(enum neph_code_kind kind);

/* Codes of the pixels first .. first + count - 1 of finite R G B planes. The curve is a table of
 * polynomials, within 1e-10 codes of its definition. Thread-safe. */
void neph_code_pixels(const struct neph_code *code, const float *const planes[3], size_t first,
                      size_t count, double *codes);

#endif
