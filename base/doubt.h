/* SPDX-License-Identifier: MIT
 *
 * Whether the standard error of a frame by Monte Carlo is to be trusted. Its square is an estimate
 * from the same paths, and where a few rare paths make most of it, it is too small in most frames.
 * The relative variance of the variance measures that.
 */
#ifndef NEPH_BASE_DOUBT_H
#define NEPH_BASE_DOUBT_H

#include "base/image.h"

/* From this relative variance of the variance on, an error bar is not to be trusted: a few paths
 * make most of it, or there are few (X-5 Monte Carlo Team, "MCNP", vol. I, LA-UR-03-1987, 2003,
 * section 2.VI.E). */
#define NEPH_DOUBTFUL 0.1

enum { NEPH_DOUBT_ROOM = 160 }; /* characters of a description */

/* Sums over the pixels of a frame. Start from {0}. */
struct neph_doubt {
    double variance, squares; /* of the pixels' means; of the variances' own standard errors */
    size_t noisy, doubtful;   /* pixels with noise; those of them with a doubtful error bar */
};

/* Add a pixel: the variance of its mean, and the relative variance of that variance. Pixels without
 * variance are not counted. */
void neph_doubt_add(struct neph_doubt *doubt, double variance, double doubt_of_pixel);

/* The relative variance of the frame's variance (the mean over its pixels); 0: no noise. Not finite
 * sums: 1, the largest value. */
double neph_doubt_of_frame(const struct neph_doubt *doubt);

/* Write the attributes neph.noise.doubt, the above, and neph.noise.doubtful_pixels, the share of
 * the noisy pixels whose own error bar is doubtful. */
enum neph_status neph_doubt_label(struct neph_image *frame, const struct neph_doubt *doubt,
                                  struct neph_diag *diag);

/* The first attribute; NaN: the frame has none. */
double neph_doubt_read(const struct neph_image *frame);

/* "error bar not trusted: ..." with the remedy; empty if the error bar is to be trusted, or not
 * known. */
void neph_doubt_describe(double doubt_of_frame, char *text, size_t size);

#endif
