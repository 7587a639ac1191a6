/* SPDX-License-Identifier: MIT
 *
 * Where in the picture a number is taken. A mean over the whole image hides what happens at edges,
 * so every number names its mask. Masks come from the reference frame alone: the image under test
 * has no say in where it is looked at.
 */
#ifndef NEPH_METRICS_MASK_H
#define NEPH_METRICS_MASK_H

#include "base/image.h"

#include <stdint.h>

struct neph_mask_kind {
    const char *name;
    const char *needs; /* the channel that must be there; NULL: none */
    const char *help;
    bool is_detail; /* one of many of its kind, taken when it is asked for */
};

/* The kinds, in the order of reports:
 *   all         every pixel
 *   sky         Z = +inf
 *   solid       Z finite
 *   medium      optical depth above `medium_optical_depth` in at least one colour channel
 *   depth_edge  both sides of every step in depth, dilated
 *   non_edge    the pixels that are not in depth_edge
 *   thin        what is up to 3 px wide: each square of 4x4 px of the image that holds the pixel
 *               also holds one that lies more than `edge_depth_ratio` times as far
 *   edge_SIDE_RING  SIDE near (the foreground) or far (the background), RING a chessboard distance
 *               to the nearest pixel at a step: 0, 1, 2, 3_4 or 5_8 px. A pixel is on the side of
 *               that pixel; on the near side when one of each side is equally close. A pixel at
 *               steps of both kinds belongs to its steepest one (see depth_edge.h).
 * NULL outside 0..count-1. */
int neph_mask_kind_count(void);
const struct neph_mask_kind *neph_mask_kind_at(int index);
const struct neph_mask_kind *neph_mask_kind_find(const char *name);

/* Further masks come with a frame: each channel "mask.NAME" makes a mask NAME, inside where it is
 * above 0.5. The NAME of the index-th such channel, as long as the image lives; NULL when there
 * are not as many. */
const char *neph_mask_channel_at(const struct neph_image *image, int index);

struct neph_mask_options {
    double medium_optical_depth; /* -log(transmittance) above which there is a medium [1] */
    double edge_depth_ratio;     /* farther / nearer of 4-neighbours above which it is an edge */
    int edge_radius_px;          /* the square around an edge pixel has the side 2 r + 1 */
};

#define NEPH_MASK_DEFAULTS                                                                         \
    ((struct neph_mask_options){                                                                   \
        .medium_optical_depth = 1e-3, .edge_depth_ratio = 1.1, .edge_radius_px = 2})

struct neph_mask {
    char name[NEPH_IMAGE_NAME_MAX];
    int width_px, height_px;
    size_t pixel_count; /* inside; 0 is a valid mask, over which nothing is defined */
    uint8_t *inside;    /* width * height of 0 or 1, row-major; owned */
};

/* Make the mask `name` of a reference frame; NULL options: NEPH_MASK_DEFAULTS. A channel
 * "mask.NAME" comes before a kind of that name: the scene knows its wires better than we do.
 * A depth edge is a pair of 4-neighbours whose linear depths have a ratio above the limit. Both
 * pixels are marked. The sky lies infinitely far: its border to any solid is an edge, sky to sky
 * is none. The marks are then dilated by a square, clipped at the border of the image.
 * Errors: NEPH_ERR_USAGE for an unknown name, NEPH_ERR_UNSUPPORTED when the frame lacks the
 * channel, NEPH_ERR_GATE when that channel holds NaN, -inf or a negative depth, NEPH_ERR_INPUT for
 * an option out of range. */
enum neph_status neph_mask_create(const struct neph_image *reference, const char *name,
                                  const struct neph_mask_options *options, struct neph_mask **mask,
                                  struct neph_diag *diag);

/* Make a mask from a picture: inside where any channel is above 0.5 (linear; an 8-bit sRGB code of
 * 188 or more). A channel "A" counts only when there is no other: opacity is 1 everywhere in most
 * files. A name that is too long is cut. NEPH_ERR_INPUT: no channel, NEPH_ERR_GATE: a NaN. */
enum neph_status neph_mask_from_image(const struct neph_image *image, const char *name,
                                      struct neph_mask **mask, struct neph_diag *diag);

/* Add the pixels of `other` to `mask`: the mask of a moving camera is united over its frames.
 * In non_edge the common pixels stay instead, so that it is what depth_edge is not.
 * NEPH_ERR_INPUT: sizes differ. */
enum neph_status neph_mask_unite(struct neph_mask *mask, const struct neph_mask *other,
                                 struct neph_diag *diag);

/* NULL is fine. */
void neph_mask_destroy(struct neph_mask *mask);

#endif
