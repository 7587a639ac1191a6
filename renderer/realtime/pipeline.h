/* SPDX-License-Identifier: MIT
 *
 * The real-time renderer. Each frame marches one ray per 4x4 pixels and reconstructs the others
 * from the history of earlier frames (table 1A of the frame split, then temporal anti-aliasing).
 *
 * Source: "The Weather of Red Dead Redemption 2" (F. Bauer, SIGGRAPH 2019) as written down for
 * Unreal Engine 4.24. docs/settings.md lists all settings, presets.c the choices of other engines.
 */
#ifndef NEPH_RENDERER_REALTIME_PIPELINE_H
#define NEPH_RENDERER_REALTIME_PIPELINE_H

#include "base/image.h"
#include "base/option.h"
#include "renderer/realtime/device.h"
#include "renderer/sky/sky_times.h"
#include "renderer/vulkan.h"
#include "scenes/scene.h"

struct neph_realtime;

/* All pointers are borrowed during _create only. */
struct neph_realtime_params {
    int width_px, height_px;              /* 1..NEPH_MARCH_SIDE_MAX_PX */
    const struct neph_settings *settings; /* values of neph_rt_options */
    uint32_t seed;                        /* seed of the dithers */
    const char *blue_noise_path;          /* needed by blue dithers: neph_blue_noise_load() */
};

/* One frame of a sequence. */
struct neph_realtime_frame {
    const struct neph_scene *scene; /* with its motion over time */
    int frame;                      /* frame of the scene */
    /* An external frame in place of the scene's own solids, or NULL: Z and, where it has them, R G
     * B of the radiance behind all media; in the size of the sequence. */
    const struct neph_image *given;
};
/* Cost of a frame. Counts are exact: the shaders count. */
struct neph_realtime_stats {
    double pass_gpu_s[NEPH_RT_PASSES_MAX]; /* of neph_rt_passes; NaN: no clock; 0: not run */
    double light_gpu_s;                    /* traced or diffused light, before the passes, or 0 */
    double places_gpu_s;                   /* places of meshes that move, before the passes, or 0 */
    struct neph_sky_times sky;             /* tables of the sky, before the passes */
    double shadow_gpu_s;                   /* shadow map of clouds, before the passes, or 0 */
    double gpu_s;                          /* sum of all device times */
    double wall_s;
    uint64_t density_evaluations; /* as in struct neph_march_stats */
    uint64_t closed_forms;
    uint64_t rays; /* view rays marched through media */
    uint64_t view_steps;
    uint64_t injected_values; /* values that the scene's injections wrote (scenes/injection.h) */
    /* Memory of the targets in the formats of the settings. Traffic: bytes that the passes read and
     * write, each texel of a target once per pass. */
    uint64_t history_bytes, target_bytes, traffic_bytes;
    uint64_t pass_traffic_bytes[NEPH_RT_PASSES_MAX];
};

/* False, with the reason in words, when the scene needs a feature that these settings lack. */
bool neph_realtime_can_render(const struct neph_scene *scene, const struct neph_settings *settings,
                              char *reason, size_t reason_size);

/* Creates a renderer without history and uploads the scene's grids and textures; every frame must
 * be of this scene. Errors: NEPH_ERR_USAGE and NEPH_ERR_UNSUPPORTED as for neph_march_create();
 * those of neph_blue_noise_load(). */
enum neph_status neph_realtime_create(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                      const struct neph_realtime_params *params,
                                      struct neph_realtime **realtime, struct neph_diag *diag);
void neph_realtime_destroy(struct neph_realtime *realtime);

/* Renders the next frame, with the scene's injections: R G B, volume.*, transmittance.*, Z and
 * volume.distance as in base/image.h. The same frames in the same order on the same device give the
 * same bits. `stats` may be NULL.
 *
 * `image` NULL: the frame is in flight when the function returns. Nothing is read back or counted,
 * and `stats` is not written; later frames are the same as with an image. Up to
 * NEPH_IN_FLIGHT_FRAMES frames are in flight.
 *
 * Errors:
 * - NEPH_ERR_INPUT: the given frame has another size, no Z, a depth that is not above 0, or
 *   radiance that is not finite or is below 0.
 * - NEPH_ERR_INTERRUPTED as for neph_march_frame(); the sequence cannot be continued.
 * - NEPH_ERR_UNSUPPORTED with `image` NULL: split=none with a pass after the march. */
enum neph_status neph_realtime_render(struct neph_realtime *realtime,
                                      const struct neph_realtime_frame *frame,
                                      struct neph_image **image, struct neph_realtime_stats *stats,
                                      struct neph_diag *diag);

/* Waits for the oldest frame in flight and returns its cost: device times, bytes and, as `wall_s`,
 * the CPU time; no counts. A frame in flight is dropped from the list when its place is reused or
 * when a later frame was rendered with an image. NEPH_ERR_USAGE: no frame is in flight. */
enum neph_status neph_realtime_collect(struct neph_realtime *realtime,
                                       struct neph_realtime_stats *stats, struct neph_diag *diag);

/* Counts the values of the last frame, in all images that its passes wrote, that are not finite or
 * are negative. Waits for the frame and counts on the device. Injected rays are left out, and so
 * are kept samples after an injected history, which later frames overwrite; results that were
 * computed from them are counted. NEPH_ERR_UNSUPPORTED: split=none, which has no such images. */
enum neph_status neph_realtime_watch(struct neph_realtime *realtime, uint64_t *bad,
                                     struct neph_diag *diag);

/* Changes the size: the history becomes invalid, the count of frames continues. */
enum neph_status neph_realtime_resize(struct neph_realtime *realtime,
                                      const struct neph_scene *scene, int width_px, int height_px,
                                      struct neph_diag *diag);

/* For tests: called with `context` after each pass of a frame; may read and change targets. */
typedef void neph_realtime_observer(struct neph_rt_device *device, const struct neph_rt_pass *pass,
                                    void *context);
void neph_realtime_observe(struct neph_realtime *realtime, neph_realtime_observer *observer,
                           void *context);

/* Runs the readable shader of each pass in place of its variant from the next frame on, to compare
 * their times; false: the variants again. */
void neph_realtime_use_readable_shaders(struct neph_realtime *realtime, bool is_readable);

/* For tests: disable optimisations that do not change bits. */
struct neph_realtime_test_hooks {
    bool always_asks_gradient; /* also where it is known to find no change (RT_STEADY) */
};
void neph_realtime_set_test_hooks(struct neph_realtime *realtime,
                                  struct neph_realtime_test_hooks hooks);

#endif
