/* SPDX-License-Identifier: MIT
 *
 * From a map to numbers over masks. Knows no extractor: a map is something that can be asked for
 * rows.
 */
#ifndef NEPH_METRICS_POOLING_H
#define NEPH_METRICS_POOLING_H

#include "base/arena.h"
#include "metrics/interval.h"
#include "metrics/mask.h"
#include "metrics/metric.h"

/* A mask with what pooling needs to know of it beforehand. */
struct neph_pool_mask {
    const struct neph_mask *mask; /* borrowed */
    uint32_t *tile_pixels;        /* pixels of the mask in each tile of neph_tiling_of() */
    bool is_bad; /* holds pixels whose inputs are not finite: nothing is pooled over it */
    struct neph_resampling resampling; /* of the last interval over it; owned */
};

/* The arena has the counts; the resampling ends with neph_resampling_finish(). NEPH_ERR_MEMORY. */
enum neph_status neph_pool_mask_create(const struct neph_mask *mask, struct neph_arena *memory,
                                       struct neph_pool_mask *pooled, struct neph_diag *diag);

/* Why a ratio to the error has no value where test and reference are equal: nothing can be better.
 */
extern const char neph_pool_no_error[];

/* Why it has none where they differ all the same. */
extern const char neph_pool_hidden_error[];

/* Where the values come from: neph_extractor.rows with its state. */
struct neph_pool_source {
    void (*rows)(const void *state, int map, int first_row, int row_count, double *const values[3]);
    const void *state;
    int width_px, height_px, plane_count;
    const char *empty_because; /* what it means when the map has no value in a mask */
};

enum { NEPH_POOL_METRICS_MAX = 16 }; /* of one map */

/* How sure a number is to be. */
enum neph_pool_certainty {
    NEPH_POOL_NUMBER_ALONE,
    NEPH_POOL_INTERVAL, /* bootstrap over tiles (interval.h) */
    NEPH_POOL_DRAWS,    /* and keep its draws */
    NEPH_POOL_CERTAINTY_COUNT,
};

/* One number over one mask. */
struct neph_pooled {
    bool defined;
    const char *undefined_because; /* static; NULL when defined */
    double value;
    bool has_interval;
    double low, high;
    int tile_count;           /* that have a value */
    size_t pixel_count;       /* that have a value */
    struct neph_draws *draws; /* with an interval, when they were asked for; the caller's, by free()
                               */
};

/* Pool one map: `metrics` are `metric_count` metrics of that map (and of one second map at most);
 * `pooled` receives metric_count numbers for each mask, mask by mask. Percentiles get the interval
 * of Woodruff (JASA 47, 1952): the bootstrap of the share below the percentile, read back through
 * the order statistics. */
enum neph_status neph_pool_map(const struct neph_pool_source *source,
                               const struct neph_metric *const *metrics, int metric_count,
                               struct neph_pool_mask *masks, int mask_count,
                               enum neph_pool_certainty certainty, struct neph_pooled *pooled,
                               struct neph_diag *diag);

#endif
