/* SPDX-License-Identifier: MIT
 *
 * The relative noise of frames.
 */
#include "harness/run/noise.h"

#include <math.h>

static double ratio(double variance, double power)
{
    return variance > 0.0 ? sqrt(variance / power) : 0.0;
}

double neph_noise_from_variance(const struct neph_image *frame)
{
    float *radiance[3], *variance[3];
    if (!neph_image_rgb(frame, NULL, radiance) || !neph_image_rgb(frame, "variance", variance))
        return NAN;
    double sum = 0.0, power = 0.0;
    for (int c = 0; c < 3; c++)
        for (size_t i = 0; i < neph_image_pixel_count(frame); i++) {
            sum += (double)variance[c][i];
            power += (double)radiance[c][i] * (double)radiance[c][i];
        }
    return ratio(sum, power);
}

double neph_noise_from_two_seeds(const struct neph_image *a, const struct neph_image *b)
{
    float *first[3], *second[3];
    if (!neph_image_rgb(a, NULL, first) || !neph_image_rgb(b, NULL, second) ||
        a->width_px != b->width_px || a->height_px != b->height_px)
        return NAN;
    double sum = 0.0, power = 0.0;
    for (int c = 0; c < 3; c++)
        for (size_t i = 0; i < neph_image_pixel_count(a); i++) {
            const double difference = (double)first[c][i] - (double)second[c][i];
            sum += 0.5 * difference * difference;
            power += (double)first[c][i] * (double)second[c][i]; /* product of independent
                                                                    estimates: no noise bias */
        }
    return ratio(sum, power);
}
