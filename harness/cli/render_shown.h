/* SPDX-License-Identifier: MIT
 *
 * The display images that `neph render` writes beside its frames, made by a post-processing chain.
 */
#ifndef NEPH_HARNESS_CLI_RENDER_SHOWN_H
#define NEPH_HARNESS_CLI_RENDER_SHOWN_H

#include "base/path.h"
#include "harness/json.h"
#include "harness/run/showing.h"

struct neph_open_device;
struct neph_shot;

/* Initialise with zeros; end with neph_shown_close(). */
struct neph_shown {
    bool is_on;
    struct neph_path folder;
    struct neph_display_chain showing;
    struct neph_open_device *device;
};

/* Load the chain of the shot's scene, or the chain in file `chain` ("off": none). Its images go to
 * `output`/shown. The camera is borrowed from the scene, which must live longer. NEPH_ERR_USAGE:
 * the chain is off, or has no size of its own. Other errors as of loading a chain. */
enum neph_status neph_shown_open(struct neph_shown *shown, const char *chain,
                                 const struct neph_shot *shot, const char *output,
                                 struct neph_diag *diag);

/* Convert the requested size to the size of the rendered frame. */
void neph_shown_frame_size(const struct neph_shown *shown, int *width_px, int *height_px);

/* Make the display image of a frame for a window of this size: shown/NAME.exr and .png for
 * FOLDER/NAME.exr. `*path` is the EXR file, "" with the chain off. `*stats` are those of frame and
 * chain; the caller decrefs them. */
enum neph_status neph_shown_make(struct neph_shown *shown, const struct neph_image *frame,
                                 const char *name, int number, int width_px, int height_px,
                                 uint64_t seed, struct neph_path *path, json_t **stats,
                                 struct neph_diag *diag);

void neph_shown_close(struct neph_shown *shown);

#endif
