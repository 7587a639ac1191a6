/* SPDX-License-Identifier: MIT */
#include "tests/renderer/twins/twin.h"

void neph_rt_oracle_compose(const struct neph_rt_oracle *oracle)
{
    for (int y = 0; y < (int)oracle->view->size_px[1]; y++)
        for (int x = 0; x < (int)oracle->view->size_px[0]; x++) {
            float volume[4], behind[4], color[4] = {[3] = 1.0f};
            neph_rt_fetch_full(oracle, RT_VOLUME, x, y, volume);
            neph_rt_fetch_full(oracle, RT_BEHIND, x, y, behind);
            for (int c = 0; c < 3; c++)
                color[c] = volume[c] + volume[3] * behind[c];
            neph_rt_put_full(oracle, RT_COLOR, x, y, color);
        }
}
