/* SPDX-License-Identifier: MIT
 *
 * Whether frames belong together by what their files say of them: place in the picture, shape of
 * the pixels, colour space, luminance of white, channels.
 */
#ifndef NEPH_HARNESS_COMPARE_FRAME_LABELS_H
#define NEPH_HARNESS_COMPARE_FRAME_LABELS_H

#include "base/arena.h"
#include "base/image.h"

enum { NEPH_FRAME_LABELS = 5 };

/* Whether a frame can be compared with the reference pixel by pixel; an `other` NULL can.
 * NEPH_ERR_INPUT, with the way out: of another place, of pixels of another shape, or colours of
 * another space or white. */
enum neph_status neph_frame_check_pair(const struct neph_image *reference,
                                       const struct neph_image *other, struct neph_diag *diag);

/* What all frames of a sequence have in common with its first. Start from {0}. */
struct neph_frame_form {
    struct neph_arena arena; /* of the texts below */
    const char *path;        /* of the first; NULL: there was none yet */
    int width_px, height_px;
    const char *labels[NEPH_FRAME_LABELS];
    const char
        *channels; /* names of those that mean something here, masks aside; NULL: none are held */
};

/* The first call keeps what a frame is, the others compare with that. `with_channels`: channels
 * that mean something here, masks aside, may not change, either. NEPH_ERR_INPUT names both files
 * and the way out. */
enum neph_status neph_frame_form_check(struct neph_frame_form *form, const char *path,
                                       const struct neph_image *image, bool with_channels,
                                       struct neph_diag *diag);

/* A zeroed form is fine. */
void neph_frame_form_finish(struct neph_frame_form *form);

#endif
