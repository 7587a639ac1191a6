/* SPDX-License-Identifier: MIT */
#include "metrics/statistics.h"

#include <stdint.h>

static void swap(double *a, double *b)
{
    double kept = *a;
    *a = *b;
    *b = kept;
}

/* Reorder so that values[rank] is the value at that rank of the sorted array, with no larger value
 * before it and no smaller one after it. Quickselect (Hoare, CACM 4, 1961, algorithm 65) with
 * pseudo-random pivots, because fixed pivots are slow on regular images. */
static double select_rank(double *values, size_t count, size_t rank)
{
    uint64_t state = 0;
    size_t first = 0, last = count - 1;
    while (first < last) {
        state = state * 6364136223846793005u + 1442695040888963407u; /* Knuth's MMIX */
        double pivot = values[first + (size_t)(state >> 33) % (last - first + 1)];
        size_t i = first, j = last;
        for (;;) {
            while (values[i] < pivot)
                i++;
            while (values[j] > pivot)
                j--;
            if (i >= j)
                break;
            swap(&values[i++], &values[j--]);
        }
        /* Now values[first .. i - 1] <= pivot <= values[j + 1 .. last], and either i == j with the
         * pivot itself there, or i == j + 1. */
        if (i == j && rank == i)
            return values[rank];
        if (rank < i)
            last = i - 1;
        else
            first = j + 1;
    }
    return values[rank];
}

double neph_percentile(double *values, size_t count, double share)
{
    double position = (double)(count - 1) * share;
    size_t rank = (size_t)position;
    double below = select_rank(values, count, rank);
    if (rank + 1 == count)
        return below;
    double above = values[rank + 1];
    for (size_t i = rank + 2; i < count; i++)
        above = fmin(above, values[i]);
    return below + (position - (double)rank) * (above - below);
}

struct neph_relative_error neph_relative_error_compute(const float *const reference[],
                                                       const float *const test[], int plane_count,
                                                       size_t count)
{
    struct neph_sum differences = {0.0, 0.0}, squares = {0.0, 0.0}, whole = {0.0, 0.0};
    for (int p = 0; p < plane_count; p++)
        for (size_t i = 0; i < count; i++) {
            const double d = (double)test[p][i] - (double)reference[p][i];
            neph_sum_add(&differences, d);
            neph_sum_add(&squares, d * d);
            neph_sum_add(&whole, (double)reference[p][i]);
        }
    const double samples = (double)plane_count * (double)count;
    const double mean = neph_sum_value(&whole) / samples;
    if (!(mean > 0.0))
        return (struct neph_relative_error){NAN, NAN};
    return (struct neph_relative_error){neph_sum_value(&differences) / samples / mean,
                                        sqrt(neph_sum_value(&squares) / samples) / mean};
}
