/* SPDX-License-Identifier: MIT */
#include "base/doubt.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const char frame_name[] = "neph.noise.doubt", pixels_name[] = "neph.noise.doubtful_pixels";

void neph_doubt_add(struct neph_doubt *doubt, double variance, double doubt_of_pixel)
{
    if (variance == 0.0)
        return;
    doubt->variance += variance;
    doubt->squares += doubt_of_pixel * variance * variance;
    doubt->noisy++;
    doubt->doubtful += !(doubt_of_pixel <= NEPH_DOUBTFUL);
}

double neph_doubt_of_frame(const struct neph_doubt *doubt)
{
    if (doubt->noisy == 0)
        return 0.0;
    const double found = doubt->squares / doubt->variance / doubt->variance;
    return isfinite(found) ? found : 1.0;
}

enum neph_status neph_doubt_label(struct neph_image *frame, const struct neph_doubt *doubt,
                                  struct neph_diag *diag)
{
    const double share = doubt->noisy > 0 ? (double)doubt->doubtful / (double)doubt->noisy : 0.0;
    const enum neph_status status = neph_image_set_attribute(frame, frame_name, diag, "%.3g",
                                                             neph_doubt_of_frame(doubt));
    return status ? status : neph_image_set_attribute(frame, pixels_name, diag, "%.3g", share);
}

double neph_doubt_read(const struct neph_image *frame)
{
    const char *text = neph_image_attribute(frame, frame_name);
    char *end;
    const double value = text ? strtod(text, &end) : NAN;
    return text && end != text && value >= 0.0 ? value : NAN;
}

void neph_doubt_describe(double doubt_of_frame, char *text, size_t size)
{
    text[0] = '\0';
    if (doubt_of_frame > NEPH_DOUBTFUL)
        snprintf(text, size,
                 "error bar not trusted: a few paths make most of it (variance of the variance "
                 "%.2g, above %g); take more samples",
                 doubt_of_frame, NEPH_DOUBTFUL);
}
