/* SPDX-License-Identifier: MIT */
#include "metrics/extractors/cycle_fit.h"

#include "metrics/vector_math.h"

#include <stdbool.h>
#include <stdlib.h>

/* Pixels per step, and model columns per step. */
enum { LANES = 16, STRIDE = 4 };

/* ---- the model ------------------------------------------------------------------------------- */

static int by_number(const void *a, const void *b)
{
    return *(const int *)a - *(const int *)b;
}

static void list_periods(struct neph_cycle_model *model, const struct neph_cycle_findings *findings)
{
    for (int i = 0; i < findings->count; i++)
        model->periods[i] = findings->items[i].frequency.period;
    qsort(model->periods, (size_t)findings->count, sizeof(*model->periods), by_number);
    for (int i = 0; i < findings->count; i++)
        if (i == 0 || model->periods[i] != model->periods[model->period_count - 1])
            model->periods[model->period_count++] = model->periods[i];
}

static int find_period_part(const struct neph_cycle_model *model, int period)
{
    int i = 0;
    while (model->periods[i] != period)
        i++;
    return NEPH_CYCLE_SQUARES + i;
}

static void center(double *column, int count)
{
    double mean = 0.0;
    for (int t = 0; t < count; t++)
        mean += column[t] / (double)count;
    for (int t = 0; t < count; t++)
        column[t] -= mean;
}

static double *add_column(struct neph_cycle_model *model, double *columns, int part, double square,
                          double noise)
{
    const int c = model->column_count++;
    model->part[c] = part;
    model->squares[c] = square;
    model->noise_share[c] = noise; /* later multiplied by the inverse of the products */
    return columns + (size_t)c * (size_t)model->frame_count;
}

static void fill_columns(struct neph_cycle_model *model, const struct neph_cycle_findings *findings,
                         double *columns)
{
    const int n = model->frame_count;
    const double nn = (double)n * (double)n;
    double *line = add_column(model, columns, NEPH_CYCLE_DRIFT, (nn - 1.0) / (3.0 * nn),
                              findings->count ? findings->items[0].noise : 1.0);
    for (int t = 0; t < n; t++)
        line[t] = (2.0 * (double)t + 1.0) / (double)n - 1.0;
    for (int i = 0; i < findings->count; i++) {
        const struct neph_cycle_found *found = &findings->items[i];
        const int m = found->frequency.m, period = found->frequency.period;
        const int part = find_period_part(model, period);
        const bool is_half = 2 * m == period;
        double *cosine = add_column(model, columns, part, is_half ? 1.0 : 0.5, found->noise);
        double *sine = is_half ? NULL : add_column(model, columns, part, 0.5, found->noise);
        for (int t = 0; t < n; t++) {
            const double turn = (double)((long long)m * t % period) / (double)period;
            cosine[t] = cos(2.0 * M_PI * turn);
            if (sine)
                sine[t] = sin(2.0 * M_PI * turn);
        }
    }
    for (int c = 0; c < model->column_count; c++)
        center(columns + (size_t)c * (size_t)n, n);
}

static double dot(const double *a, const double *b, int count)
{
    double sum = 0.0;
    for (int i = 0; i < count; i++)
        sum += a[i] * b[i];
    return sum;
}

/* Gram-Schmidt, applied twice, which is sufficient (L. Giraud et al., Numer. Math. 101, 2005). */
static void orthonormalize(struct neph_cycle_model *model, const double *columns)
{
    const int n = model->frame_count, count = model->column_count;
    for (int c = 0; c < count; c++) {
        double *unit = model->orthonormal + (size_t)c * (size_t)n;
        double *weights = model->triangle + (size_t)c * (size_t)count;
        memcpy(unit, columns + (size_t)c * (size_t)n, (size_t)n * sizeof(*unit));
        for (int pass = 0; pass < 2; pass++)
            for (int k = 0; k < c; k++) {
                const double *other = model->orthonormal + (size_t)k * (size_t)n;
                const double along = dot(unit, other, n);
                weights[k] += along;
                for (int t = 0; t < n; t++)
                    unit[t] -= along * other[t];
            }
        weights[c] = sqrt(dot(unit, unit, n));
        for (int t = 0; t < n; t++)
            unit[t] /= weights[c];
    }
}

/* Solve triangle^T x = y for each lane. With columns[c] = sum over k <= c of triangle[c][k]
 * orthonormal[k], x are the coefficients of the columns, y those of the orthonormal basis. */
