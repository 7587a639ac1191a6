/* SPDX-License-Identifier: MIT
 *
 * Masks: the pixels that a number is computed over. A mean over the whole image hides errors at
 * edges, so every number names its mask. Masks depend only on the reference frame, never on the
 * tested image.
 */
#ifndef NEPH_METRICS_MASK_H
#define NEPH_METRICS_MASK_H

#include "base/image.h"

#include <stdint.h>

struct neph_mask_kind {
    const char *name;
    const char *needs; /* required channel; NULL: none */
    const char *help;
    bool is_detail; /* one of a family of detailed masks, computed on request */
};

/* The kinds, in the order of reports:
 *   all         every pixel
 *   sky         Z = +inf
 *   solid       Z finite
 *   medium      optical depth above `medium_optical_depth` in at least one colour channel
 *   depth_edge  both sides of every step in depth, dilated
 *   non_edge    the pixels that are not in depth_edge
 *   thin        objects up to 3 px wide: each square of 4x4 px of the image with this pixel also
 *               contains one that is more than `edge_depth_ratio` times as far
 *   edge_SIDE_RING  SIDE near (foreground) or far (background), RING a chessboard distance to the
 *               nearest pixel at a step: 0, 1, 2, 3_4 or 5_8 px. A pixel is on the side of that
 *               pixel; if one of each side is equally close, on the near side. A pixel at steps of
 *               both kinds belongs to its steepest one (see depth_edge.h).
 * NULL outside 0..count-1. */
int neph_mask_kind_count(void);
const struct neph_mask_kind *neph_mask_kind_at(int index);
const struct neph_mask_kind *neph_mask_kind_find(const char *name);

/* A frame may contain more masks: each channel "mask.NAME" makes a mask NAME of the pixels above
 * 0.5. Returns the NAME of the `index`-th such channel, valid as long as the image; NULL beyond the
 * last. */
const char *neph_mask_channel_at(const struct neph_image *image, int index);

struct neph_mask_options {
    double medium_optical_depth; /* -log(transmittance) above which a pixel counts as medium [1] */
    double edge_depth_ratio;     /* farther / nearer depth of 4-neighbours above which there is an
                                  * edge */
    int edge_radius_px;          /* an edge pixel marks a square with the side 2 r + 1 */
};

#define NEPH_MASK_DEFAULTS                                                                         \
    ((struct neph_mask_options){                                                                   \
        .medium_optical_depth = 1e-3, .edge_depth_ratio = 1.1, .edge_radius_px = 2})

struct neph_mask {
    char name[NEPH_IMAGE_NAME_MAX];
    int width_px, height_px;
    size_t pixel_count; /* number of pixels; an empty mask is valid, but no number is defined over
                         * it */
    uint8_t *inside;    /* width * height of 0 or 1, row-major; owned */
};

/* Create the mask `name` of a reference frame; NULL options: NEPH_MASK_DEFAULTS. A channel
 * "mask.NAME" overrides a kind of that name. A depth edge is a pair of 4-neighbours with a ratio of
 * linear depths above the limit; both pixels are marked. The sky is infinitely far: its border to
 * any solid is an edge, two sky pixels are none. The marks are then dilated by a square, clipped at
 * the image border. Errors: NEPH_ERR_USAGE: unknown name; NEPH_ERR_UNSUPPORTED: the frame lacks the
 * channel; NEPH_ERR_GATE: the channel has NaN, -inf or a negative depth; NEPH_ERR_INPUT: an option
 * is out of range. */
enum neph_status neph_mask_create(const struct neph_image *reference, const char *name,
                                  const struct neph_mask_options *options, struct neph_mask **mask,
                                  struct neph_diag *diag);

/* Create a mask from an image: the pixels with any channel above 0.5 (linear; an 8-bit sRGB code of
 * 188 or more). A channel "A" counts only if it is the only one: most files have opacity 1
 * everywhere. A name that is too long is cut. NEPH_ERR_INPUT: no channel; NEPH_ERR_GATE: a NaN. */
enum neph_status neph_mask_from_image(const struct neph_image *image, const char *name,
                                      struct neph_mask **mask, struct neph_diag *diag);

/* Add the pixels of `other` to `mask`: with a moving camera, the mask is the union over the frames.
 * For non_edge it is the intersection, so that it stays the complement of depth_edge.
 * NEPH_ERR_INPUT: sizes differ. */
enum neph_status neph_mask_unite(struct neph_mask *mask, const struct neph_mask *other,
                                 struct neph_diag *diag);

/* `mask` may be NULL. */
void neph_mask_destroy(struct neph_mask *mask);

#endif
