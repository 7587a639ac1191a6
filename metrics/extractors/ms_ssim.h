/* SPDX-License-Identifier: MIT
 *
 * Multi-scale structural similarity as libvmaf defines it (Wang, Simoncelli and Bovik, Asilomar
 * 2003, equation 7). There are five scales, each half as large as the one before, after the
 * low-pass of the 9/7 wavelet. The index is the product of the mean contrast and structure at each
 * scale and of the mean luminance at the coarsest, to the powers 0.0448 0.2856 0.3001 0.2363
 * 0.1333.
 */
#ifndef NEPH_METRICS_EXTRACTORS_MS_SSIM_H
#define NEPH_METRICS_EXTRACTORS_MS_SSIM_H

#include "metrics/extractors/structure.h"

enum { NEPH_MS_SSIM_SIDE_MIN_PX = 176 }; /* the window of 11 px fits at a sixteenth of this */

/* Compute the index of two images of code values. `first`: the means at full size, from
 * neph_structure_compare(). On success `*undefined_because` is NULL and `*value` is in 0..1. Else
 * `*undefined_because` is the reason, a static string: a side is too short; or the mean structure
 * of a scale is negative, which has no power. */
enum neph_status neph_ms_ssim(const double *reference, const double *test, int width_px,
                              int height_px, double peak, const struct neph_structure *first,
                              const char **undefined_because, double *value,
                              struct neph_diag *diag);

/* Low-pass filter and keep every `factor`-th pixel of every `factor`-th row, from the first on.
 * The filter is separable, with `tap_count` (at most 64) weights; its middle, tap_count / 2, is
 * at the kept pixel. Beyond its border the image is mirrored with the border pixel repeated
 * (libvmaf's KBND_SYMMETRIC): no side may be shorter than tap_count. `out` has out_width_px x
 * out_height_px. */
enum neph_status neph_decimate(const double *image, int width_px, int height_px, const double *taps,
                               int tap_count, int factor, double *out, int out_width_px,
                               int out_height_px, struct neph_diag *diag);

#endif
