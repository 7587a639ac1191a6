/* SPDX-License-Identifier: MIT */
#include "metrics/mirror.h"

#include "metrics/vector_math.h"

void neph_mirror_margins(float *row, int count, int margin)
{
    for (int k = 1; k <= margin; k++) {
        row[-k] = row[neph_mirrored(-k, count)];
        row[count - 1 + k] = row[neph_mirrored(count - 1 + k, count)];
    }
}

NEPH_VECTOR
void neph_add_pairs(float *restrict sums, const float *before, const float *after, float weight,
                    int count)
{
    for (int i = 0; i < count; i++)
        sums[i] += weight * (before[i] + after[i]);
}
