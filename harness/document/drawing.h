/* SPDX-License-Identifier: MIT
 *
 * A frame as people see it, or its difference from a reference, as a PNG file.
 */
#ifndef NEPH_HARNESS_DOCUMENT_DRAWING_H
#define NEPH_HARNESS_DOCUMENT_DRAWING_H

#include "base/status.h"

/* Planes are only read; neph_image_rgb() fills them. */
struct neph_drawing {
    float *rgb[3], *reference[3]; /* reference NULL: the frame itself */
    int width_px, height_px;
    double exposure_ev; /* of a frame */
    double scale;       /* of a difference: where its colours end */
};

/* Write FOLDER/NAME. Errors as of neph_display_encode(), neph_display_difference() and
 * neph_png_write_rgb8(). */
enum neph_status neph_drawing_write(const struct neph_drawing *drawing, const char *folder,
                                    const char *name, struct neph_diag *diag);

#endif
