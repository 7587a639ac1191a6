/* SPDX-License-Identifier: MIT
 *
 * Strips of a map are asked for in parallel, one row of tiles each. For every mask each tile gets
 * its sums, and its values as keys where a pool needs their order. Everything after that, values
 * and intervals alike, is a function of these.
 */
#include "metrics/pooling.h"

#include "base/threads.h"
#include "metrics/interval.h"
#include "metrics/select.h"
#include "metrics/statistics.h"
#include "metrics/vector_math.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

/* Sums of a tile over the places where v has a value. */
enum { SUM_N, SUM_V, SUM_V2, SUM_W, SUM_COUNT };

struct tile {
    double sums[SUM_COUNT];
    double max;
};

/* ---- masks ----------------------------------------------------------------------------------- */

enum neph_status neph_pool_mask_create(const struct neph_mask *mask, struct neph_pool_mask *pooled,
                                       struct neph_diag *diag)
{
    const struct neph_tiling tiling = neph_tiling_of(mask->width_px, mask->height_px);
    uint32_t *counts = calloc((size_t)tiling.columns * (size_t)tiling.rows, sizeof(*counts));
    if (!counts)
        return neph_fail_memory(diag);
    const uint8_t *inside = mask->inside;
    for (int y = 0; y < mask->height_px; y++) {
        uint32_t *row = counts + (size_t)(y / tiling.side_px) * (size_t)tiling.columns;
        for (int x = 0; x < mask->width_px; x++)
            row[x / tiling.side_px] += *inside++;
    }
    *pooled = (struct neph_pool_mask){.mask = mask, .tile_pixels = counts};
    return NEPH_OK;
}

void neph_pool_mask_finish(struct neph_pool_mask *pooled)
{
    free(pooled->tile_pixels);
    *pooled = (struct neph_pool_mask){0};
}

/* ---- what the pools need --------------------------------------------------------------------- */

static bool needs_keys(enum neph_pool pool)
{
    return pool == NEPH_POOL_PERCENTILE || pool == NEPH_POOL_WEIGHTED_PERCENTILE ||
           pool == NEPH_POOL_TRIMMED_MEAN || pool == NEPH_POOL_SHARE_ABOVE;
}

static bool needs_over(enum neph_pool pool)
{
    return pool == NEPH_POOL_MEAN_OVER || pool == NEPH_POOL_ROOT_MEAN_OVER ||
           pool == NEPH_POOL_RMS_OVER;
}

/* ---- the walk over a map --------------------------------------------------------------------- */

/* What one mask gets from one map. */
struct gathered {
    const struct neph_pool_mask *mask;
    struct tile *tiles; /* owned */
    uint32_t *keys;     /* owned; NULL when no pool needs them */
    size_t *first;      /* of each tile in keys; owned */
    uint32_t *counts;   /* keys of each tile; owned */
};

struct walk {
    const struct neph_pool_source *source;
    struct neph_tiling tiling;
    int map, over; /* over < 0: no second map */
    struct gathered *sets;
    int set_count;
    bool any_good; /* else the map may not even exist */
    atomic_bool out_of_memory;
};

enum { LANES = 8 };

struct lanes {
    double n[LANES], v[LANES], v2[LANES], w[LANES], max[LANES];
};

/* Add the values of a piece of a row. In lanes, so that compilers may use vectors and the order of
 * additions stays what is written here. */
NEPH_VECTOR static void add_piece(const double *restrict v, const double *restrict w,
                                  const uint8_t *restrict inside, int count,
                                  struct lanes *restrict lanes)
{
    for (int x = 0; x < count; x += LANES) {
        const int here = count - x < LANES ? count - x : LANES;
        double values[LANES] = {0}, overs[LANES] = {0}, picked[LANES] = {0};
        for (int l = 0; l < here; l++) {
            values[l] = v[x + l];
            overs[l] = w[x + l];
            picked[l] = (double)inside[x + l];
        }
        for (int l = 0; l < LANES; l++) {
            const bool in = picked[l] > 0.0 && values[l] == values[l]; /* NaN: no value */
            const double value = in ? values[l] : 0.0;
            lanes->n[l] += in ? 1.0 : 0.0;
            lanes->v[l] += value;
            lanes->v2[l] += value * value;
            lanes->w[l] += in ? overs[l] : 0.0;
            lanes->max[l] = in && value > lanes->max[l] ? value : lanes->max[l];
        }
    }
}

