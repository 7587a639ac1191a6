/* SPDX-License-Identifier: MIT
 *
 * What is shown of a frame: the picture, beside the march, or a map over it.
 */
#ifndef NEPH_HARNESS_FLY_VIEW_H
#define NEPH_HARNESS_FLY_VIEW_H

#include "harness/fly/encode.h"
#include "harness/fly/heat.h"
#include "harness/fly/studio.h"

enum neph_view_kind {
    NEPH_VIEW_PICTURE,
    NEPH_VIEW_WIPE,    /* the picture left of a line, the march right of it */
    NEPH_VIEW_ERROR,   /* of the picture against the march */
    NEPH_VIEW_FLICKER, /* of the last frames before a camera at rest */
    NEPH_VIEW_KIND_COUNT,
};

/* The ends of the colours of an error, as a share of what is white. */
#define NEPH_VIEW_ERROR_SCALE 0.1

struct neph_view {
    int width_px, height_px;
    struct neph_encoder *encoder;      /* owned */
    struct neph_heat_flicker *flicker; /* owned */
    enum neph_view_kind kind;
    double exposure_ev, split_share;
    uint8_t *rgb;                /* what is shown, row 0 on top; owned */
    uint8_t *march_rgb, *a4_rgb; /* owned */

    /* What the last drawing has of these. */
    int rays_per_px; /* of the march; 0: there was none */
    struct neph_relative_error error;
    struct neph_heat_a4 a4; /* frame_count 0: too few frames yet */
    int frames_since_a4;
};

/* Free with _finish. */
enum neph_status neph_view_init(struct neph_view *view, int width_px, int height_px,
                                struct neph_diag *diag);
void neph_view_finish(struct neph_view *view);

/* Another kind, another exposure, another engine: what was gathered for a map is void. */
void neph_view_forget(struct neph_view *view);

/* Draw the studio's last picture into view->rgb. `rests`: the camera stands as in the picture
 * before. Errors as of neph_studio_reference(), neph_encoder_run() and the maps. */
enum neph_status neph_view_draw(struct neph_view *view, struct neph_studio *studio,
                                const struct neph_image *image, bool rests, struct neph_diag *diag);

#endif
