/* SPDX-License-Identifier: MIT
 *
 * Steps of a depth map, their sides, and what lies how far from them. Depths are linear and not
 * negative; the sky is +inf. All images are row-major.
 */
#ifndef NEPH_METRICS_DEPTH_EDGE_H
#define NEPH_METRICS_DEPTH_EDGE_H

#include "base/status.h"

#include <stdint.h>

enum {
    NEPH_EDGE_DISTANCE_MAX_PX = 8,
    NEPH_THIN_SIDE_PX = 4, /* nothing into which a square of 4x4 px fits is thin */
};

/* Which side of an edge a pixel is on, and how far from it. */
struct neph_edge_field {
    /* Chessboard distance (the larger of |dx| and |dy|) to the nearest edge pixel of each side, or
     * more than NEPH_EDGE_DISTANCE_MAX_PX; owned. */
    uint8_t *near_px, *far_px;
};

/* Mark with 1 in `near` or in `far` the pixels that have a step to one of their 4-neighbours: the
 * farther depth is more than `ratio` times the nearer one; the sky lies infinitely far, and not
 * beyond itself. `near`: the pixel is the nearer one at the step of the largest ratio that it has,
 * or at one of equal ratio; `far`: it is the farther one. Both arrays are written fully. */
void neph_edge_steps(const float *depth_m, int width_px, int height_px, double ratio, uint8_t *near,
                     uint8_t *far);

/* Distances to the steps of both sides. Free with _finish. */
enum neph_status neph_edge_field_create(const float *depth_m, int width_px, int height_px,
                                        double ratio, struct neph_edge_field *field,
                                        struct neph_diag *diag);
void neph_edge_field_finish(struct neph_edge_field *field);

/* Mark with 1 what is thin: every square of 4x4 px of the image that holds the pixel also holds
 * one that lies more than `ratio` times as far. (Nearer than the morphological opening of nearness
 * by that square. An image with a shorter side has narrower squares.) */
enum neph_status neph_mark_thin(const float *depth_m, int width_px, int height_px, double ratio,
                                uint8_t *thin, struct neph_diag *diag);

#endif
