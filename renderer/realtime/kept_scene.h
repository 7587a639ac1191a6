/* SPDX-License-Identifier: MIT
 *
 * What the pass `scene` has made, depths and the radiance behind all media, kept for each place of
 * the jitter. Where nothing has moved and no light has changed since a picture of the same place,
 * the pass would make it again to the last bit: it does not run, nor does the depth map.
 */
#ifndef NEPH_RENDERER_REALTIME_KEPT_SCENE_H
#define NEPH_RENDERER_REALTIME_KEPT_SCENE_H

#include "renderer/realtime/device.h"

enum { NEPH_RT_KEPT_PLACES_MAX = 16, NEPH_RT_KEPT_BYTES_MAX = 256 << 20 };

struct neph_rt_kept_scene {
    struct neph_rt_kept_place {
        struct neph_buffer depth, behind; /* owned; empty while the device has them */
        bool is_made;
        uint32_t picture; /* for which it was made */
    } places[NEPH_RT_KEPT_PLACES_MAX];
    int place_count; /* 0: nothing is kept */
    int now;         /* the place that the device has */
};

/* Give the device the targets of a picture's place. `alike`: pictures in a row before it that
 * showed the same; `is_alone`: it sees nothing but the scene itself. What need not be made of them is added to `*given` (NEPH_RT_BIT() of each).
 * Nothing is kept before as many pictures as the jitter has places were alike, of places more than
 * NEPH_RT_KEPT_PLACES_MAX or NEPH_RT_KEPT_BYTES_MAX together, of depths that jitter, and on a GPU,
 * where a game has made all that. */
enum neph_status neph_rt_kept_scene_take(struct neph_rt_kept_scene *kept,
                                         struct neph_rt_device *device, uint32_t picture,
                                         uint32_t alike, bool is_alone, uint32_t *given,
                                         struct neph_diag *diag);

/* Before the device goes, whose own targets stay with it. A zero one is fine. */
void neph_rt_kept_scene_destroy(const struct neph_vulkan *vulkan, struct neph_rt_kept_scene *kept);

#endif
