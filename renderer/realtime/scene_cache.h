/* SPDX-License-Identifier: MIT
 *
 * Scene cache: reuses the outputs of passes that depend only on solids. It keeps depth and the
 * radiance behind all media for each place of the jitter, and the slot of each tile for each phase
 * of the slot schedule. In a static scene with constant light these passes would produce the same
 * bits again, so they and the depth map are skipped. When no medium sends light the cache also
 * keeps the composed frame.
 */
#ifndef NEPH_RENDERER_REALTIME_SCENE_CACHE_H
#define NEPH_RENDERER_REALTIME_SCENE_CACHE_H

#include "renderer/realtime/device.h"

enum { NEPH_RT_CACHE_ENTRIES_MAX = 16, NEPH_RT_CACHE_TARGETS_MAX = 2, NEPH_RT_CACHE_RINGS = 3 };
enum { NEPH_RT_CACHE_BYTES_MAX = 256 << 20 };

/* One cached set of targets for each frame of a period. */
struct neph_rt_cache_ring {
    struct neph_rt_cache_entry {
        struct neph_buffer targets[NEPH_RT_CACHE_TARGETS_MAX]; /* owned; empty while they are bound
                                                                 to the device */
        bool is_made;
        uint32_t picture; /* number of the frame that made them */
    } places[NEPH_RT_CACHE_ENTRIES_MAX];
    int place_count; /* 0: nothing is cached */
    int now;         /* the place whose buffers are bound to the device */
};

struct neph_rt_scene_cache {
    struct neph_rt_cache_ring rings[NEPH_RT_CACHE_RINGS];
};

/* Binds the cached targets for this frame number to the device. `alike`: number of identical frames
 * directly before this one. `has_only_scene`: rays see only the scene itself, without injections or
 * a given frame. Targets whose contents are still valid are added to `*given` (NEPH_RT_BIT() of
 * each).
 *
 * The cache starts after one full period of identical frames. It stays off
 * - for periods above NEPH_RT_CACHE_ENTRIES_MAX frames or above NEPH_RT_CACHE_BYTES_MAX,
 * - with jittered depths,
 * - on a GPU, where a game renders the solids itself. */
enum neph_status neph_rt_scene_cache_bind(struct neph_rt_scene_cache *kept,
                                          struct neph_rt_device *device, uint32_t picture,
                                          uint32_t alike, bool has_only_scene, uint32_t *given,
                                          struct neph_diag *diag);

/* Keeps or takes the composed frame before anti-aliasing. It needs media that only absorb
 * (neph_rt_device.is_dark) and intermediate targets that no later frame reads: rays without noise
 * then give the same bits for each place of the jitter, once every texel has its ray. Call it after
 * neph_rt_scene_cache_bind(), when RT_STEADY of the frame is known. */
enum neph_status neph_rt_scene_cache_bind_composed(struct neph_rt_scene_cache *kept,
                                                   struct neph_rt_device *device, uint32_t picture,
                                                   uint32_t alike, uint32_t *given,
                                                   struct neph_diag *diag);

/* Call before the device is destroyed, which keeps its own targets. A zero-initialised cache is
 * fine. */
void neph_rt_scene_cache_destroy(const struct neph_vulkan *vulkan,
                                 struct neph_rt_scene_cache *kept);

#endif