static void solve_triangle(const struct neph_cycle_model *model, double *coefficients, int lanes)
{
    const int count = model->column_count;
    for (int c = count - 1; c >= 0; c--) {
        double *own = coefficients + (size_t)c * (size_t)lanes;
        const double *weights = model->triangle + (size_t)c * (size_t)count;
        for (int l = 0; l < lanes; l++)
            own[l] /= weights[c];
        for (int k = 0; k < c; k++)
            for (int l = 0; l < lanes; l++)
                coefficients[(size_t)k * (size_t)lanes + (size_t)l] -= weights[k] * own[l];
    }
}

/* Set the variance of each coefficient relative to the noise: the squared norm of column c of the
 * inverse triangle. `unit` has column_count^2 doubles. */
static void share_noise(struct neph_cycle_model *model, double *unit)
{
    const int count = model->column_count;
    memset(unit, 0, (size_t)count * (size_t)count * sizeof(*unit));
    for (int c = 0; c < count; c++)
        unit[c * count + c] = 1.0;
    solve_triangle(model, unit, count);
    for (int c = 0; c < count; c++) {
        const double *row = unit + (size_t)c * (size_t)count;
        model->noise_share[c] *= model->squares[c] * dot(row, row, count);
    }
}

static void share_columns(struct neph_cycle_model *model, const double *columns)
{
    const int n = model->frame_count, count = model->column_count;
    for (int c = 0; c < count; c++)
        for (int k = 0; k < count; k++)
            model->shared[c * count + k] = dot(columns + (size_t)c * (size_t)n,
                                               columns + (size_t)k * (size_t)n, n) /
                                               (double)n -
                                           (c == k ? model->squares[c] : 0.0);
}

static void scatter_noise(struct neph_cycle_model *model)
{
    for (int c = 1; c < model->column_count; c++) {
        const int period = model->part[c] - NEPH_CYCLE_SQUARES;
        const bool has_sine = model->squares[c] == 0.5;
        const double share = model->noise_share[c] + (has_sine ? model->noise_share[c + 1] : 0.0);
        model->period_scatter[period] += share * share;
        c += has_sine;
    }
    for (int p = 0; p < model->period_count; p++)
        model->period_scatter[p] = sqrt(model->period_scatter[p]);
}

enum neph_status neph_cycle_model_begin(struct neph_cycle_model *model, int frame_count,
                                        const struct neph_cycle_findings *findings,
                                        struct neph_arena *memory, struct neph_diag *diag)
{
    *model = (struct neph_cycle_model){.frame_count = frame_count};
    const size_t n = (size_t)frame_count, room = 2 * (size_t)findings->count + 1;
    double *columns = malloc(room * n * sizeof(*columns));
    double *unit = malloc(room * room * sizeof(*unit));
    model->orthonormal = neph_arena_allocate(memory, room * n, sizeof(*model->orthonormal));
    model->triangle = neph_arena_allocate(memory, room * room, sizeof(*model->triangle));
    model->shared = neph_arena_allocate(memory, room * room, sizeof(*model->shared));
    model->squares = neph_arena_allocate(memory, room, sizeof(*model->squares));
    model->noise_share = neph_arena_allocate(memory, room, sizeof(*model->noise_share));
    model->part = neph_arena_allocate(memory, room, sizeof(*model->part));
    model->periods = neph_arena_allocate(memory, room, sizeof(*model->periods));
    model->period_scatter = neph_arena_allocate(memory, room, sizeof(*model->period_scatter));
    const bool made = columns && unit && !memory->is_short;
    if (made) {
        list_periods(model, findings);
        fill_columns(model, findings, columns);
        orthonormalize(model, columns);
        share_noise(model, unit);
        share_columns(model, columns);
        scatter_noise(model);
    }
    free(unit);
    free(columns);
    return made ? NEPH_OK : neph_fail_memory(diag);
}

/* ---- pixels ---------------------------------------------------------------------------------- */

/* Subtract the mean from the series of LANES pixels, and compute their sums of squares. */
NEPH_VECTOR
static void center_series(double *restrict series, size_t n, double *restrict squares)
{
    double mean[LANES] = {0.0};
    for (size_t t = 0; t < n; t++)
        for (size_t l = 0; l < LANES; l++)
            mean[l] += series[t * LANES + l];
    for (size_t l = 0; l < LANES; l++) {
        mean[l] /= (double)n;
        squares[l] = 0.0;
    }
    for (size_t t = 0; t < n; t++)
        for (size_t l = 0; l < LANES; l++) {
            series[t * LANES + l] -= mean[l];
            squares[l] += series[t * LANES + l] * series[t * LANES + l];
        }
}

