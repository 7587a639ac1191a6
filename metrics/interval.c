/* SPDX-License-Identifier: MIT
 *
 * The bootstrap. The sums of a resample are the sums of the tiles, each multiplied by how often the
 * tile was drawn. So the draws, equal for all numbers, are counted once, and a number costs a
 * matrix product: counts by sums. Resamples are stored in groups of the width at which the product
 * is fast.
 */
#include "metrics/interval.h"

#include "metrics/statistics.h"
#include "metrics/vector_math.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    GROUP = 64, /* resamples */
    GROUP_COUNT = (NEPH_BOOTSTRAP_RESAMPLES + GROUP - 1) / GROUP,
    CHUNK = 256, /* draws per step */
    COLUMNS = 4, /* sums per step */
};

/* An arbitrary seed, fixed so that the same images give the same interval. */
static const uint64_t resample_seed = 0x6e6570685f626f6fu;

static const double low_share = 0.025, high_share = 0.975;

struct neph_tiling neph_tiling_make(int width_px, int height_px)
{
    for (int side_px = NEPH_TILE_SIDE_PX;; side_px /= 2) {
        struct neph_tiling tiling = {.side_px = side_px,
                                     .columns = (width_px + side_px - 1) / side_px,
                                     .rows = (height_px + side_px - 1) / side_px};
        if (side_px == 1 || tiling.columns * tiling.rows >= NEPH_TILING_TILES_MIN)
            return tiling;
    }
}

/* ---- the draws ------------------------------------------------------------------------------- */

/* Draws first .. first + count - 1, by splitmix64 (Steele, Lea and Flood, OOPSLA 2014). The top 32
 * bits are scaled to 0..bound-1; the bias of single values is below bound / 2^32. */
NEPH_VECTOR static void draw(uint64_t first, int bound, int count, uint32_t *restrict drawn)
{
    for (int i = 0; i < count; i++) {
        uint64_t z = resample_seed + (first + 1 + (uint64_t)i) * 0x9e3779b97f4a7c15u;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        z ^= z >> 31;
        drawn[i] = (uint32_t)(((z >> 32) * (uint64_t)bound) >> 32);
    }
}

/* Count the draws of a resample; its counts are GROUP apart. For n draws among n tiles, a count
 * above 255 occurs once in 255! resamples. */
static void count_draws(int resample, int tile_count, uint8_t *counts)
{
    uint32_t drawn[CHUNK];
    for (int done = 0; done < tile_count; done += CHUNK) {
        const int part = tile_count - done < CHUNK ? tile_count - done : CHUNK;
        draw((uint64_t)resample * (uint64_t)tile_count + (uint64_t)done, tile_count, part, drawn);
        for (int i = 0; i < part; i++)
            counts[(size_t)drawn[i] * GROUP]++;
    }
}

/* The counts of a group: GROUP for each tile. */
static uint8_t *group_counts(const struct neph_resampling *resampling, int group)
{
    return resampling->counts + (size_t)group * (size_t)resampling->tile_count * GROUP;
}

static enum neph_status draw_all(struct neph_resampling *resampling, int tile_count,
                                 struct neph_diag *diag)
{
    neph_resampling_finish(resampling);
    resampling->counts = calloc((size_t)tile_count, (size_t)GROUP_COUNT * GROUP);
    if (!resampling->counts)
        return neph_fail_memory(diag);
    resampling->tile_count = tile_count;
    for (int r = 0; r < NEPH_BOOTSTRAP_RESAMPLES; r++)
        count_draws(r, tile_count, group_counts(resampling, r / GROUP) + r % GROUP);
    return NEPH_OK;
}

void neph_resampling_finish(struct neph_resampling *resampling)
{
    free(resampling->counts);
    *resampling = (struct neph_resampling){0};
}

/* ---- the sums of the resamples --------------------------------------------------------------- */

typedef double group_sums[GROUP];

/* Add up `column_count` neighbouring columns of the tiles' sums, for each resample of a group. */
__attribute__((always_inline)) static inline void
add_columns(const uint8_t *restrict counts, const double *restrict tiles, int tile_count,
            int sum_count, int column_count, group_sums *restrict totals)
{
    group_sums sums[COLUMNS] = {{0.0}};
    for (int t = 0; t < tile_count; t++, counts += GROUP, tiles += sum_count) {
        double times[GROUP];
        for (int r = 0; r < GROUP; r++)
            times[r] = (double)counts[r];
        for (int c = 0; c < column_count; c++)
            for (int r = 0; r < GROUP; r++)
                sums[c][r] += tiles[c] * times[r];
    }
    memcpy(totals, sums, (size_t)column_count * sizeof(*sums));
}

