/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/shared/check_reference.h"

static float choose(const struct twin *twin, int x, int y)
{
    const int map = (int)twin->view->settings[RT_DEPTH_MAP];
    const bool nearest = map == RT_DEPTH_MAP_NEAREST ||
                         (map == RT_DEPTH_MAP_CHECKERBOARD && x % 2 == y % 2) ||
                         (map == RT_DEPTH_MAP_REVERSED && x % 2 != y % 2);
    float chosen[4], depth[4];
    twin_fetch_full(twin, RT_STEADY_DEPTH, 2 * x, 2 * y, chosen);
    for (int i = 1; i < 4; i++) {
        twin_fetch_full(twin, RT_STEADY_DEPTH, 2 * x + i % 2, 2 * y + i / 2, depth);
        if (nearest ? depth[0] < chosen[0] : depth[0] > chosen[0])
            chosen[0] = depth[0];
    }
    return chosen[0];
}

void twin_min_max(const struct twin *twin)
{
    for (int y = 0; y < (int)twin->view->half_size_px[1]; y++)
        for (int x = 0; x < (int)twin->view->half_size_px[0]; x++)
            twin_put_half(twin, RT_HALF_DEPTH, x, y, (float[4]){choose(twin, x, y)});
}
