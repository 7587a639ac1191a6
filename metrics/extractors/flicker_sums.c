/* SPDX-License-Identifier: MIT */
#include "metrics/extractors/flicker_sums.h"

#include "metrics/vector_math.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

enum { LANES = NEPH_FLICKER_LANES, CYCLE = NEPH_FLICKER_CYCLE };

struct neph_flicker_weights neph_flicker_weights_make(int first_frame, int frame_count)
{
    static const double quarter_sign[CYCLE] = {1.0, -1.0, -1.0, 1.0};
    static const double half_sign[CYCLE] = {1.0, -1.0, 1.0, -1.0};
    const int cycle = first_frame / CYCLE, cycle_count = frame_count / CYCLE;
    struct neph_flicker_weights weights = {.trend = (double)cycle -
                                                    0.5 * (double)(cycle_count - 1)};
    for (int k = 0; k < CYCLE; k++) {
        const long long t = first_frame + k;
        for (int j = 1; j <= 2; j++) {
            /* Reduced modulo whole turns first, so that late frames are as exact as early ones. */
            const double turn = (double)(j * t % frame_count) / (double)frame_count;
            const double cosine = cos(2.0 * M_PI * turn), sine = sin(2.0 * M_PI * turn);
            weights.quarter_cos[j - 1][k] = quarter_sign[k] * cosine;
            weights.quarter_sin[j - 1][k] = quarter_sign[k] * sine;
            weights.half_cos[j - 1][k] = half_sign[k] * cosine;
            weights.half_sin[j - 1][k] = half_sign[k] * sine;
        }
    }
    return weights;
}

int neph_flicker_padded(int width_px)
{
    return (width_px + LANES - 1) / LANES * LANES;
}

enum neph_status neph_flicker_sums_begin(struct neph_flicker_sums *sums, int width_px,
                                         int height_px, int sum_count, struct neph_arena *memory,
                                         struct neph_diag *diag)
{
    struct neph_flicker_sums begun = {
        .width_px = width_px,
        .height_px = height_px,
        .padded_width_px = neph_flicker_padded(width_px),
        .sum_count = sum_count,
    };
    const size_t pixel_count = (size_t)begun.padded_width_px * (size_t)height_px;
    begun.values = neph_arena_allocate(memory, pixel_count * (size_t)begun.sum_count,
                                       sizeof(*begun.values));
    if (begun.values)
        *sums = begun;
    return neph_arena_check(memory, diag);
}

/* The sums of LANES neighbouring pixels. */
static double *cell_at(const struct neph_flicker_sums *sums, int first_px, int row)
{
    const size_t pixel = (size_t)row * (size_t)sums->padded_width_px + (size_t)first_px;
    return sums->values + pixel * (size_t)sums->sum_count;
}

/* ---- four frames of LANES pixels ------------------------------------------------------------- */

#define SUM(which) cell[(which)*LANES + i]
#define DOT(w) ((w)[0] * v0[i] + (w)[1] * v1[i] + (w)[2] * v2[i] + (w)[3] * v3[i])
#define DOT_EVEN(w) ((w)[0] * v0[i] + (w)[2] * v2[i])
#define DOT_ODD(w) ((w)[1] * v1[i] + (w)[3] * v3[i])

static inline __attribute__((always_inline)) void
add_brief(double *restrict cell, const struct neph_flicker_weights *restrict weights,
          const double *restrict v0, const double *restrict v1, const double *restrict v2,
          const double *restrict v3)
{
    for (int i = 0; i < LANES; i++) {
        SUM(NEPH_FLICKER_PHASE_0) += v0[i];
        SUM(NEPH_FLICKER_PHASE_1) += v1[i];
        SUM(NEPH_FLICKER_PHASE_2) += v2[i];
        SUM(NEPH_FLICKER_PHASE_3) += v3[i];
        SUM(NEPH_FLICKER_TREND) += weights->trend * ((v0[i] + v1[i]) + (v2[i] + v3[i]));
    }
}

static inline __attribute__((always_inline)) void
add_bins(double *restrict cell, const struct neph_flicker_weights *restrict weights,
         const double *restrict v0, const double *restrict v1, const double *restrict v2,
         const double *restrict v3)
{
    for (int j = 0; j < 2; j++) {
        for (int i = 0; i < LANES; i++) {
            SUM(NEPH_FLICKER_QUARTER + 4 * j) += DOT_EVEN(weights->quarter_cos[j]);
            SUM(NEPH_FLICKER_QUARTER + 4 * j + 1) += DOT_ODD(weights->quarter_cos[j]);
            SUM(NEPH_FLICKER_QUARTER + 4 * j + 2) += DOT_EVEN(weights->quarter_sin[j]);
            SUM(NEPH_FLICKER_QUARTER + 4 * j + 3) += DOT_ODD(weights->quarter_sin[j]);
            SUM(NEPH_FLICKER_HALF + 2 * j) += DOT(weights->half_cos[j]);
            SUM(NEPH_FLICKER_HALF + 2 * j + 1) += DOT(weights->half_sin[j]);
        }
    }
}