static uint32_t *add_keys(const double *v, const uint8_t *inside, int count, uint32_t *keys)
{
    for (int x = 0; x < count; x++)
        if (inside[x] && v[x] == v[x])
            *keys++ = neph_key_of(v[x]);
    return keys;
}

static double sum_of(const double lanes[LANES])
{
    return ((lanes[0] + lanes[1]) + (lanes[2] + lanes[3])) +
           ((lanes[4] + lanes[5]) + (lanes[6] + lanes[7]));
}

/* One tile of one mask, from the buffers of its strip. */
static void gather_tile(const struct walk *walk, struct gathered *set, int strip, int column,
                        double *const v[3], double *const w[3])
{
    const int width = walk->source->width_px, side = walk->tiling.side_px;
    const size_t tile = (size_t)strip * (size_t)walk->tiling.columns + (size_t)column;
    const int first_x = column * side, first_y = strip * side;
    const int columns = width - first_x < side ? width - first_x : side;
    const int rows = walk->source->height_px - first_y < side ? walk->source->height_px - first_y
                                                              : side;
    struct lanes lanes = {.n = {0}};
    for (int l = 0; l < LANES; l++)
        lanes.max[l] = -INFINITY;
    uint32_t *key = set->keys ? set->keys + set->first[tile] : NULL;
    for (int p = 0; p < walk->source->plane_count; p++) {
        for (int y = 0; y < rows; y++) {
            const size_t at = (size_t)y * (size_t)width + (size_t)first_x;
            const uint8_t *inside = set->mask->mask->inside + (size_t)first_y * (size_t)width + at;
            add_piece(v[p] + at, w[p] + at, inside, columns, &lanes);
            if (key)
                key = add_keys(v[p] + at, inside, columns, key);
        }
    }
    struct tile *found = &set->tiles[tile];
    *found = (struct tile){{sum_of(lanes.n), sum_of(lanes.v), sum_of(lanes.v2), sum_of(lanes.w)},
                           -INFINITY};
    for (int l = 0; l < LANES; l++)
        found->max = fmax(found->max, lanes.max[l]);
    if (key)
        set->counts[tile] = (uint32_t)(key - (set->keys + set->first[tile]));
}

static void gather_strip(int strip, void *context)
{
    struct walk *walk = context;
    const struct neph_pool_source *source = walk->source;
    if (!walk->any_good)
        return;
    const int first_row = strip * walk->tiling.side_px;
    const int left = source->height_px - first_row;
    const int row_count = left < walk->tiling.side_px ? left : walk->tiling.side_px;
    const size_t plane = (size_t)row_count * (size_t)source->width_px;
    double *buffer = malloc(6 * plane * sizeof(*buffer));
    if (!buffer) {
        atomic_store(&walk->out_of_memory, true);
        return;
    }
    double *v[3] = {buffer, buffer + plane, buffer + 2 * plane};
    double *w[3] = {buffer + 3 * plane, buffer + 4 * plane, buffer + 5 * plane};
    source->rows(source->state, walk->map, first_row, row_count, v);
    if (walk->over >= 0)
        source->rows(source->state, walk->over, first_row, row_count, w);
    for (int s = 0; s < walk->set_count; s++) {
        const struct neph_pool_mask *mask = walk->sets[s].mask;
        const uint32_t *pixels = mask->tile_pixels + (size_t)strip * (size_t)walk->tiling.columns;
        for (int column = 0; column < walk->tiling.columns && !mask->is_bad; column++)
            if (pixels[column] > 0)
                gather_tile(walk, &walk->sets[s], strip, column, v, walk->over >= 0 ? w : v);
    }
    free(buffer);
}

static void finish_sets(struct gathered *sets, int count)
{
    for (int s = 0; sets && s < count; s++) {
        free(sets[s].tiles);
        free(sets[s].keys);
        free(sets[s].first);
        free(sets[s].counts);
    }
    free(sets);
}

