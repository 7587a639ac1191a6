/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/shared/check_reference.h"

static float choose(const struct reference *cpu, int x, int y)
{
    const int map = (int)cpu->view->settings[RT_DEPTH_MAP];
    const bool nearest = map == RT_DEPTH_MAP_NEAREST ||
                         (map == RT_DEPTH_MAP_CHECKERBOARD && x % 2 == y % 2) ||
                         (map == RT_DEPTH_MAP_REVERSED && x % 2 != y % 2);
    float chosen[4], depth[4];
    cpu_fetch_full(cpu, RT_STEADY_DEPTH, 2 * x, 2 * y, chosen);
    for (int i = 1; i < 4; i++) {
        cpu_fetch_full(cpu, RT_STEADY_DEPTH, 2 * x + i % 2, 2 * y + i / 2, depth);
        if (nearest ? depth[0] < chosen[0] : depth[0] > chosen[0])
            chosen[0] = depth[0];
    }
    return chosen[0];
}

void cpu_min_max(const struct reference *cpu)
{
    for (int y = 0; y < (int)cpu->view->half_size_px[1]; y++)
        for (int x = 0; x < (int)cpu->view->half_size_px[0]; x++)
            cpu_put_half(cpu, RT_HALF_DEPTH, x, y, (float[4]){choose(cpu, x, y)});
}
