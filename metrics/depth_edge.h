/* SPDX-License-Identifier: MIT
 *
 * Steps of a depth map, their near and far sides, and pixels' distances to them. Depths are linear
 * and not negative; the sky is +inf. All images are row-major.
 */
#ifndef NEPH_METRICS_DEPTH_EDGE_H
#define NEPH_METRICS_DEPTH_EDGE_H

#include "base/status.h"

#include <stdint.h>

enum {
    NEPH_EDGE_DISTANCE_MAX_PX = 8,
    NEPH_THIN_SIDE_PX = 4, /* an object that contains a square of 4x4 px is not thin */
};

/* Each pixel's distance to the near and to the far side of depth edges. */
struct neph_edge_field {
    /* Chessboard distance (the larger of |dx| and |dy|) to the nearest edge pixel of each side, or
     * more than NEPH_EDGE_DISTANCE_MAX_PX; owned. */
    uint8_t *near_px, *far_px;
};

/* Mark with 1, in `near` or in `far`, the pixels with a step to a 4-neighbour: the farther depth is
 * more than `ratio` times the nearer one. The sky is infinitely far; two sky pixels make no step.
 * `near`: at its step with the largest ratio the pixel is the nearer one (also for equal ratios);
 * `far`: it is the farther one. Both arrays are completely written. */
void neph_edge_steps(const float *depth_m, int width_px, int height_px, double ratio, uint8_t *near,
                     uint8_t *far);

/* Compute the distances to both sides of all steps. Free with neph_edge_field_finish(). */
enum neph_status neph_edge_field_create(const float *depth_m, int width_px, int height_px,
                                        double ratio, struct neph_edge_field *field,
                                        struct neph_diag *diag);
void neph_edge_field_finish(struct neph_edge_field *field);

/* Mark thin objects with 1: every square of 4x4 px in the image that contains the pixel also
 * contains a pixel more than `ratio` times as far. (The pixel is nearer than the morphological
 * opening of nearness by that square. Images with a shorter side use narrower squares.) */
enum neph_status neph_mark_thin(const float *depth_m, int width_px, int height_px, double ratio,
                                uint8_t *thin, struct neph_diag *diag);

#endif
