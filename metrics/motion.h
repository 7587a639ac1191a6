/* SPDX-License-Identifier: MIT
 *
 * Exact motion vectors of what stands still under a camera that moves: from depth and the two
 * cameras alone. They are the layer motion of an image (image.h).
 */
#ifndef NEPH_METRICS_MOTION_H
#define NEPH_METRICS_MOTION_H

#include "base/status.h"

/* The camera of one frame: unit axes, right x up = -forward; square pixels. The pixel (i, j), row 0
 * on top, looks through (i + 0.5, j + 0.5). */
struct neph_motion_camera {
    double position_m[3];
    double right[3], up[3], forward[3];
    double vertical_fov_rad;
};

enum neph_motion_depth {
    NEPH_MOTION_EYE_DEPTH, /* along the axis of the camera: Z */
    NEPH_MOTION_DISTANCE,  /* along the ray: volume.distance */
    NEPH_MOTION_DEPTH_COUNT,
};

/* The motion of what was behind the camera before: out of any image. */
#define NEPH_MOTION_NOWHERE_PX 1e6f

/* Where what is seen in each pixel was in the frame before, minus where it is [px], x to the right,
 * y down. A depth of +inf is the sky, which moves by the rotation alone. `before_m` (may be NULL)
 * receives its depth in the frame before, of the same kind, +inf for the sky, 0 behind the camera:
 * the layer motion.depth. Planes of width * height, exact but for the rounding to float.
 * Errors: NEPH_ERR_INPUT when a depth is NaN or not above 0. */
enum neph_status neph_motion_of_depth(const struct neph_motion_camera *now,
                                      const struct neph_motion_camera *before, int width_px,
                                      int height_px, const float *depth_m,
                                      enum neph_motion_depth kind, float *x_px, float *y_px,
                                      float *before_m, struct neph_diag *diag);

#endif
