/* SPDX-License-Identifier: MIT
 *
 * Images for tests, and their files.
 */
#ifndef NEPH_TESTS_IMAGE_TEST_H
#define NEPH_TESTS_IMAGE_TEST_H

#include "tests/neph_test.h"

#include "base/exr.h"

/* An image with one value in R, G and B. */
static inline struct neph_image *grey_image(int width_px, int height_px, double value)
{
    struct neph_image *image = NULL;
    float *planes[3];
    neph_assert_ok(neph_image_create(width_px, height_px, &image, NULL), NULL);
    neph_assert_ok(neph_image_add_rgb(image, NULL, planes, NULL), NULL);
    for (size_t i = 0; i < 3 * neph_image_pixel_count(image); i++)
        planes[i % 3][i / 3] = (float)value;
    return image;
}

/* Sets one pixel in R, G and B. */
static inline void set_grey(struct neph_image *image, size_t pixel, double value)
{
    for (int c = 0; c < 3; c++)
        image->channels[c].samples[pixel] = (float)value;
}

/* Writes an image to a file and destroys it. */
static inline void write_image(const char *path, struct neph_image *image)
{
    struct neph_diag diag = {0};
    neph_assert_ok(neph_exr_write(path, image, &diag), &diag);
    neph_image_destroy(image);
}

#endif
