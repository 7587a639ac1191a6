/* SPDX-License-Identifier: MIT
 *
 * Filling a table of optical depths towards the sun on the device, one thread an entry. Tracks
 * which entries are stale after a change of sun or media, and fills them at once or in parts over
 * several frames, with old depths in the other parts. For the light grid (sun_cache.h) and the
 * shadow map of clouds (cloud_shadow.h). Not for other folders.
 */
#ifndef NEPH_RENDERER_SUN_FILL_H
#define NEPH_RENDERER_SUN_FILL_H

#include "renderer/in_flight.h"
#include "renderer/march_split.h"
#include "renderer/skip_cells.h"

/* Tables that a frame may fill; the last is only counted (sky_shade.h). */
enum { NEPH_SUN_CACHE, NEPH_SUN_MAP, NEPH_SUN_SKY, NEPH_SUN_TABLES };

/* Cost of a filling, valid when its frame is collected; zeros if nothing was filled. */
struct neph_sun_fill_cost {
    double gpu_s[NEPH_SUN_TABLES]; /* NaN without a clock */
    /* Borrowed from the table; NULL: all are 0. */
    const struct neph_gpu_sun_counters *counters[NEPH_SUN_TABLES];
    int dispatches;
};

/* Device time of all tables together [s]. */
double neph_sun_fill_gpu_s(const struct neph_sun_fill_cost *cost);

/* Add up the counters of a collected frame. */
void neph_sun_fill_counts(const struct neph_sun_fill_cost *cost, uint64_t *density_evaluations,
                          uint64_t *closed_forms);

struct neph_sun_fill_shader {
    const char *name;
    const uint32_t *code; /* borrowed */
    size_t code_bytes;
    int table; /* NEPH_SUN_CACHE or _MAP: the entry of the costs */
};

struct neph_sun_fill {
    struct neph_vulkan *vulkan; /* borrowed */
    struct neph_sun_fill_shader shader;
    struct neph_march_params params;
    int part_count;              /* parts of a new filling */
    struct neph_buffer counters; /* of the latest filling */
    struct neph_buffer_ring counter_ring;
    struct neph_march_split cut; /* covers all entries */
    bool is_filled;
    int part, stale_parts; /* the next part to fill; the number of parts with an old sun or medium
                            */
    struct neph_sun sun;   /* of the latest filling */
    struct neph_gpu_medium media[NEPH_GPU_MEDIA_MAX]; /* in world space */
};

/* `cut` covers all entries; a new filling is spread over `pictures` frames (0 and 1: one frame).
 * Zero-initialise `fill`; free with _destroy, also after an error. */
enum neph_status neph_sun_fill_create(struct neph_vulkan *vulkan,
                                      const struct neph_sun_fill_shader *shader,
                                      const struct neph_march_params *params, int pictures,
                                      const struct neph_march_split *cut,
                                      struct neph_sun_fill *fill, struct neph_diag *diag);

/* Submit the filling of the stale entries of a table, or of the next part, before the frame's own
 * passes. `anew`: all entries are invalid. `cost` is borrowed until the frame is collected. Errors
 * as of neph_march_frame(). */
enum neph_status neph_sun_fill_run(struct neph_sun_fill *fill, const struct neph_scene *scene,
                                   const struct neph_gpu_scene *gpu,
                                   const struct neph_skip_cells *skip,
                                   const struct neph_buffer *table, bool anew,
                                   struct neph_sun_fill_cost *cost, struct neph_diag *diag);

/* A zero-initialised struct is fine. */
void neph_sun_fill_destroy(struct neph_sun_fill *fill);

#endif
