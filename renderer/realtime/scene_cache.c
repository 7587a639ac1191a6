/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/scene_cache.h"

#include "renderer/realtime/output_elision.h"

enum { SLOT_PHASES = 4 }; /* phases of the slot schedule */

enum { SCENE, TILES, COMPOSED };

/* Frames until every texel with a ray has marched twice without noise. */
enum { SETTLED = 2 * SLOT_PHASES };

static const struct {
    int targets[NEPH_RT_CACHE_TARGETS_MAX], target_count;
    int place_count; /* 0: length of the jitter */
    uint32_t given;  /* these targets, and those that are equal in all places of a static scene */
} rows[NEPH_RT_CACHE_RINGS] = {
    {{RT_DEPTH, RT_BEHIND},
     2,
     0,
     NEPH_RT_BIT(RT_DEPTH) | NEPH_RT_BIT(RT_BEHIND) | NEPH_RT_BIT(RT_STEADY_DEPTH) |
         NEPH_RT_BIT(RT_HALF_DEPTH)},
    {{RT_TILE}, 1, SLOT_PHASES, NEPH_RT_BIT(RT_TILE)},
    {{RT_COLOR},
     1,
     0,
     NEPH_RT_BIT(RT_RAY) | NEPH_RT_BIT(RT_RAY_DISTANCE) | NEPH_RT_BIT(RT_HISTORY) |
         NEPH_RT_BIT(RT_HISTORY_STATE) | NEPH_RT_BIT(RT_CHANGE) | NEPH_RT_BIT(RT_CHANGE_BEHIND) |
         NEPH_RT_BIT(RT_KEPT_RAY) | NEPH_RT_BIT(RT_VOLUME) | NEPH_RT_BIT(RT_VOLUME_DISTANCE) |
         NEPH_RT_BIT(RT_COLOR)},
};

static int count_cache_entries(const struct neph_gpu_view *view, int ring)
{
    return rows[ring].place_count ? rows[ring].place_count
                                  : (int)view->settings[RT_TAA_JITTER_LENGTH];
}

/* At least two places: the depth map must exist twice, for this frame and the one before. */
static bool can_cache_ring(const struct neph_rt_device *device, int ring)
{
    const struct neph_gpu_view *view = device->view;
    const int count = count_cache_entries(view, ring);
    uint64_t bytes = 0;
    for (int t = 0; t < rows[ring].target_count; t++)
        bytes += (uint64_t)count * neph_rt_target_bytes(view, rows[ring].targets[t]);
    return neph_rt_get_tuning(device->kind)->elides_outputs &&
           view->settings[RT_JITTERED_DEPTH] == 0.0f && count >= 2 &&
           count <= NEPH_RT_CACHE_ENTRIES_MAX && bytes <= NEPH_RT_CACHE_BYTES_MAX;
}

static enum neph_status create_ring(struct neph_rt_cache_ring *kept, struct neph_rt_device *device,
                                    int ring, int now, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    kept->place_count = count_cache_entries(device->view, ring);
    kept->now = now;
    for (int i = 0; i < kept->place_count; i++)
        for (int t = 0; t < rows[ring].target_count && i != now && !status; t++)
            status = neph_rt_device_add_target(device, rows[ring].targets[t],
                                               &kept->places[i].targets[t], diag);
    return status;
}

static void swap_buffers(struct neph_rt_device *device, int ring, struct neph_rt_cache_entry *place)
{
    for (int t = 0; t < rows[ring].target_count; t++) {
        struct neph_buffer *own = &device->targets[rows[ring].targets[t]];
        const struct neph_buffer was = *own;
        *own = place->targets[t];
        place->targets[t] = was;
    }
}

/* Whether the targets were made in an earlier frame with the same content. */
static bool is_known(const struct neph_rt_cache_entry *place, uint32_t picture, uint32_t alike)
{
    return place->is_made && picture != place->picture && picture - place->picture <= alike;
}

static enum neph_status bind_ring(struct neph_rt_cache_ring *kept, struct neph_rt_device *device,
                                  int ring, uint32_t picture, uint32_t alike, bool has_only_scene,
                                  uint32_t *given, struct neph_diag *diag)
{
    const uint32_t count = (uint32_t)count_cache_entries(device->view, ring);
    const int now = (int)(picture % count);
    enum neph_status status = NEPH_OK;
    if (kept->place_count == 0 && (alike < count || !can_cache_ring(device, ring)))
        return NEPH_OK;
    if (kept->place_count == 0)
        status = create_ring(kept, device, ring, now, diag);
    if (status)
        return status;
    if (now != kept->now) {
        swap_buffers(device, ring, &kept->places[kept->now]);
        swap_buffers(device, ring, &kept->places[now]);
        kept->now = now;
    }
    struct neph_rt_cache_entry *place = &kept->places[now];
    if (has_only_scene && is_known(place, picture, alike)) {
        *given |= rows[ring].given;
        return NEPH_OK;
    }
    place->is_made = has_only_scene;
    place->picture = picture;
    return NEPH_OK;
}

enum neph_status neph_rt_scene_cache_bind(struct neph_rt_scene_cache *kept,
                                          struct neph_rt_device *device, uint32_t picture,
                                          uint32_t alike, bool has_only_scene, uint32_t *given,
                                          struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int ring = SCENE; ring <= TILES && !status; ring++)
        status = bind_ring(&kept->rings[ring], device, ring, picture, alike,
                           has_only_scene && !device->view->resting, given, diag);
    return status;
}

enum neph_status neph_rt_scene_cache_bind_composed(struct neph_rt_scene_cache *kept,
                                                   struct neph_rt_device *device, uint32_t picture,
                                                   uint32_t alike, uint32_t *given,
                                                   struct neph_diag *diag)
{
    struct neph_rt_cache_ring *ring = &kept->rings[COMPOSED];
    const bool is_settled = device->is_dark && neph_rt_is_output_elided(device->view) &&
                            alike >= SETTLED;
    if (ring->place_count == 0 && !is_settled)
        return NEPH_OK;
    return bind_ring(ring, device, COMPOSED, picture, is_settled ? alike - SETTLED : 0, is_settled,
                     given, diag);
}

void neph_rt_scene_cache_destroy(const struct neph_vulkan *vulkan, struct neph_rt_scene_cache *kept)
{
    for (int ring = 0; ring < NEPH_RT_CACHE_RINGS; ring++)
        for (int i = 0; i < kept->rings[ring].place_count; i++)
            for (int t = 0; t < NEPH_RT_CACHE_TARGETS_MAX; t++)
                neph_buffer_destroy(vulkan, &kept->rings[ring].places[i].targets[t]);
    *kept = (struct neph_rt_scene_cache){.rings = {{.place_count = 0}}};
}