static enum neph_status prepare_set(const struct walk *walk, const struct neph_pool_mask *mask,
                                    bool with_keys, struct gathered *set, struct neph_diag *diag)
{
    const size_t tile_count = (size_t)walk->tiling.columns * (size_t)walk->tiling.rows;
    set->mask = mask;
    set->tiles = calloc(tile_count, sizeof(*set->tiles));
    if (!set->tiles)
        return neph_fail_memory(diag);
    if (!with_keys || mask->is_bad)
        return NEPH_OK;
    const size_t planes = (size_t)walk->source->plane_count;
    set->keys = malloc((mask->mask->pixel_count * planes + 1) * sizeof(*set->keys));
    set->first = malloc(tile_count * sizeof(*set->first));
    set->counts = calloc(tile_count, sizeof(*set->counts));
    if (!set->keys || !set->first || !set->counts)
        return neph_fail_memory(diag);
    size_t next = 0;
    for (size_t t = 0; t < tile_count; t++) {
        set->first[t] = next;
        next += mask->tile_pixels[t] * planes;
    }
    return NEPH_OK;
}

/* ---- numbers --------------------------------------------------------------------------------- */

/* What a statistic of one metric is a function of: the sums, and two of its own that count what is
 * on one side of a threshold. */
enum { SUM_PART = SUM_COUNT, SUM_PART_V, SUMS };

static bool known(double number, double *value)
{
    *value = number;
    return isfinite(number);
}

/* The number itself, or for percentiles the share below: see neph_pool_map(). */
static bool statistic(const void *context, const double *sums, double *value)
{
    const struct neph_metric *metric = context;
    const double n = sums[SUM_N], mean = sums[SUM_V] / n;
    switch (metric->pool) {
    case NEPH_POOL_MEAN:
        return known(mean, value);
    case NEPH_POOL_RMS:
        return known(sqrt(sums[SUM_V2] / n), value);
    case NEPH_POOL_ROOT_MEAN:
        return known(sqrt(fmax(mean, 0.0)), value);
    case NEPH_POOL_MEAN_OVER:
        return sums[SUM_W] > 0.0 && known(sums[SUM_V] / sums[SUM_W], value);
    case NEPH_POOL_ROOT_MEAN_OVER:
        return sums[SUM_W] > 0.0 && known(sqrt(fmax(sums[SUM_V] / sums[SUM_W], 0.0)), value);
    case NEPH_POOL_RMS_OVER:
        return sums[SUM_W] > 0.0 && known(sqrt(sums[SUM_V2] / n) / (sums[SUM_W] / n), value);
    case NEPH_POOL_PSNR:
        return mean > 0.0 &&
               known(10.0 * log10(metric->parameter * metric->parameter / mean), value);
    case NEPH_POOL_SHARE_ABOVE:
    case NEPH_POOL_PERCENTILE:
        return known(sums[SUM_PART] / n, value);
    case NEPH_POOL_WEIGHTED_PERCENTILE:
        return known(sums[SUM_PART_V] / sums[SUM_V], value);
    case NEPH_POOL_TRIMMED_MEAN:
        return known(sums[SUM_PART_V] / sums[SUM_PART], value);
    case NEPH_POOL_MAX:
    case NEPH_POOL_SCALAR:
        break;
    }
    return false;
}

static const char no_pixel[] = "the mask is empty";
static const char bad_pixel[] = "a pixel of the mask is not finite in one of the images";
static const char no_value[] = "the map has no value in the mask";
static const char no_mean[] = "the mean of the reference over the mask is not positive";
static const char no_error[] = "there is no error at all to take a ratio of";

/* The rows of tiles that have a value, and their totals. */
struct table {
    double (*rows)[SUMS]; /* owned */
    int *tiles;           /* index of each row; owned */
    int row_count;
    double totals[SUMS];
    double max;
};

static void add_totals(struct table *table, int first_sum, int end_sum)
{
    for (int s = first_sum; s < end_sum; s++) {
        struct neph_sum total = {0};
        for (int r = 0; r < table->row_count; r++)
            neph_sum_add(&total, table->rows[r][s]);
        table->totals[s] = neph_sum_value(&total);
    }
}

