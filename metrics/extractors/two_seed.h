/* SPDX-License-Identifier: MIT
 *
 * Squared error against a noisy reference, with the noise of the reference taken out.
 *
 * With A and B two independent seeds of the reference and T the test, E[(T - A)(T - B)] is the
 * square of what T is off the true image (plus the variance of T, if T is noisy too), whereas
 * (T - mean(A, B))^2 has half the variance of a seed on top. E[(A - B)^2] / 2 is that variance.
 */
#ifndef NEPH_METRICS_EXTRACTORS_TWO_SEED_H
#define NEPH_METRICS_EXTRACTORS_TWO_SEED_H

#include <stdbool.h>

/* The verdict "at noise floor": the error is smaller than the noise of one seed of the reference,
 * both over the same mask (rmse_unbiased and reference_noise_rmse, in one unit). Such a test is not
 * said to be better or worse than another of its kind; a reference with more samples can tell. */
static inline bool neph_is_at_noise_floor(double rmse_unbiased, double reference_noise_rmse)
{
    return rmse_unbiased < reference_noise_rmse;
}

#endif
