/* SPDX-License-Identifier: MIT
 *
 * Shared by the tests of the reconstruction: runs some frames of it on the device and downloads the
 * results into the CPU reference's memory.
 */
#ifndef NEPH_TESTS_RECONSTRUCT_TEST_H
#define NEPH_TESTS_RECONSTRUCT_TEST_H

#include "renderer/realtime/tile_index/check_reference_slots.h"
#include "tests/renderer/realtime_test.h"

/* A view that fills its buffers: all solids at 100 m, all rays and histories (0, 0, 0, 1) with a
 * distance of 100 m, every tile at its scheduled slot. The camera is static; the history has age
 * 1. */
__attribute__((format(printf, 5, 6))) static inline void
reconstruct_open(struct neph_vulkan *vulkan, int width, int height, struct test_passes *test,
                 const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    test_open_words(vulkan, (int[2]){width, height}, 3, test, format, arguments);
    va_end(arguments);
    test->view.has_history = 1;
    test_fill(test, RT_HALF_DEPTH, 100, 0, 0, 0);
    test_fill(test, RT_HALF_DEPTH_BEFORE, 100, 0, 0, 0);
    test_fill(test, RT_RAY, 0, 0, 0, 1);
    test_fill(test, RT_RAY_DISTANCE, 100, 0, 0, 0);
    test_fill(test, RT_HISTORY_BEFORE, 0, 0, 0, 1);
    test_fill(test, RT_HISTORY_STATE_BEFORE, 1, 100, 0, 0);
    cpu_tile_index(&test->cpu);
}

static inline size_t reconstruct_threads(const struct test_passes *test)
{
    return (size_t)test->view.half_size_px[0] * test->view.half_size_px[1];
}

static inline void reconstruct_run(struct test_passes *test)
{
    test_passes_run(test, "reconstruction");
    test_take(test, RT_HISTORY);
    test_take(test, RT_HISTORY_STATE);
}

/* Makes this frame the one before; depths are copied. */
static inline void reconstruct_next_frame(struct test_passes *test)
{
    test_swap(test, RT_HISTORY, RT_HISTORY_BEFORE);
    test_swap(test, RT_HISTORY_STATE, RT_HISTORY_STATE_BEFORE);
    memcpy(test->cpu.targets[RT_HALF_DEPTH_BEFORE], test->cpu.targets[RT_HALF_DEPTH],
           neph_rt_device_words(&test->device, RT_HALF_DEPTH) * sizeof(uint32_t));
    test->view.has_history = 1;
    test->view.frame++;
    cpu_tile_index(&test->cpu);
}

/* The half-resolution texel that a tile marches. */
static inline void reconstruct_marched(const struct test_passes *test, int tile_x, int tile_y,
                                       int half_pixel[2])
{
    float tile[4];
    cpu_fetch_tile(&test->cpu, RT_TILE, tile_x, tile_y, tile);
    const int *place = cpu_slot_place(&test->view, (int)tile[0]);
    half_pixel[0] = 2 * tile_x + place[0];
    half_pixel[1] = 2 * tile_y + place[1];
}

static inline bool reconstruct_is_marched(const struct test_passes *test, int x, int y)
{
    int half_pixel[2];
    reconstruct_marched(test, x / 2, y / 2, half_pixel);
    return half_pixel[0] == x && half_pixel[1] == y;
}

/* A channel of a texel at half resolution. */
static inline double half_value(const struct test_passes *test, int target, int x, int y,
                                int channel)
{
    float value[4];
    cpu_fetch_half(&test->cpu, target, x, y, value);
    return value[channel];
}

/* A camera turned by angles about its own axes: to the right, upwards, clockwise. */
static inline void reconstruct_phase(struct neph_gpu_view_camera *camera, double yaw_rad,
                                     double pitch_rad, double roll_rad)
{
    const double angles_rad[3] = {yaw_rad, pitch_rad, roll_rad};
    for (int i = 0; i < 3; i++) {
        float *from = i == 2 ? camera->up : camera->forward;
        float *to = i == 1 ? camera->up : camera->right;
        const double c = cos(angles_rad[i]), s = sin(angles_rad[i]);
        for (int k = 0; k < 3; k++) {
            const double a = from[k], b = to[k];
            from[k] = (float)(c * a + s * b);
            to[k] = (float)(c * b - s * a);
        }
    }
}

#endif
