/* SPDX-License-Identifier: MIT */
#include "metrics/metric.h"

#include "metrics/statistics.h"
#include "metrics/vector_math.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Units as in base/image.h. */
static const struct neph_quantity quantities[] = {
    {"radiance", "W m^-2 sr^-1", "radiance with everything, R G B jointly", NULL, 3, NEPH_RADIANCE},
    {"volume", "W m^-2 sr^-1", "only in-scattered radiance, R G B jointly", "volume", 3,
     NEPH_VOLUME},
    {"transmittance", "1", "camera to the first solid or to infinity, R G B jointly",
     "transmittance", 3, NEPH_TRANSMITTANCE},
    {"depth", "m", "linear eye depth where both images see a solid", "Z", 1, NEPH_DEPTH},
};

enum { QUANTITY_COUNT = sizeof(quantities) / sizeof(quantities[0]) };

int neph_quantity_count(void)
{
    return QUANTITY_COUNT;
}

const struct neph_quantity *neph_quantity_at(int index)
{
    return index >= 0 && index < QUANTITY_COUNT ? &quantities[index] : NULL;
}

const struct neph_quantity *neph_quantity_find(const char *name)
{
    for (int i = 0; i < QUANTITY_COUNT; i++)
        if (strcmp(quantities[i].name, name) == 0)
            return &quantities[i];
    return NULL;
}

bool neph_quantity_planes(const struct neph_quantity *quantity, const struct neph_image *image,
                          const float *planes[3])
{
    float *found[3] = {NULL, NULL, NULL};
    if (quantity->plane_count == 3 && !neph_image_rgb(image, quantity->layer, found))
        return false;
    if (quantity->plane_count == 1) {
        found[0] = neph_image_channel(image, quantity->layer);
        if (!found[0])
            return false;
    }
    for (int c = 0; c < 3; c++)
        planes[c] = found[c];
    return true;
}

/* ---- planes and means
 * -------------------------------------------------------------------------- */

enum { LANES = 8 }; /* partial sums; fixed, so that the order of additions is defined */

NEPH_VECTOR static void add_luminance(const float *restrict r, const float *restrict g,
                                      const float *restrict b, size_t count, double *restrict lanes)
{
    size_t i = 0;
    for (; i + LANES <= count; i += LANES)
        for (size_t l = 0; l < LANES; l++)
            lanes[l] += neph_luminance((double)r[i + l], (double)g[i + l], (double)b[i + l]);
    for (; i < count; i++)
        lanes[0] += neph_luminance((double)r[i], (double)g[i], (double)b[i]);
}

/* Add up the finite depths of a row; returns their number. */
static size_t add_depth(const float *depth_m, size_t count, double *sum)
{
    size_t solid_count = 0;
    for (size_t i = 0; i < count; i++) {
        const bool is_sky = depth_m[i] == INFINITY;
        *sum += is_sky ? 0.0 : (double)depth_m[i];
        solid_count += !is_sky;
    }
    return solid_count;
}

double neph_quantity_mean(const struct neph_quantity *quantity, const float *const planes[3],
                          int width_px, int height_px)
{
    const size_t width = (size_t)width_px;
    struct neph_sum sum = {0};
    size_t count = 0;
    for (size_t row = 0; row < (size_t)height_px; row++) {
        const size_t first = row * width;
        double lanes[LANES] = {0.0};
        if (quantity->bit == NEPH_DEPTH)
            count += add_depth(planes[0] + first, width, &lanes[0]);
        else
            add_luminance(planes[0] + first, planes[1] + first, planes[2] + first, width, lanes);
        if (quantity->bit != NEPH_DEPTH)
            count += width;
        for (int l = 0; l < LANES; l++)
            neph_sum_add(&sum, lanes[l]);
    }
    const double mean = count > 0 ? neph_sum_value(&sum) / (double)count : 0.0;
    return mean > 0.0 && isfinite(mean) ? mean : NAN;
}

NEPH_VECTOR uint32_t neph_count_not_finite(const float *values, size_t count)
{
    uint32_t bad = 0;
    for (size_t i = 0; i < count; i++)
        bad += fabsf(values[i]) <= FLT_MAX ? 0u : 1u;
    return bad;
}
