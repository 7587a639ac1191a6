/* SPDX-License-Identifier: MIT */
#include "harness/fly/overlay.h"

#include "harness/engines/engines.h"
#include "harness/fly/controls.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_VIEW_KIND_COUNT == 4, "a new kind");

enum { LINE_SIZE = 256, FIRST_FREE_LINE = 3 };

static const uint8_t plain[3] = {255, 255, 255}, loud[3] = {255, 213, 0}, red[3] = {255, 96, 96};

static void put_head(const struct neph_overlay *overlay, struct neph_canvas *canvas)
{
    char text[LINE_SIZE];
    snprintf(text, sizeof(text), "%s  %s  %dx%d  EV %+.1f  %.3g m/s%s  H: help", overlay->scene,
             overlay->engine, overlay->view->width_px, overlay->view->height_px,
             overlay->view->exposure_ev, overlay->speed_m_per_s,
             overlay->is_paused ? "  time stands still" : "");
    neph_canvas_text(canvas, 0, plain, text);
    snprintf(text, sizeof(text), "frame %.1f ms  render %.1f ms", 1e3 * overlay->frame_s,
             1e3 * overlay->render_s);
    neph_canvas_text(canvas, 1, plain, text);
}

static void put_view(const struct neph_view *view, struct neph_canvas *canvas)
{
    char text[LINE_SIZE] = "", march[64];
    snprintf(march, sizeof(march), "march, %d ray%s a pixel", view->rays_per_px,
             view->rays_per_px == 1 ? "" : "s");
    if (view->kind == NEPH_VIEW_WIPE)
        snprintf(text, sizeof(text), "right of the line: %s", march);
    if (view->kind == NEPH_VIEW_ERROR)
        snprintf(text, sizeof(text),
                 "error against %s: bias %+.2f %%, rmse %.2f %%; blue darker, red brighter, ends "
                 "%g of white",
                 march, 100.0 * view->error.bias, 100.0 * view->error.rmse, NEPH_VIEW_ERROR_SCALE);
    if (view->kind == NEPH_VIEW_FLICKER && view->a4.frame_count == 0)
        snprintf(text, sizeof(text), "flicker: waits for %d frames with a static camera",
                 NEPH_HEAT_FRAMES_MIN);
    else if (view->kind == NEPH_VIEW_FLICKER)
        snprintf(text, sizeof(text),
                 "flicker a4 of %d frames: mean %.2f/255, above 1/255 in %.1f %%; pale is 16/255",
                 view->a4.frame_count, 255.0 * view->a4.mean, 100.0 * view->a4.share_1);
    if (text[0])
        neph_canvas_text(canvas, 2, loud, text);
}

static int put_passes(const struct neph_fly_passes *passes, struct neph_canvas *canvas, int line)
{
    char text[LINE_SIZE];
    for (int i = 0; i < passes->count; i++) {
        snprintf(text, sizeof(text), "%-18s %9.3f ms", passes->passes[i].name,
                 1e3 * passes->passes[i].mean_s);
        neph_canvas_text(canvas, line++, plain, text);
    }
    if (passes->count == 0)
        neph_canvas_text(canvas, line++, plain, "this engine has no pass times");
    return line;
}

static void put_help(struct neph_canvas *canvas, int line)
{
    char text[LINE_SIZE];
    for (const struct neph_fly_help *row = neph_fly_help; row->keys; row++) {
        snprintf(text, sizeof(text), "%-14s %s", row->keys, row->text);
        neph_canvas_text(canvas, line++, plain, text);
    }
    char presets[LINE_SIZE] = "presets       "; /* "0 off  1 seed  2 fixed ..": the key of each
                                                 * preset */
    const struct neph_preset *preset = neph_engine_realtime.presets;
    for (int i = 0; preset[i].name && neph_fly_preset_keys[i]; i++) {
        const size_t used = strlen(presets);
        snprintf(presets + used, sizeof(presets) - used, " %c %s ",
                 toupper((unsigned char)neph_fly_preset_keys[i]), preset[i].name);
    }
    neph_canvas_text(canvas, line, plain, presets);
}

static void put_foot(const struct neph_overlay *overlay, struct neph_canvas *canvas)
{
    char text[LINE_SIZE];
    if (overlay->notice)
        neph_canvas_text(canvas, -1, loud, overlay->notice);
    if (overlay->recorded_frames < 0)
        return;
    snprintf(text, sizeof(text), "recording: %d frames", overlay->recorded_frames);
    neph_canvas_text(canvas, -2, red, text);
}

void neph_overlay_draw(const struct neph_overlay *overlay, struct neph_canvas *canvas)
{
    int line = FIRST_FREE_LINE;
    if (overlay->view->kind == NEPH_VIEW_WIPE)
        neph_canvas_split(canvas, overlay->view->split_share);
    put_head(overlay, canvas);
    put_view(overlay->view, canvas);
    if (overlay->passes)
        line = put_passes(overlay->passes, canvas, line);
    if (overlay->shows_help)
        put_help(canvas, line);
    put_foot(overlay, canvas);
}
