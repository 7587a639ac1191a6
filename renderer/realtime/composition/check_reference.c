/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/shared/check_reference.h"

void cpu_compose(const struct reference *cpu)
{
    for (int y = 0; y < (int)cpu->view->size_px[1]; y++)
        for (int x = 0; x < (int)cpu->view->size_px[0]; x++) {
            float volume[4], behind[4], color[4] = {[3] = 1.0f};
            cpu_fetch_full(cpu, RT_VOLUME, x, y, volume);
            cpu_fetch_full(cpu, RT_BEHIND, x, y, behind);
            for (int c = 0; c < 3; c++)
                color[c] = volume[c] + volume[3] * behind[c];
            cpu_put_full(cpu, RT_COLOR, x, y, color);
        }
}
