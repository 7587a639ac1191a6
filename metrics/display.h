/* SPDX-License-Identifier: MIT
 *
 * Images for people: 8-bit sRGB from scene-linear Rec.709 through OpenColorIO, and colour maps of
 * signed differences and amounts. Measurements never use these images.
 */
#ifndef NEPH_METRICS_DISPLAY_H
#define NEPH_METRICS_DISPLAY_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Encode scene-linear Rec.709 planes for an sRGB display: times 2^exposure_ev, Rec.709 to CIE XYZ
 * (D65), XYZ to the sRGB display (IEC 61966-2-1), clamp, round to 8 bits. No tone curve.
 * - `out_rgb`: pixel_count * 3 bytes, interleaved.
 * - A pixel with a NaN becomes magenta (255, 0, 255), the colour in neph_display_legend. Per
 *   channel, +inf becomes white and -inf black.
 * - Errors: NEPH_ERR_INPUT for an exposure outside -64..64, NEPH_ERR_INTERNAL if OpenColorIO
 *   fails. */
enum neph_status neph_display_encode(const float *const rgb[3], size_t pixel_count,
                                     double exposure_ev, uint8_t *out_rgb, struct neph_diag *diag);

/* A colour at a position -1 .. 1; code values are interpolated linearly between stops. */
struct neph_display_stop {
    double position; /* (test - reference) / scale */
    uint8_t rgb[3];
};

/* The colours of a map, for its legend in a report. */
struct neph_display_legend {
    const struct neph_display_stop *stops; /* ascending from -1 to 1; static */
    int stop_count;
    uint8_t below[3];        /* beyond the scale, test darker */
    uint8_t above[3];        /* beyond the scale, test brighter */
    uint8_t not_a_number[3]; /* magenta */
};

const struct neph_display_legend *neph_display_difference_legend(void);

/* The colours of an amount, from 0 to the scale; see neph_display_map(). */
const struct neph_display_legend *neph_display_amount_legend(void);

/* neph_display_encode() as a table, for programs that cannot call it: thresholds[k] is the smallest
 * float that is encoded as code k or above, at 0 EV; thresholds[0] is -infinity. Each channel
 * depends only on itself, so the table is exact. Errors as of neph_display_encode(). */
enum neph_status neph_display_bake(float thresholds[256], struct neph_diag *diag);

/* Draw the map of test - reference: blue where the test is darker (or nearer), near-white where
 * equal, red where brighter (or farther), with separate colours for values beyond +-scale and for
 * NaN.
 * - `scale` is in the unit of the planes, finite and positive.
 * - `plane_count` 3: shows the Rec.709 luminance of the difference (a pure change of hue is
 *   invisible); a pixel that is not finite in either image counts as NaN.
 * - `plane_count` 1: shows the plane itself. +inf in both images is equal (sky); +inf in one of
 *   them is beyond the scale.
 * - `out_rgb`: pixel_count * 3 bytes, interleaved.
 * - Error: NEPH_ERR_INPUT for a bad scale. */
enum neph_status neph_display_difference(const float *const *reference, const float *const *test,
                                         int plane_count, size_t pixel_count, double scale,
                                         uint8_t *out_rgb, struct neph_diag *diag);

/* Draw a map of values on a fixed scale, finite and positive. A signed map has the colours of
 * neph_display_difference(). An amount goes from black at 0 to pale yellow at the scale, green
 * beyond. Teal is NaN: no value. Three planes are shown by their Rec.709 luminance. `out_rgb` as
 * above. Error: NEPH_ERR_INPUT for a bad scale. */
enum neph_status neph_display_map(const float *const *planes, int plane_count, size_t pixel_count,
                                  bool is_signed, double scale, uint8_t *out_rgb,
                                  struct neph_diag *diag);

#ifdef __cplusplus
}
#endif

#endif
