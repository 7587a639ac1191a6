/* SPDX-License-Identifier: MIT
 *
 * Compatibility of frames by the metadata of their files: data window, pixel aspect ratio, colour
 * space, luminance of white, channels.
 */
#ifndef NEPH_HARNESS_COMPARE_FRAME_LABELS_H
#define NEPH_HARNESS_COMPARE_FRAME_LABELS_H

#include "base/arena.h"
#include "base/image.h"

enum { NEPH_FRAME_LABELS = 5 };

/* Check that a frame can be compared with the reference pixel by pixel; always true for `other`
 * NULL. NEPH_ERR_INPUT, with a remedy: different data window, pixel shape, colour space or
 * white. */
enum neph_status neph_frame_check_pair(const struct neph_image *reference,
                                       const struct neph_image *other, struct neph_diag *diag);

/* The properties that all frames of a sequence share with the first one. Start from {0}. */
struct neph_frame_form {
    struct neph_arena arena; /* for the texts below */
    const char *path;        /* of the first frame; NULL: none yet */
    int width_px, height_px;
    const char *labels[NEPH_FRAME_LABELS];
    const char *channels; /* names of the known channels except masks; NULL: not recorded */
};

/* The first call records the properties of a frame; later calls compare frames with them.
 * `with_channels`: the known channels, except masks, must be equal, too. NEPH_ERR_INPUT names both
 * files and a remedy. */
enum neph_status neph_frame_form_check(struct neph_frame_form *form, const char *path,
                                       const struct neph_image *image, bool with_channels,
                                       struct neph_diag *diag);

/* A zeroed form is allowed. */
void neph_frame_form_finish(struct neph_frame_form *form);

#endif
