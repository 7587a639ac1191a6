/* SPDX-License-Identifier: MIT
 *
 * Error of a lighting model against the tracer, over sets of pixels.
 *
 * The tracer renders each frame twice, with independent seeds. The mean of (model - first) (model -
 * second) is an unbiased estimate of the model's mean squared error: the noise of the two seeds is
 * independent, so its product averages to 0.
 */
#ifndef NEPH_HARNESS_STUDY_LIGHT_SUMS_H
#define NEPH_HARNESS_STUDY_LIGHT_SUMS_H

/* Initialise with {0}. */
struct neph_light_sums {
    long count;
    double model, truth; /* sums of radiances; the truth is the mean of both seeds */
    double product;      /* sum of (model - first) (model - second) */
    double noise;        /* sum of ((first - second) / 2)^2: the variance of the summed truth */
};

/* Adds a pixel: radiance of the model and of the tracer's two seeds. */
void neph_light_sums_add(struct neph_light_sums *sums, double model, double first, double second);

/* Adds all pixels of `more`. */
void neph_light_sums_merge(struct neph_light_sums *sums, const struct neph_light_sums *more);

/* Mean of the model over mean of the truth; NaN without pixels or with a dark truth. */
double neph_light_ratio(const struct neph_light_sums *sums);

/* The ratio minus 1, and its standard error from the tracer's noise. */
double neph_light_bias(const struct neph_light_sums *sums);
double neph_light_bias_noise(const struct neph_light_sums *sums);

/* Root mean squared error over the mean of the truth, without the noise; 0 where noise dominates.
 */
double neph_light_rms(const struct neph_light_sums *sums);

/* ---- axes ------------------------------------------------------------------------------------ */

/* Quantities by which pixels are binned. */
enum neph_light_axis {
    NEPH_LIGHT_EYE,   /* optical depth of the view ray */
    NEPH_LIGHT_SUN,   /* optical depth towards the sun, from the middle of the visible medium
                         (neph_light_view) */
    NEPH_LIGHT_ANGLE, /* angle between view ray and direction to the sun [degrees] */
    NEPH_LIGHT_AXES,
};

enum { NEPH_LIGHT_BINS = 7 };

/* Bin i contains edges[i] <= value < edges[i + 1]; the last bin also its upper edge. */
struct neph_light_axis_row {
    const char *title;
    double edges[NEPH_LIGHT_BINS + 1]; /* the last may be infinite */
};
extern const struct neph_light_axis_row neph_light_axes[NEPH_LIGHT_AXES];

/* Index of the bin; -1: outside. */
int neph_light_bin(enum neph_light_axis axis, double value);

#endif
