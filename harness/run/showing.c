/* SPDX-License-Identifier: MIT
 *
 * The display chain of a command: settings by frame, and files.
 */
#include "harness/run/showing.h"

#include "base/exr.h"
#include "base/png.h"
#include "harness/compare/frame.h"
#include "renderer/post/display.h"

#include <stdlib.h>
#include <string.h>

enum neph_status neph_display_chain_load(struct neph_display_chain *showing, const char *path,
                                         struct neph_diag *diag)
{
    const enum neph_status status = neph_post_plan_load(path, &showing->plan, diag);
    if (status)
        return status;
    showing->params.order = &showing->plan.order;
    showing->settings = neph_post_plan_settings(&showing->plan);
    return NEPH_OK;
}

void neph_display_chain_finish(struct neph_display_chain *showing)
{
    neph_post_plan_finish(&showing->plan);
}

/* ---- settings -------------------------------------------------------------------------------- */

/* Switches the passes off that the chain's order does not list. */
static void disable_unlisted_passes(const struct neph_post_order *order,
                                    struct neph_settings *settings)
{
    for (int pass = 0; pass < NEPH_POST_PASS_COUNT; pass++) {
        bool is_there = false;
        for (int i = 0; i < order->count; i++)
            is_there = is_there || (int)order->passes[i] == pass;
        if (!is_there)
            settings->values[neph_post_switch_setting((enum neph_post_pass)pass)] = 0.0;
    }
}

static enum neph_status check(const struct neph_display_chain *showing,
                              struct neph_settings *settings, struct neph_diag *diag)
{
    if (showing->params.order)
        disable_unlisted_passes(showing->params.order, settings);
    return neph_post_check(settings, diag);
}

enum neph_status neph_display_chain_check(struct neph_display_chain *showing,
                                          struct neph_diag *diag)
{
    return check(showing, &showing->settings, diag);
}

enum neph_status neph_display_chain_check_size(const struct neph_display_chain *showing,
                                               struct neph_diag *diag)
{
    static const int sizes[] = {POST_UPSCALE, POST_SCREEN_PERCENT, POST_SECONDARY_UPSCALE,
                                POST_SECONDARY_PERCENT};
    for (int i = 0; i < showing->plan.volume_count; i++)
        for (size_t s = 0; s < sizeof(sizes) / sizeof(sizes[0]); s++)
            if (showing->plan.volumes[i].changes.is_given[sizes[s]])
                return neph_fail(diag, NEPH_ERR_USAGE,
                                 "volume '%s' of the chain sets %s, which is the same everywhere "
                                 "in a frame: move it to the chain's own settings",
                                 showing->plan.volumes[i].name, neph_post_options[sizes[s]].name);
    return NEPH_OK;
}

enum neph_status neph_display_chain_set_frame(struct neph_display_chain *showing, int frame,
                                              struct neph_diag *diag)
{
    struct neph_settings *settings = &showing->params.settings;
    struct neph_vec3 place_m = {0.0, 0.0, 0.0};
    *settings = showing->settings;
    showing->params.frame = frame;
    if (showing->scene)
        place_m = neph_scene_camera(showing->scene, frame).position_m;
    neph_post_blend(showing->plan.volumes, showing->plan.volume_count, place_m, settings);
    return check(showing, settings, diag);
}

/* ---- files ----------------------------------------------------------------------------------- */

static enum neph_status write_bytes(const struct neph_image *picture, const char *path,
                                    const uint16_t *codes, struct neph_diag *diag)
{
    const size_t count = 3 * neph_image_pixel_count(picture);
    uint8_t *bytes = malloc(count);
    if (!bytes)
        return neph_fail_memory(diag);
    for (size_t i = 0; i < count; i++)
        bytes[i] = (uint8_t)codes[i];
    const enum neph_status status = neph_png_write_rgb8(path, picture->width_px, picture->height_px,
                                                        bytes, diag);
    free(bytes);
    return status;
}

static enum neph_status write_png(const struct neph_display_chain *showing,
                                  const struct neph_image *picture, const char *path,
                                  struct neph_diag *diag)
{
    const size_t count = 3 * neph_image_pixel_count(picture);
    const bool is_hdr = neph_post_is_hdr(&showing->params.settings);
    const int bits = showing->bits > 0 ? showing->bits : is_hdr ? 10 : 8;
    uint16_t *codes = malloc(count * sizeof(*codes));
    if (!codes)
        return neph_fail_memory(diag);
    neph_post_encode_codes(&showing->params.settings, picture, bits, codes);
    const enum neph_status status =
        bits == 8 ? write_bytes(picture, path, codes, diag)
                  : neph_png_write_rgb16(path, picture->width_px, picture->height_px, bits,
                                         is_hdr ? NEPH_PNG_BT2020_PQ : NEPH_PNG_SRGB, codes, diag);
    free(codes);
    return status;
}

static enum neph_status convert_to_display_light(const struct neph_settings *settings,
                                                 struct neph_image *picture, struct neph_diag *diag)
{
    neph_post_apply_display(settings, picture);
    return neph_image_set_attribute(picture, NEPH_DISPLAY_ATTRIBUTE, diag, "%s",
                                    neph_post_is_hdr(settings) ? "PQ" : "sRGB");
}

enum neph_status neph_display_chain_write(const struct neph_display_chain *showing,
                                          struct neph_image *picture, const char *exr,
                                          const char *png, struct neph_diag *diag)
{
    const struct neph_settings *settings = &showing->params.settings;
    char *text = neph_options_text(neph_post_options, settings);
    enum neph_status status = text ? NEPH_OK : neph_fail_memory(diag);
    if (!status && png)
        status = write_png(showing, picture, png, diag);
    if (!status && neph_post_is_displayed(settings))
        status = convert_to_display_light(settings, picture, diag);
    if (!status)
        status = neph_image_set_attribute(picture, "neph.post", diag, "%s", text);
    if (!status)
        status = neph_exr_write(exr, picture, diag);
    free(text);
    return status;
}
