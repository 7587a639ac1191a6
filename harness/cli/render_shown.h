/* SPDX-License-Identifier: MIT
 *
 * What `neph render` leaves beside its frames: pictures for a display, by a picture chain.
 */
#ifndef NEPH_HARNESS_CLI_RENDER_SHOWN_H
#define NEPH_HARNESS_CLI_RENDER_SHOWN_H

#include "base/path.h"
#include "harness/json.h"
#include "harness/run/showing.h"

struct neph_open_device;
struct neph_shot;

/* Zero-initialise it; for _close. */
struct neph_shown {
    bool is_on;
    struct neph_path folder;
    struct neph_showing showing;
    struct neph_open_device *device;
};

/* The chain of the shot's scene, or of a file in its place ("off": none), whose pictures go to
 * `output`/shown; its camera is that of the scene, which has to outlive it. NEPH_ERR_USAGE: the
 * chain is off, or has no size of its own. Errors as of loading a chain. */
enum neph_status neph_shown_open(struct neph_shown *shown, const char *chain,
                                 const struct neph_shot *shot, const char *output,
                                 struct neph_diag *diag);

/* From the size that is asked for to that which is rendered. */
void neph_shown_frame_size(const struct neph_shown *shown, int *width_px, int *height_px);

/* A picture of a frame, for a window of this size: shown/NAME.exr and .png for FOLDER/NAME.exr.
 * `*path` is the first, and "" where the chain is off; `*stats` are those of frame and chain, for
 * the caller to decref. */
enum neph_status neph_shown_make(struct neph_shown *shown, const struct neph_image *frame,
                                 const char *name, int number, int width_px, int height_px,
                                 uint64_t seed, struct neph_path *path, json_t **stats,
                                 struct neph_diag *diag);

void neph_shown_close(struct neph_shown *shown);

#endif