static enum neph_status tabulate(const struct gathered *set, int tile_count, struct table *table,
                                 struct neph_diag *diag)
{
    table->rows = malloc((size_t)tile_count * sizeof(*table->rows));
    table->tiles = malloc((size_t)tile_count * sizeof(*table->tiles));
    if (!table->rows || !table->tiles)
        return neph_fail_memory(diag);
    for (int t = 0; t < tile_count; t++) {
        if (!(set->tiles[t].sums[SUM_N] > 0.0))
            continue;
        memcpy(table->rows[table->row_count], set->tiles[t].sums, sizeof(set->tiles[t].sums));
        table->max = fmax(table->max, set->tiles[t].max);
        table->tiles[table->row_count++] = t;
    }
    add_totals(table, 0, SUM_COUNT);
    return NEPH_OK;
}

/* Fill SUM_PART and SUM_PART_V of each tile: the keys of low .. high. */
static void count_part(const struct gathered *set, struct table *table, uint32_t low, uint32_t high)
{
    for (int r = 0; r < table->row_count; r++) {
        const uint32_t *keys = set->keys + set->first[table->tiles[r]];
        const uint32_t count = set->counts[table->tiles[r]];
        double n = 0.0, sum = 0.0;
        for (uint32_t i = 0; i < count; i++) {
            const bool in = keys[i] >= low && keys[i] <= high;
            n += in ? 1.0 : 0.0;
            sum += in ? neph_key_value(keys[i]) : 0.0;
        }
        table->rows[r][SUM_PART] = n;
        table->rows[r][SUM_PART_V] = sum;
    }
    add_totals(table, SUM_PART, SUMS);
}

/* The value of a metric; fills the parts that its interval will need. */
static bool value_of(const struct neph_metric *metric, const struct gathered *set,
                     struct neph_selector *selector, struct table *table, double *value)
{
    const size_t n = (size_t)table->totals[SUM_N];
    switch (metric->pool) {
    case NEPH_POOL_MAX:
        *value = table->max;
        return true;
    case NEPH_POOL_PERCENTILE:
        *value = neph_select_percentile(selector, metric->parameter);
        count_part(set, table, 0, neph_key_of(*value));
        return true;
    case NEPH_POOL_WEIGHTED_PERCENTILE:
        *value = neph_select_weighted(selector, metric->parameter);
        count_part(set, table, 0, neph_key_of(*value));
        return true;
    case NEPH_POOL_SHARE_ABOVE:
        count_part(set, table, neph_key_of(metric->parameter) + 1, UINT32_MAX);
        break;
    case NEPH_POOL_TRIMMED_MEAN: {
        const size_t dropped = (size_t)ceil(metric->parameter * (double)n);
        const uint32_t last = neph_select_rank(selector, n > dropped ? n - dropped - 1 : 0);
        count_part(set, table, 0, last);
        break;
    }
    default:
        break;
    }
    return statistic(metric, table->totals, value);
}

/* Read the bounds of a share back through the order statistics. */
static void invert_share(const struct neph_metric *metric, struct neph_selector *selector,
                         double share, struct neph_bootstrap_bounds *bounds)
{
    const bool weighted = metric->pool == NEPH_POOL_WEIGHTED_PERCENTILE;
    double *const ends[2] = {&bounds->low, &bounds->high};
    for (int i = 0; i < 2; i++) {
        const double at = fmin(fmax(metric->parameter + (*ends[i] - share), 0.0), 1.0);
        *ends[i] = weighted ? neph_select_weighted(selector, at)
                            : neph_select_percentile(selector, at);
    }
}

static enum neph_status add_interval(const struct neph_metric *metric,
                                     struct neph_selector *selector, const struct table *table,
                                     struct neph_pooled *pooled, struct neph_diag *diag)
{
    const struct neph_bootstrapped one = {statistic, metric};
    struct neph_bootstrap_bounds bounds = {0};
    double share = 0.0;
    enum neph_status status = neph_bootstrap_tiles(&table->rows[0][0], table->row_count, SUMS, &one,
                                                   1, &bounds, diag);
    if (status || !bounds.defined)
        return status;
    if (metric->pool == NEPH_POOL_PERCENTILE || metric->pool == NEPH_POOL_WEIGHTED_PERCENTILE) {
        statistic(metric, table->totals, &share);
        invert_share(metric, selector, share, &bounds);
    }
    pooled->has_interval = true;
    pooled->low = fmin(bounds.low, pooled->value); /* sums in another order, other roundings */
    pooled->high = fmax(bounds.high, pooled->value);
    return NEPH_OK;
}

