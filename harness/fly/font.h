/* SPDX-License-Identifier: MIT
 *
 * Letters of 5 x 7 dots, for text over pictures. Small letters are shown as large ones.
 */
#ifndef NEPH_HARNESS_FLY_FONT_H
#define NEPH_HARNESS_FLY_FONT_H

#include <stdint.h>

enum { NEPH_GLYPH_WIDTH = 5, NEPH_GLYPH_HEIGHT = 7 };

/* The rows of a letter from the top; bit 4 is the left dot. What there is no letter for is a box.
 */
const uint8_t *neph_font_glyph(char letter);

#endif
