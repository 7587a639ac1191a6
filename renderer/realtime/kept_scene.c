/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/kept_scene.h"

#define KEPT (NEPH_RT_BIT(RT_DEPTH) | NEPH_RT_BIT(RT_BEHIND))
/* At rest the same for all places. */
#define MADE_OF_IT (NEPH_RT_BIT(RT_STEADY_DEPTH) | NEPH_RT_BIT(RT_HALF_DEPTH))

static int place_count_of(const struct neph_gpu_view *view)
{
    return (int)view->settings[RT_TAA_JITTER_LENGTH];
}

/* Of fewer than two places the depth map has not been made twice, for now and for before. */
static bool may_keep(const struct neph_rt_device *device)
{
    const struct neph_gpu_view *view = device->view;
    const int count = place_count_of(view);
    const uint64_t bytes = (uint64_t)count * (neph_rt_target_bytes(view, RT_DEPTH) +
                                              neph_rt_target_bytes(view, RT_BEHIND));
    return !device->on_gpu && view->settings[RT_JITTERED_DEPTH] == 0.0f && count >= 2 &&
           count <= NEPH_RT_KEPT_PLACES_MAX && bytes <= NEPH_RT_KEPT_BYTES_MAX;
}

static enum neph_status create(struct neph_rt_kept_scene *kept, struct neph_rt_device *device,
                               int now, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    kept->place_count = place_count_of(device->view);
    kept->now = now;
    for (int i = 0; i < kept->place_count && !status; i++) {
        if (i == now)
            continue;
        status = neph_rt_device_add_target(device, RT_DEPTH, &kept->places[i].depth, diag);
        if (!status)
            status = neph_rt_device_add_target(device, RT_BEHIND, &kept->places[i].behind, diag);
    }
    return status;
}

static void change(struct neph_buffer *a, struct neph_buffer *b)
{
    const struct neph_buffer was = *a;
    *a = *b;
    *b = was;
}

static void exchange(struct neph_rt_device *device, struct neph_rt_kept_place *place)
{
    change(&device->targets[RT_DEPTH], &place->depth);
    change(&device->targets[RT_BEHIND], &place->behind);
}

enum neph_status neph_rt_kept_scene_take(struct neph_rt_kept_scene *kept,
                                         struct neph_rt_device *device, uint32_t picture,
                                         uint32_t alike, bool is_alone, uint32_t *given,
                                         struct neph_diag *diag)
{
    const int now = (int)(picture % (uint32_t)place_count_of(device->view));
    if (kept->place_count == 0) {
        if (!may_keep(device) || alike < (uint32_t)place_count_of(device->view))
            return NEPH_OK;
        const enum neph_status status = create(kept, device, now, diag);
        if (status)
            return status;
    }
    struct neph_rt_kept_place *place = &kept->places[now];
    if (now != kept->now) {
        exchange(device, &kept->places[kept->now]);
        exchange(device, place);
        kept->now = now;
    }
    if (place->is_made && is_alone && picture != place->picture &&
        picture - place->picture <= alike) {
        *given |= KEPT | MADE_OF_IT;
        return NEPH_OK;
    }
    place->is_made = is_alone;
    place->picture = picture;
    return NEPH_OK;
}

void neph_rt_kept_scene_destroy(const struct neph_vulkan *vulkan, struct neph_rt_kept_scene *kept)
{
    for (int i = 0; i < kept->place_count; i++) {
        neph_buffer_destroy(vulkan, &kept->places[i].depth);
        neph_buffer_destroy(vulkan, &kept->places[i].behind);
    }
    *kept = (struct neph_rt_kept_scene){.place_count = 0};
}