static inline __attribute__((always_inline)) double lesser(double a, double b)
{
    return a < b ? a : b;
}

static inline __attribute__((always_inline)) double greater(double a, double b)
{
    return a > b ? a : b;
}

static inline __attribute__((always_inline)) void
add_squares(double *restrict cell, const double *restrict v0, const double *restrict v1,
            const double *restrict v2, const double *restrict v3)
{
    for (int i = 0; i < LANES; i++)
        SUM(NEPH_FLICKER_SQUARE) += v0[i] * v0[i] + v1[i] * v1[i] + v2[i] * v2[i] + v3[i] * v3[i];
}

static inline __attribute__((always_inline)) void
add_moves(double *restrict cell, const double *restrict v0, const double *restrict v1,
          const double *restrict v2, const double *restrict v3)
{
    for (int i = 0; i < LANES; i++) {
        SUM(NEPH_FLICKER_LEAST) = lesser(SUM(NEPH_FLICKER_LEAST),
                                         lesser(lesser(v0[i], v1[i]), lesser(v2[i], v3[i])));
        SUM(NEPH_FLICKER_MOST) = greater(SUM(NEPH_FLICKER_MOST),
                                         greater(greater(v0[i], v1[i]), greater(v2[i], v3[i])));
        SUM(NEPH_FLICKER_TRAVEL) += fabs(v0[i] - SUM(NEPH_FLICKER_LAST)) + fabs(v1[i] - v0[i]) +
                                    fabs(v2[i] - v1[i]) + fabs(v3[i] - v2[i]);
        SUM(NEPH_FLICKER_LAST) = v3[i];
    }
}

NEPH_VECTOR
static void add_cycle(double *cell, int sum_count, const struct neph_flicker_weights *weights,
                      const double *v0, const double *v1, const double *v2, const double *v3)
{
    add_brief(cell, weights, v0, v1, v2, v3);
    if (sum_count < NEPH_FLICKER_VARIANCE_COUNT)
        return;
    add_bins(cell, weights, v0, v1, v2, v3);
    add_squares(cell, v0, v1, v2, v3);
    if (sum_count == NEPH_FLICKER_SUM_COUNT)
        add_moves(cell, v0, v1, v2, v3);
}

void neph_flicker_sums_add(struct neph_flicker_sums *sums, int row, int cycle_count,
                           const struct neph_flicker_weights *weights, const double *const *frames)
{
    for (int x = 0; x < sums->padded_width_px; x += LANES) {
        double *cell = cell_at(sums, x, row);
        for (int k = 0; k < cycle_count; k++) {
            const double *const *v = frames + CYCLE * k;
            add_cycle(cell, sums->sum_count, &weights[k], v[0] + x, v[1] + x, v[2] + x, v[3] + x);
        }
    }
}

/* ---- reading --------------------------------------------------------------------------------- */

void neph_flicker_sums_read(const struct neph_flicker_sums *sums, int x_px, int y_px,
                            double values[NEPH_FLICKER_SUM_COUNT])
{
    memset(values, 0, NEPH_FLICKER_SUM_COUNT * sizeof(*values));
    if (!sums->values)
        return;
    const double *cell = cell_at(sums, x_px / LANES * LANES, y_px) + x_px % LANES;
    for (int s = 0; s < sums->sum_count; s++)
        values[s] = cell[s * LANES];
}

void neph_flicker_ramp_sums(int frame_count, double values[NEPH_FLICKER_LINEAR_COUNT])
{
    double cell[NEPH_FLICKER_SUM_COUNT * LANES] = {0};
    for (int t = 0; t < frame_count; t += CYCLE) {
        const struct neph_flicker_weights weights = neph_flicker_weights_make(t, frame_count);
        double v[CYCLE][LANES];
        for (int k = 0; k < CYCLE; k++)
            for (int i = 0; i < LANES; i++)
                v[k][i] = (double)(t + k) - 0.5 * (double)(frame_count - 1);
        add_cycle(cell, NEPH_FLICKER_VARIANCE_COUNT, &weights, v[0], v[1], v[2], v[3]);
    }
    for (int s = 0; s < NEPH_FLICKER_LINEAR_COUNT; s++)
        values[s] = cell[s * LANES];
}
