/* SPDX-License-Identifier: MIT */
#include "tests/renderer/twins/twin.h"

static float choose(const struct neph_rt_oracle *oracle, int x, int y)
{
    const int map = (int)oracle->view->settings[RT_DEPTH_MAP];
    const bool nearest = map == RT_DEPTH_MAP_NEAREST ||
                         (map == RT_DEPTH_MAP_CHECKERBOARD && x % 2 == y % 2) ||
                         (map == RT_DEPTH_MAP_REVERSED && x % 2 != y % 2);
    float chosen[4], depth[4];
    neph_rt_fetch_full(oracle, RT_STEADY_DEPTH, 2 * x, 2 * y, chosen);
    for (int i = 1; i < 4; i++) {
        neph_rt_fetch_full(oracle, RT_STEADY_DEPTH, 2 * x + i % 2, 2 * y + i / 2, depth);
        if (nearest ? depth[0] < chosen[0] : depth[0] > chosen[0])
            chosen[0] = depth[0];
    }
    return chosen[0];
}

void neph_rt_oracle_min_max(const struct neph_rt_oracle *oracle)
{
    for (int y = 0; y < (int)oracle->view->half_size_px[1]; y++)
        for (int x = 0; x < (int)oracle->view->half_size_px[0]; x++)
            neph_rt_put_half(oracle, RT_HALF_DEPTH, x, y, (float[4]){choose(oracle, x, y)});
}
