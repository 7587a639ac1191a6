/* SPDX-License-Identifier: MIT
 *
 * Basic types: quantity, pool, metric, measurement. An extractor (extractor.h) turns frames into
 * maps, one value per pixel. A pool (pooling.h) turns a map into one number over a mask. A metric
 * is a named pool of a map.
 */
#ifndef NEPH_METRICS_METRIC_H
#define NEPH_METRICS_METRIC_H

#include "base/image.h"

#include <stdint.h>

enum neph_quantity_bit {
    NEPH_RADIANCE = 1,
    NEPH_VOLUME = 2,
    NEPH_TRANSMITTANCE = 4,
    NEPH_DEPTH = 8,
    NEPH_LINEAR_RGB = NEPH_RADIANCE | NEPH_VOLUME | NEPH_TRANSMITTANCE,
};

/* A measurable part of a frame. */
struct neph_quantity {
    const char *name;
    const char *unit;
    const char *help;
    const char *layer; /* layer of the three channels, as for neph_image_rgb(); or the channel
                        * itself */
    int plane_count;   /* 3: R, G, B; 1: only the channel `layer` */
    enum neph_quantity_bit bit;
};

/* How a map is reduced to a number over a mask. v: values of the map at the mask's pixels (all
 * planes jointly); w: values of a second map at the same places; p: the parameter. */
enum neph_pool {
    NEPH_POOL_MEAN,                /* mean v */
    NEPH_POOL_RMS,                 /* sqrt(mean v^2) */
    NEPH_POOL_ROOT_MEAN,           /* sqrt(mean v), 0 when the mean is negative */
    NEPH_POOL_ROOT_OF_MEAN,        /* (mean v)^(1/p): Minkowski mean, of a map of p-th powers */
    NEPH_POOL_ROOT_MEAN_ABOVE,     /* the same, but undefined unless mean v > mean w /
                                    * sqrt(pixels) */
    NEPH_POOL_MEAN_OVER,           /* mean v / mean w */
    NEPH_POOL_ROOT_MEAN_OVER,      /* sqrt(mean v / mean w) */
    NEPH_POOL_RMS_OVER,            /* sqrt(mean v^2) / mean w */
    NEPH_POOL_ROOT_MEAN_LESS,      /* sqrt(mean v) - sqrt(mean w), v and w squares */
    NEPH_POOL_PSNR,                /* 10 log10(p^2 / mean v), v squared errors, p the peak [dB] */
    NEPH_POOL_SHARE_ABOVE,         /* share of the pixels with v > p */
    NEPH_POOL_MAX,                 /* largest v */
    NEPH_POOL_PERCENTILE,          /* type 7 percentile at the share p, see statistics.h */
    NEPH_POOL_WEIGHTED_PERCENTILE, /* first of sorted v with running sum > p * sum (FLIP's tool) */
    NEPH_POOL_TRIMMED_MEAN,        /* mean v without the ceil(p n) largest of n */
    NEPH_POOL_SCALAR, /* not from a map: a number of the whole frame, from extractor->scalar */
    NEPH_POOL_COUNT,
};

struct neph_metric {
    const char *name; /* unique over all extractors; NULL ends a table */
    const char *unit; /* NULL: the unit of the quantity */
    double low, high; /* range; +-INFINITY: unbounded */
    enum neph_pool pool;
    double parameter;
    int map;          /* v: index of the extractor's maps; SCALAR: passed to extractor->scalar */
    int over;         /* w */
    const char *help; /* one line: the definition */
};

/* The meaning of an interval. */
enum neph_interval_kind {
    NEPH_INTERVAL_NONE,          /* none: too few tiles or cycles, or not defined for this metric */
    NEPH_INTERVAL_DETERMINISTIC, /* the number is exact for these frames, without any random
                                  * sampling */
    NEPH_INTERVAL_TILES,         /* bootstrap over tiles, see interval.h: n tiles */
    NEPH_INTERVAL_CYCLES,        /* batch means over whole cycles, see series.h: n batches */
    NEPH_INTERVAL_RUNS,          /* Student's t over independent runs, see series.h: n runs */
    NEPH_INTERVAL_KIND_COUNT,
};

/* The bound beyond which a metric sees no difference. */
enum neph_display_bound {
    NEPH_BOUND_NONE,
    NEPH_BOUND_WHITE, /* a channel above display white: 2^exposure_ev * value > 1 */
    NEPH_BOUND_PU21,  /* a luminance above the end of PU21's curve, 10000 cd/m2 */
    NEPH_BOUND_COUNT,
};

/* The shares of pixels beyond a bound, 0..1. */
struct neph_clipped {
    enum neph_display_bound bound;
    double reference, test; /* 0 without a bound */
};

enum { NEPH_DRAWS_COUNT = 1000 }; /* draws of a bootstrap */

/* The values of a number in each draw of a bootstrap over tiles. Draws of two numbers are paired if
 * they use the same tiles. */
struct neph_draws {
    int tile_count;
    uint64_t tiles; /* a hash of the set of tiles */
    double values[NEPH_DRAWS_COUNT];
};

/* One number with its context for reports. Pointers, except `draws`, are static: a measurement owns
 * nothing and outlives the images. No field is ever NaN or infinite. */
struct neph_measurement {
    const struct neph_metric *metric;
    const struct neph_quantity *quantity;
    const char *unit;
    char mask[NEPH_IMAGE_NAME_MAX];
    int frame; /* index in the sequence; -1: all frames together */
    bool defined;
    const char *undefined_because; /* NULL when defined */
    double value;                  /* 0 when undefined */
    enum neph_interval_kind interval;
    double low, high;            /* 95 %; they contain `value`; 0 without bounds */
    int n;                       /* tiles or batches of the interval; else the number of frames */
    size_t pixel_count;          /* pixels that contribute */
    size_t bad_count;            /* further pixels of the mask, not finite in at least one image */
    struct neph_clipped clipped; /* of the mask, in the frame or in all frames */
    const struct neph_draws *draws; /* owned by the giver of the measurement; NULL: not requested */
};

/* All quantities: radiance, volume, transmittance, depth. NULL outside 0..count-1. */
int neph_quantity_count(void);
const struct neph_quantity *neph_quantity_at(int index);
const struct neph_quantity *neph_quantity_find(const char *name);

/* The planes of a quantity in an image; false: the image lacks one. */
bool neph_quantity_planes(const struct neph_quantity *quantity, const struct neph_image *image,
                          const float *planes[3]);

/* Mean luminance (depth: mean without the sky) of a whole frame; NaN if it is not positive and
 * finite. */
double neph_quantity_mean(const struct neph_quantity *quantity, const float *const planes[3],
                          int width_px, int height_px);

/* The number of infinite or NaN values. */
uint32_t neph_count_not_finite(const float *values, size_t count);

/* Luminance of scene-linear Rec.709 (ITU-R BT.709, item 3.2). */
static inline double neph_luminance(double r, double g, double b)
{
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

/* Luminance of a pixel of three planes. */
static inline double neph_luminance_at(const float *const planes[3], size_t pixel)
{
    return neph_luminance((double)planes[0][pixel], (double)planes[1][pixel],
                          (double)planes[2][pixel]);
}

#endif
