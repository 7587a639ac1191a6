/* SPDX-License-Identifier: MIT
 *
 * What is kept of a signal of every pixel while its frames pass by: sums from which amplitudes at
 * the periods of four and two frames, the noise around them, a linear trend and the moments follow
 * at the end. The memory does not grow with the number of frames; but the number must be known,
 * because the neighbouring bins of the discrete Fourier transform depend on it.
 *
 * With v_t the signal in frame t of N, and w = 2 pi / N. All start at 0, which is also what they
 * are after any number of frames of v = 0: sums for a signal that has not moved so far can be begun
 * late. So that nothing cancels, callers pass v_t = (signal in t) - (signal in 0).
 */
#ifndef NEPH_METRICS_EXTRACTORS_FLICKER_SUMS_H
#define NEPH_METRICS_EXTRACTORS_FLICKER_SUMS_H

#include "base/arena.h"

#include <stddef.h>

enum neph_flicker_sum {
    /* Sum of v_t over the t of the same t mod 4. */
    NEPH_FLICKER_PHASE_0,
    NEPH_FLICKER_PHASE_1,
    NEPH_FLICKER_PHASE_2,
    NEPH_FLICKER_PHASE_3,
    /* Sum of v_t (c - (C - 1) / 2), with c the cycle that t is in of C = N / 4. */
    NEPH_FLICKER_TREND,
    NEPH_FLICKER_BRIEF_COUNT,
    /* j = 1, 2: sums of v_t q_t cos(j w t) over even, then odd t, then those with sin; q is
     * 1 -1 -1 1, the parts of (-i)^t. They span the bins N/4 - j and N/4 + j. */
    NEPH_FLICKER_QUARTER = NEPH_FLICKER_BRIEF_COUNT,
    /* j = 1, 2: sums of v_t (-1)^t cos(j w t), then sin: the bins N/2 - j. */
    NEPH_FLICKER_HALF = NEPH_FLICKER_QUARTER + 8,
    NEPH_FLICKER_LINEAR_COUNT = NEPH_FLICKER_HALF + 4, /* up to here linear in v */
    NEPH_FLICKER_SQUARE = NEPH_FLICKER_LINEAR_COUNT,   /* sum of v_t^2 */
    NEPH_FLICKER_VARIANCE_COUNT,
    NEPH_FLICKER_LEAST = NEPH_FLICKER_VARIANCE_COUNT,
    NEPH_FLICKER_MOST,
    NEPH_FLICKER_LAST,   /* v of the last frame so far */
    NEPH_FLICKER_TRAVEL, /* sum of |v_t - v_(t-1)| */
    NEPH_FLICKER_SUM_COUNT,
};

enum {
    NEPH_FLICKER_CYCLE = 4,  /* frames */
    NEPH_FLICKER_LANES = 16, /* pixels that are worked on at a time; rows are padded to them */
};

/* What the frames of one cycle are multiplied by. */
struct neph_flicker_weights {
    double trend;
    double quarter_cos[2][NEPH_FLICKER_CYCLE], quarter_sin[2][NEPH_FLICKER_CYCLE];
    double half_cos[2][NEPH_FLICKER_CYCLE], half_sin[2][NEPH_FLICKER_CYCLE];
};

/* For the frames first_frame .. first_frame + 3 of `frame_count`; first_frame is a multiple of 4.
 */
struct neph_flicker_weights neph_flicker_weights_of(int first_frame, int frame_count);

/* The sums of all pixels of one signal. Start from {0}. */
struct neph_flicker_sums {
    int width_px, height_px;
    int padded_width_px; /* a multiple of NEPH_FLICKER_LANES */
    int sum_count;       /* of a pixel: the first of enum neph_flicker_sum */
    double *values;      /* by row, by NEPH_FLICKER_LANES of a row, by sum; NULL: not begun */
};

/* Begin, all zero, in the arena. `sum_count`: which are kept, NEPH_FLICKER_BRIEF_COUNT (mean, cycle
 * and trend), _VARIANCE_COUNT (the noise and the variance, too) or _SUM_COUNT. NEPH_ERR_MEMORY. */
enum neph_status neph_flicker_sums_begin(struct neph_flicker_sums *sums, int width_px,
                                         int height_px, int sum_count, struct neph_arena *memory,
                                         struct neph_diag *diag);

int neph_flicker_padded(int width_px);

/* Add cycles of four frames, which follow each other, to a row: `weights` for each cycle, `frames`
 * for each frame, rows of padded_width_px values. Rows are independent. */
void neph_flicker_sums_add(struct neph_flicker_sums *sums, int row, int cycle_count,
                           const struct neph_flicker_weights *weights, const double *const *frames);

/* The sums of a pixel; those that are not kept are 0. */
void neph_flicker_sums_of(const struct neph_flicker_sums *sums, int x_px, int y_px,
                          double values[NEPH_FLICKER_SUM_COUNT]);

/* The linear sums of the signal v_t = t - (N - 1) / 2 itself, to take a trend out of others. */
void neph_flicker_sums_of_ramp(int frame_count, double values[NEPH_FLICKER_LINEAR_COUNT]);

#endif
