/* SPDX-License-Identifier: MIT
 *
 * Running sums of a signal of every pixel, updated frame by frame. They determine, at the end, the
 * amplitudes at the periods of four and two frames, the noise around them, a linear trend and the
 * moments. The memory does not grow with the number of frames, but the number must be known: the
 * neighbouring bins of the discrete Fourier transform depend on it.
 *
 * v_t is the signal in frame t of N, and w = 2 pi / N. All sums start at 0, which is also their
 * value after any number of frames with v = 0: sums of a signal that has not changed yet can be
 * started late. To avoid cancellation, callers pass v_t = (signal in t) - (signal in 0).
 */
#ifndef NEPH_METRICS_EXTRACTORS_FLICKER_SUMS_H
#define NEPH_METRICS_EXTRACTORS_FLICKER_SUMS_H

#include "base/arena.h"

#include <stddef.h>

enum neph_flicker_sum {
    /* Sum of v_t over all t with the same t mod 4. */
    NEPH_FLICKER_PHASE_0,
    NEPH_FLICKER_PHASE_1,
    NEPH_FLICKER_PHASE_2,
    NEPH_FLICKER_PHASE_3,
    /* Sum of v_t (c - (C - 1) / 2), with c the index of t's cycle and C = N / 4. */
    NEPH_FLICKER_TREND,
    NEPH_FLICKER_BRIEF_COUNT,
    /* j = 1, 2: sums of v_t q_t cos(j w t) over even, then odd t, then those with sin; q is
     * 1 -1 -1 1, the parts of (-i)^t. They span the bins N/4 - j and N/4 + j. */
    NEPH_FLICKER_QUARTER = NEPH_FLICKER_BRIEF_COUNT,
    /* j = 1, 2: sums of v_t (-1)^t cos(j w t), then sin: the bins N/2 - j. */
    NEPH_FLICKER_HALF = NEPH_FLICKER_QUARTER + 8,
    NEPH_FLICKER_LINEAR_COUNT = NEPH_FLICKER_HALF + 4, /* all sums before this are linear in v */
    NEPH_FLICKER_SQUARE = NEPH_FLICKER_LINEAR_COUNT,   /* sum of v_t^2 */
    NEPH_FLICKER_VARIANCE_COUNT,
    NEPH_FLICKER_LEAST = NEPH_FLICKER_VARIANCE_COUNT,
    NEPH_FLICKER_MOST,
    NEPH_FLICKER_LAST,   /* v of the last added frame */
    NEPH_FLICKER_TRAVEL, /* sum of |v_t - v_(t-1)| */
    NEPH_FLICKER_SUM_COUNT,
};

enum {
    NEPH_FLICKER_CYCLE = 4,  /* frames */
    NEPH_FLICKER_LANES = 16, /* pixels per step; rows are padded to a multiple */
};

/* The weights of the frames of one cycle. */
struct neph_flicker_weights {
    double trend;
    double quarter_cos[2][NEPH_FLICKER_CYCLE], quarter_sin[2][NEPH_FLICKER_CYCLE];
    double half_cos[2][NEPH_FLICKER_CYCLE], half_sin[2][NEPH_FLICKER_CYCLE];
};

/* Weights of the frames first_frame .. first_frame + 3 of `frame_count`; first_frame is a multiple
 * of 4.
 */
struct neph_flicker_weights neph_flicker_weights_make(int first_frame, int frame_count);

/* The sums of all pixels of one signal. Start from {0}. */
struct neph_flicker_sums {
    int width_px, height_px;
    int padded_width_px; /* a multiple of NEPH_FLICKER_LANES */
    int sum_count;       /* sums per pixel: the first of enum neph_flicker_sum */
    double *values;      /* index: row, group of NEPH_FLICKER_LANES, sum; NULL: not started */
};

/* Start with all sums zero, in the arena. `sum_count`: NEPH_FLICKER_BRIEF_COUNT (mean, cycle and
 * trend), _VARIANCE_COUNT (also noise and variance) or _SUM_COUNT. NEPH_ERR_MEMORY. */
enum neph_status neph_flicker_sums_begin(struct neph_flicker_sums *sums, int width_px,
                                         int height_px, int sum_count, struct neph_arena *memory,
                                         struct neph_diag *diag);

int neph_flicker_padded(int width_px);

/* Add consecutive cycles of four frames to a row: `weights` per cycle, `frames` per frame, rows of
 * padded_width_px values. Rows are independent. */
void neph_flicker_sums_add(struct neph_flicker_sums *sums, int row, int cycle_count,
                           const struct neph_flicker_weights *weights, const double *const *frames);

/* The sums of a pixel; sums beyond sum_count are 0. */
void neph_flicker_sums_read(const struct neph_flicker_sums *sums, int x_px, int y_px,
                            double values[NEPH_FLICKER_SUM_COUNT]);

/* The linear sums of the ramp v_t = t - (N - 1) / 2, to remove a trend from other sums. */
void neph_flicker_ramp_sums(int frame_count, double values[NEPH_FLICKER_LINEAR_COUNT]);

#endif
