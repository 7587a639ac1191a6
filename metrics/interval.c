/* SPDX-License-Identifier: MIT */
#include "metrics/interval.h"

#include "metrics/statistics.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

/* Any constant would do; it is fixed so that the same images give the same interval. */
static const uint64_t resample_seed = 0x6e6570685f626f6fu;

static const double low_share = 0.025, high_share = 0.975;

struct neph_tiling neph_tiling_of(int width_px, int height_px)
{
    for (int side_px = NEPH_TILE_SIDE_PX;; side_px /= 2) {
        struct neph_tiling tiling = {.side_px = side_px,
                                     .columns = (width_px + side_px - 1) / side_px,
                                     .rows = (height_px + side_px - 1) / side_px};
        if (side_px == 1 || tiling.columns * tiling.rows >= NEPH_TILING_TILES_MIN)
            return tiling;
    }
}

/* splitmix64 (Steele, Lea and Flood, OOPSLA 2014), the top 32 bits scaled to 0..bound-1: the
 * preference for some values is below bound / 2^32. */
static int draw_below(uint64_t *state, int bound)
{
    uint64_t z = (*state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    z ^= z >> 31;
    return (int)(((z >> 32) * (uint64_t)bound) >> 32);
}

static void add_tile(double *totals, const double *tile, int sum_count)
{
    for (int s = 0; s < sum_count; s++)
        totals[s] += tile[s];
}

/* `draws` holds one row of NEPH_BOOTSTRAP_RESAMPLES values per statistic. */
static void resample(const double *tiles, int tile_count, int sum_count,
                     const struct neph_bootstrapped *statistics, int statistic_count, double *draws)
{
    uint64_t state = resample_seed;
    for (int r = 0; r < NEPH_BOOTSTRAP_RESAMPLES; r++) {
        double totals[NEPH_BOOTSTRAP_SUMS_MAX] = {0};
        for (int t = 0; t < tile_count; t++)
            add_tile(totals, tiles + (size_t)draw_below(&state, tile_count) * (size_t)sum_count,
                     sum_count);
        for (int k = 0; k < statistic_count; k++) {
            double value = 0.0;
            bool defined = statistics[k].value(statistics[k].context, totals, &value);
            draws[(size_t)k * NEPH_BOOTSTRAP_RESAMPLES + (size_t)r] = defined ? value : NAN;
        }
    }
}

static struct neph_bootstrap_bounds bounds_of(double *draws, double value)
{
    for (int r = 0; r < NEPH_BOOTSTRAP_RESAMPLES; r++)
        if (!isfinite(draws[r]))
            return (struct neph_bootstrap_bounds){0};
    double low = neph_percentile(draws, NEPH_BOOTSTRAP_RESAMPLES, low_share);
    double high = neph_percentile(draws, NEPH_BOOTSTRAP_RESAMPLES, high_share);
    return (struct neph_bootstrap_bounds){true, fmin(low, value), fmax(high, value)};
}

enum neph_status neph_bootstrap_tiles(const double *tiles, int tile_count, int sum_count,
                                      const struct neph_bootstrapped *statistics,
                                      int statistic_count, struct neph_bootstrap_bounds *bounds,
                                      struct neph_diag *diag)
{
    if (sum_count < 1 || sum_count > NEPH_BOOTSTRAP_SUMS_MAX)
        return neph_fail(diag, NEPH_ERR_INTERNAL, "a bootstrap over %d sums, 1..%d are possible",
                         sum_count, NEPH_BOOTSTRAP_SUMS_MAX);
    for (int k = 0; k < statistic_count; k++)
        bounds[k] = (struct neph_bootstrap_bounds){0};
    if (tile_count < NEPH_BOOTSTRAP_TILES_MIN || statistic_count < 1)
        return NEPH_OK;
    double *draws = calloc((size_t)statistic_count * NEPH_BOOTSTRAP_RESAMPLES, sizeof(*draws));
    if (!draws)
        return neph_fail_memory(diag);
    resample(tiles, tile_count, sum_count, statistics, statistic_count, draws);
    double totals[NEPH_BOOTSTRAP_SUMS_MAX] = {0};
    for (int t = 0; t < tile_count; t++)
        add_tile(totals, tiles + (size_t)t * (size_t)sum_count, sum_count);
    for (int k = 0; k < statistic_count; k++) {
        double value = 0.0;
        if (statistics[k].value(statistics[k].context, totals, &value))
            bounds[k] = bounds_of(draws + (size_t)k * NEPH_BOOTSTRAP_RESAMPLES, value);
    }
    free(draws);
    return NEPH_OK;
}
