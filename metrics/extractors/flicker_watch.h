/* SPDX-License-Identifier: MIT
 *
 * Collects the sums (flicker_sums.h) of a test and its reference, from which flicker is computed.
 * The signal is d = x - r: display luma of the test minus luma of the reference in the same frame,
 * so that changes of the reference do not count. Once the reference moves, its sums are collected
 * as well.
 *
 * Memory per pixel while frames arrive: 268 bytes, and 196 more for a moving reference.
 */
#ifndef NEPH_METRICS_EXTRACTORS_FLICKER_WATCH_H
#define NEPH_METRICS_EXTRACTORS_FLICKER_WATCH_H

#include "metrics/extractor.h"
#include "metrics/extractors/flicker_sums.h"

/* The luma of an image: its value in frame 0, its difference to that in the last frames, and their
 * sums. For a signal that has not moved yet, the sums are 0 and need not be allocated. */
struct neph_flicker_signal {
    double *first;  /* rows of padded_width_px */
    double *recent; /* frames that are not yet in the sums, see flicker_watch.c */
    struct neph_flicker_sums sums;
};

/* Start from {0}. */
struct neph_flicker_watch {
    int width_px, height_px, padded_width_px;
    int frame_count;
    int frames_seen;
    struct neph_flicker_signal test; /* `first` is of the test, the sums are of d */
    struct neph_flicker_signal reference;
    bool reference_moves;
    float *reference_planes[3]; /* frame 0; NULL once the reference moves */
    bool *reference_row_moved;
    struct neph_arena sums;   /* also of the first frames */
    struct neph_arena recent; /* until neph_flicker_watch_stop() */
    struct neph_arena planes; /* until then, or until the reference moves */
};

/* Begin; `frame_count` is a multiple of 4. Call neph_flicker_watch_end() also after a failure.
 * NEPH_ERR_MEMORY. */
enum neph_status neph_flicker_watch_begin(struct neph_flicker_watch *watch,
                                          const struct neph_frame_pair *first, int frame_count,
                                          struct neph_diag *diag);

/* Add frame t = 0, 1 .. frame_count - 1, in order. The reference is compared by value: the caller
 * may read every frame into the same memory. NEPH_ERR_MEMORY, NEPH_ERR_INTERRUPTED. */
enum neph_status neph_flicker_watch_frame(struct neph_flicker_watch *watch,
                                          const struct neph_frame_pair *pair, int t,
                                          struct neph_diag *diag);

/* After the last frame: free memory that only more frames would need. */
void neph_flicker_watch_stop(struct neph_flicker_watch *watch);

void neph_flicker_watch_end(struct neph_flicker_watch *watch);

/* The value of a signal in frame 0. */
static inline double neph_flicker_read_first(const struct neph_flicker_watch *watch,
                                             const struct neph_flicker_signal *signal, int x_px,
                                             int y_px)
{
    return signal->first[(size_t)y_px * (size_t)watch->padded_width_px + (size_t)x_px];
}

#endif
