/* SPDX-License-Identifier: MIT
 *
 * Reduces maps to numbers over masks. Strips of a map, one row of tiles each, are computed in
 * parallel. For every mask, each tile gets its sums, and its values as sortable keys if a pool
 * needs their order. All values and intervals are computed from these.
 */
#include "metrics/pooling.h"

#include "base/threads.h"
#include "metrics/select.h"
#include "metrics/statistics.h"
#include "metrics/vector_math.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_POOL_CERTAINTY_COUNT == 3, "a new kind");
_Static_assert(NEPH_POOL_COUNT == 16, "a new kind");

/* Sums of a tile over the pixels with a value of v. */
enum { SUM_N, SUM_V, SUM_V2, SUM_W, SUM_COUNT };

struct tile {
    double sums[SUM_COUNT];
    double max;
};

/* ---- masks ----------------------------------------------------------------------------------- */

enum neph_status neph_pool_mask_create(const struct neph_mask *mask, struct neph_arena *memory,
                                       struct neph_pool_mask *pooled, struct neph_diag *diag)
{
    const struct neph_tiling tiling = neph_tiling_of(mask->width_px, mask->height_px);
    uint32_t *counts = neph_arena_zeroed(memory, (size_t)tiling.columns * (size_t)tiling.rows,
                                         sizeof(*counts));
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

/* ---- requirements of the pools
 * ----------------------------------------------------------------- */

/* Whether a pool needs the number, or the sum, of the values on one side of a threshold. */
static bool has_part_n(enum neph_pool pool)
{
    return pool == NEPH_POOL_PERCENTILE || pool == NEPH_POOL_TRIMMED_MEAN ||
           pool == NEPH_POOL_SHARE_ABOVE;
}

static bool has_part_v(enum neph_pool pool)
{
    return pool == NEPH_POOL_WEIGHTED_PERCENTILE || pool == NEPH_POOL_TRIMMED_MEAN;
}

static bool needs_over(enum neph_pool pool)
{
    return pool == NEPH_POOL_MEAN_OVER || pool == NEPH_POOL_ROOT_MEAN_OVER ||
           pool == NEPH_POOL_RMS_OVER || pool == NEPH_POOL_ROOT_MEAN_LESS ||
           pool == NEPH_POOL_ROOT_MEAN_ABOVE;
}

/* ---- pass over a map
 * --------------------------------------------------------------------------- */

/* The data of one map for one mask. */
struct gathered {
    struct neph_pool_mask *mask;
    struct tile *tiles; /* owned */
    uint32_t *keys;     /* owned; NULL if no pool needs them */
    size_t *first;      /* index of each tile's first key; owned */
    uint32_t *counts;   /* keys of each tile; owned */
};

struct walk {
    const struct neph_pool_source *source;
    struct neph_tiling tiling;
    int map, over; /* over < 0: no second map */
    struct gathered *sets;
    int set_count;
    bool any_good; /* false: the map may not even exist */
    atomic_bool out_of_memory;
};

/* Sums of a tile by columns: a fixed order of additions, for any vector width. */
struct lanes {
    double n[NEPH_TILE_SIDE_PX], v[NEPH_TILE_SIDE_PX], v2[NEPH_TILE_SIDE_PX], w[NEPH_TILE_SIDE_PX],
        max[NEPH_TILE_SIDE_PX];
};

static void clear(struct lanes *lanes)
{
    *lanes = (struct lanes){.n = {0.0}};
    for (int l = 0; l < NEPH_TILE_SIDE_PX; l++)
        lanes->max[l] = -INFINITY;
}

/* Add the rows of one plane of a tile of full width, `stride` apart, that is completely in the mask
 * and has values everywhere; all sums but the number. */
NEPH_VECTOR static void add_plain_tile(const double *restrict v, const double *restrict w, int rows,
                                       size_t stride, struct lanes *restrict lanes)
{
    for (int y = 0; y < rows; y++, v += stride, w += stride) {
        NEPH_LANES
        for (int x = 0; x < NEPH_TILE_SIDE_PX; x++) {
            lanes->v[x] += v[x];
            lanes->v2[x] += v[x] * v[x];
            lanes->w[x] += w[x];
            lanes->max[x] = v[x] > lanes->max[x] ? v[x] : lanes->max[x];
        }
    }
}

/* Add only pixels in the mask that have a value. */
NEPH_VECTOR static void add_masked_tile(const double *restrict v, const double *restrict w,
                                        const uint8_t *restrict inside, int columns, int rows,
                                        size_t stride, struct lanes *restrict lanes)
{
    for (int y = 0; y < rows; y++, v += stride, w += stride, inside += stride) {
        for (int x = 0; x < columns; x++) {
            const bool in = inside[x] && v[x] == v[x]; /* NaN: no value */
            const double here = v[x], over_here = w[x];
            const double value = in ? here : 0.0, over = in ? over_here : 0.0;
            const double candidate = in ? here : -(double)INFINITY;
            lanes->n[x] += in ? 1.0 : 0.0;
            lanes->v[x] += value;
            lanes->v2[x] += value * value;
            lanes->w[x] += over;
            lanes->max[x] = candidate > lanes->max[x] ? candidate : lanes->max[x];
        }
    }
}

/* Add the keys of one plane of such a plain tile. */
NEPH_VECTOR static void add_plain_keys(const double *restrict v, int rows, size_t stride,
                                       uint32_t *restrict keys)
{
    for (int y = 0; y < rows; y++, v += stride, keys += NEPH_TILE_SIDE_PX) {
        NEPH_LANES
        for (int x = 0; x < NEPH_TILE_SIDE_PX; x++)
            keys[x] = neph_key_of(v[x]);
    }
}

/* Add the keys of pixels in the mask that have a value. To avoid a branch it writes one key too
 * many: into the next tile of the strip, which is filled later, or into the gap at the end of each
 * strip. */
static uint32_t *add_some_keys(const double *v, const uint8_t *inside, int count, uint32_t *keys)
{
    for (int x = 0; x < count; x++) {
        *keys = neph_key_of(v[x]);
        keys += inside[x] && v[x] == v[x];
    }
    return keys;
}

/* Add up the lanes by halving, which is vectorised. */
NEPH_VECTOR static struct tile tile_of(struct lanes *lanes)
{
    for (int half = NEPH_TILE_SIDE_PX / 2; half > 0; half /= 2) {
        for (int l = 0; l < half; l++) {
            lanes->n[l] += lanes->n[l + half];
            lanes->v[l] += lanes->v[l + half];
            lanes->v2[l] += lanes->v2[l + half];
            lanes->w[l] += lanes->w[l + half];
            const double other = lanes->max[l + half];
            lanes->max[l] = other > lanes->max[l] ? other : lanes->max[l];
        }
    }
    return (struct tile){{lanes->n[0], lanes->v[0], lanes->v2[0], lanes->w[0]}, lanes->max[0]};
}

/* A tile within the buffers of its strip. */
struct place {
    double *const *v, *const *w; /* planes */
    const uint8_t *inside;
    size_t first; /* index of its first pixel in a plane of the strip */
    size_t stride;
    int plane_count, columns, rows;
};

/* Sum a tile of full width that is completely in the mask, as if it had values everywhere; if it
 * has not, the sum is NaN. */
static struct tile sum_plain_tile(const struct place *place)
{
    struct lanes lanes;
    clear(&lanes);
    for (int p = 0; p < place->plane_count; p++)
        add_plain_tile(place->v[p] + place->first, place->w[p] + place->first, place->rows,
                       place->stride, &lanes);
    lanes.n[0] = (double)(place->columns * place->rows * place->plane_count);
    return tile_of(&lanes);
}

static struct tile sum_masked_tile(const struct place *place)
{
    struct lanes lanes;
    clear(&lanes);
    for (int p = 0; p < place->plane_count; p++)
        add_masked_tile(place->v[p] + place->first, place->w[p] + place->first, place->inside,
                        place->columns, place->rows, place->stride, &lanes);
    return tile_of(&lanes);
}

/* Add the keys of a tile; returns their number. */
static uint32_t add_keys(const struct place *place, bool is_plain, uint32_t *keys)
{
    uint32_t *next = keys;
    for (int p = 0; p < place->plane_count; p++) {
        const double *v = place->v[p] + place->first;
        if (is_plain) {
            add_plain_keys(v, place->rows, place->stride, next);
            next += place->rows * NEPH_TILE_SIDE_PX;
            continue;
        }
        for (size_t y = 0; y < (size_t)place->rows; y++)
            next = add_some_keys(v + y * place->stride, place->inside + y * place->stride,
                                 place->columns, next);
    }
    return (uint32_t)(next - keys);
}

/* Gather one tile of one mask. */
static void gather_tile(struct gathered *set, size_t tile, const struct place *place)
{
    struct tile *found = &set->tiles[tile];
    const bool is_whole = set->mask->tile_pixels[tile] ==
                          (uint32_t)(NEPH_TILE_SIDE_PX * place->rows);
    if (is_whole)
        *found = sum_plain_tile(place);
    const bool is_plain = is_whole && !isnan(found->sums[SUM_V]);
    if (!is_plain)
        *found = sum_masked_tile(place);
    if (set->keys)
        set->counts[tile] = add_keys(place, is_plain, set->keys + set->first[tile]);
}

static int lesser(int a, int b)
{
    return a < b ? a : b;
}

/* Gather the tiles of a strip that overlap the mask. */
static void gather_tiles(const struct walk *walk, struct gathered *set, int strip,
                         double *const v[3], double *const w[3])
{
    const int side = walk->tiling.side_px, first_y = strip * side;
    const size_t width = (size_t)walk->source->width_px;
    struct place place = {.v = v,
                          .w = w,
                          .stride = width,
                          .plane_count = walk->source->plane_count,
                          .rows = lesser(side, walk->source->height_px - first_y)};
    for (int column = 0; column < walk->tiling.columns; column++) {
        const size_t tile = (size_t)strip * (size_t)walk->tiling.columns + (size_t)column;
        place.first = (size_t)column * (size_t)side;
        place.columns = lesser(side, walk->source->width_px - column * side);
        place.inside = set->mask->mask->inside + (size_t)first_y * width + place.first;
        if (set->mask->tile_pixels[tile] > 0)
            gather_tile(set, tile, &place);
    }
}

static void gather_strip(int strip, void *context)
{
    struct walk *walk = context;
    const struct neph_pool_source *source = walk->source;
    if (!walk->any_good)
        return;
    const int first_row = strip * walk->tiling.side_px;
    const int row_count = lesser(walk->tiling.side_px, source->height_px - first_row);
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
    for (int s = 0; s < walk->set_count; s++)
        if (!walk->sets[s].mask->is_bad)
            gather_tiles(walk, &walk->sets[s], strip, v, walk->over >= 0 ? w : v);
    free(buffer);
}

static enum neph_status prepare_set(const struct walk *walk, struct neph_pool_mask *mask,
                                    bool with_keys, struct neph_arena *memory, struct gathered *set,
                                    struct neph_diag *diag)
{
    const size_t tile_count = (size_t)walk->tiling.columns * (size_t)walk->tiling.rows;
    set->mask = mask;
    set->tiles = neph_arena_zeroed(memory, tile_count, sizeof(*set->tiles));
    if (!with_keys || mask->is_bad)
        return neph_arena_check(memory, diag);
    const size_t planes = (size_t)walk->source->plane_count;
    const size_t room = mask->mask->pixel_count * planes + (size_t)walk->tiling.rows;
    set->keys = neph_arena_zeroed(memory, room, sizeof(*set->keys));
    set->first = neph_arena_zeroed(memory, tile_count, sizeof(*set->first));
    set->counts = neph_arena_zeroed(memory, tile_count, sizeof(*set->counts));
    size_t next = 0;
    for (size_t t = 0; set->first && t < tile_count; t++) {
        set->first[t] = next;
        next += mask->tile_pixels[t] * planes;
        next += (t + 1) % (size_t)walk->tiling.columns == 0; /* see add_some_keys() */
    }
    return neph_arena_check(memory, diag);
}

/* ---- numbers --------------------------------------------------------------------------------- */

/* Columns of the table of tiles: the sums, and two columns for each metric with a threshold of its
 * own, for the number and sum of the values on one side of it. */
enum { METRICS_MAX = NEPH_POOL_METRICS_MAX, COLUMNS_MAX = SUM_COUNT + 2 * METRICS_MAX };

_Static_assert((int)COLUMNS_MAX <= (int)NEPH_BOOTSTRAP_SUMS_MAX, "the bootstrap takes all columns");

/* A metric and its columns: the input of a statistic. */
struct statistic {
    const struct neph_metric *metric;
    int part_n, part_v; /* number and sum of v on one side; unused if the metric needs none */
};

static bool known(double number, double *value)
{
    *value = number;
    return isfinite(number);
}

/* Evaluate the number; for percentiles, the share of values below (see neph_pool_map()). */
static bool evaluate(const void *context, const double *sums, double *value)
{
    const struct statistic *statistic = context;
    const struct neph_metric *metric = statistic->metric;
    const double n = sums[SUM_N], mean = sums[SUM_V] / n;
    switch (metric->pool) {
    case NEPH_POOL_MEAN:
        return known(mean, value);
    case NEPH_POOL_RMS:
        return known(sqrt(sums[SUM_V2] / n), value);
    case NEPH_POOL_ROOT_MEAN:
    case NEPH_POOL_ROOT_MEAN_ABOVE: /* a draw may be negative: the interval then begins at 0 */
        return known(sqrt(fmax(mean, 0.0)), value);
    case NEPH_POOL_ROOT_OF_MEAN:
        return known(pow(fmax(mean, 0.0), 1.0 / metric->parameter), value);
    case NEPH_POOL_MEAN_OVER:
        return sums[SUM_W] > 0.0 && known(sums[SUM_V] / sums[SUM_W], value);
    case NEPH_POOL_ROOT_MEAN_OVER:
        return sums[SUM_W] > 0.0 && known(sqrt(fmax(sums[SUM_V] / sums[SUM_W], 0.0)), value);
    case NEPH_POOL_RMS_OVER:
        return sums[SUM_W] > 0.0 && known(sqrt(sums[SUM_V2] / n) / (sums[SUM_W] / n), value);
    case NEPH_POOL_ROOT_MEAN_LESS:
        return known(sqrt(fmax(mean, 0.0)) - sqrt(fmax(sums[SUM_W] / n, 0.0)), value);
    case NEPH_POOL_PSNR:
        return mean > 0.0 &&
               known(10.0 * log10(metric->parameter * metric->parameter / mean), value);
    case NEPH_POOL_SHARE_ABOVE:
    case NEPH_POOL_PERCENTILE:
        return known(sums[statistic->part_n] / n, value);
    case NEPH_POOL_WEIGHTED_PERCENTILE:
        return known(sums[statistic->part_v] / sums[SUM_V], value);
    case NEPH_POOL_TRIMMED_MEAN:
        return known(sums[statistic->part_v] / sums[statistic->part_n], value);
    case NEPH_POOL_MAX:
    case NEPH_POOL_SCALAR:
    case NEPH_POOL_COUNT:
        break;
    }
    return false;
}

static const char no_pixel[] = "the mask is empty";
static const char bad_pixel[] = "a pixel of the mask is not finite in one of the images";
static const char no_value[] = "the map has no value in the mask";
static const char no_mean[] = "the mean of the reference over the mask is not positive";
static const char below_noise[] = "not above the noise of the mask";
const char neph_pool_no_error[] = "there is no error at all to take a ratio of";
const char neph_pool_hidden_error[] =
    "the images differ, but only beyond the limits of the display";

/* The tiles of a mask that have a value, with their columns and the totals of the columns. */
struct table {
    const struct gathered *set;
    struct neph_selector *selector; /* owned; NULL if no pool needs an order */
    double *rows;                   /* row_count rows of column_count; owned */
    int *tiles;                     /* tile of each row; owned */
    int row_count, column_count;
    double totals[COLUMNS_MAX];
    double max;
    struct statistic statistics[METRICS_MAX];
};

static double *row_of(const struct table *table, int row)
{
    return table->rows + (size_t)row * (size_t)table->column_count;
}

static double total_of(const struct table *table, int column)
{
    struct neph_sum total = {0};
    for (int r = 0; r < table->row_count; r++)
        neph_sum_add(&total, row_of(table, r)[column]);
    return neph_sum_value(&total);
}

static void lay_out_columns(struct table *table, const struct neph_metric *const *metrics,
                            int metric_count)
{
    table->column_count = SUM_COUNT;
    for (int m = 0; m < metric_count; m++) {
        table->statistics[m] = (struct statistic){.metric = metrics[m]};
        if (has_part_n(metrics[m]->pool))
            table->statistics[m].part_n = table->column_count++;
        if (has_part_v(metrics[m]->pool))
            table->statistics[m].part_v = table->column_count++;
    }
}

static enum neph_status fill_table(struct table *table, int tile_count, struct neph_arena *memory,
                                   struct neph_diag *diag)
{
    const size_t columns = (size_t)table->column_count;
    table->max = -INFINITY;
    table->rows = neph_arena_zeroed(memory, (size_t)tile_count, columns * sizeof(*table->rows));
    table->tiles = neph_arena_zeroed(memory, (size_t)tile_count, sizeof(*table->tiles));
    if (!table->rows || !table->tiles)
        return neph_fail_memory(diag);
    for (int t = 0; t < tile_count; t++) {
        const struct tile *tile = &table->set->tiles[t];
        if (!(tile->sums[SUM_N] > 0.0))
            continue;
        memcpy(table->rows + (size_t)table->row_count * columns, tile->sums, sizeof(tile->sums));
        table->max = fmax(table->max, tile->max);
        table->tiles[table->row_count++] = t;
    }
    for (int c = 0; c < SUM_COUNT; c++)
        table->totals[c] = total_of(table, c);
    return NEPH_OK;
}

/* The number of keys in low .. high. */
NEPH_VECTOR static uint32_t count_keys(const uint32_t *restrict keys, uint32_t count, uint32_t low,
                                       uint32_t high)
{
    uint32_t n = 0;
    for (size_t i = 0; i < count; i++)
        n += keys[i] - low <= high - low ? 1u : 0u; /* unsigned: keys below wrap to large values */
    return n;
}

enum { PART_LANES = 16 };

/* Add a key's value to a lane if the key is at most `high`. */
__attribute__((always_inline)) static inline void add_key(uint32_t key, uint32_t high, double *sum)
{
    *sum += neph_key_value(key <= high ? key : NEPH_KEY_OF_ZERO);
}

/* The sum of the keys up to `high`. */
NEPH_VECTOR static double sum_keys(const uint32_t *restrict keys, uint32_t count, uint32_t high)
{
    double sums[PART_LANES] = {0.0}, sum = 0.0;
    size_t i = 0;
    for (; i + PART_LANES <= count; i += PART_LANES) {
        NEPH_LANES
        for (size_t l = 0; l < PART_LANES; l++)
            add_key(keys[i + l], high, &sums[l]);
    }
    for (size_t l = 0; i + l < count; l++)
        add_key(keys[i + l], high, &sums[l]);
    for (int l = 0; l < PART_LANES; l++)
        sum += sums[l];
    return sum;
}

/* The number of keys of a table row in low .. high. */
static uint32_t count_in_row(const struct table *table, int row, uint32_t low, uint32_t high)
{
    const struct gathered *set = table->set;
    const int tile = table->tiles[row];
    return count_keys(set->keys + set->first[tile], set->counts[tile], low, high);
}

/* Fill the part columns: number of keys in low .. high of each tile, and their sum (if low is
 * 0). */
static void fill_part(struct table *table, const struct statistic *statistic, uint32_t low,
                      uint32_t high)
{
    const bool with_n = has_part_n(statistic->metric->pool);
    const bool with_v = has_part_v(statistic->metric->pool);
    const struct gathered *set = table->set;
    for (int r = 0; r < table->row_count; r++) {
        const int tile = table->tiles[r];
        if (with_n)
            row_of(table, r)[statistic->part_n] = (double)count_in_row(table, r, low, high);
        if (with_v)
            row_of(table, r)[statistic->part_v] = sum_keys(set->keys + set->first[tile],
                                                           set->counts[tile], high);
    }
    if (with_n)
        table->totals[statistic->part_n] = total_of(table, statistic->part_n);
    if (with_v)
        table->totals[statistic->part_v] = total_of(table, statistic->part_v);
}

/* Fill the part columns with the `kept` smallest keys. Among keys equal to the largest of them,
 * each tile keeps the same share. */
static void part_smallest(struct table *table, const struct statistic *statistic, size_t kept)
{
    const uint32_t last = neph_select_rank(table->selector, kept - 1);
    fill_part(table, statistic, 0, last);
    const double surplus = table->totals[statistic->part_n] - (double)kept;
    if (surplus <= 0.0)
        return;
    double tied_count = 0.0;
    for (int r = 0; r < table->row_count; r++)
        tied_count += (double)count_in_row(table, r, last, last);
    for (int r = 0; r < table->row_count; r++) {
        const double tied = (double)count_in_row(table, r, last, last);
        const double taken = tied * (surplus / tied_count);
        row_of(table, r)[statistic->part_n] -= taken;
        row_of(table, r)[statistic->part_v] -= taken * neph_key_value(last);
    }
    table->totals[statistic->part_n] = total_of(table, statistic->part_n);
    table->totals[statistic->part_v] = total_of(table, statistic->part_v);
}

static bool is_percentile(const struct neph_metric *metric)
{
    return metric->pool == NEPH_POOL_PERCENTILE || metric->pool == NEPH_POOL_WEIGHTED_PERCENTILE;
}

static double percentile_at(const struct neph_metric *metric, struct neph_selector *selector,
                            double share)
{
    return metric->pool == NEPH_POOL_PERCENTILE ? neph_select_percentile(selector, share)
                                                : neph_select_weighted(selector, share);
}

static bool value_of(struct table *table, const struct statistic *statistic, double *value)
{
    const struct neph_metric *metric = statistic->metric;
    const size_t n = (size_t)table->totals[SUM_N];
    if (metric->pool == NEPH_POOL_MAX)
        return known(table->max, value);
    if (metric->pool == NEPH_POOL_ROOT_MEAN_ABOVE &&
        !(table->totals[SUM_V] > table->totals[SUM_W] / sqrt((double)n)))
        return false;
    if (is_percentile(metric))
        return known(percentile_at(metric, table->selector, metric->parameter), value);
    if (metric->pool == NEPH_POOL_SHARE_ABOVE)
        fill_part(table, statistic, neph_key_of(metric->parameter) + 1, UINT32_MAX);
    if (metric->pool == NEPH_POOL_TRIMMED_MEAN) {
        const size_t dropped = (size_t)ceil(metric->parameter * (double)n);
        part_smallest(table, statistic, n > dropped ? n - dropped : 1);
    }
    return evaluate(statistic, table->totals, value);
}

/* Convert the bounds of a share to values through the order statistics. */
static void invert_share(const struct table *table, const struct statistic *statistic,
                         struct neph_bootstrap_bounds *bounds)
{
    double share = 0.0;
    evaluate(statistic, table->totals, &share);
    double *const ends[2] = {&bounds->low, &bounds->high};
    for (int i = 0; i < 2; i++) {
        const double at = statistic->metric->parameter + (*ends[i] - share);
        *ends[i] = percentile_at(statistic->metric, table->selector, fmin(fmax(at, 0.0), 1.0));
    }
}

static enum neph_status add_intervals(struct table *table, int metric_count,
                                      struct neph_pooled *pooled, struct neph_diag *diag)
{
    struct neph_bootstrapped statistics[METRICS_MAX];
    struct neph_bootstrap_bounds bounds[METRICS_MAX];
    for (int m = 0; m < metric_count; m++) {
        const struct statistic *statistic = &table->statistics[m];
        statistics[m] = (struct neph_bootstrapped){evaluate, statistic};
        if (pooled[m].defined && is_percentile(statistic->metric))
            fill_part(table, statistic, 0, neph_key_of(pooled[m].value));
    }
    const enum neph_status status = neph_bootstrap_tiles(&table->set->mask->resampling, table->rows,
                                                         table->row_count, table->column_count,
                                                         statistics, metric_count, bounds, diag);
    for (int m = 0; m < metric_count && !status; m++) {
        if (!pooled[m].defined || !bounds[m].defined)
            continue;
        if (is_percentile(table->statistics[m].metric))
            invert_share(table, &table->statistics[m], &bounds[m]);
        pooled[m].has_interval = true;
        pooled[m].low = fmin(bounds[m].low, pooled[m].value); /* rounding may differ */
        pooled[m].high = fmax(bounds[m].high, pooled[m].value);
    }
    return status;
}

/* A hash of the set of tiles (FNV-1a). */
static uint64_t hash_of_tiles(const struct table *table)
{
    uint64_t hash = 0xcbf29ce484222325u;
    for (int r = 0; r < table->row_count; r++)
        hash = (hash ^ (uint64_t)table->tiles[r]) * 0x100000001b3u;
    return hash;
}

/* Convert draws of the share below the percentile to draws of the percentile, through the order
 * statistics: a draw with more values below it has a lower percentile (Bahadur's representation,
 * Annals of Mathematical Statistics 37, 1966). */
static void invert_draws(const struct table *table, const struct statistic *statistic,
                         double *draws)
{
    double share = 0.0;
    evaluate(statistic, table->totals, &share);
    for (int d = 0; d < NEPH_DRAWS_COUNT; d++) {
        const double at = statistic->metric->parameter - (draws[d] - share);
        draws[d] = percentile_at(statistic->metric, table->selector, fmin(fmax(at, 0.0), 1.0));
    }
}

static enum neph_status keep_draws(const struct table *table, const struct statistic *statistic,
                                   const double *values, struct neph_pooled *pooled,
                                   struct neph_diag *diag)
{
    struct neph_draws *draws = malloc(sizeof(*draws));
    if (!draws)
        return neph_fail_memory(diag);
    draws->tile_count = table->row_count;
    draws->tiles = hash_of_tiles(table);
    memcpy(draws->values, values, sizeof(draws->values));
    if (is_percentile(statistic->metric))
        invert_draws(table, statistic, draws->values);
    pooled->draws = draws;
    return NEPH_OK;
}

/* Add the draws; add_intervals() has filled the columns before. */
static enum neph_status add_draws(struct table *table, int metric_count, struct neph_pooled *pooled,
                                  struct neph_diag *diag)
{
    if (table->row_count < NEPH_BOOTSTRAP_TILES_MIN)
        return NEPH_OK;
    struct neph_bootstrapped statistics[METRICS_MAX];
    for (int m = 0; m < metric_count; m++)
        statistics[m] = (struct neph_bootstrapped){evaluate, &table->statistics[m]};
    double *all = malloc((size_t)metric_count * NEPH_DRAWS_COUNT * sizeof(*all));
    if (!all)
        return neph_fail_memory(diag);
    enum neph_status status = neph_bootstrap_draws(&table->set->mask->resampling, table->rows,
                                                   table->row_count, table->column_count,
                                                   statistics, metric_count, all, diag);
    for (int m = 0; m < metric_count && !status; m++)
        if (pooled[m].has_interval)
            status = keep_draws(table, &table->statistics[m], all + (size_t)m * NEPH_DRAWS_COUNT,
                                &pooled[m], diag);
    free(all);
    return status;
}

static const char *undefined_because(const struct neph_metric *metric)
{
    switch (metric->pool) {
    case NEPH_POOL_MEAN_OVER:
    case NEPH_POOL_RMS_OVER:
        return no_mean;
    case NEPH_POOL_ROOT_MEAN_OVER:
    case NEPH_POOL_PSNR:
        return neph_pool_no_error;
    case NEPH_POOL_ROOT_MEAN_ABOVE:
        return below_noise;
    case NEPH_POOL_MEAN:
    case NEPH_POOL_RMS:
    case NEPH_POOL_ROOT_MEAN:
    case NEPH_POOL_ROOT_OF_MEAN:
    case NEPH_POOL_ROOT_MEAN_LESS:
    case NEPH_POOL_SHARE_ABOVE:
    case NEPH_POOL_MAX:
    case NEPH_POOL_PERCENTILE:
    case NEPH_POOL_WEIGHTED_PERCENTILE:
    case NEPH_POOL_TRIMMED_MEAN:
    case NEPH_POOL_SCALAR:
    case NEPH_POOL_COUNT:
        break;
    }
    return no_value;
}

/* Why no number is defined over a mask; NULL: numbers are defined. */
static const char *obstacle(const struct neph_pool_source *source, const struct table *table)
{
    const struct neph_pool_mask *mask = table->set->mask;
    if (mask->mask->pixel_count == 0)
        return no_pixel;
    if (mask->is_bad)
        return bad_pixel;
    if (table->row_count == 0)
        return source->empty_because ? source->empty_because : no_value;
    return NULL;
}

static void take_values(const struct neph_pool_source *source, struct table *table,
                        int metric_count, struct neph_pooled *pooled)
{
    const char *because = obstacle(source, table);
    const size_t n = (size_t)table->totals[SUM_N];
    for (int m = 0; m < metric_count; m++) {
        pooled[m] = (struct neph_pooled){.undefined_because = because,
                                         .tile_count = table->row_count,
                                         .pixel_count = n / (size_t)source->plane_count};
        double value = 0.0;
        if (because)
            continue;
        pooled[m].defined = value_of(table, &table->statistics[m], &value);
        pooled[m].value = pooled[m].defined ? value : 0.0;
        if (!pooled[m].defined)
            pooled[m].undefined_because = undefined_because(table->statistics[m].metric);
    }
}

/* Create the selector for the values of a table. */
static enum neph_status select_from(struct table *table, const struct neph_key_runs *runs,
                                    int metric_count, struct neph_diag *diag)
{
    double shares[METRICS_MAX];
    int share_count = 0;
    for (int m = 0; m < metric_count; m++)
        if (table->statistics[m].metric->pool == NEPH_POOL_PERCENTILE)
            shares[share_count++] = table->statistics[m].metric->parameter;
    const enum neph_status status = neph_selector_create(runs, &table->selector, diag);
    return status ? status : neph_select_expect(table->selector, shares, share_count, diag);
}

static enum neph_status pool_mask(const struct walk *walk, const struct gathered *set,
                                  const struct neph_metric *const *metrics, int metric_count,
                                  enum neph_pool_certainty certainty, struct neph_pooled *pooled,
                                  struct neph_diag *diag)
{
    struct neph_arena memory = {0};
    struct table table = {.set = set};
    struct neph_key_runs runs = {.keys = set->keys,
                                 .first = set->first,
                                 .counts = set->counts,
                                 .run_count = walk->tiling.columns * walk->tiling.rows};
    lay_out_columns(&table, metrics, metric_count);
    enum neph_status status = fill_table(&table, runs.run_count, &memory, diag);
    runs.key_count = (size_t)table.totals[SUM_N];
    if (!status && set->keys && table.row_count > 0)
        status = select_from(&table, &runs, metric_count, diag);
    if (!status)
        take_values(walk->source, &table, metric_count, pooled);
    if (!status && certainty >= NEPH_POOL_INTERVAL && table.row_count > 0)
        status = add_intervals(&table, metric_count, pooled, diag);
    if (!status && certainty == NEPH_POOL_DRAWS)
        status = add_draws(&table, metric_count, pooled, diag);
    neph_selector_destroy(table.selector);
    neph_arena_finish(&memory);
    return status;
}

enum neph_status neph_pool_map(const struct neph_pool_source *source,
                               const struct neph_metric *const *metrics, int metric_count,
                               struct neph_pool_mask *masks, int mask_count,
                               enum neph_pool_certainty certainty, struct neph_pooled *pooled,
                               struct neph_diag *diag)
{
    struct walk walk = {.source = source,
                        .tiling = neph_tiling_of(source->width_px, source->height_px),
                        .map = metrics[0]->map,
                        .over = -1,
                        .set_count = mask_count};
    bool with_keys = false;
    for (int m = 0; m < metric_count; m++) {
        with_keys |= has_part_n(metrics[m]->pool) || has_part_v(metrics[m]->pool);
        if (needs_over(metrics[m]->pool))
            walk.over = metrics[m]->over;
    }
    struct neph_arena memory = {0};
    walk.sets = neph_arena_zeroed(&memory, (size_t)mask_count, sizeof(*walk.sets));
    enum neph_status status = walk.sets ? NEPH_OK : neph_fail_memory(diag);
    for (int s = 0; s < mask_count && !status; s++) {
        walk.any_good |= !masks[s].is_bad;
        status = prepare_set(&walk, &masks[s], with_keys, &memory, &walk.sets[s], diag);
    }
    if (!status)
        status = neph_parallel_rows(walk.tiling.rows, gather_strip, &walk, diag);
    if (!status && atomic_load(&walk.out_of_memory))
        status = neph_fail_memory(diag);
    for (int s = 0; s < mask_count && !status; s++)
        status = pool_mask(&walk, &walk.sets[s], metrics, metric_count, certainty,
                           pooled + (size_t)s * (size_t)metric_count, diag);
    neph_arena_finish(&memory);
    return status;
}
