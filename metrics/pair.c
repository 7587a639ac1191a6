/* SPDX-License-Identifier: MIT */
#include "metrics/pair.h"

#include "metrics/interval.h"

#include <math.h>
#include <stdlib.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_PAIR_VERDICT_COUNT == 3, "a new kind");

enum { SUM_COUNT, SUM_MEAN, SUM_DIFFERENCE, SUM_PRODUCT, SUM_NOISE, SUMS };

static bool mean_difference(const void *context, const double *sums, double *value)
{
    (void)context;
    *value = sums[SUM_DIFFERENCE] / sums[SUM_MEAN];
    return sums[SUM_MEAN] > 0.0;
}

static bool squared_difference(const void *context, const double *sums, double *value)
{
    (void)context;
    const double mean = sums[SUM_MEAN] / sums[SUM_COUNT];
    *value = sums[SUM_PRODUCT] / sums[SUM_COUNT] / (mean * mean);
    return mean > 0.0;
}

static bool squared_noise(const void *context, const double *sums, double *value)
{
    (void)context;
    const double mean = sums[SUM_MEAN] / sums[SUM_COUNT];
    *value = sums[SUM_NOISE] / sums[SUM_COUNT] / (mean * mean);
    return mean > 0.0;
}

/* Add one pixel of one channel; false: it is not finite. */
static bool add_sample(double xa, double xb, double ya, double yb, double sums[SUMS])
{
    const double x = 0.5 * (xa + xb), y = 0.5 * (ya + yb);
    sums[SUM_COUNT] += 1.0;
    sums[SUM_MEAN] += 0.5 * (x + y);
    sums[SUM_DIFFERENCE] += x - y;
    sums[SUM_PRODUCT] += (xa - ya) * (xb - yb);
    sums[SUM_NOISE] += 0.25 * ((xa - xb) * (xa - xb) + (ya - yb) * (ya - yb));
    return isfinite(x) && isfinite(y);
}

static bool add_tile(float *const planes[4][3], const struct neph_mask *mask, int column, int row,
                     int side_px, double sums[SUMS])
{
    bool finite = true;
    for (int j = row * side_px; j < (row + 1) * side_px && j < mask->height_px; j++)
        for (int i = column * side_px; i < (column + 1) * side_px && i < mask->width_px; i++) {
            const size_t p = (size_t)j * (size_t)mask->width_px + (size_t)i;
            for (int c = 0; mask->inside[p] && c < 3; c++)
                finite &= add_sample((double)planes[0][c][p], (double)planes[1][c][p],
                                     (double)planes[2][c][p], (double)planes[3][c][p], sums);
        }
    return finite;
}

/* Sums of each tile with a pixel of the mask, one row per tile. Returns their number; -1: a bad
 * pixel. */
static int add_tiles(float *const planes[4][3], const struct neph_mask *mask,
                     const struct neph_tiling *tiling, double *tiles)
{
    int count = 0;
    for (int row = 0; row < tiling->rows; row++)
        for (int column = 0; column < tiling->columns; column++) {
            double *sums = tiles + (size_t)count * SUMS;
            for (int k = 0; k < SUMS; k++)
                sums[k] = 0.0;
            if (!add_tile(planes, mask, column, row, tiling->side_px, sums))
                return -1;
            count += sums[SUM_COUNT] > 0.0;
        }
    return count;
}

/* Convert a 95 % percentile interval to `critical_z` standard errors around the value. */
static void widen(const struct neph_bootstrap_bounds *bounds, double value, double critical_z,
                  double *low, double *high)
{
    const double half_95 = 1.959963984540054;
    *low = value - (value - bounds->low) * critical_z / half_95;
    *high = value + (bounds->high - value) * critical_z / half_95;
}

static enum neph_pair_verdict judge(const struct neph_pair *pair)
{
    const double square_meant = NEPH_PAIR_RMS_MEANT * NEPH_PAIR_RMS_MEANT;
    const bool mean_is_there = (pair->mean_low > 0.0 || pair->mean_high < 0.0) &&
                               fabs(pair->mean_difference) > NEPH_PAIR_MEAN_MEANT;
    const bool rms_is_there = pair->square_low > 0.0 && pair->rms_difference > NEPH_PAIR_RMS_MEANT;
    if (mean_is_there || rms_is_there)
        return NEPH_PAIR_DIFFER;
    if (pair->mean_low > -NEPH_PAIR_MEAN_MEANT && pair->mean_high < NEPH_PAIR_MEAN_MEANT &&
        pair->square_high < square_meant)
        return NEPH_PAIR_AGREE;
    return NEPH_PAIR_CANNOT_TELL;
}

enum neph_status neph_pair_compare(const struct neph_image *const frames[4],
                                   const struct neph_mask *mask, double critical_z,
                                   struct neph_pair *pair, struct neph_diag *diag)
{
    static const struct neph_bootstrapped statistics[3] = {
        {mean_difference, NULL}, {squared_difference, NULL}, {squared_noise, NULL}};
    float *planes[4][3];
    for (int i = 0; i < 4; i++) {
        if (frames[i]->width_px != mask->width_px || frames[i]->height_px != mask->height_px)
            return neph_fail(diag, NEPH_ERR_INPUT, "frames of %dx%d and %dx%d cannot be compared",
                             frames[i]->width_px, frames[i]->height_px, mask->width_px,
                             mask->height_px);
        if (!neph_image_rgb(frames[i], NULL, planes[i]))
            return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "a frame has no radiance");
    }
    const struct neph_tiling tiling = neph_tiling_make(mask->width_px, mask->height_px);
    double *tiles = calloc((size_t)tiling.columns * (size_t)tiling.rows, SUMS * sizeof(*tiles));
    if (!tiles)
        return neph_fail_memory(diag);
    const int tile_count = add_tiles(planes, mask, &tiling, tiles);
    struct neph_bootstrap_bounds bounds[3] = {{false, 0.0, 0.0}};
    double whole[SUMS] = {0.0}, values[3] = {0.0};
    for (int t = 0; t < tile_count; t++)
        for (int k = 0; k < SUMS; k++)
            whole[k] += tiles[t * SUMS + k];
    enum neph_status status = NEPH_OK;
    if (tile_count < 0)
        status = neph_fail(diag, NEPH_ERR_GATE, "a pixel of the mask is not finite");
    struct neph_resampling resampling = {0};
    if (!status)
        status = neph_bootstrap_tiles(&resampling, tiles, tile_count, SUMS, statistics, 3, bounds,
                                      diag);
    neph_resampling_finish(&resampling);
    free(tiles);
    if (status)
        return status;
    for (int s = 0; s < 3; s++)
        if (!bounds[s].defined || !statistics[s].value(NULL, whole, &values[s]))
            return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                             "%d tiles of the mask '%s' are too few for an interval, or dark",
                             tile_count, mask->name);
    pair->mean_difference = values[0];
    pair->rms_difference = sqrt(fmax(values[1], 0.0));
    pair->noise_floor = sqrt(values[2]);
    widen(&bounds[0], values[0], critical_z, &pair->mean_low, &pair->mean_high);
    widen(&bounds[1], values[1], critical_z, &pair->square_low, &pair->square_high);
    pair->verdict = judge(pair);
    return NEPH_OK;
}

static const char *const verdict_names[] = {
    [NEPH_PAIR_AGREE] = "agree",
    [NEPH_PAIR_DIFFER] = "differ",
    [NEPH_PAIR_CANNOT_TELL] = "cannot tell: noise",
};

const char *neph_pair_verdict_name(enum neph_pair_verdict verdict)
{
    return verdict_names[verdict];
}
