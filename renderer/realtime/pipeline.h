/* SPDX-License-Identifier: MIT
 *
 * The real-time renderer: frames in sequence, each made from a sixteenth of its rays and what the
 * frames before have left (table 1A of the frame split, then temporal anti-aliasing).
 *
 * Source: "The Weather of Red Dead Redemption 2" (F. Bauer, SIGGRAPH 2019) as written down for
 * Unreal Engine 4.24; docs/settings.md has every choice and presets.c what other engines chose.
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

/* All borrowed, and only during _create. */
struct neph_realtime_params {
    int width_px, height_px;              /* 1..NEPH_MARCH_SIDE_MAX_PX */
    const struct neph_settings *settings; /* of neph_rt_options */
    uint32_t seed;                        /* of the dithers */
    const char *blue_noise_path;          /* where a dither needs it: neph_blue_noise_load() */
};

/* One picture of a sequence. */
struct neph_realtime_frame {
    const struct neph_scene *scene; /* over time, not of one frame */
    int frame;                      /* of the scene's pictures */
    /* A frame from elsewhere in place of the scene's own solids, or NULL: Z and, where it has them,
     * R G B of what is behind all media; of the sequence's size. */
    const struct neph_image *given;
};

/* What a picture has cost. Counts are exact, made by the shaders. */
struct neph_realtime_stats {
    double pass_gpu_s[NEPH_RT_PASSES_MAX]; /* of neph_rt_passes; NaN: no clock; 0: not run */
    double light_gpu_s;                    /* of traced or diffused light before them, or 0 */
    struct neph_sky_times sky;             /* of the tables of the sky before them */
    double shadow_gpu_s;                   /* of the shadow map of clouds before them, or 0 */
    double gpu_s;                          /* of all of it */
    double wall_s;
    uint64_t density_evaluations; /* as in struct neph_march_stats */
    uint64_t closed_forms;
    uint64_t rays; /* view rays marched through media */
    uint64_t view_steps;
    uint64_t injected_values; /* that the scene's injections put into it (scenes/injection.h) */
    /* Memory of targets in the formats of the settings. Traffic: what the passes read and write,
     * each texel of a target once per pass. */
    uint64_t history_bytes, target_bytes, traffic_bytes;
    uint64_t pass_traffic_bytes[NEPH_RT_PASSES_MAX];
};

/* False, with the reason in words, when the scene asks for what these settings leave out. */
bool neph_realtime_can_render(const struct neph_scene *scene, const struct neph_settings *settings,
                              char *reason, size_t reason_size);

/* A renderer without history. The scene's grids and textures go to the device here; every frame
 * must be of this scene. NEPH_ERR_USAGE, NEPH_ERR_UNSUPPORTED as of neph_march_create(); errors of
 * neph_blue_noise_load(). */
enum neph_status neph_realtime_create(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                      const struct neph_realtime_params *params,
                                      struct neph_realtime **realtime, struct neph_diag *diag);
void neph_realtime_destroy(struct neph_realtime *realtime);

/* The next picture, with what the scene injects into it: R G B, volume.*, transmittance.*, Z and
 * volume.distance as in base/image.h.
 * Same pictures in the same order on the same device: same bits. `stats` may be NULL.
 * NEPH_ERR_INPUT: the given frame has another size, no Z, a depth that is not above 0, or radiance
 * that is not finite or below 0.
 * NEPH_ERR_INTERRUPTED as of neph_march_frame(); the sequence is of no more use then.
 *
 * `image` NULL: the picture is on its way when this returns, nothing comes back of it, nothing is
 * counted, `stats` is left alone; its successors are what they would have been. Up to
 * NEPH_IN_FLIGHT_FRAMES of them are in flight. NEPH_ERR_UNSUPPORTED then: split=none with a pass
 * behind the march. */
enum neph_status neph_realtime_render(struct neph_realtime *realtime,
                                      const struct neph_realtime_frame *frame,
                                      struct neph_image **image, struct neph_realtime_stats *stats,
                                      struct neph_diag *diag);

/* What the oldest picture in flight has cost, waited for: device times, bytes, and as `wall_s` the
 * CPU's part; no counts. One whose turn is over, or that had a picture with an image after it, is
 * forgotten. NEPH_ERR_USAGE: none is in flight. */
enum neph_status neph_realtime_home(struct neph_realtime *realtime,
                                    struct neph_realtime_stats *stats, struct neph_diag *diag);

/* How many values of the last picture, in all images that its passes have made, are not finite or
 * negative: counted on the device, after waiting for it. Rays that were injected do not count,
 * nor what is overwritten bit by bit once a history was: what is made of them does.
 * NEPH_ERR_UNSUPPORTED: there are none, of a march of every pixel. */
enum neph_status neph_realtime_watch(struct neph_realtime *realtime, uint64_t *bad,
                                     struct neph_diag *diag);

/* Another size: the history is void, the count of frames goes on. */
enum neph_status neph_realtime_resize(struct neph_realtime *realtime,
                                      const struct neph_scene *scene, int width_px, int height_px,
                                      struct neph_diag *diag);

/* For tests: called with `context` after each pass of a picture; may read and change targets. */
typedef void neph_realtime_observer(struct neph_rt_device *device, const struct neph_rt_pass *pass,
                                    void *context);
void neph_realtime_observe(struct neph_realtime *realtime, neph_realtime_observer *observer,
                           void *context);

/* From the next frame on run the readable shader of each pass in place of its variant for the
 * device, to compare their times, or the variants again. */
void neph_realtime_leave_variants(struct neph_realtime *realtime, bool leaves);

/* For tests: paths that the pipeline takes by itself, with the same bits, taken or left. */
struct neph_realtime_test_hooks {
    bool always_asks_gradient; /* also where it is known that it sees no change (RT_STEADY) */
};
void neph_realtime_set_test_hooks(struct neph_realtime *realtime,
                                  struct neph_realtime_test_hooks hooks);

#endif
