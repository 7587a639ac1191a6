/* SPDX-License-Identifier: MIT */
#include "metrics/extractors/visible_flicker.h"

#include "base/threads.h"
#include "metrics/extractors/flicker_sums.h"
#include "metrics/vector_math.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum part { QUARTER_COS, QUARTER_SIN, HALF, MEAN, PART_COUNT };

/* The achromatic filter of FLIP, exp(-pi^2 x^2 / b) with x in degrees; the radius is that of its
 * widest filter. */
static const double achromatic_b = 0.0047, widest_b = 0.04;

struct filter {
    int radius_px;
    double *taps; /* 2 radius_px + 1 of sum 1 */
};

struct work {
    const struct neph_visible_flicker_params *params;
    struct filter filter;
    double *raw;      /* by row and part: width + 2 radius */
    double *filtered; /* by row and part: width; filtered along the row */
    double quarter_weight, half_weight;
    double *values;
};

double neph_visible_flicker_weight(double frequency_hz)
{
    const double off_peak = pow(frequency_hz, 0.1898) - pow(5.0, 0.1898);
    return exp(-off_peak * off_peak / 0.1231);
}

static enum neph_status make_filter(double pixels_per_degree, struct filter *filter,
                                    struct neph_diag *diag)
{
    const double radius_degrees = 3.0 * sqrt(widest_b / (2.0 * M_PI * M_PI));
    const int radius_px = (int)ceil(radius_degrees * pixels_per_degree);
    double *taps = calloc(2 * (size_t)radius_px + 1, sizeof(*taps));
    if (!taps)
        return neph_fail_memory(diag);
    double sum = 0.0;
    for (int k = -radius_px; k <= radius_px; k++) {
        const double x = M_PI * (double)k / pixels_per_degree;
        taps[k + radius_px] = exp(-x * x / achromatic_b);
        sum += taps[k + radius_px];
    }
    for (int k = 0; k <= 2 * radius_px; k++)
        taps[k] /= sum;
    *filter = (struct filter){radius_px, taps};
    return NEPH_OK;
}

static size_t raw_width(const struct work *work)
{
    return (size_t)work->params->width_px + 2 * (size_t)work->filter.radius_px;
}

static double *raw_at(const struct work *work, int row, int part)
{
    return work->raw + ((size_t)row * PART_COUNT + (size_t)part) * raw_width(work);
}

static double *filtered_at(const struct work *work, int row, int part)
{
    const size_t width = (size_t)work->params->width_px;
    return work->filtered + ((size_t)row * PART_COUNT + (size_t)part) * width;
}

NEPH_VECTOR
static void add_scaled(double *restrict sums, const double *restrict values, double factor,
                       int count)
{
    for (int i = 0; i < count; i++)
        sums[i] += factor * values[i];
}

static void filter_along(int row, void *context)
{
    const struct work *work = context;
    const int width = work->params->width_px, radius = work->filter.radius_px;
    double *inner[PART_COUNT];
    for (int part = 0; part < PART_COUNT; part++)
        inner[part] = raw_at(work, row, part) + radius;
    work->params->row(work->params->context, row, inner[QUARTER_COS], inner[QUARTER_SIN],
                      inner[HALF], inner[MEAN]);
    for (int part = 0; part < PART_COUNT; part++) {
        for (int k = 1; k <= radius; k++) {
            inner[part][-k] = inner[part][0];
            inner[part][width - 1 + k] = inner[part][width - 1];
        }
        for (int k = -radius; k <= radius; k++)
            add_scaled(filtered_at(work, row, part), inner[part] + k, work->filter.taps[k + radius],
                       width);
    }
}

static int clamped(int row, int row_count)
{
    return row < 0 ? 0 : row < row_count ? row : row_count - 1;
}

NEPH_VECTOR
static void weigh(const struct work *work, const double *const sums[PART_COUNT], double *values)
{
    const double *quarter_cos = sums[QUARTER_COS], *quarter_sin = sums[QUARTER_SIN];
    const double *half = sums[HALF], *mean = sums[MEAN];
    const double quarter_weight = work->quarter_weight * work->quarter_weight;
    const double half_weight = work->half_weight * work->half_weight;
    const int width = work->params->width_px;
    for (int x = 0; x < width; x++) {
        const double quarter = quarter_cos[x] * quarter_cos[x] + quarter_sin[x] * quarter_sin[x];
        const double above = quarter_weight * quarter + half_weight * half[x] * half[x];
        const double black = NEPH_VISIBLE_FLICKER_BLACK;
        values[x] = sqrt(above) /
                    ((mean[x] > black ? mean[x] : black) * NEPH_VISIBLE_FLICKER_THRESHOLD);
    }
}

/* The raw rows are not needed any more and hold the sums. */
static void filter_across(int row, void *context)
{
    const struct work *work = context;
    const int width = work->params->width_px, height = work->params->height_px;
    const int radius = work->filter.radius_px;
    double *sums[PART_COUNT];
    for (int part = 0; part < PART_COUNT; part++) {
        sums[part] = raw_at(work, row, part);
        memset(sums[part], 0, (size_t)width * sizeof(*sums[part]));
        for (int k = -radius; k <= radius; k++)
            add_scaled(sums[part], filtered_at(work, clamped(row + k, height), part),
                       work->filter.taps[k + radius], width);
    }
    weigh(work, (const double *const *)sums, work->values + (size_t)row * (size_t)width);
}

enum neph_status neph_visible_flicker(const struct neph_visible_flicker_params *params,
                                      double *values, struct neph_diag *diag)
{
    struct work work = {
        .params = params,
        .quarter_weight = neph_visible_flicker_weight(params->frame_rate_hz / 4.0),
        .half_weight = neph_visible_flicker_weight(params->frame_rate_hz / 2.0),
        .values = values,
    };
    const size_t row_count = (size_t)params->height_px * PART_COUNT;
    enum neph_status status = make_filter(params->pixels_per_degree, &work.filter, diag);
    if (status)
        return status;
    work.raw = neph_flicker_zeros(row_count * raw_width(&work));
    work.filtered = neph_flicker_zeros(row_count * (size_t)params->width_px);
    status = work.raw && work.filtered ? NEPH_OK : neph_fail_memory(diag);
    if (!status)
        status = neph_parallel_rows(params->height_px, filter_along, &work, diag);
    if (!status)
        status = neph_parallel_rows(params->height_px, filter_across, &work, diag);
    free(work.filtered);
    free(work.raw);
    free(work.filter.taps);
    return status;
}
