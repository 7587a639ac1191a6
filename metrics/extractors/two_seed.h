/* SPDX-License-Identifier: MIT
 *
 * Squared error against a noisy reference, without the reference's noise.
 *
 * A and B are two independent seeds of the reference and T is the test. E[(T - A)(T - B)] is the
 * squared error of T against the true image (plus the variance of T if T is noisy). In contrast, (T
 * - mean(A, B))^2 also contains half the variance of a seed. E[(A - B)^2] / 2 is that variance.
 */
#ifndef NEPH_METRICS_EXTRACTORS_TWO_SEED_H
#define NEPH_METRICS_EXTRACTORS_TWO_SEED_H

#include <stdbool.h>

/* The verdict "at noise floor": the error is below the noise of one seed of the reference, both
 * over the same mask and in one unit (rmse_unbiased and reference_noise_rmse). Such tests are not
 * ranked against each other; a reference with more samples could do so. */
static inline bool neph_is_at_noise_floor(double rmse_unbiased, double reference_noise_rmse)
{
    return rmse_unbiased < reference_noise_rmse;
}

#endif
