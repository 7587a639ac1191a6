/* SPDX-License-Identifier: MIT
 *
 * The contents of the window: a frame, enlarged by a whole factor, with text over it. 8-bit sRGB.
 */
#ifndef NEPH_HARNESS_FLY_CANVAS_H
#define NEPH_HARNESS_FLY_CANVAS_H

#include "base/status.h"

#include <stdint.h>

struct neph_canvas {
    int width_px, height_px;
    int zoom;     /* canvas pixels per frame pixel, in each direction */
    uint8_t *rgb; /* row 0 on top; owned */
};

/* Create a canvas for frames of this size; it is at least 640 pixels wide. Free with
 * neph_canvas_finish(). */
enum neph_status neph_canvas_init(struct neph_canvas *canvas, int width_px, int height_px,
                                  struct neph_diag *diag);
void neph_canvas_finish(struct neph_canvas *canvas);

/* Show a frame of the size above, width_px * height_px * 3 bytes. */
void neph_canvas_show(struct neph_canvas *canvas, const uint8_t *rgb);

/* Draw a vertical line; share 0 is the left side, 1 the right side. */
void neph_canvas_split(struct neph_canvas *canvas, double share);

/* Height of a text line and width of a letter, in pixels. */
int neph_canvas_line_px(const struct neph_canvas *canvas);
int neph_canvas_column_px(const struct neph_canvas *canvas);

/* Draw text on a darkened background. Line 0 is the top line; negative lines count from the bottom.
 * Text that is too wide is cut. */
void neph_canvas_text(struct neph_canvas *canvas, int line, const uint8_t rgb[3], const char *text);

enum { NEPH_GLYPH_WIDTH = 5, NEPH_GLYPH_HEIGHT = 7 };

/* The rows of a glyph from the top; bit 4 is the left dot. A box stands for unsupported
 * characters. */
const uint8_t *neph_font_glyph(char letter);

#endif
