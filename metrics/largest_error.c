/* SPDX-License-Identifier: MIT */
#include "metrics/largest_error.h"

#include "metrics/metric.h"
#include "metrics/vector_math.h"

#include <math.h>

/* Compared as floats: the largest of a row is found in vectors, and looked up once. */
NEPH_VECTOR static float find_row_maximum(const float *reference, const float *test, int count)
{
    float most = 0.0f;
    for (int i = 0; i < count; i++) {
        const float d = fabsf(test[i] - reference[i]);
        most = d > most ? d : most;
    }
    return most;
}

static void take_row(struct neph_largest_error *largest, const float *reference, const float *test,
                     int count, const struct neph_largest_error *place)
{
    for (int x = 0; x < count; x++) {
        const double r = (double)reference[x], t = (double)test[x];
        if (!(fabs(t - r) > fabs(largest->test - largest->reference)))
            continue;
        *largest = *place;
        largest->x_px = x;
        largest->reference = r;
        largest->test = t;
    }
}

void neph_largest_error_add(struct neph_largest_error *largest, const struct neph_image *reference,
                            const struct neph_image *test, int frame)
{
    const struct neph_quantity *radiance = neph_quantity_find("radiance");
    const float *r[3], *t[3];
    if (!neph_quantity_planes(radiance, reference, r) || !neph_quantity_planes(radiance, test, t))
        return;
    const int width = reference->width_px;
    for (int y = 0; y < reference->height_px; y++)
        for (int c = 0; c < 3; c++) {
            const size_t first = (size_t)y * (size_t)width;
            const struct neph_largest_error place = {true, frame, 0, y, "RGB"[c], 0.0, 0.0};
            if ((double)find_row_maximum(r[c] + first, t[c] + first, width) * (1.0 + 0x1p-20) >
                fabs(largest->test - largest->reference))
                take_row(largest, r[c] + first, t[c] + first, width, &place);
        }
}
