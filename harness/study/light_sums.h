/* SPDX-License-Identifier: MIT
 *
 * How far a lighting model is from the tracer, over sets of pixels. The tracer's own noise is taken
 * out: it rendered each picture twice, with seeds of their own, so the mean of (model - first)
 * (model - second) is the mean square of what the model is off by, without bias.
 */
#ifndef NEPH_HARNESS_STUDY_LIGHT_SUMS_H
#define NEPH_HARNESS_STUDY_LIGHT_SUMS_H

/* Start from {0}. */
struct neph_light_sums {
    long count;
    double model, truth; /* radiances; the truth is the mean of both seeds */
    double product;      /* (model - first) (model - second) */
    double noise;        /* ((first - second) / 2)^2: the variance of the truth */
};

void neph_light_sums_add(struct neph_light_sums *sums, double model, double first, double second);

/* As if all pixels of `more` had been added. */
void neph_light_sums_merge(struct neph_light_sums *sums, const struct neph_light_sums *more);

/* Mean of the model over mean of the truth; NaN where the truth is dark or there is no pixel. */
double neph_light_ratio(const struct neph_light_sums *sums);

/* The ratio less 1, and its standard error by the tracer's noise alone. */
double neph_light_bias(const struct neph_light_sums *sums);
double neph_light_bias_noise(const struct neph_light_sums *sums);

/* Root of the mean square over the mean of the truth, noise taken out; 0 where noise is all that is
 * left. */
double neph_light_rms(const struct neph_light_sums *sums);

/* ---- axes ------------------------------------------------------------------------------------ */

/* What pixels are sorted by. */
enum neph_light_axis {
    NEPH_LIGHT_EYE,   /* optical depth of the view ray */
    NEPH_LIGHT_SUN,   /* optical depth towards the sun, from the middle of what is seen */
    NEPH_LIGHT_ANGLE, /* between the view ray and the direction to the sun [degrees] */
    NEPH_LIGHT_AXES,
};

enum { NEPH_LIGHT_BINS = 7 };

/* Bin i holds edges[i] <= value < edges[i + 1]; the last one its upper edge too. */
struct neph_light_axis_row {
    const char *title;
    double edges[NEPH_LIGHT_BINS + 1]; /* the last may be infinite */
};
extern const struct neph_light_axis_row neph_light_axes[NEPH_LIGHT_AXES];

/* -1: outside. */
int neph_light_bin(enum neph_light_axis axis, double value);

#endif
