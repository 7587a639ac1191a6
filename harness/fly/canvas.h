/* SPDX-License-Identifier: MIT
 *
 * What a window shows: a picture, its pixels made larger, with text over it. 8-bit sRGB.
 */
#ifndef NEPH_HARNESS_FLY_CANVAS_H
#define NEPH_HARNESS_FLY_CANVAS_H

#include "base/status.h"

#include <stdint.h>

struct neph_canvas {
    int width_px, height_px;
    int zoom;     /* pixels of the canvas along a side of one of the picture */
    uint8_t *rgb; /* row 0 on top; owned */
};

/* For pictures of this size: at least 640 pixels wide. Free with _finish. */
enum neph_status neph_canvas_init(struct neph_canvas *canvas, int width_px, int height_px,
                                  struct neph_diag *diag);
void neph_canvas_finish(struct neph_canvas *canvas);

/* The whole picture, width_px * height_px * 3 bytes of the size above. */
void neph_canvas_show(struct neph_canvas *canvas, const uint8_t *rgb);

/* A line from top to bottom; 0 is the left side, 1 the right. */
void neph_canvas_split(struct neph_canvas *canvas, double share);

/* Lines of text are as high as this [px], letters `neph_canvas_column_px` wide. */
int neph_canvas_line_px(const struct neph_canvas *canvas);
int neph_canvas_column_px(const struct neph_canvas *canvas);

/* A text on a darkened ground, from the `line`-th line, 0 on top, below 0 from the bottom up; what
 * does not fit into the width is cut. */
void neph_canvas_text(struct neph_canvas *canvas, int line, const uint8_t rgb[3], const char *text);

enum { NEPH_GLYPH_WIDTH = 5, NEPH_GLYPH_HEIGHT = 7 };

/* The rows of a letter from the top, in which bit 4 is the left dot; a box for other characters. */
const uint8_t *neph_font_glyph(char letter);

#endif
