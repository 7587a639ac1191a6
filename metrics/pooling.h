/* SPDX-License-Identifier: MIT
 *
 * Reduces maps to numbers over masks. Independent of extractors: a map is a function that returns
 * rows.
 */
#ifndef NEPH_METRICS_POOLING_H
#define NEPH_METRICS_POOLING_H

#include "base/arena.h"
#include "metrics/interval.h"
#include "metrics/mask.h"
#include "metrics/metric.h"

/* A mask with data that pooling precomputes. */
struct neph_pool_mask {
    const struct neph_mask *mask; /* borrowed */
    uint32_t *tile_pixels;        /* pixels of the mask in each tile of neph_tiling_make() */
    bool is_bad; /* contains pixels with inputs that are not finite: nothing is pooled over it */
    struct neph_resampling resampling; /* of the last interval over this mask; owned */
};

/* Prepare a mask; the counts are allocated in the arena. End the resampling with
 * neph_resampling_finish(). NEPH_ERR_MEMORY. */
enum neph_status neph_pool_mask_create(const struct neph_mask *mask, struct neph_arena *memory,
                                       struct neph_pool_mask *pooled, struct neph_diag *diag);

/* Why a ratio to the error has no value if test and reference are equal: there is no error. */
extern const char neph_pool_no_error[];

/* Why a ratio to the error has no value although they differ. */
extern const char neph_pool_hidden_error[];

/* The source of the values: neph_extractor.rows with its state. */
struct neph_pool_source {
    void (*rows)(const void *state, int map, int first_row, int row_count, double *const values[3]);
    const void *state;
    int width_px, height_px, plane_count;
    const char *empty_because; /* meaning of a mask in which the map has no value */
};

enum { NEPH_POOL_METRICS_MAX = 16 }; /* metrics of one map */

/* The requested uncertainty information. */
enum neph_pool_certainty {
    NEPH_POOL_NUMBER_ALONE,
    NEPH_POOL_INTERVAL, /* bootstrap over tiles (interval.h) */
    NEPH_POOL_DRAWS,    /* the same, and keep the draws */
    NEPH_POOL_CERTAINTY_COUNT,
};

/* One number over one mask. */
struct neph_pooled {
    bool defined;
    const char *undefined_because; /* static; NULL when defined */
    double value;
    bool has_interval;
    double low, high;
    int tile_count;           /* tiles that have a value */
    size_t pixel_count;       /* pixels that have a value */
    struct neph_draws *draws; /* with an interval and on request; the caller frees them with
                               * free() */
};

/* Pool one map. `metrics` are `metric_count` metrics of that map (and of at most one second map);
 * `pooled` receives metric_count numbers for each mask, mask by mask. Percentiles get Woodruff's
 * interval (JASA 47, 1952): a bootstrap of the share below the percentile, converted back through
 * the order statistics. */
enum neph_status neph_pool_map(const struct neph_pool_source *source,
                               const struct neph_metric *const *metrics, int metric_count,
                               struct neph_pool_mask *masks, int mask_count,
                               enum neph_pool_certainty certainty, struct neph_pooled *pooled,
                               struct neph_diag *diag);

#endif
