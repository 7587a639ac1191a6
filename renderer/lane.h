/* SPDX-License-Identifier: MIT
 *
 * Command buffers: a few lanes, used by batches (compute.h) in turn, so that one batch is recorded
 * while earlier ones run. Not for other folders.
 */
#ifndef NEPH_RENDERER_LANE_H
#define NEPH_RENDERER_LANE_H

#include "renderer/vulkan_device.h"

#include <stdbool.h>
#include <stdint.h>

enum {
    NEPH_LANE_COUNT = 3, /* one running, one queued, one being recorded */
    NEPH_LANE_STAMPS_MAX = 64
};

struct neph_lane {
    VkCommandBuffer commands;
    VkFence fence;
    VkQueryPool timestamps; /* one more than stamps; null: the device has no clock */
    uint32_t stamp_count;
    double *seconds[NEPH_LANE_STAMPS_MAX]; /* borrowed; the time before each stamp is added here;
                                              NULL: not reported */
};

/* The lane of batch number n is n % NEPH_LANE_COUNT. */
struct neph_lanes {
    VkCommandPool pool;
    struct neph_lane lanes[NEPH_LANE_COUNT];
    uint64_t sent, home; /* counts of batches submitted and collected; the difference is in flight
                          */
};

/* Free with _destroy, also after an error. `has_clock`: with timestamps. */
VkResult neph_lanes_create(struct neph_vulkan *vulkan, bool has_clock);
void neph_lanes_destroy(struct neph_vulkan *vulkan);

/* Wait for the next lane and reset it; a recording that an error left incomplete is dropped. Its
 * commands run after all submitted before, and see their writes. */
VkResult neph_lane_begin(const struct neph_vulkan *vulkan, struct neph_lane **lane);

/* Record a timestamp after the commands so far, at most NEPH_LANE_STAMPS_MAX times. */
void neph_lane_stamp(const struct neph_vulkan *vulkan, struct neph_lane *lane, double *seconds);

/* Submit the lane and make its writes visible to the CPU. */
VkResult neph_lane_submit(const struct neph_vulkan *vulkan, struct neph_lane *lane);

/* Wait until the first `count` batches are done, and add up their times. */
VkResult neph_lanes_wait(const struct neph_vulkan *vulkan, uint64_t count);

/* Record a memory barrier. */
void neph_lane_barrier(const struct neph_vulkan *vulkan, const struct neph_lane *lane,
                       VkPipelineStageFlags from_stage, VkAccessFlags from_access,
                       VkPipelineStageFlags to_stage, VkAccessFlags to_access);

#endif
