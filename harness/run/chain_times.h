/* SPDX-License-Identifier: MIT
 *
 * What the stages of a picture chain take on the device, over repeats.
 */
#ifndef NEPH_HARNESS_RUN_CHAIN_TIMES_H
#define NEPH_HARNESS_RUN_CHAIN_TIMES_H

#include "harness/run/flight.h"
#include "renderer/post/chain.h"

enum { NEPH_CHAIN_REPEATS_MAX = 1000 };

struct neph_chain_time {
    double least_s; /* NaN: the device has no clock */
    struct neph_spread spread_s;
};

struct neph_chain_times {
    int count;                                           /* of repeats */
    struct neph_chain_time stages[NEPH_POST_STAGES_MAX]; /* by neph_post_stages; 0: off */
    struct neph_chain_time all;
};

/* A device that has had no work for a while has a slow clock: it gets a second of it. */
enum neph_status neph_chain_warm_up(struct neph_vulkan *vulkan,
                                    const struct neph_post_params *params,
                                    const struct neph_image *frame, struct neph_diag *diag);

/* A frame through the chain, `repeats` times or until `limit_s` is over (+inf: never), each as if
 * it were the only one: the eye goes on from where it is. `*picture`, to be destroyed, and `stats`
 * are those of the last. Errors as of neph_post_run(). */
enum neph_status neph_chain_take(struct neph_vulkan *vulkan, const struct neph_post_params *params,
                                 const struct neph_image *frame, int repeats, double limit_s,
                                 struct neph_image **picture, struct neph_post_stats *stats,
                                 struct neph_chain_times *times, struct neph_diag *diag);

/* The stages that are on, by name, and all of them: "stages" and "all" of the documents that hold
 * times. In milliseconds. For the caller to decref. */
json_t *neph_chain_stages_json(const struct neph_post_params *params,
                               const struct neph_chain_times *times);
json_t *neph_chain_time_json(const char *name, const struct neph_chain_time *time);

#endif
