/* SPDX-License-Identifier: MIT
 *
 * Draws the view of a frame: the frame itself, split with the ray-marched reference, or as a map.
 */
#ifndef NEPH_HARNESS_FLY_VIEW_H
#define NEPH_HARNESS_FLY_VIEW_H

#include "harness/fly/encode.h"
#include "harness/fly/heat.h"
#include "harness/fly/studio.h"

enum neph_view_kind {
    NEPH_VIEW_PICTURE,
    NEPH_VIEW_WIPE,    /* the frame left of a line, the ray-marched reference right of it */
    NEPH_VIEW_ERROR,   /* error of the frame against the ray-marched reference */
    NEPH_VIEW_FLICKER, /* flicker of the last frames with a static camera */
    NEPH_VIEW_KIND_COUNT,
};

/* End of the error's colour scale, as a share of display white. */
#define NEPH_VIEW_ERROR_SCALE 0.1

struct neph_view {
    int width_px, height_px;
    struct neph_encoder *encoder;      /* owned */
    struct neph_heat_flicker *flicker; /* owned */
    enum neph_view_kind kind;
    double exposure_ev, split_share;
    uint8_t *rgb;                /* the view, row 0 on top; owned */
    uint8_t *march_rgb, *a4_rgb; /* owned */

    /* Results of the last drawing. */
    int rays_per_px; /* of the reference; 0: there was none */
    struct neph_relative_error error;
    struct neph_heat_a4 a4; /* frame_count 0: not enough frames yet */
    int frames_since_a4;
};

/* Free with neph_view_finish(). */
enum neph_status neph_view_init(struct neph_view *view, int width_px, int height_px,
                                struct neph_diag *diag);
void neph_view_finish(struct neph_view *view);

/* Forget the frames of a map, after a change of view, exposure or engine. */
void neph_view_forget(struct neph_view *view);

/* Draw the studio's last frame into view->rgb. `rests`: the camera is the same as in the frame
 * before. Errors as of neph_studio_reference(), neph_encoder_run() and the maps. */
enum neph_status neph_view_draw(struct neph_view *view, struct neph_studio *studio,
                                const struct neph_image *image, bool rests, struct neph_diag *diag);

#endif
