/* SPDX-License-Identifier: MIT
 *
 * What a display makes of the code values of the picture chain.
 */
#ifndef NEPH_RENDERER_POST_DISPLAY_H
#define NEPH_RENDERER_POST_DISPLAY_H

#include "base/image.h"
#include "renderer/post/options.h"

#include <stdint.h>

/* 8-bit codes of the channels R G B of a picture of the chain, row by row: `codes` holds 3 a pixel.
 * With encode=linear the display's curve is applied first. */
void neph_post_codes(const struct neph_settings *settings, const struct neph_image *picture,
                     uint8_t *codes);

/* R G B from code values to the linear light that an sRGB display makes of them (IEC
 * 61966-2-1:1999, 1 is its white), in double and rounded once; linear ones stay. */
void neph_post_show(const struct neph_settings *settings, struct neph_image *picture);

#endif
