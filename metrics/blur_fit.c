/* SPDX-License-Identifier: MIT */
#include "metrics/blur_fit.h"

#include "metrics/gaussian.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double coarse_px = 0.1, fine_px = 0.001;

/* The sum of squared differences with a blur; `plane` is work space. */
static enum neph_status compute_error(const struct neph_blur_fit *fit, double sigma_px,
                                      float *plane, double *error, struct neph_diag *diag)
{
    const size_t count = (size_t)fit->width_px * (size_t)fit->height_px;
    enum neph_status status = NEPH_OK;
    *error = 0.0;
    for (int frame = 0; frame < fit->frame_count && !status; frame++) {
        memcpy(plane, fit->sharp[frame], count * sizeof(*plane));
        if (sigma_px > 0.0)
            status = neph_gaussian_blur(plane, fit->width_px, fit->height_px, sigma_px, diag);
        for (size_t i = 0; i < count && !status; i++) {
            const double difference = (double)plane[i] - (double)fit->blurred[frame][i];
            *error += difference * difference;
        }
    }
    return status;
}

/* A grid, then finer grids around the best of the one before. Of equal errors the smallest blur
 * counts. */
static enum neph_status search(const struct neph_blur_fit *fit, float *plane, double *sigma_px,
                               struct neph_diag *diag)
{
    double low_px = 0.0, high_px = NEPH_BLUR_FIT_MOST_PX, best_px = 0.0, least = INFINITY;
    enum neph_status status = NEPH_OK;
    for (double step_px = coarse_px; step_px > 0.5 * fine_px && !status; step_px /= 10.0) {
        const int last = (int)lround((high_px - low_px) / step_px);
        for (int i = 0; i <= last && !status; i++) {
            const double tried_px = low_px + i * step_px;
            double error;
            status = compute_error(fit, tried_px, plane, &error, diag);
            if (status || error >= least)
                continue;
            least = error;
            best_px = tried_px;
        }
        low_px = fmax(best_px - step_px, 0.0);
        high_px = fmin(best_px + step_px, NEPH_BLUR_FIT_MOST_PX);
    }
    if (!status)
        *sigma_px = best_px;
    return status;
}

enum neph_status neph_blur_fit_find(const struct neph_blur_fit *fit, double *sigma_px,
                                    struct neph_diag *diag)
{
    float *plane = malloc((size_t)fit->width_px * (size_t)fit->height_px * sizeof(*plane));
    const enum neph_status status = plane ? search(fit, plane, sigma_px, diag)
                                          : neph_fail_memory(diag);
    free(plane);
    return status;
}
