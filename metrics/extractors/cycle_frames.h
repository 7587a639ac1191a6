/* SPDX-License-Identifier: MIT
 *
 * Stores a signal of each pixel for all frames: 4 bytes per pixel and frame, 0.5 GB for 256 frames
 * of 960x540. The periods are known only after the last frame, and then all frames are needed
 * again.
 */
#ifndef NEPH_METRICS_EXTRACTORS_CYCLE_FRAMES_H
#define NEPH_METRICS_EXTRACTORS_CYCLE_FRAMES_H

#include "base/arena.h"

#include <stddef.h>

struct neph_cycle_frames {
    int width_px, height_px, frame_count;
    float *values; /* index: row, frame, column */
};

/* Allocate the values in the arena. NEPH_ERR_MEMORY names the needed size. */
enum neph_status neph_cycle_frames_begin(struct neph_cycle_frames *frames, int width_px,
                                         int height_px, int frame_count, struct neph_arena *memory,
                                         struct neph_diag *diag);

static inline float *neph_cycle_frames_row(const struct neph_cycle_frames *frames, int row, int t)
{
    const size_t line = (size_t)row * (size_t)frames->frame_count + (size_t)t;
    return frames->values + line * (size_t)frames->width_px;
}

/* The frame_count^2 second moments of the pixels about their means, for neph_cycle_search(), in the
 * arena. Each pixel has one vote: it is divided by its own variance around a line, but at least by
 * the variance of a quarter step of an 8-bit display. So the noise of a cloud does not hide the
 * flicker of a wire. In large images one pixel of each square is used, chosen at random with a
 * fixed seed. NEPH_ERR_MEMORY, NEPH_ERR_INTERRUPTED. */
enum neph_status neph_cycle_moments(const struct neph_cycle_frames *frames,
                                    struct neph_arena *memory, double **moments,
                                    struct neph_diag *diag);

#endif
