/* SPDX-License-Identifier: MIT
 *
 * The spectrum over time of many series of frames side by side.
 *
 * A line is fitted and taken out, the rest is tapered by Hann's window, filled up with zeros to a
 * power of two M >= N and transformed. What comes out are energies: bin k, at the frequency k rate
 * / M, holds 2 |X_k|^2 (1 + [0 < k < M / 2]) / (M sum w^2). By Parseval's theorem they sum to twice
 * the variance of the tapered series. That is the squared amplitude of a sine, wherever it lies
 * between the bins; and for noise it does not depend on the number of frames.
 */
#ifndef NEPH_METRICS_EXTRACTORS_SEEN_SPECTRUM_H
#define NEPH_METRICS_EXTRACTORS_SEEN_SPECTRUM_H

#include "base/arena.h"

#include <stddef.h>

enum { NEPH_SEEN_LANES = 32 };      /* series that are worked on side by side */
enum { NEPH_SEEN_FRAMES_MIN = 16 }; /* fewer tell next to no frequencies apart */

struct neph_seen_window {
    int frame_count;
    int padded_count;                            /* M */
    int bin_count;                               /* M / 2 + 1 */
    float *taper, *mean_weights, *slope_weights; /* by frame */
    float *turns;                                /* cos and -sin of 2 pi j / M, for j < M / 2 */
    int *places;                                 /* of each frame in the order of the transform */
};

/* For `frame_count` frames, at least 3; the arena has its arrays. NEPH_ERR_MEMORY. */
enum neph_status neph_seen_window_create(int frame_count, struct neph_arena *memory,
                                         struct neph_seen_window *window, struct neph_diag *diag);

/* How many floats of room neph_seen_spectrum() needs. */
size_t neph_seen_room(const struct neph_seen_window *window);

/* Energies of NEPH_SEEN_LANES series: frame t of lane l is series[t * stride + l], bin k of lane l
 * becomes energies[k * NEPH_SEEN_LANES + l]. Thread-safe. */
void neph_seen_spectrum(const struct neph_seen_window *window, const float *series, size_t stride,
                        float *room, float *energies);

#endif
