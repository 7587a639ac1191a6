/* SPDX-License-Identifier: MIT
 *
 * The renderers of `neph fly`: the live renderer (realtime or the ray marcher), and the ray marcher
 * as its reference. Engines are used as by `neph render`, but with a scene whose camera is set from
 * outside for every frame.
 */
#ifndef NEPH_HARNESS_FLY_STUDIO_H
#define NEPH_HARNESS_FLY_STUDIO_H

#include "harness/run/job.h"

/* All members are borrowed and must outlive the studio. */
struct neph_studio_params {
    const struct neph_scene *scene;
    int width_px, height_px;
    const char *const *settings; /* "key=value" of engine realtime, applied after a preset */
    int setting_count;
    uint64_t seed;
    struct neph_shared_device *device; /* as neph_shot.device */
};

struct neph_studio;

/* Open the studio with a preset of engine realtime (NULL: its defaults). Free with
 * neph_studio_close(). Sequences start without warm-up frames, to show how the history builds up; a
 * "warm_up=" in the settings overrides this. NEPH_ERR_USAGE, NEPH_ERR_UNSUPPORTED,
 * NEPH_ERR_UNAVAILABLE, NEPH_ERR_ENGINE as of neph_job_open(). */
enum neph_status neph_studio_open(const struct neph_studio_params *params, const char *preset,
                                  struct neph_studio **studio, struct neph_diag *diag);
void neph_studio_close(struct neph_studio *studio);

/* Change the preset and clear the history; after an error nothing has changed. */
enum neph_status neph_studio_choose_preset(struct neph_studio *studio, const char *preset,
                                           struct neph_diag *diag);

/* Switch between realtime and the ray marcher of the same model with one ray per pixel; otherwise
 * as above.
 */
enum neph_status neph_studio_choose_march(struct neph_studio *studio, bool is_march,
                                          struct neph_diag *diag);

/* The name of the live renderer: "realtime ours", "march". */
const char *neph_studio_name(const struct neph_studio *studio);

/* The live job after the last frame, for its settings and its device. */
const struct neph_job *neph_studio_job(const struct neph_studio *studio);

/* Render the next frame, with this camera at this frame of the scene's sun and wind.
 * NEPH_ERR_INTERRUPTED, and errors of neph_job_render(); pixel values are not checked. */
enum neph_status neph_studio_render(struct neph_studio *studio,
                                    const struct neph_camera_key *camera, int frame,
                                    struct neph_image **image, struct neph_cost *cost,
                                    struct neph_diag *diag);

/* The reference for the last frame, by the ray marcher of the same model: one ray per pixel during
 * motion, 16 after a few static frames. `*image` is owned by the studio and valid until the next
 * call. */
enum neph_status neph_studio_reference(struct neph_studio *studio, const struct neph_image **image,
                                       int *rays_per_px, struct neph_diag *diag);

#endif
