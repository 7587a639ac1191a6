/* SPDX-License-Identifier: MIT
 *
 * 95 % intervals of statistics over an image, by a bootstrap over square tiles: neighbouring
 * pixels err together, so the tile and not the pixel is the unit that is drawn again. (Kuensch,
 * The Annals of Statistics 17, 1989, for blocks; Efron and Tibshirani, An Introduction to the
 * Bootstrap, 1993, section 13.3, for the percentile interval.)
 *
 * What the interval says: how far the number moves with what happened to be in the picture, noise
 * included. It says nothing about another scene. When errors hang together within a tile it holds
 * the truth in 92 to 95 % of all images (91 to 94 % when there are only 64 tiles). It is too narrow
 * when they hang together over a tile or more: 67 % for blocks of 16 px that straddle the tiles.
 * All this is measured in tests/metrics/test_interval.c.
 */
#ifndef NEPH_METRICS_INTERVAL_H
#define NEPH_METRICS_INTERVAL_H

#include "metrics/metric.h"

#include <stdbool.h>
#include <stdint.h>

enum {
    NEPH_BOOTSTRAP_RESAMPLES = NEPH_DRAWS_COUNT,
    NEPH_BOOTSTRAP_TILES_MIN = 20, /* below, a percentile interval covers too little: none given */
    NEPH_BOOTSTRAP_SUMS_MAX = 48,
    NEPH_TILE_SIDE_PX = 16,
    NEPH_TILING_TILES_MIN = 64, /* smaller images get smaller tiles, see neph_tiling_of() */
};

/* The image cut into squares from the top left; the last column and row may be narrower. */
struct neph_tiling {
    int side_px;
    int columns, rows;
};

/* The largest side of 16, 8, 4, 2 and 1 that makes at least 64 tiles; 1 when none does. */
struct neph_tiling neph_tiling_of(int width_px, int height_px);

/* A statistic as a function of sums over pixels: false when it is undefined for them. */
typedef bool neph_statistic(const void *context, const double *sums, double *value);

struct neph_bootstrapped {
    neph_statistic *value;
    const void *context;
};

struct neph_bootstrap_bounds {
    bool defined;
    double low, high; /* 0 when undefined */
};

/* How often each tile is in each resample. That depends on the number of tiles alone and takes
 * longer to draw than to use: whoever asks again for as many tiles keeps it. Start from {0}. */
struct neph_resampling {
    int tile_count;
    uint8_t *counts; /* owned; see interval.c */
};

void neph_resampling_finish(struct neph_resampling *resampling); /* a zeroed one is fine */

/* Draw `tile_count` of the tiles with replacement, add up their sums, evaluate the statistics;
 * 1000 times with a fixed seed, the same draws for all statistics. `tiles` holds `tile_count` rows
 * of `sum_count` (at most NEPH_BOOTSTRAP_SUMS_MAX) sums; leave out tiles without a pixel. Bounds
 * are the 2.5 and 97.5 percentiles of each statistic (see statistics.h),
 * widened where need be to hold the statistic of the tiles themselves. They are undefined when
 * there are fewer than NEPH_BOOTSTRAP_TILES_MIN tiles or the statistic is undefined in any draw.
 * `resampling` is drawn anew when it is of another number of tiles. */
enum neph_status neph_bootstrap_tiles(struct neph_resampling *resampling, const double *tiles,
                                      int tile_count, int sum_count,
                                      const struct neph_bootstrapped *statistics,
                                      int statistic_count, struct neph_bootstrap_bounds *bounds,
                                      struct neph_diag *diag);

/* What lies behind bounds: the value of each statistic in each draw, NAN where it is undefined.
 * `draws` receives NEPH_BOOTSTRAP_RESAMPLES values for each statistic in turn. At least
 * NEPH_BOOTSTRAP_TILES_MIN tiles. As many tiles are always drawn alike: draws of two sets of
 * numbers from the same tiles are pairs. */
enum neph_status neph_bootstrap_draws(struct neph_resampling *resampling, const double *tiles,
                                      int tile_count, int sum_count,
                                      const struct neph_bootstrapped *statistics,
                                      int statistic_count, double *draws, struct neph_diag *diag);

#endif
