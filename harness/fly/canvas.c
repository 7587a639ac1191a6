/* SPDX-License-Identifier: MIT */
#include "harness/fly/canvas.h"

#include "harness/fly/font.h"

#include <stdlib.h>
#include <string.h>

/* From where on letters of single dots are too small to read. */
enum { WIDTH_MIN_PX = 640, WIDTH_OF_LARGE_TEXT_PX = 1280, MARGIN_DOTS = 2 };

enum neph_status neph_canvas_init(struct neph_canvas *canvas, int width_px, int height_px,
                                  struct neph_diag *diag)
{
    const int zoom = (WIDTH_MIN_PX + width_px - 1) / width_px;
    struct neph_canvas made = {zoom * width_px, zoom * height_px, zoom, NULL};
    made.rgb = calloc((size_t)made.width_px * (size_t)made.height_px, 3);
    if (!made.rgb)
        return neph_fail_memory(diag);
    *canvas = made;
    return NEPH_OK;
}

void neph_canvas_finish(struct neph_canvas *canvas)
{
    free(canvas->rgb);
    canvas->rgb = NULL;
}

static uint8_t *pixel_at(struct neph_canvas *canvas, int x, int y)
{
    return canvas->rgb + 3 * ((size_t)y * (size_t)canvas->width_px + (size_t)x);
}

static void stretch_row(struct neph_canvas *canvas, const uint8_t *from, uint8_t *to)
{
    const int width_px = canvas->width_px / canvas->zoom;
    for (int x = 0; x < width_px; x++, from += 3)
        for (int i = 0; i < canvas->zoom; i++, to += 3)
            memcpy(to, from, 3);
}

void neph_canvas_show(struct neph_canvas *canvas, const uint8_t *rgb)
{
    const size_t row_bytes = 3 * (size_t)canvas->width_px;
    const size_t picture_row_bytes = row_bytes / (size_t)canvas->zoom;
    for (int y = 0; y < canvas->height_px; y++) {
        const size_t row = (size_t)(y / canvas->zoom);
        uint8_t *to = pixel_at(canvas, 0, y);
        if (y % canvas->zoom != 0)
            memcpy(to, to - row_bytes, row_bytes);
        else
            stretch_row(canvas, rgb + row * picture_row_bytes, to);
    }
}

void neph_canvas_split(struct neph_canvas *canvas, double share)
{
    const int x = (int)(share * (canvas->width_px - 1));
    for (int y = 0; y < canvas->height_px; y++)
        memset(pixel_at(canvas, x, y), y / 4 % 2 ? 0xff : 0x00, 3);
}

/* ---- text ------------------------------------------------------------------------------------ */

/* Pixels of a dot. */
static int dot_of(const struct neph_canvas *canvas)
{
    return 1 + canvas->width_px / WIDTH_OF_LARGE_TEXT_PX;
}

int neph_canvas_line_px(const struct neph_canvas *canvas)
{
    return dot_of(canvas) * (NEPH_GLYPH_HEIGHT + 2 * MARGIN_DOTS);
}

int neph_canvas_column_px(const struct neph_canvas *canvas)
{
    return dot_of(canvas) * (NEPH_GLYPH_WIDTH + 1);
}

static void darken(struct neph_canvas *canvas, int top, int width_px)
{
    for (int y = top; y < top + neph_canvas_line_px(canvas); y++) {
        uint8_t *pixel = pixel_at(canvas, 0, y);
        for (int i = 0; i < 3 * width_px; i++)
            pixel[i] /= 4;
    }
}

static void put_dot(struct neph_canvas *canvas, int left, int top, const uint8_t rgb[3])
{
    const int side = dot_of(canvas);
    for (int y = top; y < top + side; y++)
        for (int x = left; x < left + side; x++)
            memcpy(pixel_at(canvas, x, y), rgb, 3);
}

static void put_letter(struct neph_canvas *canvas, int left, int top, const uint8_t rgb[3],
                       char letter)
{
    const uint8_t *rows = neph_font_glyph(letter);
    const int dot = dot_of(canvas);
    for (int y = 0; y < NEPH_GLYPH_HEIGHT; y++)
        for (int x = 0; x < NEPH_GLYPH_WIDTH; x++)
            if (rows[y] >> (NEPH_GLYPH_WIDTH - 1 - x) & 1)
                put_dot(canvas, left + dot * x, top + dot * y, rgb);
}

void neph_canvas_text(struct neph_canvas *canvas, int line, const uint8_t rgb[3], const char *text)
{
    const int line_px = neph_canvas_line_px(canvas), column_px = neph_canvas_column_px(canvas);
    const int margin_px = MARGIN_DOTS * dot_of(canvas);
    const int top = line < 0 ? canvas->height_px + line * line_px : line * line_px;
    const int most = (canvas->width_px - 2 * margin_px) / column_px;
    const int length = (int)strnlen(text, (size_t)most);
    if (top < 0 || top + line_px > canvas->height_px)
        return;
    darken(canvas, top, 2 * margin_px + length * column_px);
    for (int i = 0; i < length; i++)
        put_letter(canvas, margin_px + i * column_px, top + margin_px, rgb, text[i]);
}
