/* SPDX-License-Identifier: MIT
 *
 * The renderers of a flight: realtime or march, whichever is looked at, and the march that it is
 * held against. Engines are driven as by `neph render`; what is special is a scene whose camera is
 * set from outside, anew in every frame.
 */
#ifndef NEPH_HARNESS_FLY_STUDIO_H
#define NEPH_HARNESS_FLY_STUDIO_H

#include "harness/run/job.h"

/* All borrowed, and as long as the studio lives. */
struct neph_studio_params {
    const struct neph_scene *scene;
    int width_px, height_px;
    const char *const *settings; /* "key=value" of engine realtime, after any preset */
    int setting_count;
    uint64_t seed;
    struct neph_shared_device *device; /* as neph_shot.device */
};

struct neph_studio;

/* Free with _close. The preset is one of engine realtime, NULL: its defaults. Sequences begin
 * without pictures before the first, so that one sees how a history builds up; "warm_up=" among the
 * settings is stronger. NEPH_ERR_USAGE, NEPH_ERR_UNSUPPORTED, NEPH_ERR_UNAVAILABLE, NEPH_ERR_ENGINE
 * as of neph_job_open(). */
enum neph_status neph_studio_open(const struct neph_studio_params *params, const char *preset,
                                  struct neph_studio **studio, struct neph_diag *diag);
void neph_studio_close(struct neph_studio *studio);

/* Another preset from now on, without history; on failure all is as before. */
enum neph_status neph_studio_choose_preset(struct neph_studio *studio, const char *preset,
                                           struct neph_diag *diag);

/* The march of the same model, one ray a pixel, in place of realtime; or realtime again. Likewise.
 */
enum neph_status neph_studio_choose_march(struct neph_studio *studio, bool is_march,
                                          struct neph_diag *diag);

/* "realtime ours", "march". */
const char *neph_studio_name(const struct neph_studio *studio);

/* The job that is looked at, of the last frame; for its settings and its device. */
const struct neph_job *neph_studio_job(const struct neph_studio *studio);

/* The next picture, with this camera at this frame of the scene's sun and wind.
 * NEPH_ERR_INTERRUPTED and what neph_job_render() has else; values are not checked. */
enum neph_status neph_studio_render(struct neph_studio *studio,
                                    const struct neph_camera_key *camera, int frame,
                                    struct neph_image **image, struct neph_cost *cost,
                                    struct neph_diag *diag);

/* What the last picture ought to be, by the march of the same model: one ray a pixel while
 * something moves, 16 once a few frames were the same. `*image` is the studio's, until the next
 * call. */
enum neph_status neph_studio_reference(struct neph_studio *studio, const struct neph_image **image,
                                       int *rays_per_px, struct neph_diag *diag);

#endif
