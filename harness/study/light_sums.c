/* SPDX-License-Identifier: MIT
 *
 * Sums of a lighting model's error and the bins of pixels.
 */
#include "harness/study/light_sums.h"

#include <math.h>

/* Fails to compile when an axis is added, as the table of axes needs a row for it. */
_Static_assert(NEPH_LIGHT_AXES == 3, "a new kind");

void neph_light_sums_add(struct neph_light_sums *sums, double model, double first, double second)
{
    const double half_difference = 0.5 * (first - second);
    sums->count++;
    sums->model += model;
    sums->truth += 0.5 * (first + second);
    sums->product += (model - first) * (model - second);
    sums->noise += half_difference * half_difference;
}

void neph_light_sums_merge(struct neph_light_sums *sums, const struct neph_light_sums *more)
{
    sums->count += more->count;
    sums->model += more->model;
    sums->truth += more->truth;
    sums->product += more->product;
    sums->noise += more->noise;
}

double neph_light_ratio(const struct neph_light_sums *sums)
{
    return sums->truth > 0.0 ? sums->model / sums->truth : NAN;
}

double neph_light_bias(const struct neph_light_sums *sums)
{
    return neph_light_ratio(sums) - 1.0;
}

/* The variance of the summed truth is `noise`; the ratio's relative error is its square root over
 * the sum. */
double neph_light_bias_noise(const struct neph_light_sums *sums)
{
    return neph_light_ratio(sums) * sqrt(sums->noise) / sums->truth;
}

double neph_light_rms(const struct neph_light_sums *sums)
{
    if (!(sums->truth > 0.0))
        return NAN;
    return sqrt(fmax(sums->product, 0.0) * (double)sums->count) / sums->truth;
}

/* ---- axes ------------------------------------------------------------------------------------ */

/* Edges: at ln 10, where the dense parts begin, the transmittance is 1/10. */
const struct neph_light_axis_row neph_light_axes[NEPH_LIGHT_AXES] = {
    [NEPH_LIGHT_EYE] = {"optical depth towards the eye",
                        {0.01, 0.1, 0.5, M_LN10, 5.0, 10.0, 30.0, INFINITY}},
    [NEPH_LIGHT_SUN] = {"optical depth towards the sun",
                        {0.0, 0.1, 0.5, 1.5, 5.0, 15.0, 50.0, INFINITY}},
    [NEPH_LIGHT_ANGLE] = {"angle to the sun [degrees]",
                          {0.0, 30.0, 60.0, 80.0, 100.0, 120.0, 150.0, 180.0}},
};

int neph_light_bin(enum neph_light_axis axis, double value)
{
    const double *edges = neph_light_axes[axis].edges;
    if (!(value >= edges[0] && value <= edges[NEPH_LIGHT_BINS]))
        return -1;
    int bin = 0;
    while (bin < NEPH_LIGHT_BINS - 1 && value >= edges[bin + 1])
        bin++;
    return bin;
}
