/* SPDX-License-Identifier: MIT
 *
 * The frames of a test and of its reference, as the sums that flicker is taken from
 * (flicker_sums.h). The signal is d = x - r: the display luma of the test minus that of the
 * reference in the same frame, so that what the reference does is not held against the test. Once
 * the reference moves it is summed up as well.
 *
 * Bytes per pixel while frames come: 268, and 196 more when the reference moves.
 */
#ifndef NEPH_METRICS_EXTRACTORS_FLICKER_WATCH_H
#define NEPH_METRICS_EXTRACTORS_FLICKER_WATCH_H

#include "metrics/extractor.h"
#include "metrics/extractors/flicker_sums.h"

/* The luma of an image: what it was in frame 0, how far it was from that in the last frames, and
 * their sums. While it has not moved, the sums are 0 and need not be there. */
struct neph_flicker_signal {
    double *first;  /* rows of padded_width_px */
    double *recent; /* the frames that are not summed up yet, see flicker_watch.c */
    struct neph_flicker_sums sums;
};

/* Start from {0}. */
struct neph_flicker_watch {
    int width_px, height_px, padded_width_px;
    double gain; /* display value = gain * radiance */
    int frame_count;
    int frames_seen;
    struct neph_flicker_signal test; /* its `first` is of the test, but the sums are of d */
    struct neph_flicker_signal reference;
    bool reference_moves;
    float *reference_planes[3]; /* frame 0; NULL when the reference moves */
    bool *reference_row_moved;
    struct neph_arena sums;   /* has the first frames, too */
    struct neph_arena recent; /* until neph_flicker_watch_stop() */
    struct neph_arena planes; /* until then, or until the reference moves */
};

/* `frame_count` is a multiple of 4. After a failure neph_flicker_watch_end(), too.
 * NEPH_ERR_MEMORY. */
enum neph_status neph_flicker_watch_begin(struct neph_flicker_watch *watch,
                                          const struct neph_frame_pair *first, int frame_count,
                                          struct neph_diag *diag);

/* Frame t = 0, 1 .. frame_count - 1, in order. The reference is compared by value: a caller may
 * well read every frame into the same memory. NEPH_ERR_MEMORY, NEPH_ERR_INTERRUPTED. */
enum neph_status neph_flicker_watch_frame(struct neph_flicker_watch *watch,
                                          const struct neph_frame_pair *pair, int t,
                                          struct neph_diag *diag);

/* After the last frame: frees what only further frames would need. */
void neph_flicker_watch_stop(struct neph_flicker_watch *watch);

void neph_flicker_watch_end(struct neph_flicker_watch *watch);

/* What a signal was in frame 0. */
static inline double neph_flicker_first(const struct neph_flicker_watch *watch,
                                        const struct neph_flicker_signal *signal, int x_px,
                                        int y_px)
{
    return signal->first[(size_t)y_px * (size_t)watch->padded_width_px + (size_t)x_px];
}

#endif
