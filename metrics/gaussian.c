/* SPDX-License-Identifier: MIT */
#include "metrics/gaussian.h"

#include "base/threads.h"
#include "metrics/mirror.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct blur {
    float *plane;   /* by row */
    float *wide;    /* rows with a margin on both sides; owned */
    float *weights; /* weights of the distances 0 .. radius_px, halved at 0; owned */
    int width_px, height_px, radius_px;
};

static float *wide_row(const struct blur *blur, int row)
{
    const size_t width = (size_t)(blur->width_px + 2 * blur->radius_px);
    return blur->wide + (size_t)row * width + (size_t)blur->radius_px;
}

static float *plane_row(const struct blur *blur, int row)
{
    return blur->plane + (size_t)row * (size_t)blur->width_px;
}

/* Blur the rows of the plane, into the inner part of the wide rows. */
static void blur_along(int row, void *context)
{
    const struct blur *blur = context;
    const size_t size = (size_t)blur->width_px * sizeof(*blur->plane);
    float *wide = wide_row(blur, row), *sums = plane_row(blur, row);
    memcpy(wide, sums, size);
    memset(sums, 0, size);
    neph_mirror_margins(wide, blur->width_px, blur->radius_px);
    for (int k = 0; k <= blur->radius_px; k++)
        neph_add_pairs(sums, wide - k, wide + k, blur->weights[k], blur->width_px);
    memcpy(wide, sums, size);
}

static void blur_across(int row, void *context)
{
    const struct blur *blur = context;
    const int height = blur->height_px;
    float *sums = plane_row(blur, row);
    memset(sums, 0, (size_t)blur->width_px * sizeof(*sums));
    for (int k = 0; k <= blur->radius_px; k++)
        neph_add_pairs(sums, wide_row(blur, neph_mirrored(row - k, height)),
                       wide_row(blur, neph_mirrored(row + k, height)), blur->weights[k],
                       blur->width_px);
}

static void fill_weights(const struct blur *blur, double sigma_px)
{
    double sum = 0.0;
    for (int k = -blur->radius_px; k <= blur->radius_px; k++)
        sum += exp(-0.5 * (k / sigma_px) * (k / sigma_px));
    for (int k = 0; k <= blur->radius_px; k++)
        blur->weights[k] = (float)(exp(-0.5 * (k / sigma_px) * (k / sigma_px)) / sum *
                                   (k == 0 ? 0.5 : 1.0));
}

enum neph_status neph_gaussian_blur(float *plane, int width_px, int height_px, double sigma_px,
                                    struct neph_diag *diag)
{
    struct blur blur = {.plane = plane,
                        .width_px = width_px,
                        .height_px = height_px,
                        .radius_px = (int)ceil(3.0 * sigma_px)};
    const size_t wide_width = (size_t)(width_px + 2 * blur.radius_px);
    blur.weights = malloc(((size_t)blur.radius_px + 1) * sizeof(*blur.weights));
    blur.wide = malloc((size_t)height_px * wide_width * sizeof(*blur.wide));
    enum neph_status status = blur.weights && blur.wide ? NEPH_OK : neph_fail_memory(diag);
    if (!status) {
        fill_weights(&blur, sigma_px);
        status = neph_parallel_rows(height_px, blur_along, &blur, diag);
    }
    if (!status)
        status = neph_parallel_rows(height_px, blur_across, &blur, diag);
    free(blur.weights);
    free(blur.wide);
    return status;
}
