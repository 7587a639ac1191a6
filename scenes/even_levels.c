/* SPDX-License-Identifier: MIT */
#include "scenes/even_levels.h"

#include <math.h>

/* The lower end of cell i; of cell `count` the upper end of the last. */
static double find_end(struct neph_levels all, int i)
{
    const double *levels = all.at;
    const int count = all.count;
    if (all.are_ends)
        return levels[i];
    if (i == 0)
        return levels[0] - 0.5 * (levels[1] - levels[0]);
    if (i == count)
        return levels[count - 1] + 0.5 * (levels[count - 1] - levels[count - 2]);
    return 0.5 * (levels[i - 1] + levels[i]);
}

bool neph_are_levels_even(struct neph_levels levels, int most, struct neph_even_levels *even)
{
    const double *at = levels.at, low = find_end(levels, 0), high = find_end(levels, levels.count);
    const int steps = levels.are_ends ? levels.count : levels.count - 1;
    const double spacing = (at[steps] - at[0]) / steps;
    double off = 0.0, thinnest = INFINITY;
    for (int i = 0; i <= steps; i++)
        off = fmax(off, fabs(at[i] - at[0] - i * spacing));
    for (int i = 0; i < levels.count; i++)
        thinnest = fmin(thinnest, find_end(levels, i + 1) - find_end(levels, i));
    if (off <= NEPH_EVEN_LEVELS_TOLERANCE * spacing) {
        const double first = levels.are_ends ? at[0] + 0.5 * spacing : at[0];
        *even = (struct neph_even_levels){levels.count, first, spacing};
        return true;
    }
    const double cells = fmin(most, ceil((high - low) / thinnest - NEPH_EVEN_LEVELS_TOLERANCE));
    const double thickness = (high - low) / cells;
    *even = (struct neph_even_levels){(int)cells, low + 0.5 * thickness, thickness};
    return false;
}

/* Adds `weight` times a row to another. */
static void add_row(const float *from, double weight, size_t count, float *to)
{
    for (size_t i = 0; i < count; i++)
        to[i] += (float)(weight * (double)from[i]);
}

static double sum_row(const float *row, size_t count)
{
    double sum = 0.0;
    for (size_t i = 0; i < count; i++)
        sum += (double)row[i];
    return sum;
}

double neph_even_levels_resample(struct neph_levels levels, const struct neph_even_levels *even,
                                 size_t outer, size_t inner, const float *values, float *to)
{
    const int count = levels.count;
    const double low = even->first - 0.5 * even->spacing;
    double before = 0.0, after = 0.0;
    for (size_t o = 0; o < outer; o++) {
        const float *from = values + o * (size_t)count * inner;
        float *target = to + o * (size_t)even->count * inner;
        int i = 0;
        for (int cell = 0; cell < even->count; cell++) {
            const double start = low + cell * even->spacing, end = start + even->spacing;
            float *row = target + (size_t)cell * inner;
            for (size_t n = 0; n < inner; n++)
                row[n] = 0.0F;
            while (i < count - 1 && find_end(levels, i + 1) <= start)
                i++;
            for (int k = i; k < count && find_end(levels, k) < end; k++) {
                const double overlap = fmin(end, find_end(levels, k + 1)) -
                                       fmax(start, find_end(levels, k));
                if (overlap > 0.0)
                    add_row(from + (size_t)k * inner, overlap / even->spacing, inner, row);
            }
            after += even->spacing * sum_row(row, inner);
        }
        for (int k = 0; k < count; k++)
            before += (find_end(levels, k + 1) - find_end(levels, k)) *
                      sum_row(from + (size_t)k * inner, inner);
    }
    return before > 0.0 ? after / before - 1.0 : 0.0;
}
