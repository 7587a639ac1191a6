/* SPDX-License-Identifier: MIT
 *
 * Repetitions of a point with several seeds: their seeds, and the mean with its interval.
 */
#ifndef NEPH_HARNESS_SWEEP_REPEAT_H
#define NEPH_HARNESS_SWEEP_REPEAT_H

#include "harness/sweep/results.h"

/* Repetition numbers of the ground truth's two frames; points have lower numbers. */
enum { NEPH_SWEEP_TRUTH_REPEAT = 1000 };

/* The seed of a repetition (from 0) in a sweep. Sweeps with different seeds, up to 2^20, share no
 * seed and are independent. */
uint64_t neph_sweep_seed(uint64_t seed, int repeat);

/* The mean of `count` >= 1 values from independent seeds. Its interval combines the interval of
 * each value over the frame with the 95 % interval over seeds (Student's t): their variances add
 * up. A single value is returned as it is. NaN where one of the values is. */
struct neph_sweep_value neph_sweep_repeated(const struct neph_sweep_value *values, int count);

#endif
