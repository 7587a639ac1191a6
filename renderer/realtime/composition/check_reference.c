/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/shared/check_reference.h"

void twin_compose(const struct twin *twin)
{
    for (int y = 0; y < (int)twin->view->size_px[1]; y++)
        for (int x = 0; x < (int)twin->view->size_px[0]; x++) {
            float volume[4], behind[4], color[4] = {[3] = 1.0f};
            twin_fetch_full(twin, RT_VOLUME, x, y, volume);
            twin_fetch_full(twin, RT_BEHIND, x, y, behind);
            for (int c = 0; c < 3; c++)
                color[c] = volume[c] + volume[3] * behind[c];
            twin_put_full(twin, RT_COLOR, x, y, color);
        }
}
