/* SPDX-License-Identifier: MIT
 *
 * What a metric, a quantity and a measurement are. A metric turns images into one number; a family
 * of metrics that share their work (error.h, later FLIP and flicker) is one file with one table,
 * and one line in metric.c.
 */
#ifndef NEPH_METRICS_METRIC_H
#define NEPH_METRICS_METRIC_H

#include "base/image.h"

struct neph_metric {
    const char *name;
    const char *unit; /* NULL: the unit of the quantity that is measured */
    const char *help; /* one line: the definition */
};

/* What of a frame is measured. */
struct neph_quantity {
    const char *name;
    const char *unit;
    const char *help;
    const char *layer; /* of the three channels, as for neph_image_rgb(); or the channel itself */
    int plane_count;   /* 3: R, G, B; 1: the channel `layer` alone */
};

/* One number with everything that a report needs beside it. The strings are static: a measurement
 * owns nothing and outlives the images. No field is ever NaN or infinite. */
struct neph_measurement {
    const char *metric;
    const char *unit;
    const char *quantity;
    const char *mask;
    bool defined;
    const char *undefined_because; /* NULL when defined */
    double value;                  /* 0 when undefined */
    bool has_interval;
    double low, high;   /* 95 %, see interval.h; they hold `value`; 0 without an interval */
    size_t pixel_count; /* that the number is taken over */
    size_t bad_count;   /* further pixels of the mask, not finite in one image or in both */
};

/* All metrics of all families, in the order of reports. NULL outside 0..count-1. */
int neph_metric_count(void);
const struct neph_metric *neph_metric_at(int index);
const struct neph_metric *neph_metric_find(const char *name);

/* All quantities: radiance, volume, transmittance, depth. NULL outside 0..count-1. */
int neph_quantity_count(void);
const struct neph_quantity *neph_quantity_at(int index);
const struct neph_quantity *neph_quantity_find(const char *name);

/* The planes of a quantity in an image; false when it has not got all of them. */
bool neph_quantity_planes(const struct neph_quantity *quantity, const struct neph_image *image,
                          const float *planes[3]);

/* Luminance of scene-linear Rec.709 (ITU-R BT.709, item 3.2). */
static inline double neph_luminance(double r, double g, double b)
{
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

#endif
