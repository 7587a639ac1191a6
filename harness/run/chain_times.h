/* SPDX-License-Identifier: MIT
 *
 * GPU times of the display chain's stages over repeats.
 */
#ifndef NEPH_HARNESS_RUN_CHAIN_TIMES_H
#define NEPH_HARNESS_RUN_CHAIN_TIMES_H

#include "harness/run/flight.h"
#include "renderer/post/chain.h"

enum { NEPH_CHAIN_REPEATS_MAX = 1000 };

struct neph_chain_time {
    double least_s; /* NaN: the device has no timestamps */
    struct neph_spread spread_s;
};

struct neph_chain_times {
    int count;                                           /* number of repeats */
    struct neph_chain_time stages[NEPH_POST_STAGES_MAX]; /* indexed as neph_post_stages; 0: the
                                                            stage is off */
    struct neph_chain_time all;
};

/* Runs the chain for a second: the clock of an idle GPU is low. */
enum neph_status neph_chain_warm_up(struct neph_vulkan *vulkan,
                                    const struct neph_post_params *params,
                                    const struct neph_image *frame, struct neph_diag *diag);

/* Runs a frame through the chain `repeats` times or until `limit_s` is over (+inf: no limit). Every
 * repeat starts from the exposure state that `params` came with, as if it were the only run. The
 * image `*picture` (the caller destroys it), `stats` and the exposure state are those of the last
 * run. Errors as of neph_post_run(). */
enum neph_status neph_chain_measure(struct neph_vulkan *vulkan,
                                    const struct neph_post_params *params,
                                    const struct neph_image *frame, int repeats, double limit_s,
                                    struct neph_image **picture, struct neph_post_stats *stats,
                                    struct neph_chain_times *times, struct neph_diag *diag);

/* The "stages" (active ones, by name) and the "all" of documents with times, in milliseconds. The
 * caller decrefs the result. */
json_t *neph_chain_stages_json(const struct neph_post_params *params,
                               const struct neph_chain_times *times);
json_t *neph_chain_time_json(const char *name, const struct neph_chain_time *time);

#endif
