/* SPDX-License-Identifier: MIT
 *
 * Multi-scale structural similarity as libvmaf defines it (Wang, Simoncelli and Bovik, Asilomar
 * 2003, equation 7). Of five scales each is half the one before, behind the low-pass of the 9/7
 * wavelet. The index is the product of the mean contrast and structure at each scale and of the
 * mean luminance at the coarsest, to the powers 0.0448 0.2856 0.3001 0.2363 0.1333.
 */
#ifndef NEPH_METRICS_EXTRACTORS_MS_SSIM_H
#define NEPH_METRICS_EXTRACTORS_MS_SSIM_H

#include "metrics/extractors/structure.h"

enum { NEPH_MS_SSIM_SIDE_MIN_PX = 176 }; /* the window of 11 px still fits at a sixteenth */

/* The index of two images of code values. `first` are the means at full size, which the caller has
 * from neph_structure_compare(). `*undefined_because` receives NULL and `*value` a number of 0..1;
 * or the reason, a static string: a side is too short; the mean structure of a scale is negative,
 * and has no power. */
enum neph_status neph_ms_ssim(const double *reference, const double *test, int width_px,
                              int height_px, double peak, const struct neph_structure *first,
                              const char **undefined_because, double *value,
                              struct neph_diag *diag);

/* Low-pass and keep every `factor`-th pixel of every `factor`-th row, from the first. The filter is
 * separable, of `tap_count` (at most 64) weights whose middle, tap_count / 2, lies on the pixel
 * kept. Beyond its border the image is mirrored, the last pixel twice (libvmaf's KBND_SYMMETRIC):
 * no side may be shorter than tap_count. `out` has out_width_px x out_height_px. */
enum neph_status neph_decimate(const double *image, int width_px, int height_px, const double *taps,
                               int tap_count, int factor, double *out, int out_width_px,
                               int out_height_px, struct neph_diag *diag);

#endif
