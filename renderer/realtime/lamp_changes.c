/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/lamp_changes.h"

#include "base/vec3.h"
#include "renderer/gpu_scene.h"

#include <string.h>

/* Compares as floats relative to the camera: a static lamp whose world has moved has not changed.
 */
static bool set_lamp_before(struct neph_gpu_view *view, int index, const struct neph_light *now,
                            const struct neph_light *before, struct neph_vec3 origin_shift_m,
                            struct neph_vec3 camera_m)
{
    const struct neph_gpu_lamp lamp = neph_gpu_lamp_pack(now, camera_m);
    struct neph_light shifted = *before;
    shifted.position_m = neph_vec3_add(before->position_m, origin_shift_m);
    view->lamps_before[index] = neph_gpu_lamp_pack(&shifted, camera_m);
    return memcmp(&lamp, &view->lamps_before[index], sizeof(lamp)) != 0;
}

void neph_rt_view_set_lamp_changes(struct neph_gpu_view *view,
                                   const struct neph_rt_light_history *history,
                                   struct neph_vec3 origin_shift_m, struct neph_vec3 camera_m)
{
    const struct neph_rt_light_frame *now = neph_rt_light_history_frame(history, 0);
    const struct neph_rt_light_frame *before = neph_rt_light_history_frame(history, 1);
    view->lamps_changed = 0;
    view->sun_jumped = 0;
    if (history->count < 2)
        return;
    view->sun_jumped = now->light_count != before->light_count ||
                       !neph_rt_are_suns_similar(&now->sun, &before->sun);
    for (int i = 0; i < now->light_count && i < before->light_count; i++)
        if (set_lamp_before(view, i, &now->lights[i], &before->lights[i], origin_shift_m, camera_m))
            view->lamps_changed |= 1u << i;
}