NEPH_VECTOR static void add_group(const uint8_t *counts, const double *tiles, int tile_count,
                                  int sum_count, group_sums *totals)
{
    int s = 0;
    for (; s + COLUMNS <= sum_count; s += COLUMNS)
        add_columns(counts, tiles + s, tile_count, sum_count, COLUMNS, totals + s);
    for (; s < sum_count; s++)
        add_columns(counts, tiles + s, tile_count, sum_count, 1, totals + s);
}

/* `draws` has one row of NEPH_BOOTSTRAP_RESAMPLES values for each statistic. */
static void resample(const struct neph_resampling *resampling, const double *tiles, int sum_count,
                     const struct neph_bootstrapped *statistics, int statistic_count, double *draws)
{
    for (int first = 0; first < NEPH_BOOTSTRAP_RESAMPLES; first += GROUP) {
        group_sums totals[NEPH_BOOTSTRAP_SUMS_MAX];
        add_group(group_counts(resampling, first / GROUP), tiles, resampling->tile_count, sum_count,
                  totals);
        for (int r = 0; r < GROUP && first + r < NEPH_BOOTSTRAP_RESAMPLES; r++) {
            double sums[NEPH_BOOTSTRAP_SUMS_MAX];
            for (int s = 0; s < sum_count; s++)
                sums[s] = totals[s][r];
            for (int k = 0; k < statistic_count; k++) {
                double value = 0.0;
                const bool defined = statistics[k].value(statistics[k].context, sums, &value);
                draws[(size_t)k * NEPH_BOOTSTRAP_RESAMPLES + (size_t)(first + r)] = defined ? value
                                                                                            : NAN;
            }
        }
    }
}

/* ---- bounds ---------------------------------------------------------------------------------- */

static struct neph_bootstrap_bounds compute_draw_bounds(double *draws, double value)
{
    for (int r = 0; r < NEPH_BOOTSTRAP_RESAMPLES; r++)
        if (!isfinite(draws[r]))
            return (struct neph_bootstrap_bounds){0};
    double low = neph_percentile(draws, NEPH_BOOTSTRAP_RESAMPLES, low_share);
    double high = neph_percentile(draws, NEPH_BOOTSTRAP_RESAMPLES, high_share);
    return (struct neph_bootstrap_bounds){true, fmin(low, value), fmax(high, value)};
}

enum neph_status neph_bootstrap_draws(struct neph_resampling *resampling, const double *tiles,
                                      int tile_count, int sum_count,
                                      const struct neph_bootstrapped *statistics,
                                      int statistic_count, double *draws, struct neph_diag *diag)
{
    if (sum_count < 1 || sum_count > NEPH_BOOTSTRAP_SUMS_MAX)
        return neph_fail(diag, NEPH_ERR_INTERNAL, "a bootstrap over %d sums, 1..%d are possible",
                         sum_count, NEPH_BOOTSTRAP_SUMS_MAX);
    if (resampling->tile_count != tile_count) {
        const enum neph_status status = draw_all(resampling, tile_count, diag);
        if (status)
            return status;
    }
    resample(resampling, tiles, sum_count, statistics, statistic_count, draws);
    return NEPH_OK;
}

enum neph_status neph_bootstrap_tiles(struct neph_resampling *resampling, const double *tiles,
                                      int tile_count, int sum_count,
                                      const struct neph_bootstrapped *statistics,
                                      int statistic_count, struct neph_bootstrap_bounds *bounds,
                                      struct neph_diag *diag)
{
    for (int k = 0; k < statistic_count; k++)
        bounds[k] = (struct neph_bootstrap_bounds){0};
    if (tile_count < NEPH_BOOTSTRAP_TILES_MIN || statistic_count < 1)
        return NEPH_OK;
    double *draws = calloc((size_t)statistic_count * NEPH_BOOTSTRAP_RESAMPLES, sizeof(*draws));
    if (!draws)
        return neph_fail_memory(diag);
    const enum neph_status status = neph_bootstrap_draws(resampling, tiles, tile_count, sum_count,
                                                         statistics, statistic_count, draws, diag);
    if (status) {
        free(draws);
        return status;
    }
    double totals[NEPH_BOOTSTRAP_SUMS_MAX] = {0};
    for (int t = 0; t < tile_count; t++)
        for (int s = 0; s < sum_count; s++)
            totals[s] += tiles[(size_t)t * (size_t)sum_count + (size_t)s];
    for (int k = 0; k < statistic_count; k++) {
        double value = 0.0;
        if (statistics[k].value(statistics[k].context, totals, &value))
            bounds[k] = compute_draw_bounds(draws + (size_t)k * NEPH_BOOTSTRAP_RESAMPLES, value);
    }
    free(draws);
    return NEPH_OK;
}
