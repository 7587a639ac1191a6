/* SPDX-License-Identifier: MIT
 *
 * Costs of frames: the attributes "neph.stats.NAME" that engines set.
 */
#ifndef NEPH_HARNESS_ENGINES_FRAME_STATS_H
#define NEPH_HARNESS_ENGINES_FRAME_STATS_H

#include "base/image.h"
#include "harness/json.h"

/* Set a cost of a frame under NAME. A value that is not finite means "not measured" and is left
 * out. */
enum neph_status neph_frame_stats_set(struct neph_image *frame, const char *name, double value,
                                      struct neph_diag *diag);

struct neph_frame_stat {
    const char *name;
    double value;
};

/* Set several costs. */
enum neph_status neph_frame_stats_set_all(struct neph_image *frame,
                                          const struct neph_frame_stat *stats, size_t count,
                                          struct neph_diag *diag);

/* Set the time of a pass in ms, if the pass ran and the device has timestamps. The name is
 * "PASS_ENDING", with spaces and hyphens of the pass's name as underscores: "depth_map_gpu_ms". */
enum neph_status neph_frame_stats_set_pass(struct neph_image *frame, const char *pass,
                                           const char *ending, double gpu_s,
                                           struct neph_diag *diag);

/* The costs of one frame as JSON, {"rays": 3600, ..}, in the engine's order; for the caller to
 * decref. */
json_t *neph_frame_stats(const struct neph_image *frame);

/* Print a table with mean, minimum and maximum of each number over an array of such objects; a
 * message if there are no numbers. */
void neph_frame_stats_print(const json_t *frames);

#endif
