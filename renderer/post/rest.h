/* SPDX-License-Identifier: MIT
 *
 * What of a frame goes past the picture chain.
 */
#ifndef NEPH_RENDERER_POST_REST_H
#define NEPH_RENDERER_POST_REST_H

#include "base/image.h"

/* Attributes, the place in the picture that the frame is a part of, and in an image of the same
 * size depth, motion and masks, which metrics look at; in another they would be of other pixels.
 * NEPH_ERR_INPUT: as of neph_image_copy_labels(). */
enum neph_status neph_post_copy_rest(const struct neph_image *from, struct neph_image *to,
                                     struct neph_diag *diag);

#endif
