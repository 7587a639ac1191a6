/* SPDX-License-Identifier: MIT
 *
 * The parts of a frame that the post-processing chain does not process.
 */
#ifndef NEPH_RENDERER_POST_METADATA_H
#define NEPH_RENDERER_POST_METADATA_H

#include "base/image.h"

/* Copy the attributes, the data window and display window and, if the sizes are equal, the channels
 * of depth, motion and masks, which metrics need. NEPH_ERR_INPUT: as of neph_image_copy_labels().
 */
enum neph_status neph_post_copy_metadata(const struct neph_image *from, struct neph_image *to,
                                         struct neph_diag *diag);

#endif
