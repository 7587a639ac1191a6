/* SPDX-License-Identifier: MIT
 *
 * What frames have cost: the attributes "neph.stats.NAME" that engines give them.
 */
#ifndef NEPH_HARNESS_ENGINES_FRAME_STATS_H
#define NEPH_HARNESS_ENGINES_FRAME_STATS_H

#include "base/image.h"
#include "harness/json.h"

/* For engines: what a frame has cost, under a NAME. A value that is not finite was not measured and
 * is left out. */
enum neph_status neph_frame_stats_set(struct neph_image *frame, const char *name, double value,
                                      struct neph_diag *diag);

struct neph_frame_stat {
    const char *name;
    double value;
};

/* Several of them. */
enum neph_status neph_frame_stats_set_all(struct neph_image *frame,
                                          const struct neph_frame_stat *stats, size_t count,
                                          struct neph_diag *diag);

/* The time of a pass in ms, if it ran on a device with a clock, as "NAME_ENDING" with the pass's
 * spaces and hyphens as underscores: "depth_map_gpu_ms". */
enum neph_status neph_frame_stats_set_pass(struct neph_image *frame, const char *pass,
                                           const char *ending, double gpu_s,
                                           struct neph_diag *diag);

/* {"rays": 3600, ..} of one frame, in the engine's order; for the caller to decref. */
json_t *neph_frame_stats(const struct neph_image *frame);

/* A table with the mean, the least and the most of each number over the frames: an array of such
 * objects. Prints that there are none when the engine counts nothing. */
void neph_frame_stats_print(const json_t *frames);

#endif
