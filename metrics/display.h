/* SPDX-License-Identifier: MIT
 *
 * Pictures for people: 8-bit sRGB from scene-linear Rec.709 through OpenColorIO, and maps of signed
 * differences. Numbers are never taken from these.
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
 * `out_rgb` holds pixel_count * 3 bytes, interleaved. A pixel with a NaN comes out magenta (255, 0,
 * 255), the colour of neph_display_legend; +inf is white, -inf black, per channel.
 * Errors: NEPH_ERR_INPUT when the exposure is outside -64..64, NEPH_ERR_INTERNAL when OpenColorIO
 * refuses. */
enum neph_status neph_display_encode(const float *const rgb[3], size_t pixel_count,
                                     double exposure_ev, uint8_t *out_rgb, struct neph_diag *diag);

/* A colour at a position -1 .. 1; between two stops the code values are linear. */
struct neph_display_stop {
    double position; /* (test - reference) / scale */
    uint8_t rgb[3];
};

/* What a report needs to draw the legend of a difference map. */
struct neph_display_legend {
    const struct neph_display_stop *stops; /* ascending from -1 to 1; static */
    int stop_count;
    uint8_t below[3];        /* beyond the scale, test darker */
    uint8_t above[3];        /* beyond the scale, test brighter */
    uint8_t not_a_number[3]; /* magenta */
};

const struct neph_display_legend *neph_display_difference_legend(void);

/* The colours of an amount, from 0 to 1 times the scale: see neph_display_map(). */
const struct neph_display_legend *neph_display_amount_legend(void);

/* neph_display_encode() baked for programs that cannot call it: thresholds[k] is the least float
 * that comes out as code k or above, at 0 EV; thresholds[0] is -infinity. A channel depends on
 * itself alone, so this is all of it, exactly. Errors as there. */
enum neph_status neph_display_bake(float thresholds[256], struct neph_diag *diag);

/* The map of test - reference: blue where the test is darker (or nearer), near-white where equal,
 * red where brighter (or farther), with colours of their own for values beyond +-scale and for
 * NaN. The scale is in the unit of the planes and finite and positive.
 * `plane_count` 3: the Rec.709 luminance of the difference is shown (a pure change of hue is not
 * seen here), and a pixel that is not finite in either image counts as NaN. `plane_count` 1: the
 * plane itself; +inf in both images is equal (sky), in one of them it is beyond the scale.
 * `out_rgb` holds pixel_count * 3 bytes, interleaved. Error: NEPH_ERR_INPUT for a bad scale. */
enum neph_status neph_display_difference(const float *const *reference, const float *const *test,
                                         int plane_count, size_t pixel_count, double scale,
                                         uint8_t *out_rgb, struct neph_diag *diag);

/* The picture of a map of values on a fixed scale, finite and positive: a signed one in the colours
 * of neph_display_difference(); an amount from black at 0 to pale yellow at the scale, and green
 * beyond. Teal: NaN, there is no value. Three planes are shown by their Rec.709 luminance.
 * `out_rgb` as above. Error: NEPH_ERR_INPUT for a bad scale. */
enum neph_status neph_display_map(const float *const *planes, int plane_count, size_t pixel_count,
                                  bool is_signed, double scale, uint8_t *out_rgb,
                                  struct neph_diag *diag);

#ifdef __cplusplus
}
#endif

#endif
