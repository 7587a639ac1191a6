/* SPDX-License-Identifier: MIT
 *
 * Frames through a display chain: its settings at the camera's position, and the written files.
 */
#ifndef NEPH_HARNESS_RUN_SHOWING_H
#define NEPH_HARNESS_RUN_SHOWING_H

#include "renderer/post/chain.h"
#include "renderer/post/plan.h"
#include "scenes/scene.h"

/* Initialise with zeros; end with neph_display_chain_finish(). */
struct neph_display_chain {
    struct neph_post_plan plan;     /* of a chain file; empty without one */
    struct neph_settings settings;  /* before the plan's volumes are applied */
    const struct neph_scene *scene; /* borrowed; its camera selects the volumes; NULL: none */
    struct neph_post_params params; /* of the current frame */
    struct neph_exposure_state eye; /* exposure state of the sequence */
    int bits;                       /* per channel of a PNG; 0 or less: by the encoding */
};

/* Loads order, settings and volumes from a chain file. Errors as of neph_post_plan_load(). */
enum neph_status neph_display_chain_load(struct neph_display_chain *showing, const char *path,
                                         struct neph_diag *diag);

/* Checks the settings, with all passes off that the order does not list. NEPH_ERR_USAGE. */
enum neph_status neph_display_chain_check(struct neph_display_chain *showing,
                                          struct neph_diag *diag);

/* Checks that all frames of a sequence have one window size. NEPH_ERR_USAGE: a volume changes it;
 * the message names the volume. */
enum neph_status neph_display_chain_check_size(const struct neph_display_chain *showing,
                                               struct neph_diag *diag);

/* Sets params.settings for a frame, with the volumes around the camera. Errors as of
 * neph_display_chain_check(). */
enum neph_status neph_display_chain_set_frame(struct neph_display_chain *showing, int frame,
                                              struct neph_diag *diag);

/* Writes an output image of the chain: an EXR with the light that the display emits for it, and its
 * code values as a PNG unless `png` is NULL. `picture` is converted to that light in place. */
enum neph_status neph_display_chain_write(const struct neph_display_chain *showing,
                                          struct neph_image *picture, const char *exr,
                                          const char *png, struct neph_diag *diag);

void neph_display_chain_finish(struct neph_display_chain *showing);

#endif
