/* SPDX-License-Identifier: MIT
 *
 * A signal of each pixel in all frames, kept: 4 bytes a pixel and frame, 0.5 GB for 256 frames of
 * 960x540. What flickers is known only at the end, and then the frames are looked at once more.
 */
#ifndef NEPH_METRICS_EXTRACTORS_CYCLE_FRAMES_H
#define NEPH_METRICS_EXTRACTORS_CYCLE_FRAMES_H

#include "base/arena.h"

#include <stddef.h>

struct neph_cycle_frames {
    int width_px, height_px, frame_count;
    float *values; /* by row, frame, column */
};

/* The arena has the values. NEPH_ERR_MEMORY, with what it takes. */
enum neph_status neph_cycle_frames_begin(struct neph_cycle_frames *frames, int width_px,
                                         int height_px, int frame_count, struct neph_arena *memory,
                                         struct neph_diag *diag);

static inline float *neph_cycle_frames_row(const struct neph_cycle_frames *frames, int row, int t)
{
    const size_t line = (size_t)row * (size_t)frames->frame_count + (size_t)t;
    return frames->values + line * (size_t)frames->width_px;
}

/* The frame_count^2 second moments of the pixels about their means, for neph_cycle_search(), in
 * the arena. Each pixel has one vote: it is divided by its own variance about a line,
 * which counts as at least that of a quarter of a step of an 8-bit display, so that the noise of a
 * cloud does not hide what a wire does. Of large pictures one pixel in each square is taken, by
 * chance with a fixed seed. NEPH_ERR_MEMORY, NEPH_ERR_INTERRUPTED. */
enum neph_status neph_cycle_moments(const struct neph_cycle_frames *frames,
                                    struct neph_arena *memory, double **moments,
                                    struct neph_diag *diag);

#endif
