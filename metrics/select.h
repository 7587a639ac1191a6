/* SPDX-License-Identifier: MIT
 *
 * Order statistics of millions of values without sorting. Values are stored as keys: unsigned
 * integers with the same order as their floats.
 */
#ifndef NEPH_METRICS_SELECT_H
#define NEPH_METRICS_SELECT_H

#include "base/status.h"

#include <float.h>
#include <stdint.h>
#include <string.h>

#define NEPH_KEY_OF_ZERO 0x80000000u

/* The key of a finite double, rounded to float (relative error 6e-8) and clamped to FLT_MAX. */
static inline uint32_t neph_key_from_value(double value)
{
    const float rounded_freely = (float)value;
    const float above = rounded_freely < -FLT_MAX ? -FLT_MAX : rounded_freely;
    const float rounded = above > FLT_MAX ? FLT_MAX : above;
    uint32_t bits;
    memcpy(&bits, &rounded, sizeof(bits));
    return bits ^ ((uint32_t)((int32_t)bits >> 31) | 0x80000000u);
}

static inline double neph_key_value(uint32_t key)
{
    const uint32_t bits = key ^ (((key >> 31) - 1) | 0x80000000u);
    float value;
    memcpy(&value, &bits, sizeof(value));
    return (double)value;
}

/* Runs of keys: run r has counts[r] keys from keys[first[r]] on. */
struct neph_key_runs {
    const uint32_t *keys;
    const size_t *first;
    const uint32_t *counts;
    int run_count;
    size_t key_count; /* total over all runs */
};

/* The order statistics of a set of keys; created once, queried often. */
struct neph_selector;

/* Create a selector; `runs` is borrowed for its life. NEPH_ERR_MEMORY. */
enum neph_status neph_selector_create(const struct neph_key_runs *runs,
                                      struct neph_selector **selector, struct neph_diag *diag);
void neph_selector_destroy(struct neph_selector *selector); /* NULL is allowed */

/* The key at a rank, 0 .. key_count - 1 in ascending order. */
uint32_t neph_select_rank(struct neph_selector *selector, size_t rank);

/* Announce percentiles that will be requested: a few of them then cost one pass over all keys
 * instead of one pass each. The results do not change. key_count >= 1. */
enum neph_status neph_select_expect(struct neph_selector *selector, const double *shares, int count,
                                    struct neph_diag *diag);

/* The percentile at `share` (0..1), type 7 as neph_percentile(). key_count >= 1. */
double neph_select_percentile(struct neph_selector *selector, double share);

/* The first value of the ascending order whose running sum of values exceeds share * the sum of all
 * (the "weighted percentile" of FLIP's tool; values >= 0); 0 when all values are 0. */
double neph_select_weighted(struct neph_selector *selector, double share);

#endif
