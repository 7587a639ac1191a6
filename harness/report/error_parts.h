/* SPDX-License-Identifier: MIT
 *
 * Decomposition of a frame's radiance error: noise, a constant offset, edges. The report derives
 * the location and the cause of an error from it.
 */
#ifndef NEPH_HARNESS_REPORT_ERROR_PARTS_H
#define NEPH_HARNESS_REPORT_ERROR_PARTS_H

#include "base/image.h"

/* A pixel of the reference is an edge pixel when its luminance differs from a neighbour's (above,
 * below, left, right) by more than NEPH_EDGE_CONTRAST times the mean luminance. All pixels within
 * NEPH_EDGE_REACH_PX of an edge pixel belong to the edge as well. */
#define NEPH_EDGE_CONTRAST 0.1
#define NEPH_EDGE_REACH_PX 2

/* Shares of the mean squared error over pixels and channels, 0 .. 1; NaN: unknown. The shares
 * overlap: edges contain noise, too. */
struct neph_error_parts {
    double noise_share;      /* from the difference of two seeds; sampling may push it above 1. NaN:
                                one seed */
    double offset_share;     /* squared mean difference of each channel */
    double edge_share;       /* error at the edges of the reference */
    double edge_pixel_share; /* share of the pixels at edges */
};

/* A reference and an engine's frame, each with a frame of a second seed: the same image for a
 * deterministic renderer, NULL when there is none. */
struct neph_error_frames {
    const struct neph_image *reference, *reference_second;
    const struct neph_image *test, *test_second;
};

/* Pixels with NaN or infinite values are left out. All parts are NaN when the frames are equal or
 * one of them has no radiance. NEPH_ERR_INTERNAL: the frames have different sizes. */
enum neph_status neph_error_parts(const struct neph_error_frames *frames,
                                  struct neph_error_parts *parts, struct neph_diag *diag);

#endif
