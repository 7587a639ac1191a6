/* SPDX-License-Identifier: MIT
 *
 * What a point has of several seeds: a number that another seed would change has an interval that
 * says by how much.
 */
#ifndef NEPH_HARNESS_SWEEP_REPEAT_H
#define NEPH_HARNESS_SWEEP_REPEAT_H

#include "harness/sweep/results.h"

/* The truth's two pictures are these repetitions; those of points are before them. */
enum { NEPH_SWEEP_TRUTH_REPEAT = 1000 };

/* The seed of a repetition, from 0 on, in a sweep of that seed. Sweeps with other seeds, up to
 * 2^20, share none of theirs: they are independent. */
uint64_t neph_sweep_seed(uint64_t seed, int repeat);

/* One value of `count` >= 1 of independent seeds: their mean. Its interval holds what differs over
 * the picture, which is that of each, and what differs over seeds, Student's, 95 %: variances of
 * both add up. One value stays as it is. NaN where one of them is. */
struct neph_sweep_value neph_sweep_repeated(const struct neph_sweep_value *values, int count);

#endif
