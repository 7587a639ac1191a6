/* SPDX-License-Identifier: MIT */
#include "harness/fly/view.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_VIEW_KIND_COUNT == 4, "a new kind");

/* The flicker map is redrawn every so many frames: it costs more than most frames. */
enum { A4_EVERY_FRAMES = 8 };

enum neph_status neph_view_init(struct neph_view *view, int width_px, int height_px,
                                struct neph_diag *diag)
{
    const size_t bytes = 3 * (size_t)width_px * (size_t)height_px;
    struct neph_view made = {.width_px = width_px, .height_px = height_px};
    made.rgb = calloc(bytes, 1);
    made.march_rgb = calloc(bytes, 1);
    made.a4_rgb = calloc(bytes, 1);
    enum neph_status status = made.rgb && made.march_rgb && made.a4_rgb ? NEPH_OK
                                                                        : neph_fail_memory(diag);
    if (!status)
        status = neph_encoder_create(&made.encoder, diag);
    if (!status)
        status = neph_heat_flicker_create(width_px, height_px, &made.flicker, diag);
    if (status)
        neph_view_finish(&made);
    else
        *view = made;
    return status;
}

void neph_view_finish(struct neph_view *view)
{
    neph_heat_flicker_destroy(view->flicker);
    neph_encoder_destroy(view->encoder);
    free(view->a4_rgb);
    free(view->march_rgb);
    free(view->rgb);
    *view = (struct neph_view){.rgb = NULL};
}

void neph_view_forget(struct neph_view *view)
{
    neph_heat_flicker_forget(view->flicker);
    view->a4.frame_count = 0;
    view->frames_since_a4 = 0;
}

static enum neph_status encode(const struct neph_view *view, const struct neph_image *image,
                               uint8_t *rgb, struct neph_diag *diag)
{
    float *planes[3];
    if (!neph_image_rgb(image, NULL, planes))
        return neph_fail(diag, NEPH_ERR_ENGINE, "a frame has no radiance");
    return neph_encoder_run(view->encoder, (const float *const[]){planes[0], planes[1], planes[2]},
                            view->width_px, view->height_px, view->exposure_ev, rgb, diag);
}

/* Replace the pixels right of the split line by the ray-marched reference. */
static void wipe(const struct neph_view *view)
{
    const int split_px = (int)lround(view->split_share * view->width_px);
    const size_t left = 3 * (size_t)split_px, row_bytes = 3 * (size_t)view->width_px;
    for (size_t row = 0; row < (size_t)view->height_px; row++)
        memcpy(view->rgb + row * row_bytes + left, view->march_rgb + row * row_bytes + left,
               row_bytes - left);
}

static enum neph_status draw_beside_march(struct neph_view *view, struct neph_studio *studio,
                                          const struct neph_image *image, struct neph_diag *diag)
{
    const struct neph_image *march = NULL;
    enum neph_status status = neph_studio_reference(studio, &march, &view->rays_per_px, diag);
    if (status)
        return status;
    if (view->kind == NEPH_VIEW_WIPE) {
        status = encode(view, image, view->rgb, diag);
        if (!status)
            status = encode(view, march, view->march_rgb, diag);
        if (!status)
            wipe(view);
        return status;
    }
    return neph_heat_error(march, image, view->exposure_ev, NEPH_VIEW_ERROR_SCALE, &view->error,
                           view->rgb, diag);
}

/* Draw the flicker map; the plain frame until there are enough frames. */
static enum neph_status draw_flicker(struct neph_view *view, const struct neph_image *image,
                                     bool rests, struct neph_diag *diag)
{
    if (!rests)
        neph_view_forget(view);
    const enum neph_status status = neph_heat_flicker_add(view->flicker, image, view->exposure_ev,
                                                          diag);
    if (status)
        return status;
    view->frames_since_a4++;
    const bool is_due = view->a4.frame_count == 0 || view->frames_since_a4 >= A4_EVERY_FRAMES;
    if (is_due && neph_heat_flicker_show(view->flicker, &view->a4, view->a4_rgb))
        view->frames_since_a4 = 0;
    if (view->a4.frame_count == 0)
        return encode(view, image, view->rgb, diag);
    memcpy(view->rgb, view->a4_rgb, 3 * (size_t)view->width_px * (size_t)view->height_px);
    return NEPH_OK;
}

enum neph_status neph_view_draw(struct neph_view *view, struct neph_studio *studio,
                                const struct neph_image *image, bool rests, struct neph_diag *diag)
{
    view->rays_per_px = 0;
    switch (view->kind) {
    case NEPH_VIEW_WIPE:
    case NEPH_VIEW_ERROR:
        return draw_beside_march(view, studio, image, diag);
    case NEPH_VIEW_FLICKER:
        return draw_flicker(view, image, rests, diag);
    case NEPH_VIEW_PICTURE:
    case NEPH_VIEW_KIND_COUNT:
        break;
    }
    return encode(view, image, view->rgb, diag);
}