static const char *undefined_because(const struct neph_metric *metric)
{
    switch (metric->pool) {
    case NEPH_POOL_MEAN_OVER:
    case NEPH_POOL_RMS_OVER:
        return no_mean;
    case NEPH_POOL_ROOT_MEAN_OVER:
    case NEPH_POOL_PSNR:
        return no_error;
    default:
        return no_value;
    }
}

static enum neph_status pool_metric(const struct neph_metric *metric, const struct gathered *set,
                                    struct neph_selector *selector, struct table *table,
                                    bool intervals, struct neph_pooled *pooled,
                                    struct neph_diag *diag)
{
    double value = 0.0;
    if (!value_of(metric, set, selector, table, &value)) {
        pooled->undefined_because = undefined_because(metric);
        return NEPH_OK;
    }
    pooled->defined = true;
    pooled->value = value;
    return intervals ? add_interval(metric, selector, table, pooled, diag) : NEPH_OK;
}

/* Why nothing at all can be said over a mask, or NULL. */
static const char *obstacle(const struct walk *walk, const struct gathered *set,
                            const struct table *table)
{
    if (set->mask->mask->pixel_count == 0)
        return no_pixel;
    if (set->mask->is_bad)
        return bad_pixel;
    if (table->row_count == 0)
        return walk->source->empty_because ? walk->source->empty_because : no_value;
    return NULL;
}

static enum neph_status pool_mask(const struct walk *walk, const struct gathered *set,
                                  const struct neph_metric *const *metrics, int metric_count,
                                  bool intervals, struct neph_pooled *pooled,
                                  struct neph_diag *diag)
{
    struct table table = {.max = -INFINITY};
    struct neph_selector *selector = NULL;
    struct neph_key_runs runs = {.keys = set->keys,
                                 .first = set->first,
                                 .counts = set->counts,
                                 .run_count = walk->tiling.columns * walk->tiling.rows};
    enum neph_status status = tabulate(set, runs.run_count, &table, diag);
    runs.key_count = (size_t)table.totals[SUM_N];
    const char *because = status ? NULL : obstacle(walk, set, &table);
    if (!status && !because && set->keys)
        status = neph_selector_create(&runs, &selector, diag);
    for (int m = 0; m < metric_count && !status; m++) {
        pooled[m] = (struct neph_pooled){.undefined_because = because,
                                         .tile_count = table.row_count,
                                         .pixel_count = runs.key_count /
                                                        (size_t)walk->source->plane_count};
        if (!because)
            status = pool_metric(metrics[m], set, selector, &table, intervals, &pooled[m], diag);
    }
    neph_selector_destroy(selector);
    free(table.rows);
    free(table.tiles);
    return status;
}

enum neph_status neph_pool_map(const struct neph_pool_source *source,
                               const struct neph_metric *const *metrics, int metric_count,
                               const struct neph_pool_mask *masks, int mask_count, bool intervals,
                               struct neph_pooled *pooled, struct neph_diag *diag)
{
    struct walk walk = {.source = source,
                        .tiling = neph_tiling_of(source->width_px, source->height_px),
                        .map = metrics[0]->map,
                        .over = -1,
                        .set_count = mask_count};
    bool with_keys = false;
    for (int m = 0; m < metric_count; m++) {
        with_keys |= needs_keys(metrics[m]->pool);
        if (needs_over(metrics[m]->pool))
            walk.over = metrics[m]->over;
    }
    walk.sets = calloc((size_t)mask_count, sizeof(*walk.sets));
    enum neph_status status = walk.sets ? NEPH_OK : neph_fail_memory(diag);
    for (int s = 0; s < mask_count && !status; s++) {
        walk.any_good |= !masks[s].is_bad;
        status = prepare_set(&walk, &masks[s], with_keys, &walk.sets[s], diag);
    }
    if (!status)
        status = neph_parallel_rows(walk.tiling.rows, gather_strip, &walk, diag);
    if (!status && atomic_load(&walk.out_of_memory))
        status = neph_fail_memory(diag);
    for (int s = 0; s < mask_count && !status; s++)
        status = pool_mask(&walk, &walk.sets[s], metrics, metric_count, intervals,
                           pooled + (size_t)s * (size_t)metric_count, diag);
    finish_sets(walk.sets, mask_count);
    return status;
}
