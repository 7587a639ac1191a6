/* SPDX-License-Identifier: MIT */
#include "metrics/extractors/seen_spatial.h"

#include "metrics/eye.h"
#include "metrics/mirror.h"
#include "metrics/vector_math.h"

#include <math.h>
#include <string.h>

enum { STEPS = 64, SIDE = NEPH_SEEN_RADIUS_MAX_PX + 1 };

static double cosine(int distance_px, int step)
{
    return cos(distance_px * M_PI * (step + 0.5) / STEPS);
}

/* Coefficient of the series at (dy, dx): the mean of sensitivity times both cosines over all
 * frequencies. */
static double coefficient(double pixels_per_degree, int dy, int dx)
{
    const double step_cpd = 0.5 * pixels_per_degree / STEPS;
    double sum = 0.0;
    for (int v = 0; v < STEPS; v++)
        for (int u = 0; u < STEPS; u++)
            sum += neph_eye_spatial(step_cpd * hypot(u + 0.5, v + 0.5)) * cosine(dy, v) *
                   cosine(dx, u);
    return sum / (STEPS * STEPS);
}

struct neph_seen_filter neph_seen_filter_make(double pixels_per_degree)
{
    struct neph_seen_filter filter = {
        .radius_px = (int)fmin(fmax(ceil(pixels_per_degree / 15.0), 2.0), NEPH_SEEN_RADIUS_MAX_PX)};
    double weights[SIDE][SIDE], sum = 0.0;
    for (int dy = 0; dy <= filter.radius_px; dy++)
        for (int dx = 0; dx <= filter.radius_px; dx++) {
            weights[dy][dx] = coefficient(pixels_per_degree, dy, dx) * (dy ? 1.0 : 0.5) *
                              (dx ? 1.0 : 0.5);
            sum += 4.0 * weights[dy][dx];
        }
    for (int dy = 0; dy <= filter.radius_px; dy++)
        for (int dx = 0; dx <= filter.radius_px; dx++)
            filter.weights[dy][dx] = (float)(weights[dy][dx] / sum);
    return filter;
}

NEPH_VECTOR
static void add(float *restrict sums, const float *above, const float *below, int count)
{
    for (int i = 0; i < count; i++)
        sums[i] = above[i] + below[i];
}

void neph_seen_filter_row(const struct neph_seen_filter *filter, const float *plane, int width_px,
                          int height_px, int row, float *wide, float *filtered)
{
    float *inner = wide + filter->radius_px;
    memset(filtered, 0, (size_t)width_px * sizeof(*filtered));
    for (int dy = 0; dy <= filter->radius_px; dy++) {
        const int above = neph_mirrored(row - dy, height_px);
        const int below = neph_mirrored(row + dy, height_px);
        add(inner, plane + (size_t)above * (size_t)width_px,
            plane + (size_t)below * (size_t)width_px, width_px);
        neph_mirror_margins(inner, width_px, filter->radius_px);
        for (int dx = 0; dx <= filter->radius_px; dx++)
            neph_add_pairs(filtered, inner - dx, inner + dx, filter->weights[dy][dx], width_px);
    }
}
