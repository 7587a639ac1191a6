/* SPDX-License-Identifier: MIT
 *
 * Filling a table of optical depths towards the sun on the device, one thread an entry: what is in
 * it already, and what must be filled anew when sun or media have moved; at once, or a part in each
 * of the next pictures, while the rest still has the depths of before. For the sun cache
 * (sun_cache.h) and the shadow map of clouds (cloud_shadow.h). Not for other folders.
 */
#ifndef NEPH_RENDERER_SUN_FILL_H
#define NEPH_RENDERER_SUN_FILL_H

#include "renderer/in_flight.h"
#include "renderer/march_cut.h"
#include "renderer/skip_cells.h"

/* Tables that a picture may fill; of the last, counts alone (sky_shade.h). */
enum { NEPH_SUN_CACHE, NEPH_SUN_MAP, NEPH_SUN_SKY, NEPH_SUN_TABLES };

/* What filling costs, known when the frame that it is for is home; zeros when nothing was to be
 * done. */
struct neph_sun_fill_cost {
    double gpu_s[NEPH_SUN_TABLES]; /* NaN when the device has no clock */
    /* Borrowed from who fills; NULL: all are 0. */
    const struct neph_gpu_sun_counters *counters[NEPH_SUN_TABLES];
    int dispatches;
};

/* The device's time of all tables together [s]. */
double neph_sun_fill_gpu_s(const struct neph_sun_fill_cost *cost);

/* What has been counted, once that is home. */
void neph_sun_fill_counts(const struct neph_sun_fill_cost *cost, uint64_t *density_evaluations,
                          uint64_t *closed_forms);

struct neph_sun_fill_shader {
    const char *name;
    const uint32_t *code; /* borrowed */
    size_t code_bytes;
    int table; /* NEPH_SUN_CACHE or _MAP: whose costs it adds to */
};

struct neph_sun_fill {
    struct neph_vulkan *vulkan; /* borrowed */
    struct neph_sun_fill_shader shader;
    struct neph_march_params params;
    int part_count;              /* that a new filling takes */
    struct neph_buffer counters; /* of the newest filling */
    struct neph_turns counter_turns;
    struct neph_march_cut cut; /* of all entries */
    bool is_filled;
    int part, stale_parts; /* which is filled next; how many are of an older sun or medium */
    struct neph_sun sun;   /* what it was filled for last */
    struct neph_gpu_medium media[NEPH_GPU_MEDIA_MAX]; /* in the world */
};

/* `cut` is of all entries; `pictures` (0 and 1: one) share a new filling. Zero-initialise `fill`;
 * free with _destroy, also after an error. */
enum neph_status neph_sun_fill_create(struct neph_vulkan *vulkan,
                                      const struct neph_sun_fill_shader *shader,
                                      const struct neph_march_params *params, int pictures,
                                      const struct neph_march_cut *cut, struct neph_sun_fill *fill,
                                      struct neph_diag *diag);

/* Send what is stale of a table, or the part whose turn it is, on its way, before the frame's own
 * passes. `anew`: nothing of it is of use any more. `cost` is borrowed until the frame is home.
 * Errors as of neph_march_frame(). */
enum neph_status neph_sun_fill_run(struct neph_sun_fill *fill, const struct neph_scene *scene,
                                   const struct neph_gpu_scene *gpu,
                                   const struct neph_skip_cells *skip,
                                   const struct neph_buffer *table, bool anew,
                                   struct neph_sun_fill_cost *cost, struct neph_diag *diag);

/* A zero one is fine. */
void neph_sun_fill_destroy(struct neph_sun_fill *fill);

#endif
