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
};

/* The kinds, in the order of reports:
 *   all         every pixel
 *   sky         Z = +inf
 *   solid       Z finite
 *   medium      optical depth above `medium_optical_depth` in at least one colour channel
 *   depth_edge  both sides of every step in depth, dilated
 * NULL outside 0..count-1. */
int neph_mask_kind_count(void);
const struct neph_mask_kind *neph_mask_kind_at(int index);
const struct neph_mask_kind *neph_mask_kind_find(const char *name);

struct neph_mask_options {
    double medium_optical_depth; /* -log(transmittance) above which there is a medium [1] */
    double edge_depth_ratio;     /* farther / nearer of 4-neighbours above which it is an edge */
    int edge_radius_px;          /* the square around an edge pixel has the side 2 r + 1 */
};

#define NEPH_MASK_DEFAULTS                                                                         \
    ((struct neph_mask_options){                                                                   \
        .medium_optical_depth = 1e-3, .edge_depth_ratio = 1.1, .edge_radius_px = 2})

struct neph_mask {
    const char *name; /* static */
    int width_px, height_px;
    size_t pixel_count; /* inside; 0 is a valid mask, over which nothing is defined */
    uint8_t *inside;    /* width * height of 0 or 1, row-major; owned */
};

/* Make the mask `name` of a reference frame; NULL options: NEPH_MASK_DEFAULTS.
 * A depth edge is a pair of 4-neighbours whose linear depths have a ratio above the limit. Both
 * pixels are marked. The sky lies infinitely far: its border to any solid is an edge, sky to sky
 * is none. The marks are then dilated by a square, clipped at the border of the image.
 * Errors: NEPH_ERR_USAGE for an unknown name, NEPH_ERR_UNSUPPORTED when the frame lacks the
 * channel, NEPH_ERR_GATE when that channel holds NaN, -inf or a negative depth. */
enum neph_status neph_mask_create(const struct neph_image *reference, const char *name,
                                  const struct neph_mask_options *options, struct neph_mask **mask,
                                  struct neph_diag *diag);

/* NULL is fine. */
void neph_mask_destroy(struct neph_mask *mask);

#endif
