/* SPDX-License-Identifier: MIT
 *
 * Exact motion vectors of static objects under a moving camera, from depth and both cameras. They
 * are the layer motion of an image (image.h).
 */
#ifndef NEPH_METRICS_MOTION_H
#define NEPH_METRICS_MOTION_H

#include "base/status.h"

/* The camera of one frame: unit axes, right x up = -forward; square pixels. The centre of pixel (i,
 * j), row 0 on top, is (i + 0.5, j + 0.5). */
struct neph_motion_camera {
    double position_m[3];
    double right[3], up[3], forward[3];
    double vertical_fov_rad;
};

enum neph_motion_depth {
    NEPH_MOTION_EYE_DEPTH, /* along the camera axis: Z */
    NEPH_MOTION_DISTANCE,  /* along the ray: volume.distance */
    NEPH_MOTION_DEPTH_COUNT,
};

/* Motion of a point that was behind the camera: outside of any image. */
#define NEPH_MOTION_NOWHERE_PX 1e6f

/* Compute previous minus current position of each pixel's point [px], x to the right, y down. A
 * depth of +inf is the sky, which moves only with the rotation. `before_m` (may be NULL) receives
 * the depth in the previous frame, of the same kind, +inf for the sky, 0 behind the camera: the
 * layer motion.depth. Planes of width * height, exact up to the rounding to float. NEPH_ERR_INPUT:
 * a depth is NaN or not above 0. */
enum neph_status neph_motion_from_depth(const struct neph_motion_camera *now,
                                        const struct neph_motion_camera *before, int width_px,
                                        int height_px, const float *depth_m,
                                        enum neph_motion_depth kind, float *x_px, float *y_px,
                                        float *before_m, struct neph_diag *diag);

#endif
