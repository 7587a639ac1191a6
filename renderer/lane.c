/* SPDX-License-Identifier: MIT */
#include "renderer/lane.h"

#include <math.h>
#include <stdlib.h>

/* --- creation ----------------------------------------------------------------------------- */

static VkResult create_lane(struct neph_vulkan *vulkan, bool has_clock, struct neph_lane *lane)
{
    const VkCommandBufferAllocateInfo commands = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
        .commandPool = vulkan->lanes->pool,
        .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
        .commandBufferCount = 1,
    };
    const VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    const VkQueryPoolCreateInfo timestamps = {
        .sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
        .queryType = VK_QUERY_TYPE_TIMESTAMP,
        .queryCount = NEPH_LANE_STAMPS_MAX + 1,
    };
    VkResult result = vulkan->api.vkAllocateCommandBuffers(vulkan->device, &commands,
                                                           &lane->commands);
    if (result == VK_SUCCESS)
        result = vulkan->api.vkCreateFence(vulkan->device, &fence, NULL, &lane->fence);
    if (result == VK_SUCCESS && has_clock)
        result = vulkan->api.vkCreateQueryPool(vulkan->device, &timestamps, NULL,
                                               &lane->timestamps);
    if (result != VK_SUCCESS)
        return result;
    neph_vulkan_name(vulkan, VK_OBJECT_TYPE_FENCE, (uint64_t)lane->fence, "batch is over");
    if (has_clock)
        neph_vulkan_name(vulkan, VK_OBJECT_TYPE_QUERY_POOL, (uint64_t)lane->timestamps,
                         "timestamps");
    return VK_SUCCESS;
}

VkResult neph_lanes_create(struct neph_vulkan *vulkan, bool has_clock)
{
    const VkCommandPoolCreateInfo pool = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
        .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
        .queueFamilyIndex = vulkan->queue_family,
    };
    vulkan->lanes = calloc(1, sizeof(*vulkan->lanes));
    if (!vulkan->lanes)
        return VK_ERROR_OUT_OF_HOST_MEMORY;
    VkResult result = vulkan->api.vkCreateCommandPool(vulkan->device, &pool, NULL,
                                                      &vulkan->lanes->pool);
    if (result != VK_SUCCESS)
        return result;
    neph_vulkan_name(vulkan, VK_OBJECT_TYPE_COMMAND_POOL, (uint64_t)vulkan->lanes->pool,
                     "commands");
    for (int i = 0; i < NEPH_LANE_COUNT && result == VK_SUCCESS; i++)
        result = create_lane(vulkan, has_clock, &vulkan->lanes->lanes[i]);
    return result;
}

void neph_lanes_destroy(struct neph_vulkan *vulkan)
{
    struct neph_lanes *lanes = vulkan->lanes;
    if (!lanes)
        return;
    neph_lanes_wait(vulkan, lanes->sent);
    for (int i = 0; i < NEPH_LANE_COUNT; i++) {
        vulkan->api.vkDestroyFence(vulkan->device, lanes->lanes[i].fence, NULL);
        vulkan->api.vkDestroyQueryPool(vulkan->device, lanes->lanes[i].timestamps, NULL);
    }
    vulkan->api.vkDestroyCommandPool(vulkan->device, lanes->pool, NULL);
    free(lanes);
    vulkan->lanes = NULL;
}

/* --- recording ---------------------------------------------------------------------------- */

void neph_lane_barrier(const struct neph_vulkan *vulkan, const struct neph_lane *lane,
                       VkPipelineStageFlags from_stage, VkAccessFlags from_access,
                       VkPipelineStageFlags to_stage, VkAccessFlags to_access)
{
    const VkMemoryBarrier barrier = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
        .srcAccessMask = from_access,
        .dstAccessMask = to_access,
    };
    vulkan->api.vkCmdPipelineBarrier(lane->commands, from_stage, to_stage, 0, 1, &barrier, 0, NULL,
                                     0, NULL);
}

static void write_timestamp(const struct neph_vulkan *vulkan, const struct neph_lane *lane)
{
    if (lane->timestamps)
        vulkan->api.vkCmdWriteTimestamp(lane->commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                                        lane->timestamps, lane->stamp_count);
}

