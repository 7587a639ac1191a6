/* SPDX-License-Identifier: MIT */
#include "renderer/post/display.h"

#include <math.h>

static bool is_encoded(const struct neph_settings *settings)
{
    return settings->values[POST_ENCODE] == POST_ENCODE_SRGB;
}

static double encoded(double linear)
{
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1.0 / 2.4) - 0.055;
}

static double decoded(double code)
{
    return code <= 0.04045 ? code / 12.92 : pow((code + 0.055) / 1.055, 2.4);
}

void neph_post_codes(const struct neph_settings *settings, const struct neph_image *picture,
                     uint8_t *codes)
{
    float *rgb[3];
    if (!neph_image_rgb(picture, NULL, rgb))
        return;
    for (size_t i = 0; i < neph_image_pixel_count(picture); i++)
        for (size_t c = 0; c < 3; c++) {
            const double value = is_encoded(settings) ? rgb[c][i] : encoded(rgb[c][i]);
            codes[3 * i + c] = (uint8_t)lround(255.0 * fmin(fmax(value, 0.0), 1.0));
        }
}

void neph_post_show(const struct neph_settings *settings, struct neph_image *picture)
{
    float *rgb[3];
    if (!is_encoded(settings) || !neph_image_rgb(picture, NULL, rgb))
        return;
    for (size_t i = 0; i < neph_image_pixel_count(picture); i++)
        for (int c = 0; c < 3; c++)
            rgb[c][i] = (float)decoded(rgb[c][i]);
}
