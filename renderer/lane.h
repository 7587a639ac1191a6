/* SPDX-License-Identifier: MIT
 *
 * Command buffers on their way to the device: a few lanes that batches (compute.h) take in turn, so
 * that one is recorded while the ones before run. Not for other folders.
 */
#ifndef NEPH_RENDERER_LANE_H
#define NEPH_RENDERER_LANE_H

#include "renderer/vulkan_device.h"

#include <stdbool.h>
#include <stdint.h>

enum {
    NEPH_LANE_COUNT = 3, /* one runs, one waits behind it, one is recorded */
    NEPH_LANE_STAMPS_MAX = 64
};

struct neph_lane {
    VkCommandBuffer commands;
    VkFence fence;
    VkQueryPool timestamps; /* one more than stamps; null: the device has no clock */
    uint32_t stamp_count;
    double *seconds[NEPH_LANE_STAMPS_MAX]; /* borrowed; what the time before each stamp is added to;
                                              NULL: nobody wants it */
};

/* The lane of batch number n is n % NEPH_LANE_COUNT. */
struct neph_lanes {
    VkCommandPool pool;
    struct neph_lane lanes[NEPH_LANE_COUNT];
    uint64_t sent, home; /* batches, ever; those between them are on their way */
};

/* Free with _destroy, also after an error. `has_clock`: with timestamps. */
VkResult neph_lanes_create(struct neph_vulkan *vulkan, bool has_clock);
void neph_lanes_destroy(struct neph_vulkan *vulkan);

/* The next lane, empty, once it is home; what an error has left half recorded in it is dropped. Its
 * commands come after all that were sent before, and see what those wrote. */
VkResult neph_lane_begin(const struct neph_vulkan *vulkan, struct neph_lane **lane);

/* Take the time when all before is done: at most NEPH_LANE_STAMPS_MAX times. */
void neph_lane_stamp(const struct neph_vulkan *vulkan, struct neph_lane *lane, double *seconds);

/* Send it on its way, the CPU being shown what it writes. */
VkResult neph_lane_send(const struct neph_vulkan *vulkan, struct neph_lane *lane);

/* Wait until `count` of all batches ever sent are home, and take the times of each. */
VkResult neph_lanes_wait(const struct neph_vulkan *vulkan, uint64_t count);

/* In the lane, between what comes before and what comes after. */
void neph_lane_barrier(const struct neph_vulkan *vulkan, const struct neph_lane *lane,
                       VkPipelineStageFlags from_stage, VkAccessFlags from_access,
                       VkPipelineStageFlags to_stage, VkAccessFlags to_access);

#endif