/* sums[k] = dot products of STRIDE rows of `units` with the series. */
NEPH_VECTOR
static void project(const double *restrict units, const double *restrict series, size_t n,
                    double *restrict sums)
{
    double s0[LANES] = {0.0}, s1[LANES] = {0.0}, s2[LANES] = {0.0}, s3[LANES] = {0.0};
    for (size_t t = 0; t < n; t++) {
        const double u0 = units[t], u1 = units[n + t], u2 = units[2 * n + t], u3 = units[3 * n + t];
        for (size_t l = 0; l < LANES; l++) {
            const double value = series[t * LANES + l];
            s0[l] += u0 * value;
            s1[l] += u1 * value;
            s2[l] += u2 * value;
            s3[l] += u3 * value;
        }
    }
    for (size_t l = 0; l < LANES; l++) {
        sums[l] = s0[l];
        sums[LANES + l] = s1[l];
        sums[2 * LANES + l] = s2[l];
        sums[3 * LANES + l] = s3[l];
    }
}

NEPH_VECTOR
static void project_one(const double *restrict unit, const double *restrict series, size_t n,
                        double *restrict sums)
{
    for (size_t l = 0; l < LANES; l++)
        sums[l] = 0.0;
    for (size_t t = 0; t < n; t++)
        for (size_t l = 0; l < LANES; l++)
            sums[l] += unit[t] * series[t * LANES + l];
}

static void project_all(const struct neph_cycle_model *model, const double *series, double *sums)
{
    const size_t n = (size_t)model->frame_count;
    int c = 0;
    for (; c + STRIDE <= model->column_count; c += STRIDE)
        project(model->orthonormal + (size_t)c * n, series, n, sums + (size_t)c * LANES);
    for (; c < model->column_count; c++)
        project_one(model->orthonormal + (size_t)c * n, series, n, sums + (size_t)c * LANES);
}

/* Overlap of the parts of a pixel; `coefficients` are LANES apart. */
static double compute_overlap(const struct neph_cycle_model *model, const double *coefficients)
{
    const int count = model->column_count;
    double sum = 0.0;
    for (int c = 0; c < count; c++) {
        double row = 0.5 * model->shared[c * count + c] * coefficients[c * LANES];
        for (int k = 0; k < c; k++)
            row += model->shared[c * count + k] * coefficients[k * LANES];
        sum += 2.0 * row * coefficients[c * LANES];
    }
    return sum;
}

static void split(const struct neph_cycle_model *model, const double *coefficients, double variance,
                  double residual, double *const *parts, size_t x)
{
    const double n = (double)model->frame_count;
    const double noise = residual * n / (n - 1.0 - (double)model->column_count);
    parts[NEPH_CYCLE_VARIANCE][x] = variance;
    parts[NEPH_CYCLE_OVERLAP][x] = compute_overlap(model, coefficients);
    parts[NEPH_CYCLE_NOISE][x] = residual;
    parts[NEPH_CYCLE_DRIFT][x] = 0.0;
    for (int p = 0; p < model->period_count; p++)
        parts[NEPH_CYCLE_SQUARES + p][x] = 0.0;
    for (int c = 0; c < model->column_count; c++) {
        const double of_noise = model->noise_share[c] * noise;
        const double own = coefficients[c * LANES];
        parts[model->part[c]][x] += model->squares[c] * own * own - of_noise;
        parts[NEPH_CYCLE_NOISE][x] += of_noise;
    }
}

size_t neph_cycle_scratch_count(const struct neph_cycle_model *model)
{
    return LANES * ((size_t)model->frame_count + (size_t)model->column_count + 2);
}

void neph_cycle_fit_row(const struct neph_cycle_model *model,
                        const struct neph_cycle_frames *frames, int row, double *scratch,
                        double *const *parts)
{
    const size_t n = (size_t)model->frame_count, width = (size_t)frames->width_px;
    double *series = scratch, *squares = series + n * LANES, *left = squares + LANES;
    double *coefficients = left + LANES;
    for (size_t first = 0; first < width; first += LANES) {
        const size_t lanes = width - first < LANES ? width - first : LANES;
        for (size_t t = 0; t < n; t++) {
            const float *values = neph_cycle_frames_row(frames, row, (int)t) + first;
            for (size_t l = 0; l < LANES; l++)
                series[t * LANES + l] = l < lanes ? (double)values[l] : 0.0;
        }
        center_series(series, n, squares);
        project_all(model, series, coefficients);
        for (size_t l = 0; l < LANES; l++)
            left[l] = squares[l];
        for (int c = 0; c < model->column_count; c++)
            for (size_t l = 0; l < LANES; l++)
                left[l] -= coefficients[(size_t)c * LANES + l] *
                           coefficients[(size_t)c * LANES + l];
        solve_triangle(model, coefficients, LANES);
        for (size_t l = 0; l < lanes; l++)
            split(model, coefficients + l, squares[l] / (double)n, fmax(left[l], 0.0) / (double)n,
                  parts, first + l);
    }
}
