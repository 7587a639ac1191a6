/* SPDX-License-Identifier: MIT
 *
 * 95 % intervals of image statistics, by a bootstrap over square tiles. Errors of neighbouring
 * pixels are correlated, so tiles are resampled instead of pixels. (Kuensch, The Annals of
 * Statistics 17, 1989, for blocks; Efron and Tibshirani, An Introduction to the Bootstrap, 1993,
 * section 13.3, for the percentile interval.)
 *
 * The interval describes the scatter of the number over the image content, noise included. It says
 * nothing about other scenes. Its coverage, measured in tests/metrics/test_interval.c:
 * - errors correlated within a tile: 92 to 95 % of all images (91 to 94 % with only 64 tiles);
 * - errors correlated over a tile or more: too low, 67 % for blocks of 16 px across tile borders.
 */
#ifndef NEPH_METRICS_INTERVAL_H
#define NEPH_METRICS_INTERVAL_H

#include "metrics/metric.h"

#include <stdbool.h>
#include <stdint.h>

enum {
    NEPH_BOOTSTRAP_RESAMPLES = NEPH_DRAWS_COUNT,
    NEPH_BOOTSTRAP_TILES_MIN = 20, /* with fewer tiles a percentile interval covers too little: none
                                    * is given */
    NEPH_BOOTSTRAP_SUMS_MAX = 48,
    NEPH_TILE_SIDE_PX = 16,
    NEPH_TILING_TILES_MIN = 64, /* smaller images get smaller tiles, see neph_tiling_make() */
};

/* The division of the image into squares from the top left; the last column and row may be
 * narrower. */
struct neph_tiling {
    int side_px;
    int columns, rows;
};

/* Choose the tile side: the largest of 16, 8, 4, 2 and 1 with at least 64 tiles; 1 if there is
 * none. */
struct neph_tiling neph_tiling_make(int width_px, int height_px);

/* A statistic, as a function of sums over pixels; false: undefined for these sums. */
typedef bool neph_statistic(const void *context, const double *sums, double *value);

struct neph_bootstrapped {
    neph_statistic *value;
    const void *context;
};

struct neph_bootstrap_bounds {
    bool defined;
    double low, high; /* 0 when undefined */
};

/* The count of each tile in each resample. It depends only on the number of tiles, and drawing
 * takes longer than using it: keep it for further calls with the same number. Start from {0}. */
struct neph_resampling {
    int tile_count;
    uint8_t *counts; /* owned; see interval.c */
};

void neph_resampling_finish(struct neph_resampling *resampling); /* may be zeroed */

/* Draw `tile_count` of the tiles with replacement, add up their sums and evaluate the statistics;
 * 1000 times with a fixed seed, with the same draws for all statistics.
 * - `tiles`: `tile_count` rows of `sum_count` (at most NEPH_BOOTSTRAP_SUMS_MAX) sums; leave out
 *   tiles without a pixel.
 * - The bounds are the 2.5 and 97.5 percentiles of each statistic (see statistics.h), widened if
 *   needed to contain the statistic of the tiles themselves.
 * - They are undefined for fewer than NEPH_BOOTSTRAP_TILES_MIN tiles, or if the statistic is
 *   undefined in a draw.
 * - `resampling` is redrawn for another number of tiles. */
enum neph_status neph_bootstrap_tiles(struct neph_resampling *resampling, const double *tiles,
                                      int tile_count, int sum_count,
                                      const struct neph_bootstrapped *statistics,
                                      int statistic_count, struct neph_bootstrap_bounds *bounds,
                                      struct neph_diag *diag);

/* The values behind the bounds: each statistic in each draw, NAN where undefined. `draws` receives
 * NEPH_BOOTSTRAP_RESAMPLES values for each statistic in turn. At least NEPH_BOOTSTRAP_TILES_MIN
 * tiles. Equal numbers of tiles have equal draws, so the draws of two sets of numbers from the same
 * tiles are paired. */
enum neph_status neph_bootstrap_draws(struct neph_resampling *resampling, const double *tiles,
                                      int tile_count, int sum_count,
                                      const struct neph_bootstrapped *statistics,
                                      int statistic_count, double *draws, struct neph_diag *diag);

#endif
