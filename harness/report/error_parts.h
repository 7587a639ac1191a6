/* SPDX-License-Identifier: MIT
 *
 * What the error of a frame's radiance is made of: noise, one offset of the whole picture, edges.
 * The report says from this where an engine is off, and why.
 */
#ifndef NEPH_HARNESS_REPORT_ERROR_PARTS_H
#define NEPH_HARNESS_REPORT_ERROR_PARTS_H

#include "base/image.h"

/* A pixel of the reference is at an edge when its luminance differs from that of one of its four
 * neighbours by more than this share of the mean luminance, or lies within that many pixels of such
 * a pixel. */
#define NEPH_EDGE_CONTRAST 0.1
#define NEPH_EDGE_REACH_PX 2

/* Shares of the mean squared error over pixels and channels, 0 .. 1; NaN: not known. They overlap:
 * noise is also at edges. */
struct neph_error_parts {
    double noise_share;      /* what two seeds differ by; may pass 1 by chance. NaN: one seed */
    double offset_share;     /* the squared mean difference of each channel */
    double edge_share;       /* of pixels at edges of the reference's luminance */
    double edge_pixel_share; /* of the pixels: how many are at edges */
};

/* A reference and an engine's frame, each with a second frame by another seed: the same image again
 * of a renderer that draws nothing, NULL where there is none. */
struct neph_error_frames {
    const struct neph_image *reference, *reference_second;
    const struct neph_image *test, *test_second;
};

/* Pixels that are not finite are left out. All parts are NaN where the frames do not differ or one
 * of them has no radiance. NEPH_ERR_INTERNAL: the frames have different sizes. */
enum neph_status neph_error_parts(const struct neph_error_frames *frames,
                                  struct neph_error_parts *parts, struct neph_diag *diag);

#endif
