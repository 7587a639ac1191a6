/* SPDX-License-Identifier: MIT
 *
 * What passes make of solids alone, kept for as many pictures as it takes to come back: depths and
 * the radiance behind all media for each place of the jitter, which texel a tile marches for each
 * turn of its slots. Where nothing has moved and no light has changed since, the pass would make it
 * again to the last bit, and does not run; nor does the depth map. Where media send no light more
 * is kept.
 */
#ifndef NEPH_RENDERER_REALTIME_KEPT_SCENE_H
#define NEPH_RENDERER_REALTIME_KEPT_SCENE_H

#include "renderer/realtime/device.h"

enum { NEPH_RT_KEPT_PLACES_MAX = 16, NEPH_RT_KEPT_TARGETS_MAX = 2, NEPH_RT_KEPT_RINGS = 3 };
enum { NEPH_RT_KEPT_BYTES_MAX = 256 << 20 };

/* The targets of as many pictures. */
struct neph_rt_kept_ring {
    struct neph_rt_kept_place {
        struct neph_buffer targets[NEPH_RT_KEPT_TARGETS_MAX]; /* owned; empty while the device has
                                                                 them */
        bool is_made;
        uint32_t picture; /* for which they were made */
    } places[NEPH_RT_KEPT_PLACES_MAX];
    int place_count; /* 0: nothing is kept */
    int now;         /* the place that the device has */
};

struct neph_rt_kept_scene {
    struct neph_rt_kept_ring rings[NEPH_RT_KEPT_RINGS];
};

/* Give the device the targets of a picture's places. `alike`: pictures in a row before it that
 * showed the same; `is_alone`: it sees nothing but the scene itself. What need not be made of them
 * is added to `*given` (NEPH_RT_BIT() of each). Nothing is kept before as many pictures as it takes
 * to come back were alike, of more than NEPH_RT_KEPT_PLACES_MAX or NEPH_RT_KEPT_BYTES_MAX together,
 * of depths that jitter, and on a GPU, where a game has made all that. */
enum neph_status neph_rt_kept_scene_take(struct neph_rt_kept_scene *kept,
                                         struct neph_rt_device *device, uint32_t picture,
                                         uint32_t alike, bool is_alone, uint32_t *given,
                                         struct neph_diag *diag);

/* And the picture before anti-aliasing, where media only take light (neph_rt_device.is_dark) and
 * nobody reads what lies between: rays without noise make it anew, to the last bit, for each place
 * of the jitter once all texels have taken theirs. Behind neph_rt_kept_scene_take(), when it is
 * known whether the picture is read (RT_STEADY). */
enum neph_status neph_rt_kept_scene_take_picture(struct neph_rt_kept_scene *kept,
                                                 struct neph_rt_device *device, uint32_t picture,
                                                 uint32_t alike, uint32_t *given,
                                                 struct neph_diag *diag);

/* Before the device goes, whose own targets stay with it. A zero one is fine. */
void neph_rt_kept_scene_destroy(const struct neph_vulkan *vulkan, struct neph_rt_kept_scene *kept);

#endif
