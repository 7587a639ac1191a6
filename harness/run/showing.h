/* SPDX-License-Identifier: MIT
 *
 * Frames through a picture chain to a display: its settings where the camera is, and the files that
 * hold what the display makes of a picture.
 */
#ifndef NEPH_HARNESS_RUN_SHOWING_H
#define NEPH_HARNESS_RUN_SHOWING_H

#include "renderer/post/chain.h"
#include "renderer/post/plan.h"
#include "scenes/scene.h"

/* Zero-initialise it; for _finish. */
struct neph_showing {
    struct neph_post_plan plan;     /* of a file; empty without */
    struct neph_settings settings;  /* before the plan's volumes */
    const struct neph_scene *scene; /* borrowed: whose camera is in the volumes; NULL: none */
    struct neph_post_params params; /* of the picture at hand */
    struct neph_post_eye eye;       /* of the sequence */
    int bits;                       /* of a channel of a PNG; 0 or less: by the encoding */
};

/* Order, settings and volumes from a file. Errors as of neph_post_plan_load(). */
enum neph_status neph_showing_load(struct neph_showing *showing, const char *path,
                                   struct neph_diag *diag);

/* Whether the settings make sense, those that the order leaves out being off. NEPH_ERR_USAGE. */
enum neph_status neph_showing_check(struct neph_showing *showing, struct neph_diag *diag);

/* Whether all pictures of a sequence can have the size of one window: NEPH_ERR_USAGE names the
 * volume that sets it otherwise. */
enum neph_status neph_showing_check_size(const struct neph_showing *showing,
                                         struct neph_diag *diag);

/* What is set where the camera is in a frame. Errors as of _check. */
enum neph_status neph_showing_settle(struct neph_showing *showing, int frame,
                                     struct neph_diag *diag);

/* A picture of the chain, as it was settled: an EXR of the light that the display makes of it, and
 * unless `png` is NULL its codes. The picture holds that light then. */
enum neph_status neph_showing_write(const struct neph_showing *showing, struct neph_image *picture,
                                    const char *exr, const char *png, struct neph_diag *diag);

void neph_showing_finish(struct neph_showing *showing);

#endif
