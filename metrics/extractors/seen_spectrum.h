/* SPDX-License-Identifier: MIT
 *
 * The temporal spectra of many series, several at a time.
 *
 * A fitted line is subtracted, the residual is tapered by a Hann window, zero-padded to a power of
 * two M >= N and transformed. The results are energies: bin k, at the frequency k rate / M, is 2
 * |X_k|^2 (1 + [0 < k < M / 2]) / (M sum w^2). By Parseval's theorem they sum to twice the variance
 * of the tapered series. For a sine this is its squared amplitude, at any frequency between the
 * bins; for noise it does not depend on the number of frames.
 */
#ifndef NEPH_METRICS_EXTRACTORS_SEEN_SPECTRUM_H
#define NEPH_METRICS_EXTRACTORS_SEEN_SPECTRUM_H

#include "base/arena.h"

#include <stddef.h>

enum { NEPH_SEEN_LANES = 32 };      /* series per step */
enum { NEPH_SEEN_FRAMES_MIN = 16 }; /* fewer frames separate hardly any frequencies */

struct neph_seen_window {
    int frame_count;
    int padded_count;                            /* M */
    int bin_count;                               /* M / 2 + 1 */
    float *taper, *mean_weights, *slope_weights; /* one value per frame */
    float *turns;                                /* cos and -sin of 2 pi j / M, for j < M / 2 */
    int *places;                                 /* index of each frame in the order of the
                                                  * transform */
};

/* Create the window for `frame_count` frames, at least 3, in the arena. NEPH_ERR_MEMORY. */
enum neph_status neph_seen_window_create(int frame_count, struct neph_arena *memory,
                                         struct neph_seen_window *window, struct neph_diag *diag);

/* Number of floats of `room` in neph_seen_spectrum(). */
size_t neph_seen_room(const struct neph_seen_window *window);

/* Compute the energies of NEPH_SEEN_LANES series: frame t of lane l is series[t * stride + l], bin
 * k of lane l becomes energies[k * NEPH_SEEN_LANES + l]. Thread-safe. */
void neph_seen_spectrum(const struct neph_seen_window *window, const float *series, size_t stride,
                        float *room, float *energies);

#endif