/* The first timestamp is written after the barrier, so that earlier batches do not count. */
static void record_start(const struct neph_vulkan *vulkan, struct neph_lane *lane)
{
    const VkPipelineStageFlags stages = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT |
                                        VK_PIPELINE_STAGE_TRANSFER_BIT;
    const VkAccessFlags writes = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT;
    const VkAccessFlags reads = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_TRANSFER_READ_BIT;
    lane->stamp_count = 0;
    if (lane->timestamps) /* reset by the CPU: the lane is idle, and a reset by the device would be
                             timed */
        vulkan->api.vkResetQueryPool(vulkan->device, lane->timestamps, 0, NEPH_LANE_STAMPS_MAX + 1);
    neph_lane_barrier(vulkan, lane, stages, writes, stages, reads | writes);
    write_timestamp(vulkan, lane);
}

VkResult neph_lane_begin(const struct neph_vulkan *vulkan, struct neph_lane **lane)
{
    struct neph_lanes *lanes = vulkan->lanes;
    struct neph_lane *next = &lanes->lanes[lanes->sent % NEPH_LANE_COUNT];
    const VkCommandBufferBeginInfo info = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
        .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT,
    };
    VkResult result = VK_SUCCESS;
    if (lanes->sent >= NEPH_LANE_COUNT)
        result = neph_lanes_wait(vulkan, lanes->sent - NEPH_LANE_COUNT + 1);
    if (result == VK_SUCCESS)
        result = vulkan->api.vkResetCommandBuffer(next->commands, 0);
    if (result == VK_SUCCESS)
        result = vulkan->api.vkBeginCommandBuffer(next->commands, &info);
    if (result != VK_SUCCESS)
        return result;
    record_start(vulkan, next);
    *lane = next;
    return VK_SUCCESS;
}

void neph_lane_stamp(const struct neph_vulkan *vulkan, struct neph_lane *lane, double *seconds)
{
    lane->seconds[lane->stamp_count++] = seconds;
    write_timestamp(vulkan, lane);
}

/* --- submission and completion ------------------------------------------------------------ */

VkResult neph_lane_submit(const struct neph_vulkan *vulkan, struct neph_lane *lane)
{
    const VkSubmitInfo submit = {
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
        .commandBufferCount = 1,
        .pCommandBuffers = &lane->commands,
    };
    neph_lane_barrier(vulkan, lane,
                      VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT,
                      VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT,
                      VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT);
    VkResult result = vulkan->api.vkEndCommandBuffer(lane->commands);
    if (result == VK_SUCCESS)
        result = vulkan->api.vkResetFences(vulkan->device, 1, &lane->fence);
    if (result == VK_SUCCESS)
        result = vulkan->api.vkQueueSubmit(vulkan->queue, 1, &submit, lane->fence);
    if (result == VK_SUCCESS)
        vulkan->lanes->sent++;
    return result;
}

static void add_time(const struct neph_lane *lane, uint32_t stamp, double seconds)
{
    if (lane->seconds[stamp])
        *lane->seconds[stamp] += seconds;
}

static VkResult collect_times(const struct neph_vulkan *vulkan, const struct neph_lane *lane)
{
    const uint32_t count = lane->stamp_count;
    uint64_t ticks[NEPH_LANE_STAMPS_MAX + 1];
    VkResult result = VK_SUCCESS;
    if (lane->timestamps && count > 0)
        result = vulkan->api.vkGetQueryPoolResults(
            vulkan->device, lane->timestamps, 0, count + 1, sizeof(ticks), ticks, sizeof(ticks[0]),
            VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT);
    for (uint32_t i = 0; i < count && result == VK_SUCCESS; i++)
        add_time(lane, i,
                 lane->timestamps ? (double)((ticks[i + 1] - ticks[i]) & vulkan->timestamp_mask) *
                                        vulkan->timestamp_period_s
                                  : NAN);
    return result;
}

VkResult neph_lanes_wait(const struct neph_vulkan *vulkan, uint64_t count)
{
    struct neph_lanes *lanes = vulkan->lanes;
    VkResult result = VK_SUCCESS;
    for (; lanes->home < count && result == VK_SUCCESS; lanes->home++) {
        const struct neph_lane *lane = &lanes->lanes[lanes->home % NEPH_LANE_COUNT];
        result = vulkan->api.vkWaitForFences(vulkan->device, 1, &lane->fence, VK_TRUE, UINT64_MAX);
        if (result == VK_SUCCESS)
            result = collect_times(vulkan, lane);
    }
    return result;
}
