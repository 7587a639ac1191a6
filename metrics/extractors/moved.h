/* SPDX-License-Identifier: MIT
 *
 * Reprojection for metrics: the position of a pixel's point in the previous frame, from exact
 * motion vectors, and whether it was visible there.
 *
 * motion.x, motion.y: previous minus current position [px], x to the right, y down. Depth is Z of
 * the image with the motion; for the sky, and where a medium hides the background, it is
 * volume.distance if that is finite. The expected depth in the previous frame is motion.depth, or
 * else the current depth; in the latter case a surface that approaches by more than the tolerance
 * per frame counts as disoccluded. Depths are stored as nearness, 1 / depth [1/m]: it is 0 for the
 * sky, and linear over the image of a plane.
 */
#ifndef NEPH_METRICS_EXTRACTORS_MOVED_H
#define NEPH_METRICS_EXTRACTORS_MOVED_H

#include "metrics/extractor.h"

#include <math.h>
#include <stdint.h>

/* The layers of a frame; borrowed. */
struct neph_moved {
    const char *of; /* "reference" or "test" */
    const float *x_px, *y_px, *depth_m;
    const float *before_m;   /* NULL: not known */
    const float *distance_m; /* NULL: none */
    float *transmittance[3];
    bool has_transmittance;
};

/* The hook `obstacle` of an extractor: the reason why a sequence with this first frame has no such
 * layers. */
const char *neph_moved_obstacle(const struct neph_frame_pair *first,
                                const struct neph_settings *settings);

/* Find the layers of the reference, or else of the test. NEPH_ERR_INPUT: they are missing.
 * NEPH_ERR_GATE: a layer has an invalid value. */
enum neph_status neph_moved_find(const struct neph_frame_pair *pair, struct neph_moved *moved,
                                 struct neph_diag *diag);

/* Nearness of a pixel's point, now; and in the previous frame, from its current value. */
double neph_moved_nearness_per_m(const struct neph_moved *moved, size_t pixel);
double neph_moved_nearness_before_per_m(const struct neph_moved *moved, size_t pixel,
                                        double now_per_m);

/* Per-pixel data of a frame, stored until the next frame; initially zero. */
struct neph_kept {
    double *nearness_per_m;
    double *planes[2];
    uint8_t *age; /* in frames */
    uint8_t *flags;
};

/* Allocate two frames in the arena, the current and the previous one, which alternate by parity.
 * NEPH_ERR_MEMORY, also if the arena failed earlier. */
enum neph_status neph_kept_init(struct neph_kept frames[2], size_t pixel_count,
                                struct neph_arena *memory, struct neph_diag *diag);

/* Four pixels of the previous frame and their bilinear weights. */
struct neph_place {
    size_t taps[4];
    double weights[4];
    size_t nearest;
};

/* Find a pixel's position in the previous frame; false: outside of the frame, beyond the rounding
 * of motion to float. */
static inline bool neph_place_find(const struct neph_moved *moved, int width_px, int height_px,
                                   int x, int y, struct neph_place *place)
{
    const double border_slack_px = 1e-3;
    const size_t width = (size_t)width_px, i = (size_t)y * width + (size_t)x;
    const double x_px = x + (double)moved->x_px[i], y_px = y + (double)moved->y_px[i];
    const double last_x = width_px - 1, last_y = height_px - 1;
    if (!(x_px >= -border_slack_px && x_px <= last_x + border_slack_px &&
          y_px >= -border_slack_px && y_px <= last_y + border_slack_px))
        return false;
    const double at_x = fmin(fmax(x_px, 0.0), last_x), at_y = fmin(fmax(y_px, 0.0), last_y);
    const size_t left = (size_t)at_x, top = (size_t)at_y;
    const size_t right = left + (at_x > (double)left), bottom = top + (at_y > (double)top);
    const double fx = at_x - (double)left, fy = at_y - (double)top;
    *place = (struct neph_place){
        .taps = {top * width + left, top * width + right, bottom * width + left,
                 bottom * width + right},
        .weights = {(1.0 - fx) * (1.0 - fy), fx * (1.0 - fy), (1.0 - fx) * fy, fx * fy},
        .nearest = (size_t)(at_y + 0.5) * width + (size_t)(at_x + 0.5),
    };
    return true;
}

/* Interpolate a plane of the previous frame at the position, bilinearly. */
static inline double neph_place_value(const struct neph_place *place, const double *plane)
{
    double sum = 0.0;
    for (int k = 0; k < 4; k++)
        sum += place->weights[k] * plane[place->taps[k]];
    return sum;
}

static inline bool neph_nearness_agrees(double nearness_per_m, double wanted_per_m,
                                        double tolerance)
{
    return fabs(nearness_per_m - wanted_per_m) <= tolerance * wanted_per_m;
}

/* Whether the depth agrees at that position. */
static inline bool neph_place_agrees(const struct neph_place *place, const double *nearness_per_m,
                                     double wanted_per_m, double tolerance)
{
    return neph_nearness_agrees(neph_place_value(place, nearness_per_m), wanted_per_m, tolerance);
}

/* Whether the point was visible: the depth agrees at the position or at one of the four pixels. */
static inline bool neph_place_was_visible(const struct neph_place *place,
                                          const double *nearness_per_m, double wanted_per_m,
                                          double tolerance)
{
    if (neph_place_agrees(place, nearness_per_m, wanted_per_m, tolerance))
        return true;
    for (int k = 0; k < 4; k++)
        if (neph_nearness_agrees(nearness_per_m[place->taps[k]], wanted_per_m, tolerance))
            return true;
    return false;
}

#endif
