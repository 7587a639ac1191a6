/* SPDX-License-Identifier: MIT
 *
 * The mean of independent values with its standard error, and whether that is to be trusted
 * (base/doubt.h).
 */
#ifndef NEPH_TRUTH_MOMENTS_H
#define NEPH_TRUTH_MOMENTS_H

/* The first four powers of a value less the first one, summed: without the difference the fourth
 * moment would cancel. Only doubles, for checkpoints. Start from {0}. */
struct neph_moments {
    double count, first, powers[4];
};

struct neph_moments_estimate {
    double mean, standard_error; /* NaN: too few values */
    double doubt;                /* relative variance of the variance of the mean; 0: no variance */
};

void neph_moments_add(struct neph_moments *moments, double value);

struct neph_moments_estimate neph_moments_estimate(const struct neph_moments *moments);

#endif
