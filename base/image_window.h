/* SPDX-License-Identifier: MIT
 *
 * The data window of an image: the rectangle of the display window that has samples.
 */
#ifndef NEPH_BASE_IMAGE_WINDOW_H
#define NEPH_BASE_IMAGE_WINDOW_H

#include "base/image.h"

/* Positions are counted from the upper left corner of the display window [px]. */
struct neph_window {
    int64_t min_px[2], size_px[2]; /* corner and size of the data window; size 0: none */
    int64_t display_px[2];         /* size of the display window */
};

/* The windows of an image by its header; without one both are the image. */
struct neph_window neph_image_window(const struct neph_image *image);

bool neph_window_is_equal(const struct neph_window *a, const struct neph_window *b);

/* Say that the samples of an image are those of this window, which has the size of the image: in
 * its header, and in the attribute "crop" (base/exr.h) if the window is not the display window. */
enum neph_status neph_image_set_window(struct neph_image *image, const struct neph_window *window,
                                       struct neph_diag *diag);

/* Give an image another data window: samples outside it are removed, and pixels that the image does
 * not have get the value `outside` of their channel's name. The attribute "crop" (base/exr.h) is
 * updated. NEPH_ERR_INPUT: the image has a display window of another size. NEPH_ERR_MEMORY, also
 * before anything is allocated: the image would need more memory than the machine has. After an
 * error the image can only be destroyed. */
enum neph_status neph_image_place(struct neph_image *image, const struct neph_window *window,
                                  float (*outside)(const char *channel), struct neph_diag *diag);

#endif
