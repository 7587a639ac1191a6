/* SPDX-License-Identifier: MIT
 *
 * Error in stops: the exposure change per pixel that would map the test to the reference. Below a
 * floor both count as black, so dark pixels contribute nothing.
 */
#include "metrics/extractors/extractors.h"
#include "metrics/vector_math.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

enum { CHUNK_PX = 256 };

enum { MAP_SIGNED, MAP_ABSOLUTE, MAP_COUNT };

static const double floor_share = 1e-4; /* relative to the scene's mean luminance */

static const char black_frame[] = "the mean of the whole reference frame is not positive";

static const char *obstacle(const struct neph_frame_pair *first,
                            const struct neph_settings *settings)
{
    (void)settings;
    return first->scene_mean > 0.0 ? NULL : black_frame;
}

static enum neph_status extract(void *opaque, const struct neph_frame_pair *pair,
                                struct neph_diag *diag)
{
    (void)diag;
    struct neph_frame_pair *kept = opaque;
    *kept = *pair;
    return NEPH_OK;
}

/* log2(max(test, floor) / max(reference, floor)) of the luminance; count is at most CHUNK_PX. */
NEPH_VECTOR static void compute_stops(const float *const reference[3], const float *const test[3],
                                      size_t first, size_t count, double floor, double *stops)
{
    const float *rr = reference[0] + first, *rg = reference[1] + first, *rb = reference[2] + first;
    const float *tr = test[0] + first, *tg = test[1] + first, *tb = test[2] + first;
    for (size_t i = 0; i < count; i++) {
        double from = neph_luminance((double)rr[i], (double)rg[i], (double)rb[i]);
        double to = neph_luminance((double)tr[i], (double)tg[i], (double)tb[i]);
        from = from > floor ? from : floor;
        to = to > floor ? to : floor;
        stops[i] = neph_log2(to / from);
    }
}

static void rows(const void *opaque, int map, int first_row, int row_count, double *const values[3])
{
    const struct neph_frame_pair *pair = opaque;
    size_t first = (size_t)first_row * (size_t)pair->width_px;
    size_t count = (size_t)row_count * (size_t)pair->width_px;
    double floor = floor_share * pair->scene_mean;
    for (size_t done = 0; done < count; done += CHUNK_PX) {
        size_t part = count - done < CHUNK_PX ? count - done : CHUNK_PX;
        double *stops = values[0] + done;
        if (floor > 0.0)
            compute_stops(pair->reference, pair->test, first + done, part, floor, stops);
        for (size_t i = 0; i < part; i++) {
            if (!(floor > 0.0)) /* a black frame within a sequence */
                stops[i] = NAN;
            else if (map == MAP_ABSOLUTE)
                stops[i] = fabs(stops[i]);
        }
    }
}

static const struct neph_option options[] = {{.name = NULL}};

#define DEFINITION " of |log2(max(t, f) / max(r, f))|, luminance, f = 1e-4 of the scene's mean"

static const struct neph_metric metrics[] = {
    {"stops_mean", "stops", 0.0, INFINITY, NEPH_POOL_MEAN, 0.0, MAP_ABSOLUTE, 0, "mean" DEFINITION},
    {"stops_p50", "stops", 0.0, INFINITY, NEPH_POOL_PERCENTILE, 0.50, MAP_ABSOLUTE, 0,
     "median" DEFINITION},
    {"stops_p95", "stops", 0.0, INFINITY, NEPH_POOL_PERCENTILE, 0.95, MAP_ABSOLUTE, 0,
     "95th percentile" DEFINITION},
    {.name = NULL},
};

static const struct neph_map maps[] = {
    [MAP_SIGNED] = {"stops", "stops", 1, true, 1.0, black_frame, 0},
    [MAP_ABSOLUTE] = {NULL, "stops", 1, false, 0.0, black_frame, 0},
};

const struct neph_extractor neph_extractor_stops = {
    .name = "stops",
    .help = "error of luminance as a change of exposure; dark pixels count as much as bright ones",
    .source = "log2 error with a floor tied to the scene, so that black is not divided by",
    .quantities = NEPH_LINEAR_RGB,
    .pointwise = true,
    .options = options,
    .metrics = metrics,
    .maps = maps,
    .map_count = MAP_COUNT,
    .state_size = sizeof(struct neph_frame_pair),
    .obstacle = obstacle,
    .extract = extract,
    .rows = rows,
};
